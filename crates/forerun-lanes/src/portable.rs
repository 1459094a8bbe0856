//! Lanes as plain arrays: every target has these. Counted loops over fixed arrays, which compilers turn into vector instructions.
#![allow(
    unsafe_code,
    reason = "reads rows by address, as the other forms do, and says of its layout what they rely on"
)]

use std::cell::Cell;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Sub, SubAssign};

use super::{LANES, LaneMask, Lanes, Row, last_pair, out_of_range};

/// Eight numbers in an array.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Portable([f32; LANES]);

/// Eight truth values, each all ones or all zeros.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct PortableMask([u32; LANES]);

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
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = self.0[i].sqrt();
        }
        Portable(out)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = self.0[i].abs();
        }
        Portable(out)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> PortableMask {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = if self.0[i] < other.0[i] { !0 } else { 0 };
        }
        PortableMask(out)
    }

    #[inline(always)]
    fn le(self, other: Self) -> PortableMask {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = if self.0[i] <= other.0[i] { !0 } else { 0 };
        }
        PortableMask(out)
    }

    #[inline(always)]
    fn to_whole(self) -> [u32; LANES] {
        let mut out = [0; LANES];
        for i in 0..LANES {
            // Whole numbers below 2^23 are exact, and adding 2^23 puts them into the lowest bits.
            out[i] = (self.0[i] + 8_388_608.0).to_bits() & 0x007f_ffff;
        }
        out
    }

    #[inline(always)]
    fn gather_pairs<const N: usize>(
        list: &[i16],
        index: &[u32; LANES],
        offsets: &[u32; N],
    ) -> [[Self; 2]; N] {
        if !last_pair(list.len(), offsets).is_some_and(|last| index.iter().all(|i| *i <= last)) {
            out_of_range(index, list.len());
        }
        let mut pairs = [[Self::zero(); 2]; N];
        for k in 0..N {
            for lane in 0..LANES {
                let at = (index[lane] + offsets[k]) as usize;
                pairs[k][0].0[lane] = f32::from(list[at]);
                pairs[k][1].0[lane] = f32::from(list[at + 1]);
            }
        }
        pairs
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
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = f32::from_bits((yes.0[i].to_bits() & self.0[i]) | (no.0[i].to_bits() & !self.0[i]));
        }
        Portable(out)
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        let mut bits = 0;
        for i in 0..LANES {
            bits |= (self.0[i] & 1) << i;
        }
        bits
    }

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = if bits >> i & 1 == 1 { !0 } else { 0 };
        }
        PortableMask(out)
    }
}

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Portable {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let mut out = [0.0; LANES];
                for i in 0..LANES {
                    out[i] = self.0[i] $op other.0[i];
                }
                Portable(out)
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
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = -self.0[i];
        }
        Portable(out)
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
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = self.0[i] & other.0[i];
        }
        PortableMask(out)
    }
}

impl BitOr for PortableMask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = self.0[i] | other.0[i];
        }
        PortableMask(out)
    }
}
