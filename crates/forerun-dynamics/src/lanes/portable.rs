//! Lanes as plain arrays: every target has these.
#![allow(
    unsafe_code,
    reason = "reads rows by address, as the other forms do, and says of its layout what they rely on"
)]

use std::cell::Cell;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Sub, SubAssign};

use super::{LANES, LaneMask, Lanes, Row};

/// Eight numbers in an array.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Portable([f32; LANES]);

/// Eight truth values, each all ones or all zeros.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct PortableMask([u32; LANES]);

impl Portable {
    #[inline(always)]
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Portable(self.0.map(f))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Portable(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f32, f32) -> bool) -> PortableMask {
        PortableMask(std::array::from_fn(|i| if f(self.0[i], other.0[i]) { !0 } else { 0 }))
    }
}

// SAFETY: eight f32 at the alignment of 32; every bit pattern is valid.
unsafe impl Lanes for Portable {
    type Mask = PortableMask;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Portable([x; LANES])
    }

    #[inline(always)]
    fn from_array(lanes: [f32; LANES]) -> Self {
        Portable(lanes)
    }

    #[inline(always)]
    fn to_array(self) -> [f32; LANES] {
        self.0
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f32::sqrt)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f32::abs)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> PortableMask {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> PortableMask {
        self.compare(other, |a, b| a <= b)
    }

    #[inline(always)]
    unsafe fn gather_raw(rows: *const Row, length: usize, index: &[u32; LANES]) -> [Self; LANES] {
        let rows = index.map(|i| {
            assert!((i as usize) < length, "row {i} of {length}");
            // SAFETY: the index is below the length.
            unsafe { (*rows.add(i as usize)).0 }
        });
        std::array::from_fn(|k| Portable(rows.map(|row| row[k])))
    }

    #[inline(always)]
    fn scatter(rows: &[Cell<Row>], index: &[u32; LANES], values: [Self; LANES]) {
        for (lane, &i) in index.iter().enumerate() {
            rows[i as usize].set(Row(values.map(|v| v.0[lane])));
        }
    }
}

impl LaneMask<Portable> for PortableMask {
    #[inline(always)]
    fn select(self, yes: Portable, no: Portable) -> Portable {
        Portable(std::array::from_fn(|i| {
            f32::from_bits((yes.0[i].to_bits() & self.0[i]) | (no.0[i].to_bits() & !self.0[i]))
        }))
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.iter().enumerate().fold(0, |bits, (i, lane)| bits | (lane & 1) << i)
    }
}

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Portable {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $op b)
            }
        }
    };
}
lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);
lanewise!(Div, div, /);

impl Neg for Portable {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}

impl AddAssign for Portable {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Portable {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl BitAnd for PortableMask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        PortableMask(std::array::from_fn(|i| self.0[i] & other.0[i]))
    }
}

impl BitOr for PortableMask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        PortableMask(std::array::from_fn(|i| self.0[i] | other.0[i]))
    }
}
