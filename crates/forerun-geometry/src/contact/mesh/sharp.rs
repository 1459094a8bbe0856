//! Sharp: distances at edges and corners, where a grid blurs them.
//!
//! See [`Blur`]: the corners of two stones that touch would not. There the grid is asked only who is near, and the
//! triangles how near.

use forerun_lanes::{LANES, LaneMask, Lanes, Portable, V8};

use super::directions::Direction;
use super::look_up::Eight;
use crate::Vec3;
use crate::sdf::blur::{Asked, Blur, see};
use crate::sdf::eight::{lane, of_vectors};
use crate::sdf::facets::Seen;
use crate::sdf::primitive::{LookUp, Surface};

/// Unit vectors whose largest part is less than this are along no axis: off the sides of a box.
const AXIS: f32 = 0.999_99;

/// What a surface says to eight points.
pub(super) struct Answer<F> {
    /// Metres.
    pub(super) distance: F,
    /// Not quite unit.
    pub(super) gradient: V8<F>,
    /// The bits of points to which a sharp edge or a corner is nearest.
    pub(super) beside: u32,
}

/// What triangles say to some of eight points.
struct Exact {
    distance: [f32; LANES],
    gradient: [Vec3; LANES],
    /// The bits of the points.
    known: u32,
    /// See [`Answer::beside`].
    beside: u32,
}

impl Direction<'_> {
    /// Asks the surface about eight points of the field's frame: the answers are good where they are `asked` for and
    /// near.
    #[inline(always)]
    pub(super) fn answer<F: Lanes>(&self, points: V8<F>, asked: u32) -> Answer<F> {
        self.sharpened(points, self.surface.look_up_some(points, asked), asked)
    }

    /// What the surface `told`, made good beside sharp edges.
    #[inline(always)]
    pub(super) fn sharpened<F: Lanes>(&self, points: V8<F>, told: (F, V8<F>), asked: u32) -> Answer<F> {
        let (distance, gradient) = told;
        let mut answer = Answer { distance, gradient, beside: 0 };
        if let Some(blur) = self.blur {
            let reach = self.reach(points, F::zero()) + F::splat(self.blur_depth);
            let near = asked & distance.lt(reach).bits();
            if near != 0 {
                answer = answer.but_for(&self.sharp(blur, &points.form(), near));
            }
        }
        if let Surface::Cuboid(_) = self.surface {
            let [x, y, z] = [gradient.x.abs(), gradient.y.abs(), gradient.z.abs()];
            answer.beside = x.max(y).max(z).lt(F::splat(AXIS)).bits();
        }
        answer
    }

    /// Asks about points that lie `back` inside the surface that they are of: next to an edge or corner the side is
    /// meant that faces them best.
    #[inline(always)]
    pub(super) fn answer_inside<F: Lanes, S: LookUp>(
        &self,
        surface: &S,
        eight: &Eight<F>,
        back: V8<F>,
        asked: u32,
    ) -> Answer<F> {
        let points = eight.points - back;
        let (distance, gradient) = surface.look_up_some(points, asked);
        let answer = Answer { distance, gradient, beside: 0 };
        match self.blur {
            Some(blur) => answer.but_for(&self.facing(blur, [&points.form(), &eight.outwards.form()], asked)),
            None => answer,
        }
    }

    #[inline(never)]
    fn sharp(&self, blur: &Blur, points: &V8<Portable>, asked: u32) -> Exact {
        let mut exact = Exact::NOTHING;
        let Some(skin) = &self.skin else { return exact };
        let seen = self.see(blur, points, asked, &mut exact.known);
        for (i, seen) in some(&seen, exact.known) {
            (exact.distance[i], exact.gradient[i]) = seen.signed(skin, &blur.facets);
            exact.beside |= u32::from(!seen.is_on_face()) << i;
        }
        exact
    }

    #[inline(never)]
    fn facing(&self, blur: &Blur, [points, outwards]: [&V8<Portable>; 2], asked: u32) -> Exact {
        let mut exact = Exact::NOTHING;
        let Some(skin) = &self.skin else { return exact };
        let seen = self.see(blur, points, asked, &mut exact.known);
        for (i, seen) in some(&seen, exact.known) {
            (exact.distance[i], exact.gradient[i]) = seen.facing(skin, &blur.facets, lane(outwards, i));
        }
        exact
    }

    /// What is nearest to those of some points where the field is blurred.
    fn see(&self, blur: &Blur, points: &V8<Portable>, bits: u32, known: &mut u32) -> [Seen; LANES] {
        let mut seen = [Seen::NOTHING; LANES];
        if let Surface::Field(field) = self.surface {
            see(blur, &Asked { field, points, bits }, &mut seen, known);
        }
        seen
    }
}

/// Those of eight things whose bits are set, with their places.
fn some<T>(eight: &[T; LANES], bits: u32) -> impl Iterator<Item = (usize, &T)> {
    eight.iter().enumerate().filter(move |(i, _)| bits >> i & 1 == 1)
}

impl Exact {
    const NOTHING: Exact =
        Exact { distance: [0.0; LANES], gradient: [Vec3::ZERO; LANES], known: 0, beside: 0 };
}

impl<F: Lanes> Answer<F> {
    /// Better answers in the place of some.
    #[inline(always)]
    fn but_for(self, exact: &Exact) -> Answer<F> {
        let known = F::Mask::from_bits(exact.known);
        Answer {
            distance: known.select(F::from_array(exact.distance), self.distance),
            gradient: known.select_v(of_vectors(&exact.gradient).form(), self.gradient),
            beside: self.beside | exact.beside,
        }
    }
}
