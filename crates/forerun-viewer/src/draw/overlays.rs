//! Overlays: what is inside a frame, drawn over the bodies: contacts, bounds, areas, levels and a slice of a distance field.

mod field;

pub(super) use field::FieldSlice;

use forerun::{Aabb, Frame, FrameInspection, InspectedArea, InspectedContact, Touch, Vec3};

use super::Scenery;
use super::labels::Label;
use super::lines::{Ink, Lines};

/// So many labels can be read at once.
const LABELS_MAX: usize = 300;
/// So many active areas tell their clocks.
const ACTIVE_TOLD: usize = 12;
/// So many contacts, bounds or areas are drawn.
const DRAWN_MAX: usize = 6000;

const POINT: Ink = [255, 214, 70, 255];
const OVERLAP: Ink = [255, 84, 60, 255];
const NORMAL: Ink = [90, 220, 255, 230];
const IMPULSE: Ink = [255, 96, 70, 240];
const FRICTION: Ink = [255, 170, 80, 220];
const BOUNDS: Ink = [130, 220, 150, 110];
const ACTIVE: Ink = [255, 140, 66, 190];
const IDLE: Ink = [110, 140, 190, 70];
const LATE: Ink = [240, 70, 80, 230];

/// Overlap that is marked. Metres.
const OVERLAP_SEEN: f32 = 0.002;

/// Draws the overlays that the view asks for as lines.
pub(super) fn draw(lines: &mut Lines, scenery: &Scenery<'_>) {
    let overlays = &scenery.view.overlays;
    let snapshot = &scenery.play.picture.snapshot;
    if overlays.contacts || overlays.impulses {
        match scenery.inside {
            Some(inside) => draw_contacts(lines, scenery, &inside.step.contacts),
            None => draw_touches(lines, scenery, &snapshot.contacts(scenery.play.picture.frame)),
        }
    }
    if overlays.bounds {
        draw_bounds(lines, scenery);
    }
    if overlays.areas
        && let Some(inside) = scenery.inside
    {
        draw_areas(lines, inside);
    }
}

/// A length that is seen well from here. Metres.
fn handy_length(scenery: &Scenery<'_>) -> f32 {
    0.045 * scenery.camera.distance
}

/// The impulse that is drawn as long as a normal: what the median contact has. N s.
fn usual(impulses: impl Iterator<Item = f32>) -> f32 {
    let mut sorted: Vec<f32> = impulses.filter(|impulse| *impulse > 0.0).collect();
    sorted.sort_unstable_by(f32::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(1.0)
}

/// Roots, so that the strong ones do not hide the weak ones.
fn length_of(impulse: f32, usual: f32) -> f32 {
    (impulse / usual).max(0.0).sqrt().min(4.0)
}

fn draw_contacts(lines: &mut Lines, scenery: &Scenery<'_>, contacts: &[InspectedContact]) {
    let overlays = &scenery.view.overlays;
    let unit = handy_length(scenery);
    let usual = usual(contacts.iter().flat_map(|contact| contact.points()).map(|point| point.impulse));
    for contact in contacts.iter().take(DRAWN_MAX) {
        for point in contact.points() {
            let at = point.position;
            if overlays.contacts {
                let ink = if point.separation < -OVERLAP_SEEN { OVERLAP } else { POINT };
                lines.line([at, at + point.normal * (0.5 * unit)], 1.5, NORMAL);
                lines.dot(at, 5.0, ink);
            }
            if overlays.impulses && point.impulse > 0.0 {
                let length = unit * length_of(point.impulse, usual);
                lines.arrow([at, at + point.normal * length], 2.0, IMPULSE);
            }
        }
        let (count, friction) = (contact.points().len() as f32, contact.friction.length());
        if overlays.impulses && friction > 0.0 && count > 0.0 {
            let middle = contact.points().iter().map(|point| point.position).sum::<Vec3>() / count;
            let ahead = contact.friction * (unit * length_of(friction, usual) / friction);
            lines.arrow([middle, middle + ahead], 1.5, FRICTION);
        }
    }
}

/// Contacts as far as touches that were written down tell of them: until it is known what is inside.
fn draw_touches(lines: &mut Lines, scenery: &Scenery<'_>, touches: &[Touch]) {
    let overlays = &scenery.view.overlays;
    let unit = handy_length(scenery);
    let usual = usual(touches.iter().map(|touch| touch.impulse));
    for touch in touches.iter().take(DRAWN_MAX) {
        if overlays.contacts {
            lines.line([touch.point, touch.point + touch.normal * (0.5 * unit)], 1.5, NORMAL);
            lines.dot(touch.point, 5.0, POINT);
        }
        if overlays.impulses && touch.impulse > 0.0 {
            let length = unit * length_of(touch.impulse, usual);
            lines.arrow([touch.point, touch.point + touch.normal * length], 2.0, IMPULSE);
        }
    }
}

fn draw_bounds(lines: &mut Lines, scenery: &Scenery<'_>) {
    let play = scenery.play;
    let has_end = |bounds: &Aabb| (bounds.max - bounds.min).max_element() < 1e4;
    match scenery.inside {
        Some(inside) => {
            let bounds = inside.step.bodies.iter().map(|body| body.bound);
            bounds.filter(has_end).take(DRAWN_MAX).for_each(|bound| lines.boxed(&bound, 1.2, BOUNDS));
        }
        None => {
            let shapes = play.samples.iter().filter_map(|(id, sample)| Some((play.body(*id)?, sample)));
            let bounds = shapes.map(|(body, sample)| body.shape.aabb(&sample.pose));
            bounds.filter(has_end).take(DRAWN_MAX).for_each(|bound| lines.boxed(&bound, 1.2, BOUNDS));
        }
    }
}

/// The clock of areas in which nothing waits to be computed.
fn latest_clock(inside: &FrameInspection) -> Frame {
    inside.areas.iter().map(|area| area.clock).max().unwrap_or(inside.frame)
}

fn draw_areas(lines: &mut Lines, inside: &FrameInspection) {
    let latest = latest_clock(inside);
    // Those that matter last: they are drawn over the others.
    let mut areas: Vec<_> = inside.areas.iter().take(DRAWN_MAX).collect();
    areas.sort_by_key(|area| (area.clock < latest, area.active));
    for area in areas {
        let (ink, width) = match (area.clock < latest, area.active) {
            (true, _) => (LATE, 2.0),
            (_, true) => (ACTIVE, 2.0),
            _ => (IDLE, 1.2),
        };
        // A little smaller, so that neighbours do not lie on each other.
        let inset = 0.01 * (area.bounds.max.x - area.bounds.min.x);
        lines.boxed(&area.bounds.grown(-inset), width, ink);
    }
}

/// What overlays say in words.
pub(super) fn labels(scenery: &Scenery<'_>) -> Vec<Label> {
    let overlays = &scenery.view.overlays;
    let Some(inside) = scenery.inside else { return Vec::new() };
    let mut labels = Vec::new();
    if overlays.levels {
        for body in &inside.step.bodies {
            let Some(sample) = scenery.play.sample(body.body) else { continue };
            let fixed = scenery.play.body(body.body).is_none_or(|body| !body.is_dynamic());
            if !fixed {
                let text = body.level.map_or_else(|| "-".to_owned(), |level| level.to_string());
                labels.push(Label { at: sample.pose.position, text, rgb: level_colour(body.level) });
            }
        }
    }
    if overlays.areas {
        let latest = latest_clock(inside);
        let active = inside.areas.iter().filter(|area| area.active).count();
        // The clocks of those in which nothing waits are all the same.
        let told = |area: &&InspectedArea| area.clock < latest || area.active && active <= ACTIVE_TOLD;
        for area in inside.areas.iter().filter(told) {
            let ink = if area.clock < latest { LATE } else { ACTIVE };
            let [red, green, blue, _] = ink;
            let at = area.bounds.centre();
            labels.push(Label { at, text: format!("t = {}", area.clock.0), rgb: [red, green, blue] });
        }
    }
    // The nearest are the ones that can be read.
    let eye = scenery.camera.eye();
    labels.sort_by(|a, b| (a.at - eye).length_squared().total_cmp(&(b.at - eye).length_squared()));
    labels.truncate(LABELS_MAX);
    labels
}

/// Levels from the ground up, in turn.
fn level_colour(level: Option<u32>) -> [u8; 3] {
    level.map_or([200; 3], |level| {
        [[255, 255, 255], [255, 224, 120], [150, 230, 160], [140, 205, 255], [230, 170, 240]]
            [level as usize % 5]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_impulse_is_drawn_as_long_as_a_normal() {
        let impulses = [0.0, 4.0, 1.0, 100.0, 0.0];
        let usual = usual(impulses.into_iter());
        assert!((length_of(4.0, usual) - 1.0).abs() < 1e-6);
        assert!(length_of(1.0, usual) < 1.0 && length_of(1e9, usual) <= 4.0);
        assert!(length_of(f32::NAN, usual) <= 4.0 && super::usual(std::iter::empty()) > 0.0);
    }
}
