//! Colours: what the colour of a body tells, and the legend that says so.

use std::collections::BTreeMap;

use forerun::{Body, BodyId, BodyKind, Frame, FrameInspection, Sample, Snapshot, Touch};

use crate::session::Play;
use crate::view::{ColourBy, View};

/// Red, green, blue, as screens show them.
pub type Rgb = [u8; 3];

/// Colours that neighbours in the list are told apart by, also with a colour-vision deficiency (after Okabe and Ito, lightened).
const PALETTE: [Rgb; 8] = [
    [222, 148, 42],
    [86, 168, 222],
    [40, 150, 118],
    [228, 208, 96],
    [52, 112, 180],
    [208, 104, 52],
    [196, 128, 174],
    [186, 188, 196],
];

const FIXED: Rgb = [138, 139, 136];
const DRIVEN: Rgb = [150, 138, 116];
/// Of what the colour says nothing.
const UNKNOWN: Rgb = [168, 168, 166];
const RESTING: Rgb = [96, 120, 158];
const SETTLING: Rgb = [222, 196, 98];
const AWAKE: Rgb = [226, 112, 66];
const IDLE_AREA: Rgb = [96, 120, 158];
const ACTIVE_AREA: Rgb = [226, 112, 66];
/// From the least to the most: dark blue, teal, green, yellow (after matplotlib's viridis), and red for too much.
const RAMP: [Rgb; 5] = [[86, 78, 152], [48, 104, 142], [34, 154, 136], [120, 206, 88], [250, 226, 60]];
/// One slice, two, four, eight and more.
const SLICES: [Rgb; 4] = [[150, 160, 172], [232, 202, 84], [232, 136, 56], [214, 62, 48]];
/// Speeds of the legend. m/s.
const SPEEDS: [f32; 5] = [0.01, 0.1, 1.0, 5.0, 20.0];

/// What the colours say that bodies have now: words and colours, in order. None where the colour only tells bodies apart.
#[must_use]
pub fn legend(view: &View) -> Vec<(String, Rgb)> {
    let named = |rows: &[(&str, Rgb)]| rows.iter().map(|(text, rgb)| ((*text).to_owned(), *rgb)).collect();
    match view.colour_by {
        ColourBy::Body => Vec::new(),
        ColourBy::Island => named(&[("one colour an island", PALETTE[1]), ("alone or fixed", UNKNOWN)]),
        ColourBy::Area => named(&[("active area", ACTIVE_AREA), ("idle area", IDLE_AREA)]),
        ColourBy::Lookahead => named(&[
            ("known to the horizon", RAMP[3]),
            ("half as far", RAMP[2]),
            ("a few frames", RAMP[0]),
            ("out of date now", AWAKE),
        ]),
        ColourBy::Rest => named(&[("moves", AWAKE), ("nearly rests", SETTLING), ("rests", RESTING)]),
        ColourBy::Slices => named(&[
            ("1 slice a frame", SLICES[0]),
            ("2", SLICES[1]),
            ("4", SLICES[2]),
            ("8 or more", SLICES[3]),
        ]),
        ColourBy::Speed => {
            SPEEDS.iter().zip(RAMP).map(|(speed, rgb)| (format!("{speed} m/s"), rgb)).collect()
        }
    }
}

/// What says which colour a body has in one picture.
pub(super) struct Paint<'a> {
    by: ColourBy,
    snapshot: &'a Snapshot,
    frame: Frame,
    /// What is inside a frame, when that is known.
    inside: Option<&'a FrameInspection>,
    /// By body, the lowest body of its island, where nothing better is known.
    islands: BTreeMap<BodyId, BodyId>,
    rest_frames: f32,
    slices: u32,
}

impl<'a> Paint<'a> {
    /// For the picture that is shown.
    pub(super) fn of(play: &'a Play, by: ColourBy, inside: Option<&'a FrameInspection>) -> Paint<'a> {
        let snapshot = &play.picture.snapshot;
        let frame = play.picture.frame.min(snapshot.horizon());
        let islands = match (by, inside) {
            (ColourBy::Island, None) => {
                let moves = |id: BodyId| snapshot.body_at(id, frame).is_some_and(|body| body.is_dynamic());
                islands_of(&snapshot.contacts(frame), moves)
            }
            _ => BTreeMap::new(),
        };
        Paint {
            by,
            snapshot,
            frame,
            inside,
            islands,
            rest_frames: snapshot.environment_at(frame).settings.rest_frames().max(1) as f32,
            slices: play.picture.note.as_ref().map_or(1, |note| u32::from(note.slices_max)),
        }
    }

    /// The colour of a body.
    pub(super) fn colour(&self, id: BodyId, body: &Body, sample: &Sample) -> Rgb {
        match self.by {
            ColourBy::Body => self.plain_colour(id, body, sample),
            _ => distinct(self.plain_colour(id, body, sample), id),
        }
    }

    fn plain_colour(&self, id: BodyId, body: &Body, sample: &Sample) -> Rgb {
        match body.kind {
            BodyKind::Dynamic => {}
            BodyKind::Fixed => return FIXED,
            BodyKind::Kinematic => return DRIVEN,
        }
        match self.by {
            ColourBy::Body => palette(id.0),
            ColourBy::Speed => speed_colour(sample.velocity.length()),
            ColourBy::Lookahead => self.lookahead_colour(id),
            ColourBy::Rest => {
                let rest = self.snapshot.state(id, self.frame).map_or(0, |state| state.rest);
                rest_colour(rest as f32 / self.rest_frames)
            }
            ColourBy::Island => match self.inspected(id) {
                Some(inspected) => inspected.island.map_or(UNKNOWN, |name| palette(name.0)),
                None => self.islands.get(&id).map_or(UNKNOWN, |name| palette(name.0)),
            },
            ColourBy::Slices => {
                slice_colour(self.inspected(id).map_or(self.slices, |inspected| inspected.slices))
            }
            ColourBy::Area => self.area_colour(sample),
        }
    }

    fn inspected(&self, id: BodyId) -> Option<&forerun::InspectedBody> {
        let bodies = &self.inside?.step.bodies;
        let at = bodies.binary_search_by_key(&id, |inspected| inspected.body).ok()?;
        Some(&bodies[at])
    }

    fn lookahead_colour(&self, id: BodyId) -> Rgb {
        let known_to = self.snapshot.known_to(id);
        if known_to < self.frame {
            return AWAKE;
        }
        let all = self.snapshot.horizon().since(self.frame).max(1);
        ramp(0.8 * known_to.since(self.frame) as f32 / all as f32)
    }

    fn area_colour(&self, sample: &Sample) -> Rgb {
        let Some(areas) = self.inside.map(|inside| &inside.areas) else { return UNKNOWN };
        let Some(edge) = areas.first().map(|first| first.bounds.max.x - first.bounds.min.x) else {
            return UNKNOWN;
        };
        let cell = (sample.pose.position / edge).floor();
        let name = [cell.x as i32, cell.y as i32, cell.z as i32];
        let found = areas.binary_search_by(|inspected| inspected.area.cmp(&name));
        let Ok(at) = found else { return UNKNOWN };
        let base = if areas[at].active { ACTIVE_AREA } else { IDLE_AREA };
        // Neighbours differ a little, so that one sees where an area ends.
        let odd = name.iter().sum::<i32>().rem_euclid(2) == 1;
        if odd { base.map(|c| (f32::from(c) * 0.8) as u8) } else { base }
    }
}

/// A little darker or lighter than bodies of the same colour beside it, so that one sees where it ends.
fn distinct(rgb: Rgb, id: BodyId) -> Rgb {
    let factor = [1.0, 0.91, 1.06, 0.96, 0.87][id.0 as usize % 5];
    rgb.map(|c| (f32::from(c) * factor).min(255.0) as u8)
}

/// The colour of the body or island with a number.
fn palette(number: u32) -> Rgb {
    // Rows of as many bodies as there are colours are not to have columns of one colour.
    let number = number as usize;
    PALETTE[(number + 3 * (number / PALETTE.len())) % PALETTE.len()]
}

fn ramp(part: f32) -> Rgb {
    let steps = (RAMP.len() - 1) as f32;
    let at = part.clamp(0.0, 1.0) * steps;
    let from = (at.floor() as usize).min(RAMP.len() - 2);
    mix(RAMP[from], RAMP[from + 1], at - from as f32)
}

fn speed_colour(speed: f32) -> Rgb {
    let at = SPEEDS.partition_point(|s| *s <= speed);
    if at == 0 || at == SPEEDS.len() {
        return RAMP[at.min(RAMP.len() - 1)];
    }
    mix(RAMP[at - 1], RAMP[at], (speed - SPEEDS[at - 1]) / (SPEEDS[at] - SPEEDS[at - 1]))
}

/// `part`: how long it has been quiet, against how long it takes to rest.
fn rest_colour(part: f32) -> Rgb {
    if part >= 1.0 {
        RESTING
    } else if part > 0.0 {
        mix(AWAKE, SETTLING, 0.5 + 0.5 * part)
    } else {
        AWAKE
    }
}

fn slice_colour(slices: u32) -> Rgb {
    SLICES[(slices.max(1).ilog2() as usize).min(SLICES.len() - 1)]
}

/// Between two colours.
fn mix(a: Rgb, b: Rgb, part: f32) -> Rgb {
    let part = part.clamp(0.0, 1.0);
    [0, 1, 2].map(|k| (f32::from(a[k]) + (f32::from(b[k]) - f32::from(a[k])) * part).round() as u8)
}

/// The lowest body of the island of each body that touches another. Bodies of which `moves` is false join no islands.
fn islands_of(touches: &[Touch], moves: impl Fn(BodyId) -> bool) -> BTreeMap<BodyId, BodyId> {
    let mut above: BTreeMap<BodyId, BodyId> = BTreeMap::new();
    fn root(above: &mut BTreeMap<BodyId, BodyId>, body: BodyId) -> BodyId {
        let mut at = body;
        while let Some(next) = above.get(&at).copied().filter(|next| *next != at) {
            at = next;
        }
        above.insert(body, at);
        at
    }
    for touch in touches {
        if moves(touch.first) && moves(touch.second) {
            let (a, b) = (root(&mut above, touch.first), root(&mut above, touch.second));
            above.insert(a.max(b), a.min(b));
        }
    }
    let bodies: Vec<BodyId> = above.keys().copied().collect();
    bodies.into_iter().map(|body| (body, root(&mut above, body))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun::Vec3;

    #[test]
    fn islands_are_found_through_touches_but_not_through_the_ground() {
        let touch = |a: u32, b: u32| Touch {
            first: BodyId(a),
            second: BodyId(b),
            impulse: 1.0,
            speed: 0.0,
            point: Vec3::ZERO,
            normal: Vec3::Y,
        };
        let touches = [touch(0, 1), touch(0, 5), touch(4, 5), touch(1, 3), touch(3, 7), touch(2, 9)];
        let islands = islands_of(&touches, |body| body != BodyId(0));
        let of = |body: u32| islands.get(&BodyId(body)).map(|island| island.0);
        assert_eq!([1, 3, 7].map(of), [Some(1); 3]);
        assert_eq!([of(4), of(5), of(2), of(9), of(6)], [Some(4), Some(4), Some(2), Some(2), None]);
    }

    #[test]
    fn ramps_go_through_the_colours_of_the_legend() {
        assert_eq!((ramp(0.0), ramp(0.5), ramp(7.0)), (RAMP[0], RAMP[2], RAMP[4]));
        for (speed, rgb) in SPEEDS.iter().zip(RAMP) {
            assert_eq!(speed_colour(*speed), rgb);
        }
        assert_eq!((speed_colour(0.0), speed_colour(400.0)), (RAMP[0], RAMP[4]));
        assert_eq!([1, 2, 3, 4, 8, 64].map(slice_colour), [0, 1, 1, 2, 3, 3].map(|k| SLICES[k]));
        assert_eq!((rest_colour(0.0), rest_colour(1.0), rest_colour(9.0)), (AWAKE, RESTING, RESTING));
    }

    #[test]
    fn all_ways_to_colour_but_one_have_a_legend() {
        for by in ColourBy::ALL {
            let view = View { colour_by: by, ..View::default() };
            assert_eq!(legend(&view).is_empty(), by == ColourBy::Body, "{}", by.name());
        }
    }
}
