//! Noise for scenes: the same numbers everywhere, for ever.

use forerun_geometry::Quat;

/// A generator of numbers that look random: SplitMix64 (Steele, Lea, Flood: *Fast Splittable Pseudorandom Number Generators*, 2014).
///
/// Scenes name their seed. A change here changes every scene with noise, and with it every recorded result.
pub(super) struct Noise(u64);

impl Noise {
    pub(super) fn new(seed: u64) -> Noise {
        Noise(seed)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from `low` up to `high`, in 2^24 equal steps: exact in f32.
    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        let unit = (self.bits() >> 40) as f32 * (1.0 / 16_777_216.0);
        low + (high - low) * unit
    }

    /// A number from `-most` to `most`.
    pub(super) fn about_zero(&mut self, most: f32) -> f32 {
        self.between(-most, most)
    }

    /// A rotation, all equally likely (Shoemake: *Uniform Random Rotations*, Graphics Gems III, 1992).
    pub(super) fn rotation(&mut self) -> Quat {
        let u = self.between(0.0, 1.0);
        let (sin_a, cos_a) = libm::sincosf(self.between(0.0, std::f32::consts::TAU));
        let (sin_b, cos_b) = libm::sincosf(self.between(0.0, std::f32::consts::TAU));
        let (p, q) = ((1.0 - u).sqrt(), u.sqrt());
        Quat::from_xyzw(p * sin_a, p * cos_a, q * sin_b, q * cos_b).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gives_the_published_numbers() {
        // First outputs of SplitMix64 for seed 1234567 (Vigna's reference program).
        let mut noise = Noise::new(1_234_567);
        assert_eq!(noise.bits(), 6_457_827_717_110_365_317);
        assert_eq!(noise.bits(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn stays_in_its_range_and_fills_it() {
        let mut noise = Noise::new(1);
        let numbers: Vec<f32> = (0..1000).map(|_| noise.between(2.0, 4.0)).collect();
        assert!(numbers.iter().all(|x| (2.0..4.0).contains(x)));
        let mean = numbers.iter().sum::<f32>() / 1000.0;
        assert!((mean - 3.0).abs() < 0.06, "{mean}");
    }
}
