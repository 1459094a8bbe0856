//! Ghosts: what is still to come, as far as it is computed: transparent bodies (dissertation, figure 5.7), trails, and what a throw would do.

use forerun::{BodyId, BodyKind, Frame, Pose, Sample, Vec3};
use three_d::{Context, Cull, RenderStates};

use super::colours::Paint;
use super::crowd::{Crowd, Drawn, Mark};
use super::eye::Eye;
use super::lines::{Ink, Lines};
use super::programs::{CLEAR, Programs};
use super::surface::Surfaces;
use super::{Extras, Scenery};
use crate::session::Play;
use crate::view::View;

/// A body that gets no farther than this part of its radius leaves no ghost.
const STAYS: f32 = 0.02;
/// And turns no more than this. Radians, nearly.
const TURNS: f32 = 0.02;
/// So many bodies of a selection leave trails.
const TRAILS_MAX: usize = 64;
/// So many ghosts of one body are drawn.
const GHOSTS_MAX: u32 = 20;

/// How opaque things at hand and glass are.
const HELD: f32 = 0.5;
const GLASS: f32 = 0.16;

const AIM: Ink = [255, 190, 60, 255];
const GRAB: Ink = [255, 225, 120, 255];
const PREVIEW: [u8; 3] = [255, 196, 84];

/// One picture of what is to come.
#[derive(Default)]
struct Layer {
    crowd: Crowd,
    opacity: f32,
}

/// What is still to come.
#[derive(Default)]
pub(super) struct Ghosts {
    /// The farthest in time first.
    layers: Vec<Layer>,
    used: usize,
    /// What the hands show.
    held: Crowd,
    samples: Vec<(BodyId, Sample)>,
    /// Those of the layer before, which is farther in time.
    farther: Vec<(BodyId, Sample)>,
}

impl Ghosts {
    /// Another scene.
    pub(super) fn forget(&mut self) {
        *self = Ghosts::default();
    }

    /// Places all ghosts of a picture.
    pub(super) fn place(&mut self, context: &Context, surfaces: &mut Surfaces, scenery: &Scenery<'_>) {
        let Scenery { play, view, extras, .. } = *scenery;
        self.used = 0;
        self.samples.clear();
        if view.ghosts.shown {
            let paint = Paint::of(play, view.colour_by, scenery.inside);
            for (time_s, opacity) in times_of(play, view) {
                self.place_layer(context, surfaces, (play, &paint), (time_s, opacity));
            }
        }
        self.held.begin();
        let [red, green, blue] = PREVIEW;
        let last = extras.preview.iter().filter_map(|track| Some((&track.shape, track.poses.last()?)));
        let shown = last.chain(extras.held.as_ref().map(|(shape, pose)| (shape, pose)));
        for (shape, pose) in shown {
            if let Some(seat) = self.held.seat(context, surfaces, shape) {
                let ink = [red, green, blue, 255];
                self.held.add(seat, &Drawn { shape, pose, ink, mark: Mark::None });
            }
        }
        self.held.send();
    }

    fn place_layer(
        &mut self,
        context: &Context,
        surfaces: &mut Surfaces,
        (play, paint): (&Play, &Paint<'_>),
        (time_s, opacity): (f64, f32),
    ) {
        if self.used == self.layers.len() {
            self.layers.push(Layer::default());
        }
        let layer = &mut self.layers[self.used];
        self.used += 1;
        layer.opacity = opacity;
        layer.crowd.begin();
        std::mem::swap(&mut self.samples, &mut self.farther);
        play.picture.snapshot.sample_all(time_s, &mut self.samples);
        let mut now = Walk { rest: &play.samples };
        let mut farther = Walk { rest: &self.farther };
        for (id, sample) in &self.samples {
            let Some(body) = play.body(*id).filter(|body| body.kind != BodyKind::Fixed) else { continue };
            let same = |other: Option<&Sample>| {
                other.is_some_and(|other| stays(&other.pose, &sample.pose, body.radius))
            };
            // Who is there already, now or in a ghost, is drawn there once.
            if same(now.find(*id)) || same(farther.find(*id)) {
                continue;
            }
            if let Some(seat) = layer.crowd.seat(context, surfaces, &body.shape) {
                let [red, green, blue] = paint.colour(*id, body, sample);
                let ink = [red, green, blue, 255];
                let drawn = Drawn { shape: &body.shape, pose: &sample.pose, ink, mark: Mark::None };
                layer.crowd.add(seat, &drawn);
            }
        }
        layer.crowd.send();
    }

    /// Draws them over what is there now, and what is of glass.
    pub(super) fn draw(&self, programs: &Programs, eye: &Eye, (glass, surfaces): (&Crowd, &Surfaces)) {
        let program = &programs.ghost;
        program.use_uniform("viewProjection", eye.view_projection);
        program.use_uniform("eye", super::convert::vector(eye.position));
        let layers = self.layers[..self.used].iter().map(|layer| (&layer.crowd, layer.opacity));
        for (crowd, opacity) in layers.chain([(&self.held, HELD), (glass, GLASS)]) {
            if crowd.is_empty() {
                continue;
            }
            program.use_uniform("opacity", opacity);
            crowd.draw(program, RenderStates { cull: Cull::Back, ..CLEAR }, eye.viewport, surfaces);
        }
    }
}

/// Goes through samples, which are sorted by body, with ever larger bodies.
struct Walk<'a> {
    rest: &'a [(BodyId, Sample)],
}

impl<'a> Walk<'a> {
    fn find(&mut self, id: BodyId) -> Option<&'a Sample> {
        while let [(first, sample), rest @ ..] = self.rest {
            if *first >= id {
                return (*first == id).then_some(sample);
            }
            self.rest = rest;
        }
        None
    }
}

/// When ghosts are shown and how opaque they are: evenly from display time to the horizon, the farthest first and faintest.
fn times_of(play: &Play, view: &View) -> Vec<(f64, f32)> {
    let snapshot = &play.picture.snapshot;
    let horizon_s = snapshot.horizon().seconds(snapshot.frame_seconds());
    ghost_times(play.picture.time_s, horizon_s, view.ghosts.count)
        .into_iter()
        .map(|(time_s, part)| (time_s, view.ghosts.opacity * (1.0 - 0.6 * part)))
        .collect()
}

/// Times (seconds) from the farthest to the nearest, and how far each is between the nearest (0) and the farthest (1).
fn ghost_times(now_s: f64, horizon_s: f64, count: u32) -> Vec<(f64, f32)> {
    let count = count.clamp(1, GHOSTS_MAX);
    if horizon_s <= now_s {
        return Vec::new();
    }
    let time = |k: u32| now_s + (horizon_s - now_s) * f64::from(k) / f64::from(count);
    let part = |k: u32| (k - 1) as f32 / (count.max(2) - 1) as f32;
    (1..=count).rev().map(|k| (time(k), part(k))).collect()
}

/// Whether a body is nearly where it was.
fn stays(now: &Pose, then: &Pose, radius: f32) -> bool {
    let moved = (now.position - then.position).length();
    let turned = 2.0 * (1.0 - now.rotation.dot(then.rotation).abs()).max(0.0).sqrt();
    moved < STAYS * radius && turned < TURNS
}

/// Trails of the selection, and what the hands show.
pub(super) fn draw_trails(lines: &mut Lines, play: &Play, view: &View, extras: &Extras) {
    if view.ghosts.trails {
        for id in play.selection.bodies().iter().take(TRAILS_MAX) {
            let points = trail_of(play, *id, view.ghosts.trail_seconds);
            let [red, green, blue] = [255, 205, 90];
            lines.path(&points, 2.0, |part| [red, green, blue, (235.0 * (1.0 - 0.85 * part)) as u8]);
        }
    }
    for track in &extras.preview {
        let points: Vec<Vec3> = track.poses.iter().map(|pose| pose.position).collect();
        let [red, green, blue] = PREVIEW;
        lines.path(&points, 2.5, |part| [red, green, blue, (255.0 * (1.0 - 0.7 * part)) as u8]);
    }
    if let Some(aim) = extras.aim {
        lines.arrow(aim, 3.0, AIM);
    }
    if let Some(grab) = extras.grab {
        lines.line(grab, 2.5, GRAB);
        grab.into_iter().for_each(|end| lines.dot(end, 9.0, GRAB));
    }
}

/// Where the middle of a body will be, frame by frame, as far as it is known to be true.
fn trail_of(play: &Play, id: BodyId, seconds: f32) -> Vec<Vec3> {
    let snapshot = &play.picture.snapshot;
    let frames = (seconds / snapshot.frame_seconds()).ceil().max(0.0) as u64;
    let from = play.picture.frame;
    let to = Frame(from.0.saturating_add(frames)).min(snapshot.known_to(id));
    let middle = |frame: u64| Some(snapshot.state(id, Frame(frame))?.position);
    // The first point is where it is drawn, so that the trail does not jump from frame to frame.
    let now = play
        .sample(id)
        .zip(play.body(id))
        .map(|(sample, body)| sample.pose.transform_point(body.frame.position));
    now.into_iter().chain((from.0 + 1..=to.0).map_while(middle)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun::Quat;

    #[test]
    fn the_last_ghost_is_at_the_horizon_and_the_others_evenly_before_it() {
        let times = ghost_times(1.0, 2.0, 4);
        assert_eq!(times.iter().map(|(time_s, _)| *time_s).collect::<Vec<_>>(), [2.0, 1.75, 1.5, 1.25]);
        assert_eq!((times[0].1, times[3].1), (1.0, 0.0));
        assert_eq!(ghost_times(1.0, 2.0, 1), [(2.0, 0.0)]);
        assert!(ghost_times(2.0, 2.0, 3).is_empty(), "nothing is known of the future");
        assert_eq!(ghost_times(0.0, 1.0, 900).len(), 20);
    }

    #[test]
    fn who_neither_moves_nor_turns_stays() {
        let at = |x: f32, angle: f32| Pose { position: Vec3::X * x, rotation: Quat::from_rotation_y(angle) };
        assert!(stays(&at(1.0, 0.3), &at(1.001, 0.301), 0.5));
        assert!(!stays(&at(1.0, 0.3), &at(1.02, 0.3), 0.5));
        assert!(!stays(&at(1.0, 0.3), &at(1.0, 0.4), 0.5));
        // The same rotation, written the other way.
        let turned = Pose { rotation: -at(1.0, 0.3).rotation, ..at(1.0, 0.3) };
        assert!(stays(&at(1.0, 0.3), &turned, 0.5));
    }
}
