//! Eight: vectors in lanes, from and to single ones.

use forerun_lanes::{LANES, Lanes, Portable, V8};

use crate::{Mat3, Vec3};

/// The same vector in all lanes.
#[inline(always)]
pub(crate) fn splat<F: Lanes>(v: Vec3) -> V8<F> {
    V8::splat([v.x, v.y, v.z])
}

/// One vector per lane.
pub(crate) fn of_vectors(vectors: &[Vec3; LANES]) -> V8<Portable> {
    V8::from_arrays([vectors.map(|v| v.x), vectors.map(|v| v.y), vectors.map(|v| v.z)])
}

/// The vector of a lane.
#[inline(always)]
pub(crate) fn lane(v: &V8<Portable>, i: usize) -> Vec3 {
    Vec3::new(v.x.to_array()[i], v.y.to_array()[i], v.z.to_array()[i])
}

/// Unit vectors; very short ones stay very short instead of becoming infinite.
#[inline(always)]
pub(crate) fn normalized<F: Lanes>(v: V8<F>) -> V8<F> {
    v * (F::one() / (v.dot(v) + F::splat(1e-20)).sqrt())
}

/// `axes * v + origin`.
#[inline(always)]
pub(crate) fn transformed<F: Lanes>(v: V8<F>, axes: &Mat3, origin: Vec3) -> V8<F> {
    let (x, y, z) = (splat::<F>(axes.x_axis), splat::<F>(axes.y_axis), splat::<F>(axes.z_axis));
    V8 {
        x: v.x * x.x + v.y * y.x + v.z * z.x + F::splat(origin.x),
        y: v.x * x.y + v.y * y.y + v.z * z.y + F::splat(origin.y),
        z: v.x * x.z + v.y * y.z + v.z * z.z + F::splat(origin.z),
    }
}
