//! Throw: aimed while the button is held down, with a preview of what would come of it, and thrown when it is let go.

use forerun::{BodyDef, Change, Vec3};

use super::missile::{Missiles, lead, radius_of};
use super::sight::Sight;
use crate::draw::{Extras, PreviewTrack};
use crate::session::Play;
use crate::view::View;

/// No throw begins farther from where it is aimed than this part of the way that is possible at its speed: it would take too long, or not get there.
const FARTHEST: f32 = 0.6;

/// A throw begins so many times its radius before the eye, if it is not half way by then: nearer, what is thrown would hide what it is aimed at.
const AWAY: f32 = 8.0;

/// The preview shows so many bodies besides the one that is thrown.
const OTHERS_MAX: usize = 32;

/// What would be thrown now, and at what; none while it is being made.
///
/// # Errors
/// Why nothing can be thrown.
fn missile(
    play: &Play,
    (missiles, view): (&mut Missiles, &View),
    sight: &Sight<'_>,
    pointer: [f32; 2],
) -> Result<Option<(BodyDef, Vec3)>, String> {
    let Some(mut def) = missiles.def(play, &view.grip)? else { return Ok(None) };
    let ray = sight.ray(pointer);
    let hit = sight.hit(play, pointer);
    let speed = view.grip.speed.max(0.01);
    let gravity = play.gravity() * def.gravity_scale;
    let reach =
        if gravity == Vec3::ZERO { f32::INFINITY } else { FARTHEST * speed * speed / gravity.length() };
    let to = hit.map_or(sight.camera.distance, |hit| hit.distance);
    let clear = (AWAY * radius_of(&def)).min(0.5 * to);
    let start = clear.max(to - reach);
    let aimed = ray.origin + ray.direction * to;
    def.pose.position = ray.origin + ray.direction * start;
    let led = hit.and_then(|_| lead(aimed - def.pose.position, gravity, speed));
    def.velocity = led.unwrap_or(ray.direction * speed);
    Ok(Some((def, aimed)))
}

/// Shows what is aimed, and asks what would come of it.
pub(super) fn aim(
    extras: &mut Extras,
    play: &mut Play,
    (missiles, view): (&mut Missiles, &View),
    (sight, pointer): (&Sight<'_>, [f32; 2]),
) {
    match missile(play, (missiles, view), sight, pointer) {
        Ok(None) => {}
        Ok(Some((def, aimed))) => {
            extras.held = Some((def.shape.clone(), def.pose));
            extras.aim = Some([def.pose.position, aimed]);
            if view.ghosts.preview {
                let frames = (f64::from(view.ghosts.trail_seconds) / play.frame_seconds()).ceil() as u32;
                let body = play.coming_body();
                let shape = def.shape.clone();
                play.ask_preview(vec![Change::Add { body, def: Box::new(def) }], frames.max(1), Vec::new());
                extras.preview = tracks(play, (body, &shape));
            }
        }
        Err(message) => play.notice.tell(message),
    }
}

/// Throws; whether it is done with, and nothing has still to be made for it.
pub(super) fn release(
    play: &mut Play,
    missiles_and_view: (&mut Missiles, &View),
    sight: &Sight<'_>,
    pointer: [f32; 2],
) -> bool {
    match missile(play, missiles_and_view, sight, pointer) {
        Ok(None) => return false,
        Ok(Some((def, _))) => drop(play.add_all("throw", vec![def])),
        Err(message) => play.notice.tell(message),
    }
    play.forget_preview();
    true
}

/// What is known of what would come of it: first the one that is thrown, then whom it reaches.
fn tracks(play: &Play, (thrown, shape): (forerun::BodyId, &forerun::Shape)) -> Vec<PreviewTrack> {
    let trails = play.preview().map_or(&[][..], |previewed| &previewed.trails);
    let (own, others): (Vec<_>, Vec<_>) = trails.iter().partition(|trail| trail.body == thrown);
    let others = others.into_iter().take(OTHERS_MAX).filter_map(|trail| {
        let shape = play.body(trail.body)?.shape.clone();
        Some(PreviewTrack { shape, poses: trail.poses.clone() })
    });
    let own = own.into_iter().map(|trail| PreviewTrack { shape: shape.clone(), poses: trail.poses.clone() });
    own.chain(others).collect()
}
