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

/// The points of a contact with a body below. Where one does not support, its weight is 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Footing {
    /// Horizontal places relative to the body's centre, where the line of the force, friction of a slide included, is as high as the centre.
    pub(super) x: [f32; 4],
    pub(super) z: [f32; 4],
    /// The same for the body below.
    pub(super) below_x: [f32; 4],
    pub(super) below_z: [f32; 4],
    pub(super) rise: [f32; 4],
    /// 1 in full touch, next to 0 where the points just miss each other.
    pub(super) weight: [f32; 4],
    pub(super) below: u32,
    pub(super) contact: u32,
}

/// What the points of a footing carry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shares {
    /// As in the footing; 0 too for points that would have to pull.
    weight: [f32; 4],
    pub(super) total: [f32; 4],
    pub(super) still: [f32; 4],
}

/// A body's load spread over the points below it. Sums are taken by place in the footing, then over the four places.
#[derive(Debug, Default)]
pub(super) struct Pressure {
    /// In the order of the footings.
    pub(super) shares: Vec<Shares>,
}

impl Pressure {
    /// Spreads the load over the points as an affine function of the place, without pulling.
    pub(super) fn fit(&mut self, footings: &[Footing], total: &Carried, still: &Carried, ridge: f32) {
        let shares = &mut self.shares;
        shares.clear();
        shares.extend(footings.iter().map(|f| Shares { weight: f.weight, total: [0.0; 4], still: [0.0; 4] }));
        for _ in 0..REFITS {
            if !spread(footings, shares, (total, still), ridge) {
                break;
            }
        }
        let (mut of_total, mut of_still) = ([0.0; 4], [0.0; 4]);
        for s in shares.iter_mut() {
            for q in 0..4 {
                let kept = s.weight[q] > 0.0;
                s.total[q] = if kept { s.total[q] } else { 0.0 };
                s.still[q] = if kept && s.still[q] > 0.0 { s.still[q] } else { 0.0 };
                of_total[q] += s.total[q];
                of_still[q] += s.still[q];
            }
        }
        let scale = |wanted: f32, got: f32| if got > 0.0 { wanted / got } else { 0.0 };
        let (of_total, of_still) = (scale(total.sum, sum(of_total)), scale(still.sum, sum(of_still)));
        for s in shares {
            for q in 0..4 {
                s.total[q] *= of_total;
                s.still[q] *= of_still;
            }
        }
    }
}

/// One fit over the points that are left. Drops those that would have to pull, and says whether there were some, and others are left.
fn spread(
    footings: &[Footing],
    shares: &mut [Shares],
    (total, still): (&Carried, &Carried),
    ridge: f32,
) -> bool {
    let (mut weight, mut cx, mut cz) = ([0.0; 4], [0.0; 4], [0.0; 4]);
    for (f, s) in footings.iter().zip(&*shares) {
        for q in 0..4 {
            weight[q] += s.weight[q];
            cx[q] += f.x[q] * s.weight[q];
            cz[q] += f.z[q] * s.weight[q];
        }
    }
    let weight = sum(weight);
    let (cx, cz) = (sum(cx) / weight, sum(cz) / weight);
    let (mut xx, mut xz, mut zz) = ([0.0; 4], [0.0; 4], [0.0; 4]);
    for (f, s) in footings.iter().zip(&*shares) {
        for q in 0..4 {
            let (x, z) = (f.x[q] - cx, f.z[q] - cz);
            xx[q] += s.weight[q] * x * x;
            xz[q] += s.weight[q] * x * z;
            zz[q] += s.weight[q] * z * z;
        }
    }
    let (xx, xz, zz) = (sum(xx) + ridge * weight, sum(xz), sum(zz) + ridge * weight);
    let inverse = 1.0 / (xx * zz - xz * xz);
    let slopes = |load: &Carried| {
        let (m1, m2) = (load.moment_1 - load.sum * cx, load.moment_2 - load.sum * cz);
        ((m1 * zz - m2 * xz) * inverse, (m2 * xx - m1 * xz) * inverse)
    };
    let ((tx, tz), (sx, sz)) = (slopes(total), slopes(still));
    let (mean_total, mean_still) = (total.sum / weight, still.sum / weight);
    let (mut pulls, mut kept) = (false, false);
    for (f, s) in footings.iter().zip(shares) {
        for q in 0..4 {
            let (x, z) = (f.x[q] - cx, f.z[q] - cz);
            s.still[q] = s.weight[q] * (mean_still + x * sx + z * sz);
            s.total[q] = s.weight[q] * (mean_total + x * tx + z * tz);
            let pull = s.total[q] < 0.0;
            s.weight[q] = if pull { 0.0 } else { s.weight[q] };
            pulls |= pull;
            kept |= s.weight[q] > 0.0;
        }
    }
    pulls && kept
}

fn sum(places: [f32; 4]) -> f32 {
    (places[0] + places[1]) + (places[2] + places[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: Footing = Footing {
        x: [-1.0, 1.0, 1.0, -1.0],
        z: [-1.0, -1.0, 1.0, 1.0],
        below_x: [0.0; 4],
        below_z: [0.0; 4],
        rise: [1.0; 4],
        weight: [1.0; 4],
        below: 0,
        contact: 0,
    };

    /// The load spread over these points.
    fn fitted(footings: &[Footing], load: &Carried) -> Vec<Shares> {
        let mut pressure = Pressure::default();
        pressure.fit(footings, load, load, 1e-9);
        pressure.shares
    }

    #[test]
    fn sum_and_moments_match_where_no_point_must_pull() {
        let mut load = Carried::default();
        load.add(10.0, 0.3, -0.2);
        // Another footing, of which one point alone supports.
        let beside = Footing { weight: [0.0, 1.0, 0.0, 0.0], ..SQUARE };
        let footings = [SQUARE, beside];
        let shares = fitted(&footings, &load);
        let moment = |place: fn(&Footing, usize) -> f32| {
            let of = |(f, s): (&Footing, &Shares)| (0..4).map(|q| s.total[q] * place(f, q)).sum::<f32>();
            footings.iter().zip(&shares).map(of).sum::<f32>()
        };
        assert!((moment(|_, _| 1.0) - 10.0).abs() < 1e-5);
        assert!((moment(|f, q| f.x[q]) - 3.0).abs() < 1e-5);
        assert!((moment(|f, q| f.z[q]) + 2.0).abs() < 1e-5);
        assert!(shares.iter().all(|s| s.still.map(f32::to_bits) == s.total.map(f32::to_bits)));
        assert_eq!(shares[1].total.map(|load| load > 0.0), [false, true, false, false]);
    }

    #[test]
    fn a_load_beyond_the_edge_lies_on_the_edge() {
        let mut load = Carried::default();
        load.add(10.0, 1.5, 0.0);
        let shares = fitted(&[SQUARE], &load);
        assert_eq!(shares[0].weight.map(|w| w > 0.0), [false, true, true, false]);
        let expected = [0.0, 5.0, 5.0, 0.0];
        assert!(shares[0].total.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4), "{shares:?}");
    }
}
