//! Sharp: distances at edges and corners, where a grid blurs them.
//!
//! See [`Blur`]: the corners of two stones that touch would not. There the grid is asked only who is near, and the
//! triangles how near.

use glam::DVec3;

use super::directions::Direction;
use super::look_up::Eight;
use crate::sdf::blur::Blur;
use crate::sdf::lanes::{Lanes, Lanes3, WIDTH};
use crate::sdf::nearest::Nearest;
use crate::sdf::primitive::Surface;

/// Unit vectors whose largest part is less than this are along no axis: off the sides of a box.
const AXIS: f32 = 0.999_99;

/// What a surface says to eight points.
pub(super) struct Answer {
    /// Metres.
    pub(super) distance: Lanes,
    /// Not quite unit.
    pub(super) gradient: Lanes3,
    /// The bits of points to which a sharp edge or a corner is nearest.
    pub(super) beside: u32,
}

impl Direction<'_> {
    /// Asks the surface about eight points of the field's frame: the answers are good where they are `asked` for and
    /// near.
    #[inline(always)]
    pub(super) fn answer(&self, points: Lanes3, asked: u32) -> Answer {
        let (distance, gradient) = self.surface.look_up_some(points, asked);
        let mut answer = Answer { distance, gradient, beside: 0 };
        if let (Some(blur), Some(skin)) = (self.blur, &self.skin) {
            let reach = self.reach(points, Lanes::ZERO) + Lanes::splat(self.blur_depth);
            let near = asked & distance.below(reach).bits();
            self.in_the_blur(blur, &points, near, |i, point, nearest| {
                let signed = skin.signed(point, nearest);
                answer.distance.0[i] = signed.distance as f32;
                answer.gradient.set_lane(i, signed.gradient);
                answer.beside |= u32::from(!nearest.is_on_face()) << i;
            });
        }
        if let Surface::Cuboid(_) = self.surface {
            let [x, y, z] = [gradient.x.abs(), gradient.y.abs(), gradient.z.abs()];
            answer.beside = x.max(y).max(z).below(Lanes::splat(AXIS)).bits();
        }
        answer
    }

    /// The same for points that lie `back` inside the surface that they are of: next to an edge or corner the side is
    /// meant that faces them best.
    #[inline(always)]
    pub(super) fn answer_inside(&self, eight: &Eight, back: Lanes3, asked: u32) -> Answer {
        let points = eight.points.minus(back);
        let (distance, gradient) = self.surface.look_up_some(points, asked);
        let mut answer = Answer { distance, gradient, beside: 0 };
        if let (Some(blur), Some(skin)) = (self.blur, &self.skin) {
            self.in_the_blur(blur, &points, asked, |i, point, nearest| {
                let outwards = eight.outwards.lane(i).as_dvec3();
                let (distance, normal) = skin.facing(point, nearest, outwards);
                answer.distance.0[i] = distance;
                answer.gradient.set_lane(i, normal);
            });
        }
        answer
    }

    /// Finds what is nearest to those of some points where the field is blurred.
    #[inline(always)]
    fn in_the_blur(
        &self,
        blur: &Blur,
        points: &Lanes3,
        asked: u32,
        mut tell: impl FnMut(usize, DVec3, &Nearest),
    ) {
        let (Surface::Field(field), Some(skin)) = (&self.surface, &self.skin) else { return };
        let mut guess: Option<Nearest> = None;
        for i in (0..WIDTH).filter(|i| asked >> i & 1 == 1) {
            let point = points.lane(i);
            if blur.is_at(field, point) {
                let nearest = skin.nearest(point.as_dvec3(), guess.as_ref());
                tell(i, point.as_dvec3(), &nearest);
                guess = Some(nearest);
            }
        }
    }
}
