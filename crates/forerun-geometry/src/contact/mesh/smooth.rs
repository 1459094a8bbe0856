//! Smoothing: the normals of the few points that are kept, by central differences.

use forerun_lanes::{LANES, Lanes, V8, dispatched};

use super::candidates::Candidate;
use super::directions::{Direction, Way};
use crate::sdf::Field;
use crate::sdf::primitive::Surface;

/// Cosine of the largest angle by which smoothing may turn a normal: 20 degrees.
const SMOOTH_COSINE: f32 = 0.94;

/// Where fields are looked up, six times for each candidate.
#[derive(Clone, Debug, Default)]
pub(super) struct Taps {
    /// The candidates, by their places in a list.
    candidates: Vec<u32>,
    /// Coordinates in the field's frame. Metres.
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    /// Signed distances there. Metres.
    distances: Vec<f32>,
}

/// Replaces the normals of candidates that were found in the field of a mesh by smooth ones.
pub(super) fn smooth(candidates: &mut [Candidate], directions: &[Option<Direction>; 2], taps: &mut Taps) {
    for way in [Way::There, Way::Back] {
        let Some(direction) = &directions[way as usize] else { continue };
        let Surface::Field(field) = direction.surface else { continue };
        taps.place(candidates, way, field);
        if taps.candidates.is_empty() {
            continue;
        }
        measure(field, taps);
        for (&i, distances) in taps.candidates.iter().zip(taps.distances.chunks_exact(6)) {
            let candidate = &mut candidates[i as usize];
            let mut six = [0.0; 6];
            six.copy_from_slice(distances);
            let Some(gradient) = field.difference(six).try_normalize() else { continue };
            let (normal, position) = direction.to_world(candidate.point, gradient, candidate.separation);
            // On round surfaces the two are within a few degrees. At edges and in the middle of thin parts the
            // differences mix sides that have nothing to do with each other.
            if normal.dot(candidate.normal) > SMOOTH_COSINE {
                (candidate.normal, candidate.position) = (normal, position);
            }
        }
    }
}

impl Taps {
    /// Those of the candidates that came this way and may be smoothed.
    fn place(&mut self, candidates: &[Candidate], way: Way, field: &Field) {
        self.candidates.clear();
        let coordinates = [&mut self.x, &mut self.y, &mut self.z];
        let [x, y, z] = coordinates.map(|list| {
            list.clear();
            list
        });
        for (i, candidate) in candidates.iter().enumerate() {
            // Beyond the grid there is nothing to take differences of.
            if candidate.way != way || !candidate.rough || !field.contains(candidate.point) {
                continue;
            }
            let taps = field.taps(candidate.point);
            x.extend_from_slice(&taps[0]);
            y.extend_from_slice(&taps[1]);
            z.extend_from_slice(&taps[2]);
            self.candidates.push(i as u32);
        }
        // Whole lanes, the last of which may ask about nothing.
        let whole = x.len().next_multiple_of(LANES);
        for list in [x, y, z, &mut self.distances] {
            list.resize(whole, 0.0);
        }
    }
}

dispatched! {
    /// The distances at all taps.
    fn measure(field: &Field, taps: &mut Taps) => measure_lanes
}

#[inline(always)]
fn measure_lanes<F: Lanes>(field: &Field, taps: &mut Taps) {
    let points = taps.x.chunks_exact(LANES).zip(taps.y.chunks_exact(LANES)).zip(taps.z.chunks_exact(LANES));
    for (((x, y), z), out) in points.zip(taps.distances.chunks_exact_mut(LANES)) {
        let (distances, _) = field.look_up::<F>(V8 { x: eight(x), y: eight(y), z: eight(z) });
        out.copy_from_slice(&distances.to_array());
    }
}

#[inline(always)]
fn eight<F: Lanes>(numbers: &[f32]) -> F {
    let mut lanes = [0.0; LANES];
    lanes.copy_from_slice(numbers);
    F::from_array(lanes)
}
