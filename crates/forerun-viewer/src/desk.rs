//! Desk: what the user works with, without a window: what keys ask for is done here, and what the mouse does.

use forerun::{BodyId, BodyKind, Sample, Vec3};
use three_d::Event;

use crate::actions::{Action, action_of};
use crate::camera::{Camera, Framed};
use crate::hands::Hands;
use crate::input::Input;
use crate::session::{Play, Session};
use crate::view::{Tool, View};

/// Half and double speed.
const SPEED_FACTOR: f64 = 2.0;

/// What the user works with.
#[derive(Debug)]
pub struct Desk<'a> {
    /// The scene that is open.
    pub session: &'a mut Session,
    /// What is shown and how.
    pub view: &'a mut View,
    /// Where it is seen from.
    pub camera: &'a mut Camera,
    /// What the mouse does.
    pub hands: &'a mut Hands,
}

/// What the keys ask for that nobody has taken yet.
pub fn keys_of(input: &mut Input) -> Vec<Action> {
    let mut asked = Vec::new();
    for event in &mut input.events {
        if let Event::KeyPress { kind, modifiers, handled: handled @ false } = event
            && let Some(action) = action_of(*kind, *modifiers)
        {
            *handled = true;
            asked.push(action);
        }
    }
    asked
}

impl Desk<'_> {
    /// Takes what the mouse did since the last picture.
    pub fn take_mouse(&mut self, input: &mut Input) {
        let opened = self.session.opened;
        if let Some(play) = self.session.play_mut() {
            self.hands.take(input, (play, opened), self.camera, self.view);
        }
    }

    /// The window is not looked at any more: nobody tells when keys and buttons are let go.
    pub fn lose_focus(&mut self) {
        if let Some(play) = self.session.play_mut() {
            self.hands.let_go(play);
        }
        self.camera.motion.release();
        self.camera.motion.turning = false;
    }

    /// Does what a key, a menu or a button asks for, as far as it needs no window.
    pub fn perform(&mut self, action: Action) {
        let Desk { session, view, .. } = self;
        match action {
            Action::Reload => session.reload(),
            Action::Coupled => {
                if let Some(play) = session.play_mut() {
                    self.hands.cancel(play);
                }
                session.switch_driver();
            }
            Action::Help => view.open.help ^= true,
            Action::Plots => view.open.plots ^= true,
            Action::Inspector => view.open.inspector ^= true,
            Action::Ghosts => view.ghosts.shown ^= true,
            Action::Contacts => view.overlays.contacts ^= true,
            Action::NextColour => view.colour_by = view.colour_by.next(),
            Action::SelectTool => view.grip.tool = Tool::Select,
            Action::ThrowTool => view.grip.tool = Tool::Throw,
            Action::PushTool => view.grip.tool = Tool::Push,
            action => self.perform_in_scene(action),
        }
    }

    /// Actions that need a scene.
    fn perform_in_scene(&mut self, action: Action) {
        let Some(play) = self.session.play_mut() else { return };
        match action {
            Action::Focus => focus(play, self.camera, play.selection.bodies()),
            Action::FrameAll => focus(play, self.camera, &[]),
            Action::Add | Action::Delete | Action::Duplicate => {
                // A step of its own: what is in hand ends before it.
                self.hands.let_go(play);
                match action {
                    Action::Add => self.hands.add(play, self.camera, &self.view.grip),
                    Action::Delete => play.remove_selected(),
                    _ => play.duplicate_selected(),
                }
            }
            Action::SelectAll => play.select_all(),
            Action::Deselect => {
                if !self.hands.cancel(play) {
                    play.selection.clear();
                }
            }
            Action::Undo => {
                // What is in hand is the last thing that was done.
                if !self.hands.cancel(play) {
                    play.undo();
                }
            }
            Action::Redo => {
                self.hands.cancel(play);
                play.redo();
            }
            action => perform_in_time(play, action),
        }
    }
}

fn perform_in_time(play: &mut Play, action: Action) {
    if play.is_coupled() && action != Action::PlayPause {
        // The traditional driver has neither a past nor a future to go to.
        return;
    }
    let snapshot = play.picture.snapshot.clone();
    match action {
        Action::PlayPause => play.set_paused(!play.paused),
        Action::StepForward => play.step(1),
        Action::StepBack => play.step(-1),
        Action::JumpForward => play.seek(play.picture.time_s + 1.0),
        Action::JumpBack => play.seek(play.picture.time_s - 1.0),
        Action::GoToStart => play.seek(play.seconds_of(snapshot.oldest())),
        Action::GoToHorizon => play.seek(play.seconds_of(snapshot.horizon())),
        Action::Slower => play.set_speed(play.speed / SPEED_FACTOR),
        Action::Faster => play.set_speed(play.speed * SPEED_FACTOR),
        Action::Rewind => play.set_rewinding(!play.rewinding),
        _ => {}
    }
}

/// Travels to bodies; with none to all, but for strays.
fn focus(play: &Play, camera: &mut Camera, bodies: &[BodyId]) {
    let (balls, free) = (balls_of(play, bodies), camera.motion.free);
    let Some(around) = Framed::around(&balls, free) else { return };
    if bodies.is_empty() {
        camera.travel(around);
    } else {
        // From the direction that it looks in already.
        let Framed { yaw, pitch, .. } = camera.framed();
        camera.travel(Framed { yaw, pitch, ..around }.fitting(&balls, free));
    }
}

/// Balls around bodies as they are drawn: those picked, or with none what moves, and what does not where it is no larger than all that does.
fn balls_of(play: &Play, bodies: &[BodyId]) -> Vec<(Vec3, f32)> {
    let ball = |(id, sample): &(BodyId, Sample)| {
        let body = play.body(*id).filter(|body| body.radius.is_finite())?;
        let ball = (sample.pose.transform_point(body.frame.position), body.radius);
        Some((*id, body.kind != BodyKind::Fixed, ball))
    };
    let balls = || play.samples.iter().filter_map(ball);
    if !bodies.is_empty() {
        return balls().filter(|(id, ..)| bodies.contains(id)).map(|(.., ball)| ball).collect();
    }
    let moving: Vec<(Vec3, f32)> = balls().filter(|(_, moves, _)| *moves).map(|(.., ball)| ball).collect();
    let low = moving.iter().fold(Vec3::INFINITY, |low, (at, radius)| low.min(*at - *radius));
    let high = moving.iter().fold(Vec3::NEG_INFINITY, |high, (at, radius)| high.max(*at + *radius));
    let reach = if moving.is_empty() { f32::INFINITY } else { 0.5 * (high - low).length() };
    let fixed = balls().filter(|(_, moves, (_, radius))| !moves && *radius <= reach);
    moving.into_iter().chain(fixed.map(|(.., ball)| ball)).collect()
}
