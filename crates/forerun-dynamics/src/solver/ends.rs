//! Ends: the two bodies of eight contacts, as the rows are made from them.

use super::blocks::Detail;
use super::bodies::Bodies;
use super::manifolds::Manifolds;
use super::points::Side;
use crate::lanes::{LANES, LaneMask, Lanes, V8};

/// A point contact twists as if it were a patch of this part of the thinner body's half thickness: a ball that spins in its place comes to stand. (A ball of
/// 0.2 m at 10 rad/s needs 16 s with friction 0.5; rolling is not hindered.)
const PATCH_PART: f32 = 0.01;

/// One body of each contact.
pub(super) struct End<F> {
    pub(super) position: V8<F>,
    pub(super) axes: [V8<F>; 3],
    pub(super) inertia: V8<F>,
    pub(super) scale: F,
    pub(super) answers: F,
    pub(super) static_friction: F,
    pub(super) friction: F,
    pub(super) restitution: F,
    pub(super) half_thickness: F,
    pub(super) inverse_mass: F,
    /// How far the centre of mass comes to where the contacts are looked at.
    shift: V8<F>,
    /// By how much a kinematic body turns in a substep; zero for others.
    turn: V8<F>,
}

/// Both bodies of each contact.
pub(super) struct EndPair<F> {
    pub(super) first: End<F>,
    pub(super) second: End<F>,
}

/// What two materials make together.
pub(super) struct Surface<F> {
    pub(super) static_friction: F,
    pub(super) friction: F,
    pub(super) restitution: F,
    pub(super) patch: F,
}

impl<F: Lanes> End<F> {
    #[inline(always)]
    pub(super) fn gather(bodies: &Bodies, index: &[u32; LANES], substep_seconds: f32) -> Self {
        let [x, y, z, scale, ix, iy, iz, answers] = F::gather(&bodies.centres, index);
        let [ux, uy, uz, vx, vy, vz, ..] = F::gather(&bodies.axes, index);
        let [static_friction, friction, restitution, half_thickness, inverse_mass, sx, sy, sz] =
            F::gather(&bodies.surfaces, index);
        let (u, v) = (V8 { x: ux, y: uy, z: uz }, V8 { x: vx, y: vy, z: vz });
        let axes = [u, v, u.cross(v)];
        let mut turn = V8::zero();
        let kinematic = scale.gt(F::zero()) & answers.le(F::zero());
        if kinematic.any() {
            let [_, _, _, wx, wy, wz, ..] = F::gather(&bodies.velocities, index);
            let spin = axes[0] * wx + axes[1] * wy + axes[2] * wz;
            turn = kinematic.select_v(spin * F::splat(substep_seconds), turn);
        }
        End {
            position: V8 { x, y, z },
            axes,
            inertia: V8 { x: ix, y: iy, z: iz },
            scale,
            answers,
            static_friction,
            friction,
            restitution,
            half_thickness,
            inverse_mass,
            shift: V8 { x: sx, y: sy, z: sz },
            turn,
        }
    }

    /// I^(-1/2) Rᵀ w
    #[inline(always)]
    pub(super) fn scaled(&self, w: V8<F>) -> V8<F> {
        V8 { x: self.axes[0].dot(w), y: self.axes[1].dot(w), z: self.axes[2].dot(w) }.times(self.inertia)
    }

    /// What the rows know of this body of a contact with `other`.
    #[inline(always)]
    pub(super) fn side(&self, other: &End<F>, centre: V8<F>, axes: &[V8<F>; 3]) -> Side<F> {
        let arm = self.arm(other, centre);
        Side {
            scale: self.scale,
            offset: along(axes, arm + self.turn.cross(arm) * F::splat(0.5)),
            turns: [self.scaled(axes[0]), self.scaled(axes[1]), self.scaled(axes[2])],
        }
    }

    /// By how much the arm of a contact turns with a kinematic body in a substep. With the arm of the frame's beginning, what rides on a turntable would
    /// leave it along the tangent, a little every frame.
    #[inline(always)]
    pub(super) fn carry(&self, other: &End<F>, centre: V8<F>, axes: &[V8<F>; 3]) -> V8<F> {
        along(axes, self.turn.cross(self.arm(other, centre)))
    }

    /// From the centre of mass to the contact: where it is looked at, but on a kinematic body that turns, which takes it along from where the other one
    /// has it at the start of the frame.
    #[inline(always)]
    fn arm(&self, other: &End<F>, centre: V8<F>) -> V8<F> {
        let arm = centre - self.position;
        let turns = self.turn.dot(self.turn).gt(F::zero());
        turns.select_v(arm - (other.shift - self.shift), arm)
    }
}

#[inline(always)]
pub(super) fn along<F: Lanes>(axes: &[V8<F>; 3], v: V8<F>) -> V8<F> {
    V8 { x: axes[0].dot(v), y: axes[1].dot(v), z: axes[2].dot(v) }
}

impl<F: Lanes> EndPair<F> {
    /// Friction is the geometric mean, restitution the larger of the two.
    #[inline(always)]
    pub(super) fn surface(&self) -> Surface<F> {
        let (a, b) = (&self.first, &self.second);
        Surface {
            static_friction: (a.static_friction * b.static_friction).sqrt(),
            friction: (a.friction * b.friction).sqrt(),
            restitution: a.restitution.max(b.restitution),
            patch: F::splat(PATCH_PART) * a.half_thickness.min(b.half_thickness),
        }
    }

    /// What lies below moves less than its mass says, and never more than what lies above.
    #[inline(always)]
    pub(super) fn share_yield(&self, detail: &mut Detail<F>, manifolds: &Manifolds<F>, shock_yield: F) {
        let (low, high) = (manifolds.levels[0], manifolds.levels[1]);
        let (a, b) = (self.first.inverse_mass, self.second.inverse_mass);
        // 1, or less where the lower body is the lighter one: the ratio of the inverse masses.
        let below = |own: F, other: F| {
            let lighter = other.lt(own);
            shock_yield * lighter.select(other / lighter.select(own, F::one()), F::one())
        };
        detail.first_yields = low.lt(high).select(below(a, b), F::one());
        detail.second_yields = high.lt(low).select(below(b, a), F::one());
    }
}
