//! Harness: plays mouse and keys to a session with its real driver, without a window.

#![allow(dead_code, reason = "each test file uses a part of it")]

use std::time::Duration;

use forerun::scene::Format;
use forerun::{BodyId, BodyState, Clock, Frame, Pose};
use forerun_viewer::SceneSource;
use forerun_viewer::camera::Camera;
use forerun_viewer::desk::{Desk, keys_of};
use forerun_viewer::hands::Hands;
use forerun_viewer::host::Host;
use forerun_viewer::input::Input;
use forerun_viewer::report::{Report, Reported, Window};
use forerun_viewer::session::{Play, Session, Stage};
use forerun_viewer::view::{Tool, View};
use three_d::{Event, Key, Modifiers, MouseButton, PhysicalPoint, Viewport};

/// Width and height of the window.
pub(crate) const SIZE: [u32; 2] = [1280, 720];
/// From picture to picture. Seconds.
pub(crate) const INTERVAL_S: f64 = 1.0 / 60.0;
/// How far timelines look ahead.
pub(crate) const LOOKAHEAD: u64 = 100;

/// Boxes on the ground, and a ball that hangs in the air without gravity.
pub(crate) const BOXES: &str = r#"
name = "boxes"
[[bodies]]
shape = "half_space"
kind = "fixed"
[[bodies]]
shape = { box = { half_extents = [0.5, 0.5, 0.5] } }
position = [0.0, 0.5, 0.0]
[[bodies]]
shape = { box = { half_extents = [0.5, 0.5, 0.5] } }
position = [0.0, 1.5, 0.0]
[[bodies]]
shape = { box = { half_extents = [0.5, 0.5, 0.5] } }
position = [3.0, 0.5, 0.0]
[[bodies]]
shape = { sphere = { radius = 0.3 } }
position = [-2.0, 2.0, 0.0]
gravity_scale = 0.0
"#;

/// Somebody who sits before the viewer.
pub(crate) struct User {
    pub(crate) session: Session,
    pub(crate) view: View,
    pub(crate) camera: Camera,
    pub(crate) hands: Hands,
    pub(crate) modifiers: Modifiers,
    /// The window's clock. Seconds.
    pub(crate) real_s: f64,
}

impl User {
    /// Opens a scene, looks at all of it from the front, and waits until physics has looked ahead.
    pub(crate) fn of(text: &str) -> User {
        let source =
            SceneSource::Text { name: "scene".to_owned(), text: text.to_owned(), format: Format::Toml };
        User::of_source(source)
    }

    pub(crate) fn of_source(source: SceneSource) -> User {
        let mut camera = Camera::default();
        (camera.yaw, camera.pitch, camera.distance, camera.target) = (0.0, 0.2, 12.0, forerun::Vec3::Y);
        let mut user = User {
            session: Session::new(Host::default(), source),
            view: View::default(),
            camera,
            hands: Hands::default(),
            modifiers: Modifiers::default(),
            real_s: 0.0,
        };
        user.wait("the scene starts", |user| {
            user.picture_now(Vec::new());
            assert!(!matches!(user.session.stage, Stage::Failed(_)), "{:?}", user.session.stage);
            user.session.play().is_some()
        });
        user.settle();
        user
    }

    pub(crate) fn play(&mut self) -> &mut Play {
        self.session.play_mut().expect("the scene plays")
    }

    pub(crate) fn desk(&mut self) -> Desk<'_> {
        let User { session, view, camera, hands, .. } = self;
        Desk { session, view, camera, hands }
    }

    /// A picture at the same time as the last.
    pub(crate) fn picture_now(&mut self, events: Vec<Event>) {
        let viewport = Viewport::new_at_origo(SIZE[0], SIZE[1]);
        let (real_s, elapsed_s) = (self.real_s, INTERVAL_S);
        let mut input = Input { events, viewport, pixels_per_point: 1.0, real_s, elapsed_s };
        self.session.show(real_s);
        for action in keys_of(&mut input) {
            self.desk().perform(action);
        }
        self.desk().take_mouse(&mut input);
    }

    /// The next picture.
    pub(crate) fn picture(&mut self, events: Vec<Event>) {
        self.real_s += INTERVAL_S;
        self.picture_now(events);
    }

    /// So many pictures, each when physics has done its work: no machine is too slow for it.
    pub(crate) fn pictures(&mut self, count: u32) {
        for _ in 0..count {
            self.settle();
            self.picture(Vec::new());
        }
    }

    /// Waits until physics has heard and computed everything.
    pub(crate) fn settle(&mut self) {
        if self.play().is_coupled() {
            return;
        }
        self.play().driver.request_fork().expect("room");
        self.wait("physics has heard everything", |user| user.play().driver.take_fork().is_some());
        self.wait("physics has computed everything", |user| {
            user.picture_now(Vec::new());
            let picture = &user.play().picture;
            picture.snapshot.valid_to() >= picture.frame.plus(LOOKAHEAD)
        });
    }

    pub(crate) fn wait(&mut self, what: &str, mut ready: impl FnMut(&mut User) -> bool) {
        let clock = Clock::system();
        while !ready(self) {
            assert!(clock.now() < Duration::from_secs(60), "waited for long: {what}");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    pub(crate) fn report(&self) -> Report {
        let viewport = Viewport::new_at_origo(SIZE[0], SIZE[1]);
        Report::of(&Reported {
            session: &self.session,
            view: &self.view,
            hands: &self.hands,
            camera: &self.camera,
            window: Window { viewport, pixels_per_point: 1.0 },
            pictures: 0,
        })
    }

    pub(crate) fn key(&mut self, kind: Key, modifiers: Modifiers) {
        self.picture_now(vec![Event::KeyPress { kind, modifiers, handled: false }]);
    }

    pub(crate) fn ctrl(&mut self, kind: Key) {
        self.key(kind, Modifiers { ctrl: true, command: true, ..Modifiers::default() });
    }

    /// Where the centre of a body is. Pixels from the left and the top.
    pub(crate) fn pixel(&self, body: u32) -> [f32; 2] {
        let play = self.report().play.expect("the scene plays");
        let seen = play.in_sight.iter().find(|seen| seen.id == body);
        seen.unwrap_or_else(|| panic!("body {body} is not in sight: {:?}", play.in_sight)).pixel
    }

    fn point(pixel: [f32; 2]) -> PhysicalPoint {
        PhysicalPoint { x: pixel[0], y: SIZE[1] as f32 - pixel[1] }
    }

    pub(crate) fn press(&self, pixel: [f32; 2]) -> Event {
        let (button, modifiers) = (MouseButton::Left, self.modifiers);
        Event::MousePress { button, position: User::point(pixel), modifiers, handled: false }
    }

    pub(crate) fn motion(&self, pixel: [f32; 2]) -> Event {
        let (button, modifiers) = (Some(MouseButton::Left), self.modifiers);
        Event::MouseMotion {
            button,
            delta: (1.0, 1.0),
            position: User::point(pixel),
            modifiers,
            handled: false,
        }
    }

    pub(crate) fn release(&self, pixel: [f32; 2]) -> Event {
        let (button, modifiers) = (MouseButton::Left, self.modifiers);
        Event::MouseRelease { button, position: User::point(pixel), modifiers, handled: false }
    }

    pub(crate) fn click(&mut self, pixel: [f32; 2]) {
        let events = vec![self.press(pixel), self.release(pixel)];
        self.picture_now(events);
    }

    pub(crate) fn take(&mut self, tool: Tool) {
        self.view.grip.tool = tool;
    }

    /// All states that are stored up to a frame, in bits.
    pub(crate) fn states_to(&mut self, last: u64) -> Vec<(u64, BodyId, BodyState)> {
        let snapshot = self.play().picture.snapshot.clone();
        let frames = (snapshot.oldest().0..=last).map(Frame);
        frames
            .flat_map(|frame| {
                let bodies: Vec<BodyId> = snapshot.bodies_at(frame).collect();
                let state = |body| (frame.0, body, *snapshot.state(body, frame).expect("it is stored"));
                bodies.into_iter().map(state).collect::<Vec<_>>()
            })
            .collect()
    }

    /// Where a body is at a frame.
    pub(crate) fn pose_at(&mut self, body: u32, frame: u64) -> Pose {
        let play = self.play();
        let snapshot = play.picture.snapshot.clone();
        snapshot.pose(BodyId(body), play.seconds_of(Frame(frame))).expect("it is there")
    }
}
