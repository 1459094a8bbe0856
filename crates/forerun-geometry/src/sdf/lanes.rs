//! Lanes: eight numbers at a time, as plain arrays that compilers turn into vector instructions.
//!
//! Promise: lane by lane these are the IEEE operations + - * / sqrt and comparisons, the same bits on every target.

#![allow(clippy::needless_range_loop, reason = "counted loops over fixed arrays are what vectorises")]

use std::ops::{Add, Mul, Sub};

use crate::{Mat3, Vec3};

/// How many numbers go together.
pub(crate) const WIDTH: usize = 8;

/// Eight numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub(crate) struct Lanes(pub(crate) [f32; WIDTH]);

/// Eight answers to a comparison: all bits set for yes, none for no.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub(crate) struct Mask(pub(crate) [u32; WIDTH]);

/// Eight vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes3 {
    pub(crate) x: Lanes,
    pub(crate) y: Lanes,
    pub(crate) z: Lanes,
}

impl Lanes {
    pub(crate) const ZERO: Lanes = Lanes([0.0; WIDTH]);

    #[inline(always)]
    pub(crate) fn splat(value: f32) -> Lanes {
        Lanes([value; WIDTH])
    }

    #[inline(always)]
    fn zip(self, other: Lanes, operation: impl Fn(f32, f32) -> f32) -> Lanes {
        let mut out = [0.0; WIDTH];
        for i in 0..WIDTH {
            out[i] = operation(self.0[i], other.0[i]);
        }
        Lanes(out)
    }

    #[inline(always)]
    pub(crate) fn map(self, operation: impl Fn(f32) -> f32) -> Lanes {
        let mut out = [0.0; WIDTH];
        for i in 0..WIDTH {
            out[i] = operation(self.0[i]);
        }
        Lanes(out)
    }

    /// The larger of two; `other` where this is not a number.
    #[inline(always)]
    pub(crate) fn max(self, other: Lanes) -> Lanes {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    /// The smaller of two; `other` where this is not a number.
    #[inline(always)]
    pub(crate) fn min(self, other: Lanes) -> Lanes {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Lanes {
        self.map(f32::sqrt)
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Lanes {
        self.map(f32::abs)
    }

    /// Where this is below `other`; never where either is not a number.
    #[inline(always)]
    pub(crate) fn below(self, other: Lanes) -> Mask {
        let mut out = [0; WIDTH];
        for i in 0..WIDTH {
            out[i] = if self.0[i] < other.0[i] { u32::MAX } else { 0 };
        }
        Mask(out)
    }
}

impl Mask {
    /// `yes` where set, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn select(self, yes: Lanes, no: Lanes) -> Lanes {
        let mut out = [0.0; WIDTH];
        for i in 0..WIDTH {
            out[i] = f32::from_bits((yes.0[i].to_bits() & self.0[i]) | (no.0[i].to_bits() & !self.0[i]));
        }
        Lanes(out)
    }

    #[inline(always)]
    pub(crate) fn select3(self, yes: Lanes3, no: Lanes3) -> Lanes3 {
        Lanes3 { x: self.select(yes.x, no.x), y: self.select(yes.y, no.y), z: self.select(yes.z, no.z) }
    }

    /// One bit a lane, the first lane lowest.
    #[inline(always)]
    pub(crate) fn bits(self) -> u32 {
        let mut out = 0;
        for i in 0..WIDTH {
            out |= (self.0[i] & 1) << i;
        }
        out
    }
}

impl Add for Lanes {
    type Output = Lanes;
    #[inline(always)]
    fn add(self, other: Lanes) -> Lanes {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Lanes;
    #[inline(always)]
    fn sub(self, other: Lanes) -> Lanes {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Lanes;
    #[inline(always)]
    fn mul(self, other: Lanes) -> Lanes {
        self.zip(other, |a, b| a * b)
    }
}

impl Mul<f32> for Lanes {
    type Output = Lanes;
    #[inline(always)]
    fn mul(self, factor: f32) -> Lanes {
        self.map(|a| a * factor)
    }
}

impl Lanes3 {
    pub(crate) const ZERO: Lanes3 = Lanes3 { x: Lanes::ZERO, y: Lanes::ZERO, z: Lanes::ZERO };

    #[inline(always)]
    pub(crate) fn splat(v: Vec3) -> Lanes3 {
        Lanes3 { x: Lanes::splat(v.x), y: Lanes::splat(v.y), z: Lanes::splat(v.z) }
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Lanes3) -> Lanes {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn length(self) -> Lanes {
        self.dot(self).sqrt()
    }

    /// Lane by lane times a number each.
    #[inline(always)]
    pub(crate) fn scaled(self, factor: Lanes) -> Lanes3 {
        Lanes3 { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }

    #[inline(always)]
    pub(crate) fn minus(self, other: Lanes3) -> Lanes3 {
        Lanes3 { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    #[inline(always)]
    pub(crate) fn plus(self, other: Lanes3) -> Lanes3 {
        Lanes3 { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }

    /// Unit vectors; very short ones stay very short instead of becoming infinite.
    #[inline(always)]
    pub(crate) fn normalized(self) -> Lanes3 {
        self.scaled((self.dot(self) + Lanes::splat(1e-20)).sqrt().map(|length| 1.0 / length))
    }

    /// `axes * self + origin`.
    #[inline(always)]
    pub(crate) fn transformed(self, axes: &Mat3, origin: Vec3) -> Lanes3 {
        let row = |x: f32, y: f32, z: f32, o: f32| self.x * x + self.y * y + self.z * z + Lanes::splat(o);
        Lanes3 {
            x: row(axes.x_axis.x, axes.y_axis.x, axes.z_axis.x, origin.x),
            y: row(axes.x_axis.y, axes.y_axis.y, axes.z_axis.y, origin.y),
            z: row(axes.x_axis.z, axes.y_axis.z, axes.z_axis.z, origin.z),
        }
    }

    #[inline(always)]
    pub(crate) fn lane(&self, i: usize) -> Vec3 {
        Vec3::new(self.x.0[i], self.y.0[i], self.z.0[i])
    }

    #[inline(always)]
    pub(crate) fn set_lane(&mut self, i: usize, v: Vec3) {
        (self.x.0[i], self.y.0[i], self.z.0[i]) = (v.x, v.y, v.z);
    }
}
