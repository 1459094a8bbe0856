//! Halfway: where contacts are looked at: not where bodies are at the start of the frame, but where they are soon after, by the velocities of the start.
//!
//! Directions and arms of a contact stay as they are for the frame's n substeps, while what they hold goes on. Take a body that swings about a peg, by small
//! angles θ with θ'' = -Ω² θ, and let the directions be those of a time a after the start of a frame of length T. Then
//!
//! ω' = ω - Ω² T (θ + a ω),  θ' = θ + T ω - Ω² T² (n + 1) / 2n (θ + a ω)
//!
//! whose determinant is 1 + Ω² T (T (1 - 1/n) / 2 - a): with directions of the start (a = 0) the swing gains Ω² T (1 - 1/n) / 2 of its energy a second (2.7
//! fold in 20 s, measured at 1/60 and Ω = 3.6 / s), and with a = T (1 - 1/n) / 2 it neither gains nor loses. What is left is of the order of ω² T: a
//! velocity loses what turns out of its new direction, 14 % of the energy in 20 s from 17°.
//!
//! Shapes are put there before contacts are looked for, so that every shape gives the directions that it will have: those of a face turn with it, those
//! of a ball do not. A row there tells the change of a gap over the frame to the second order, as the midpoint rule does; its separation at the start
//! is the one found, less what the row says of the way there. So nobody overlaps who did not, and nothing changes for what stands still.

use forerun_geometry::Vec3;

use crate::solver::turned;
use crate::{Body, BodyState, Environment};

/// A body that comes less far is looked at where it is. Metres.
const LEAST_M: f32 = 2e-5;
/// Bodies that come less far than this part of the contact margin are looked at halfway; those that come twice as far where they are: what falls fast has
/// no contact yet, and others on its way than the one that it will have.
const MARGIN_PART: f32 = 0.5;
/// The same, as part of half the body's thickness: a coin that rolls on its rim at 0.7 m/s keeps its tilt longer where it is.
const THICKNESS_PART: f32 = 0.25;

/// How far a body comes, by the velocity of the frame's start, to where its contacts are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halfway {
    /// Metres.
    pub shift: Vec3,
    /// Rotation vector. Radians.
    pub turn: Vec3,
}

impl Halfway {
    pub(crate) const NONE: Halfway = Halfway { shift: Vec3::ZERO, turn: Vec3::ZERO };

    /// Of a body that is not fixed.
    pub(crate) fn of(body: &Body, state: &BodyState, environment: &Environment) -> Halfway {
        let settings = &environment.settings;
        let seconds = 0.5 * settings.frame_seconds * (1.0 - 1.0 / settings.substeps as f32);
        let (shift, turn) = (state.velocity * seconds, state.angular_velocity * seconds);
        let way2 = shift.length_squared() + turn.length_squared() * body.radius * body.radius;
        let most = (MARGIN_PART * settings.contact_margin_m).min(THICKNESS_PART * body.half_thickness);
        // What is not a number is neither.
        let goes = way2 > LEAST_M * LEAST_M && way2 < 4.0 * most * most;
        if !goes {
            return Halfway::NONE;
        }
        let part = if way2 > most * most { 2.0 - way2.sqrt() / most } else { 1.0 };
        Halfway { shift: shift * part, turn: turn * part }
    }

    pub(crate) fn is_none(&self) -> bool {
        *self == Halfway::NONE
    }

    /// Where the body is there, with the velocities of the start.
    pub(crate) fn state(&self, start: &BodyState) -> BodyState {
        BodyState {
            position: start.position + self.shift,
            rotation: turned(start.rotation, self.turn),
            ..*start
        }
    }

    /// How far a point of the body, as it is there, has come. `start` is the centre of mass at the start of the frame. Metres.
    pub(crate) fn way(&self, start: Vec3, point: Vec3) -> Vec3 {
        self.shift + self.turn.cross(point - (start + self.shift))
    }
}

#[cfg(test)]
mod tests {
    use forerun_geometry::{Quat, Shape};

    use super::*;
    use crate::narrow_phase::{Contact, find_contacts};
    use crate::{BodyDef, BodyId, Member};

    /// Of a ball of 0.5 m that is fixed and a cube on it, with these velocities.
    fn contact(velocity: Vec3, spin: Vec3) -> Contact {
        let ball = BodyDef::fixed(Shape::sphere(0.5).unwrap());
        let mut cube = BodyDef::new(Shape::cuboid(Vec3::splat(0.5)).unwrap()).at(Vec3::new(0.1, 1.001, 0.0));
        (cube.velocity, cube.angular_velocity) = (velocity, spin);
        let bodies = [ball, cube].map(|def| Body::new(&def).unwrap());
        let ids = (0..).map(BodyId);
        let members: Vec<Member> =
            ids.zip(&bodies).map(|(id, (body, state))| Member { id, body, state: *state }).collect();
        find_contacts(&members, &[(0, 1)], &Environment::default())[0]
    }

    #[test]
    fn directions_are_those_of_later_and_gaps_those_of_the_start() {
        let spin = Vec3::Z * 0.5;
        // About the ball's middle.
        let velocity = spin.cross(Vec3::new(0.1, 1.001, 0.0));
        let found = contact(velocity, spin).manifold;
        let angle = 0.5 * 0.375 / 60.0;
        let expected = Quat::from_rotation_z(angle) * Vec3::Y;
        assert!((found.normal - expected).length() < 1e-5, "{}", found.normal);
        assert!((found.points[0].separation - 0.001).abs() < 1e-5, "{:?}", found.points[0]);
        let sinking = contact(Vec3::NEG_Y * 0.3, Vec3::ZERO).manifold.points[0];
        assert!((sinking.separation - 0.001).abs() < 1e-6, "{sinking:?}");
    }

    #[test]
    fn what_stands_or_is_fast_is_looked_at_where_it_is() {
        let (body, state) = Body::new(&BodyDef::new(Shape::sphere(0.5).unwrap())).unwrap();
        let of = |speed: f32| {
            Halfway::of(&body, &BodyState { velocity: Vec3::X * speed, ..state }, &Environment::default())
        };
        assert!(of(0.0).is_none() && of(0.003).is_none() && of(4.0).is_none() && of(f32::INFINITY).is_none());
        assert!((of(1.0).shift.x - 0.375 / 60.0).abs() < 1e-6);
    }
}
