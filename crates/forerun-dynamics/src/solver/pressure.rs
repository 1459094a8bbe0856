//! Pressure: a body's load spread over the points below it, without pulling.

/// Points that would have to pull are dropped and the pressure is fitted again, at most this often.
const REFITS: usize = 4;

/// A vertical load and its first moments about the body's centre.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Carried {
    pub(super) sum: f32,
    pub(super) moment_1: f32,
    pub(super) moment_2: f32,
}

impl Carried {
    pub(super) fn add(&mut self, force: f32, x: f32, z: f32) {
        self.sum += force;
        self.moment_1 += force * x;
        self.moment_2 += force * z;
    }
}

/// A contact point below a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Support {
    /// Horizontal place relative to the body's centre, where the line of the force, friction of a slide included, is as high as the centre.
    pub(super) x: f32,
    pub(super) z: f32,
    /// The same for the body below.
    pub(super) below_x: f32,
    pub(super) below_z: f32,
    pub(super) contact: u32,
    pub(super) point: u32,
    pub(super) below: u32,
    pub(super) rise: f32,
    /// 1 in full touch, next to 0 where the points just miss each other; 0 for a point that is dropped.
    pub(super) weight: f32,
    pub(super) total: f32,
    pub(super) still: f32,
}

impl Support {
    /// Whether the point would have to pull.
    pub(super) fn dropped(&self) -> bool {
        self.weight == 0.0
    }
}

/// Spreads the load over the supports as an affine function of the place, without pulling.
pub(super) fn fit(supports: &mut [Support], total: &Carried, still: &Carried, ridge: f32) {
    let mut kept = supports.len();
    for _ in 0..REFITS {
        let dropped = spread(supports, total, still, ridge);
        kept -= dropped;
        if dropped == 0 || kept == 0 {
            break;
        }
    }
    let (mut of_total, mut of_still) = (0.0, 0.0);
    for s in supports.iter_mut() {
        if s.dropped() {
            s.total = 0.0;
            s.still = 0.0;
        }
        s.still = s.still.max(0.0);
        of_total += s.total;
        of_still += s.still;
    }
    let scale = |wanted: f32, got: f32| if got > 0.0 { wanted / got } else { 0.0 };
    let (of_total, of_still) = (scale(total.sum, of_total), scale(still.sum, of_still));
    for s in supports {
        s.total *= of_total;
        s.still *= of_still;
    }
}

/// One fit over the points that are left. Drops those that would have to pull, and returns how many.
fn spread(supports: &mut [Support], total: &Carried, still: &Carried, ridge: f32) -> usize {
    // Points that are dropped weigh nothing, and add nothing to the sums.
    let (mut weight, mut cx, mut cz) = (0.0, 0.0, 0.0);
    for s in supports.iter() {
        weight += s.weight;
        cx += s.x * s.weight;
        cz += s.z * s.weight;
    }
    let (cx, cz) = (cx / weight, cz / weight);
    let (mut xx, mut xz, mut zz) = (ridge * weight, 0.0, ridge * weight);
    for s in supports.iter() {
        let (x, z) = (s.x - cx, s.z - cz);
        xx += s.weight * x * x;
        xz += s.weight * x * z;
        zz += s.weight * z * z;
    }
    let inverse = 1.0 / (xx * zz - xz * xz);
    let slopes = |load: &Carried| {
        let (m1, m2) = (load.moment_1 - load.sum * cx, load.moment_2 - load.sum * cz);
        ((m1 * zz - m2 * xz) * inverse, (m2 * xx - m1 * xz) * inverse)
    };
    let (tx, tz) = slopes(total);
    let (sx, sz) = slopes(still);
    let (mean_total, mean_still) = (total.sum / weight, still.sum / weight);
    let mut dropped = 0;
    for s in supports {
        let (x, z) = (s.x - cx, s.z - cz);
        s.still = s.weight * (mean_still + x * sx + z * sz);
        s.total = s.weight * (mean_total + x * tx + z * tz);
        if s.total < 0.0 {
            s.weight = 0.0;
            dropped += 1;
        }
    }
    dropped
}

#[cfg(test)]
mod tests {
    use super::*;

    fn supports(places: &[(f32, f32)]) -> Vec<Support> {
        let at = |&(x, z)| Support {
            x,
            z,
            below_x: 0.0,
            below_z: 0.0,
            contact: 0,
            point: 0,
            below: 0,
            rise: 1.0,
            weight: 1.0,
            total: 0.0,
            still: 0.0,
        };
        places.iter().map(at).collect()
    }

    const SQUARE: [(f32, f32); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];

    #[test]
    fn sum_and_moments_match_where_no_point_must_pull() {
        let mut load = Carried::default();
        load.add(10.0, 0.3, -0.2);
        let mut points = supports(&SQUARE);
        fit(&mut points, &load, &load, 1e-9);
        let moment = |place: fn(&Support) -> f32| points.iter().map(|s| s.total * place(s)).sum::<f32>();
        assert!((moment(|_| 1.0) - 10.0).abs() < 1e-5);
        assert!((moment(|s| s.x) - 3.0).abs() < 1e-5);
        assert!((moment(|s| s.z) + 2.0).abs() < 1e-5);
        assert!(points.iter().all(|s| s.still.to_bits() == s.total.to_bits() && !s.dropped()));
    }

    #[test]
    fn a_load_beyond_the_edge_lies_on_the_edge() {
        let mut load = Carried::default();
        load.add(10.0, 1.5, 0.0);
        let mut points = supports(&SQUARE);
        fit(&mut points, &load, &load, 1e-9);
        let dropped: Vec<bool> = points.iter().map(Support::dropped).collect();
        assert_eq!(dropped, [true, false, false, true]);
        assert!(points[1..3].iter().all(|s| (s.total - 5.0).abs() < 1e-4), "{points:?}");
    }
}
