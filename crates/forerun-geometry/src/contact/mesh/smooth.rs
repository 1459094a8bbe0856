//! Smoothing: the normals of the few points that are kept, by central differences.

use forerun_lanes::{LANES, LaneMask, Lanes, V8, dispatched};

use super::candidates::Candidate;
use super::directions::{Direction, Way};
use crate::Vec3;
use crate::sdf::Field;
use crate::sdf::eight::{splat, transformed};
use crate::sdf::primitive::Surface;

/// Cosine of the largest angle by which smoothing may turn a normal: 20 degrees.
const SMOOTH_COSINE: f32 = 0.94;

/// Replaces the normals of candidates that were found in the field of a mesh by smooth ones. `rough` is memory.
pub(super) fn smooth(
    candidates: &mut [Candidate],
    directions: &[Option<Direction>; 2],
    rough: &mut Vec<u32>,
) {
    for way in [Way::There, Way::Back] {
        let Some(direction) = &directions[way as usize] else { continue };
        let Surface::Field(field) = direction.surface else { continue };
        rough.clear();
        let all = candidates.iter().enumerate();
        rough.extend(all.filter(|(_, c)| c.way == way && c.rough).map(|(i, _)| i as u32));
        smooth_in(field, direction, rough, candidates);
    }
}

dispatched! {
    /// Those at the places `rough`, which came this way.
    fn smooth_in(
        field: &Field,
        direction: &Direction,
        rough: &[u32],
        candidates: &mut [Candidate],
    ) => smooth_lanes
}

#[inline(always)]
fn smooth_lanes<F: Lanes>(field: &Field, direction: &Direction, rough: &[u32], candidates: &mut [Candidate]) {
    let bounds = field.bounds();
    for chunk in rough.chunks(LANES) {
        let mut numbers = [[0.0; LANES]; 7];
        for lane in 0..LANES {
            // The last one fills what is left over.
            let c = &candidates[chunk[lane.min(chunk.len() - 1)] as usize];
            let (p, n) = (c.point, c.normal);
            for (k, number) in [p.x, p.y, p.z, n.x, n.y, n.z, c.separation].into_iter().enumerate() {
                numbers[k][lane] = number;
            }
        }
        let [px, py, pz, nx, ny, nz, separation] = numbers;
        let (points, rough_normals) = (V8::<F>::from_arrays([px, py, pz]), V8::from_arrays([nx, ny, nz]));
        let gradients = field.differences(points, chunk.len());
        let lengths = gradients.length();
        let gradients = gradients * (F::one() / lengths);
        let normals = transformed(gradients, &direction.field_axes, Vec3::ZERO) * F::splat(direction.sign());
        let midpoints = points - gradients * (F::splat(0.5) * F::from_array(separation));
        let positions = transformed(midpoints, &direction.field_axes, direction.field_position);
        // On round surfaces the two are within a few degrees. At edges and in the middle of thin parts the differences
        // mix sides that have nothing to do with each other. Beyond the grid there is nothing to take them of.
        let alike = rough_normals.dot(normals).gt(F::splat(SMOOTH_COSINE));
        let better = (alike & lengths.gt(F::zero())).bits()
            & within(points, splat(bounds.min), splat(bounds.max)).bits();
        let (nx, ny, nz) = (normals.x.to_array(), normals.y.to_array(), normals.z.to_array());
        let (px, py, pz) = (positions.x.to_array(), positions.y.to_array(), positions.z.to_array());
        for (lane, &i) in chunk.iter().enumerate() {
            if better >> lane & 1 == 1 {
                let c = &mut candidates[i as usize];
                c.normal = Vec3::new(nx[lane], ny[lane], nz[lane]);
                c.position = Vec3::new(px[lane], py[lane], pz[lane]);
            }
        }
    }
}

/// Which points are in a box.
#[inline(always)]
fn within<F: Lanes>(p: V8<F>, min: V8<F>, max: V8<F>) -> F::Mask {
    min.x.le(p.x) & min.y.le(p.y) & min.z.le(p.z) & p.x.le(max.x) & p.y.le(max.y) & p.z.le(max.z)
}
