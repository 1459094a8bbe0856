//! Shadows: depth maps seen from the sun, one of what is looked at and one of all that is farther.
//!
//! Maps turn with the sun only and move by whole texels, so that edges of shadows stand still when the camera moves. They are drawn
//! again only when a body or their frame moved.

use forerun::Vec3;
use three_d::{
    ClearState, Context, CoreError, Cull, DepthTest, DepthTexture2D, Mat4, Program, RenderStates, Viewport,
    Wrapping, WriteMask,
};

use super::crowd::Crowd;
use super::eye::identity;
use super::light::TO_SUN;
use super::programs::Programs;
use super::surface::Surfaces;

/// Texels along an edge.
const TEXELS: u32 = 2048;
/// The near map goes so far around the target, in distances of the eye from it.
const NEAR_REACH: f32 = 1.15;
/// What is farther from the target than so many distances of the eye has no shadow.
const FAR_REACH: f32 = 14.0;
/// Edges of maps grow by this factor, so that they do not change in every picture.
const STEP: f32 = 1.19;

const DEPTH: RenderStates = RenderStates {
    write_mask: WriteMask::DEPTH,
    depth_test: DepthTest::Less,
    blend: three_d::Blend::Disabled,
    cull: Cull::None,
};

/// A box along the directions of [`axes`], which a map covers: right, up, towards the sun. Metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SunBox {
    pub(super) min: Vec3,
    pub(super) max: Vec3,
}

impl SunBox {
    /// Around nothing.
    pub(super) const EMPTY: SunBox =
        SunBox { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY) };

    /// Takes a ball in.
    pub(super) fn add(&mut self, centre: Vec3, radius: f32) {
        let [right, up, sun] = axes();
        let at = Vec3::new(centre.dot(right), centre.dot(up), centre.dot(sun));
        if at.is_finite() {
            self.min = self.min.min(at - radius);
            self.max = self.max.max(at + radius);
        }
    }

    /// What the maps cover when the eye is so far from its target: what is near, and all when that is more.
    fn maps(&self, target: Vec3, distance: f32) -> Vec<SunBox> {
        if self.min.x > self.max.x {
            return Vec::new();
        }
        let [right, up, _] = axes();
        let middle = [target.dot(right), target.dot(up)];
        let part = |reach: f32| {
            let cut =
                |axis: usize, side: f32| (middle[axis] + side * reach).clamp(self.min[axis], self.max[axis]);
            self.square([cut(0, -1.0), cut(1, -1.0)], [cut(0, 1.0), cut(1, 1.0)])
        };
        let (near, far) = (part(NEAR_REACH * distance), part(FAR_REACH * distance));
        if near == far { vec![near] } else { vec![near, far] }
    }

    /// A square around a part of it, that changes by steps.
    fn square(&self, low: [f32; 2], high: [f32; 2]) -> SunBox {
        let wished = (high[0] - low[0]).max(high[1] - low[1]).max(1e-4) * 1.02;
        let edge = ((wished.log2() / STEP.log2()).ceil() * STEP.log2()).exp2();
        let texel = edge / (TEXELS - 2) as f32;
        let middle = [0, 1].map(|axis| (0.5 * (low[axis] + high[axis]) / texel).round() * texel);
        let half = 0.5 * texel * TEXELS as f32;
        // Depths change by steps too: the least part of a map's range is enough to tell them apart.
        let grain = 0.05 * edge;
        let (deep, tall) = ((self.min.z / grain).floor() * grain, (self.max.z / grain).ceil() * grain);
        SunBox {
            min: Vec3::new(middle[0] - half, middle[1] - half, deep),
            max: Vec3::new(middle[0] + half, middle[1] + half, tall),
        }
    }

    /// From the world to -1..1, the nearest to the sun at -1.
    fn matrix(&self) -> Mat4 {
        let size = self.max - self.min;
        let rows: Vec<[f32; 4]> = axes()
            .into_iter()
            .enumerate()
            .map(|(k, axis)| {
                let sign = if k == 2 { -1.0 } else { 1.0 };
                let scaled = axis * (sign * 2.0 / size[k].max(1e-6));
                let shift = -sign * (self.min[k] + self.max[k]) / size[k].max(1e-6);
                [scaled.x, scaled.y, scaled.z, shift]
            })
            .collect();
        let column = |c: usize, last: f32| three_d::vec4(rows[0][c], rows[1][c], rows[2][c], last);
        Mat4::from_cols(column(0, 0.0), column(1, 0.0), column(2, 0.0), column(3, 1.0))
    }

    fn texel(&self) -> f32 {
        (self.max.x - self.min.x) / TEXELS as f32
    }
}

/// To the right, up, and towards the sun.
pub(super) fn axes() -> [Vec3; 3] {
    let sun = TO_SUN.normalize();
    let right = Vec3::Y.cross(sun).normalize();
    [right, sun.cross(right), sun]
}

/// The maps.
#[derive(Default)]
pub(super) struct Shadows {
    maps: Vec<DepthTexture2D>,
    boxes: Vec<SunBox>,
}

impl Shadows {
    /// Nothing casts a shadow.
    pub(super) fn clear(&mut self) {
        self.boxes.clear();
    }

    /// Draws the maps, unless they are as they would be.
    pub(super) fn cast(
        &mut self,
        context: &Context,
        programs: &Programs,
        (crowd, surfaces, moved): (&Crowd, &Surfaces, bool),
        (all, target, distance): (&SunBox, Vec3, f32),
    ) {
        let boxes = all.maps(target, distance);
        if boxes == self.boxes && !moved {
            return;
        }
        self.boxes = boxes;
        while self.maps.len() < self.boxes.len() {
            let edge = Wrapping::ClampToEdge;
            self.maps.push(DepthTexture2D::new::<three_d::f24>(context, TEXELS, TEXELS, edge, edge));
        }
        let program = &programs.shape;
        for (map, covered) in self.maps.iter().zip(&self.boxes) {
            program.use_uniform("viewProjection", covered.matrix());
            let viewport = Viewport::new_at_origo(TEXELS, TEXELS);
            let target = map.as_depth_target();
            let drawn = target.clear(ClearState::depth(1.0)).write::<CoreError>(|| {
                crowd.draw(program, DEPTH, viewport, surfaces);
                Ok(())
            });
            // What draws cannot fail.
            drop(drawn);
        }
    }

    /// Tells a program that draws what is lit.
    pub(super) fn tell(&self, program: &Program) {
        if !program.requires_uniform("shadowMaps") {
            return;
        }
        // From -1..1 to 0..1.
        let to_map = Mat4::from_translation(three_d::vec3(0.5, 0.5, 0.5)) * Mat4::from_scale(0.5);
        let matrix = |k: usize| self.boxes.get(k).map_or_else(identity, |covered| to_map * covered.matrix());
        let texel = |k: usize| self.boxes.get(k).map_or(0.0, SunBox::texel);
        program.use_uniform("shadowMaps", self.boxes.len() as i32);
        program.use_uniform("nearShadowMatrix", matrix(0));
        program.use_uniform("farShadowMatrix", matrix(1));
        program.use_uniform("shadowTexels", three_d::vec2(texel(0), texel(1)));
        if let Some(near) = self.maps.first() {
            program.use_depth_texture("nearShadow", near);
            program.use_depth_texture("farShadow", self.maps.get(1).unwrap_or(near));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::convert::vector;

    fn mapped(covered: &SunBox, point: Vec3) -> Vec3 {
        let at = covered.matrix() * vector(point).extend(1.0);
        Vec3::new(at.x, at.y, at.z)
    }

    #[test]
    fn a_map_covers_what_casts_and_what_is_nearer_to_the_sun_is_nearer() {
        let mut all = SunBox::EMPTY;
        let centres = [Vec3::ZERO, Vec3::new(3.0, 1.0, -2.0), Vec3::new(-1.0, 4.0, 2.0)];
        centres.iter().for_each(|centre| all.add(*centre, 0.5));
        let maps = all.maps(Vec3::ZERO, 20.0);
        assert_eq!(maps.len(), 1, "all of it is near");
        for centre in centres {
            let at = mapped(&maps[0], centre);
            assert!(at.abs().max_element() < 1.0, "{at}");
            assert!(mapped(&maps[0], centre + TO_SUN * 0.1).z < at.z);
        }
        // Not much larger than it has to be: three quarters of the edge are used.
        let size = (all.max - all.min).truncate().max_element();
        assert!((maps[0].max.x - maps[0].min.x) < 1.25 * size);
    }

    #[test]
    fn a_large_scene_has_a_sharp_map_of_what_is_looked_at() {
        let mut all = SunBox::EMPTY;
        all.add(Vec3::ZERO, 0.1);
        all.add(Vec3::X * 400.0, 0.1);
        let maps = all.maps(Vec3::X * 7.0, 5.0);
        assert_eq!(maps.len(), 2);
        assert!(maps[0].texel() < 0.01 && maps[0].texel() < 0.2 * maps[1].texel());
        // A little to the side moves the map by whole texels.
        let moved = all.maps(Vec3::new(7.013, 0.0, 0.021), 5.0)[0].min - maps[0].min;
        let texels = moved.truncate() / maps[0].texel();
        assert!((texels - texels.round()).abs().max_element() < 0.02, "{texels}");
    }
}
