//! Report: the state of the viewer as plain values, for scripts that play it with mouse and keys and check what came of it.

use forerun::{BodyId, Sample, Vec3};
use serde::Serialize;
use three_d::Viewport;

use crate::camera::Camera;
use crate::hands::Hands;
use crate::session::{Play, Session, Stage};
use crate::view::View;

/// So many bodies are told of that can be clicked at.
const IN_SIGHT_MAX: usize = 16;

/// The window as it was at the last picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// All of it. Pixels.
    pub viewport: Viewport,
    /// Pixels per point of the system's unit.
    pub pixels_per_point: f32,
}

impl Default for Window {
    fn default() -> Self {
        Window { viewport: Viewport::new_at_origo(1, 1), pixels_per_point: 1.0 }
    }
}

/// Where the timeline strip was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripPlace {
    /// Left, top, width and height. Points, from the window's top left corner.
    pub rect: [f32; 4],
    /// The time at its left end. Seconds.
    pub from_s: f64,
    /// The time at its right end. Seconds.
    pub to_s: f64,
}

/// What is reported on.
#[derive(Clone, Copy, Debug)]
pub struct Reported<'a> {
    /// What is open.
    pub session: &'a Session,
    /// How it is shown.
    pub view: &'a View,
    /// What the mouse does.
    pub hands: &'a Hands,
    /// From where it is seen.
    pub camera: &'a Camera,
    /// Into what.
    pub window: Window,
    /// Pictures drawn so far.
    pub pictures: u64,
}

/// What a script may ask about. Pixels are counted from the window's top left corner.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// `loading`, `playing` or `failed`.
    pub stage: &'static str,
    /// Why it failed.
    pub failure: Option<String>,
    /// What is open.
    pub scene: String,
    /// How many scenes were opened so far.
    pub opened: u64,
    /// Pictures drawn so far.
    pub pictures: u64,
    /// Width and height. Pixels.
    pub window: [u32; 2],
    /// Pixels per point of the system's unit.
    pub pixels_per_point: f32,
    /// Where a press puts the playhead.
    pub strip: Option<StripReport>,
    /// What a press of the left button does: `select`, `throw` or `push`.
    pub tool: &'static str,
    /// How much slower every step is made. Seconds.
    pub slow_down_s: f32,
    /// How it is shown.
    pub view: View,
    /// The scene that plays.
    pub play: Option<PlayReport>,
}

/// The timeline strip. Pixels.
#[derive(Clone, Debug, Serialize)]
pub struct StripReport {
    /// Its left edge.
    pub x: f32,
    /// Its upper edge.
    pub y: f32,
    /// From left to right.
    pub width: f32,
    /// From top to bottom.
    pub height: f32,
    /// The time at its left end. Seconds.
    pub from_s: f64,
    /// The time at its right end. Seconds.
    pub to_s: f64,
}

/// A scene that plays.
#[derive(Clone, Debug, Serialize)]
pub struct PlayReport {
    /// Display time. Seconds.
    pub time_s: f64,
    /// The frame that is shown.
    pub frame: u64,
    /// Seconds.
    pub horizon_s: f64,
    /// Seconds.
    pub oldest_s: f64,
    /// The last frame that is true for all bodies.
    pub valid_to: u64,
    /// Whether the user paused it.
    pub paused: bool,
    /// Whether it runs backwards.
    pub rewinding: bool,
    /// How fast it is to go.
    pub speed: f64,
    /// Whether the traditional driver plays.
    pub coupled: bool,
    /// How many bodies are drawn.
    pub bodies: usize,
    /// Ids of the bodies that are picked.
    pub selected: Vec<u32>,
    /// Where the last one picked is. Metres.
    pub selected_position: Option<[f32; 3]>,
    /// How fast the last one picked is. m/s.
    pub selected_speed: Option<f32>,
    /// How many steps can be taken back.
    pub undo: usize,
    /// How many can be done again.
    pub redo: usize,
    /// What is taken back next.
    pub undo_label: Option<String>,
    /// What is done again next.
    pub redo_label: Option<String>,
    /// Where a command acts that is given now.
    pub edit_frame: u64,
    /// The body that the mouse drags.
    pub dragged: Option<u32>,
    /// Whether a throw is aimed.
    pub aiming: bool,
    /// What would come of the throw.
    pub preview: Option<PreviewReport>,
    /// The last body that was thrown or added.
    pub thrown: Option<u32>,
    /// Of all poses as they are drawn: the same exactly when everything is where it was.
    pub samples_hash: String,
    /// Bodies that a click at their centre would pick, those nearest to the middle first; a panel may still be before them.
    pub in_sight: Vec<SightReport>,
    /// The last message to the user.
    pub notice: Option<String>,
}

/// What would come of a throw.
#[derive(Clone, Debug, Serialize)]
pub struct PreviewReport {
    /// The name that the body will have.
    pub body: u32,
    /// How many frames are known.
    pub frames: usize,
    /// Where it is after the last of them. Metres.
    pub end: [f32; 3],
}

/// A body that can be clicked at.
#[derive(Clone, Debug, Serialize)]
pub struct SightReport {
    /// Its name.
    pub id: u32,
    /// Its centre. Metres.
    pub position: [f32; 3],
    /// m/s.
    pub speed: f32,
    /// Where its centre is in the picture. Pixels.
    pub pixel: [f32; 2],
}

impl Report {
    /// The state now.
    #[must_use]
    pub fn of(reported: &Reported<'_>) -> Report {
        let Reported { session, view, window, pictures, .. } = *reported;
        let (stage, failure) = match &session.stage {
            Stage::Loading(_) => ("loading", None),
            Stage::Playing(_) => ("playing", None),
            Stage::Failed(message) => ("failed", Some(message.clone())),
        };
        let scale = window.pixels_per_point * view.scale;
        Report {
            stage,
            failure,
            scene: session.source.name(),
            opened: session.opened,
            pictures,
            window: [window.viewport.width, window.viewport.height],
            pixels_per_point: window.pixels_per_point,
            strip: session.strip.map(|strip| StripReport::of(&strip, scale)),
            tool: view.grip.tool.name(),
            slow_down_s: session.slow_down_s,
            view: *view,
            play: session.play().map(|play| PlayReport::of(play, reported)),
        }
    }
}

impl StripReport {
    fn of(strip: &StripPlace, scale: f32) -> StripReport {
        let [x, y, width, height] = strip.rect.map(|points| points * scale);
        StripReport { x, y, width, height, from_s: strip.from_s, to_s: strip.to_s }
    }
}

impl PlayReport {
    fn of(play: &Play, reported: &Reported<'_>) -> PlayReport {
        let snapshot = &play.picture.snapshot;
        let active = play.selection.active().and_then(|body| play.sample(body));
        let (undo, undo_count) = play.to_undo();
        let (redo, redo_count) = play.to_redo();
        let id = |body: BodyId| body.0;
        PlayReport {
            time_s: play.picture.time_s,
            frame: play.picture.frame.0,
            horizon_s: play.seconds_of(snapshot.horizon()),
            oldest_s: play.seconds_of(snapshot.oldest()),
            valid_to: snapshot.valid_to().0,
            paused: play.paused,
            rewinding: play.rewinding,
            speed: play.speed,
            coupled: play.is_coupled(),
            bodies: play.samples.len(),
            selected: play.selection.bodies().iter().map(|body| body.0).collect(),
            selected_position: active.map(|sample| sample.pose.position.to_array()),
            selected_speed: active.map(|sample| sample.velocity.length()),
            undo: undo_count,
            redo: redo_count,
            undo_label: undo.map(|step| step.label.clone()),
            redo_label: redo.map(|step| step.label.clone()),
            edit_frame: play.edit_frame().0,
            dragged: reported.hands.dragged().map(id),
            aiming: reported.hands.is_aiming(),
            preview: preview_of(play),
            thrown: play.added.map(id),
            samples_hash: format!("{:016x}", hash_of(&play.samples)),
            in_sight: in_sight(play, reported),
            notice: play.notice.last().cloned(),
        }
    }
}

fn preview_of(play: &Play) -> Option<PreviewReport> {
    let trail = play.preview()?.trails.iter().find(|trail| trail.body == play.coming_body())?;
    let end = trail.poses.last()?.position.to_array();
    Some(PreviewReport { body: trail.body.0, frames: trail.poses.len(), end })
}

/// FNV-1a of names and poses.
#[must_use]
pub fn hash_of(samples: &[(BodyId, Sample)]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |bits: u32| {
        for byte in bits.to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    for (id, sample) in samples {
        add(id.0);
        let numbers = sample.pose.position.to_array().into_iter().chain(sample.pose.rotation.to_array());
        numbers.for_each(|number| add(number.to_bits()));
    }
    hash
}

fn in_sight(play: &Play, reported: &Reported<'_>) -> Vec<SightReport> {
    let Viewport { width, height, .. } = reported.window.viewport;
    let size = [width as f32, height as f32];
    let dynamic = |id: BodyId| play.body(id).is_some_and(|body| body.is_dynamic());
    let mut seen: Vec<(f32, SightReport)> = play
        .samples
        .iter()
        .filter(|(id, _)| dynamic(*id))
        .filter_map(|(id, sample)| {
            let position = sample.pose.position;
            let [x, y] = pixel_of(reported.camera, size, position)?;
            let inside = (0.0..size[0]).contains(&x) && (0.0..size[1]).contains(&y);
            let off = (x - 0.5 * size[0]).hypot(y - 0.5 * size[1]);
            let speed = sample.velocity.length();
            inside
                .then(|| (off, SightReport { id: id.0, position: position.to_array(), speed, pixel: [x, y] }))
        })
        .collect();
    seen.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let snapshot = &play.picture.snapshot;
    let clear = |report: &SightReport| {
        let [x, y] = report.pixel;
        let ray = reported.camera.ray(x / size[0] * 2.0 - 1.0, 1.0 - y / size[1] * 2.0, size[0] / size[1]);
        let hit = snapshot.cast_ray(play.picture.time_s, &ray, f32::INFINITY);
        hit.is_some_and(|hit| hit.body.0 == report.id)
    };
    // To look for them all would take long in a large scene.
    seen.into_iter()
        .map(|(_, report)| report)
        .take(4 * IN_SIGHT_MAX)
        .filter(clear)
        .take(IN_SIGHT_MAX)
        .collect()
}

/// Where a point of the world is in the picture, from its top left corner; none behind the eye.
fn pixel_of(camera: &Camera, [width, height]: [f32; 2], point: Vec3) -> Option<[f32; 2]> {
    let [x, y] = camera.project(point, width / height)?;
    Some([0.5 * (x + 1.0) * width, 0.5 * (1.0 - y) * height])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_where_the_ray_through_it_goes() {
        let camera = Camera {
            target: Vec3::new(1.0, 2.0, 3.0),
            yaw: 2.0,
            pitch: 0.3,
            distance: 7.0,
            ..Camera::default()
        };
        let size = [1280.0, 720.0];
        let ray = camera.ray(0.4, -0.3, size[0] / size[1]);
        let [x, y] = pixel_of(&camera, size, ray.origin + ray.direction * 5.0).expect("before the eye");
        assert!((x - 0.7 * 1280.0).abs() < 0.05 && (y - 0.65 * 720.0).abs() < 0.05, "{x} {y}");
        assert_eq!(pixel_of(&camera, size, ray.origin - ray.direction), None);
    }
}
