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
    pub(super) rise: f32,
    /// 1 in full touch, next to 0 where the points just miss each other.
    pub(super) weight: f32,
    pub(super) below: u32,
    /// Four times the contact, plus the point.
    pub(super) slot: u32,
}

/// What a point below a body carries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    x: f32,
    z: f32,
    /// 0 once the point is dropped.
    weight: f32,
    pub(super) total: f32,
    pub(super) still: f32,
}

impl Share {
    /// Whether the point would have to pull.
    pub(super) fn dropped(&self) -> bool {
        self.weight == 0.0
    }
}

/// A body's load spread over the points below it.
#[derive(Debug, Default)]
pub(super) struct Pressure {
    /// In the order of the supports.
    pub(super) points: Vec<Share>,
}

impl Pressure {
    /// Spreads the load over the supports as an affine function of the place, without pulling.
    pub(super) fn fit(&mut self, supports: &[Support], total: &Carried, still: &Carried, ridge: f32) {
        let points = &mut self.points;
        points.clear();
        points.extend(supports.iter().map(|s| Share {
            x: s.x,
            z: s.z,
            weight: s.weight,
            total: 0.0,
            still: 0.0,
        }));
        let mut kept = points.len();
        for _ in 0..REFITS {
            let dropped = spread(points, total, still, ridge);
            kept -= dropped;
            if dropped == 0 || kept == 0 {
                break;
            }
        }
        let (mut of_total, mut of_still) = (0.0, 0.0);
        for p in points.iter_mut() {
            if p.dropped() {
                p.total = 0.0;
                p.still = 0.0;
            }
            p.still = p.still.max(0.0);
            of_total += p.total;
            of_still += p.still;
        }
        let scale = |wanted: f32, got: f32| if got > 0.0 { wanted / got } else { 0.0 };
        let (of_total, of_still) = (scale(total.sum, of_total), scale(still.sum, of_still));
        for p in points {
            p.total *= of_total;
            p.still *= of_still;
        }
    }
}

/// One fit over the points that are left. Drops those that would have to pull, and returns how many.
fn spread(points: &mut [Share], total: &Carried, still: &Carried, ridge: f32) -> usize {
    // Points that are dropped weigh nothing, and add nothing to the sums.
    let (mut weight, mut cx, mut cz) = (0.0, 0.0, 0.0);
    for p in points.iter() {
        weight += p.weight;
        cx += p.x * p.weight;
        cz += p.z * p.weight;
    }
    let (cx, cz) = (cx / weight, cz / weight);
    let (mut xx, mut xz, mut zz) = (ridge * weight, 0.0, ridge * weight);
    for p in points.iter() {
        let (x, z) = (p.x - cx, p.z - cz);
        xx += p.weight * x * x;
        xz += p.weight * x * z;
        zz += p.weight * z * z;
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
    for p in points {
        let (x, z) = (p.x - cx, p.z - cz);
        p.still = p.weight * (mean_still + x * sx + z * sz);
        p.total = p.weight * (mean_total + x * tx + z * tz);
        if p.total < 0.0 {
            p.weight = 0.0;
            dropped += 1;
        }
    }
    dropped
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The load spread over points at these places.
    fn fitted(places: &[(f32, f32)], load: &Carried) -> Vec<Share> {
        let at =
            |&(x, z)| Support { x, z, below_x: 0.0, below_z: 0.0, rise: 1.0, weight: 1.0, below: 0, slot: 0 };
        let supports: Vec<Support> = places.iter().map(at).collect();
        let mut pressure = Pressure::default();
        pressure.fit(&supports, load, load, 1e-9);
        pressure.points
    }

    const SQUARE: [(f32, f32); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];

    #[test]
    fn sum_and_moments_match_where_no_point_must_pull() {
        let mut load = Carried::default();
        load.add(10.0, 0.3, -0.2);
        let points = fitted(&SQUARE, &load);
        let moment = |place: fn(&Share) -> f32| points.iter().map(|p| p.total * place(p)).sum::<f32>();
        assert!((moment(|_| 1.0) - 10.0).abs() < 1e-5);
        assert!((moment(|p| p.x) - 3.0).abs() < 1e-5);
        assert!((moment(|p| p.z) + 2.0).abs() < 1e-5);
        assert!(points.iter().all(|p| p.still.to_bits() == p.total.to_bits() && !p.dropped()));
    }

    #[test]
    fn a_load_beyond_the_edge_lies_on_the_edge() {
        let mut load = Carried::default();
        load.add(10.0, 1.5, 0.0);
        let points = fitted(&SQUARE, &load);
        let dropped: Vec<bool> = points.iter().map(Share::dropped).collect();
        assert_eq!(dropped, [true, false, false, true]);
        assert!(points[1..3].iter().all(|p| (p.total - 5.0).abs() < 1e-4), "{points:?}");
    }
}
