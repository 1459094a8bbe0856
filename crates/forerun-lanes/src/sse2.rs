//! Lanes in pairs of SSE2 registers: every x86-64 processor has these.
#![allow(unsafe_code, reason = "one of the rooms that use processor intrinsics")]

use std::arch::x86_64::*;
use std::cell::Cell;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Sub, SubAssign};

use super::{LANES, LaneMask, Lanes, Row, last_pair, out_of_range};

/// Eight numbers in two registers.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Sse2(__m128, __m128);

/// Eight truth values, each all ones or all zeros.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Sse2Mask(__m128, __m128);

// SAFETY: two registers of four f32 at the alignment of 32; every bit pattern is valid. All functions need SSE2 alone, which x86-64 has.
unsafe impl Lanes for Sse2 {
    type Mask = Sse2Mask;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        let half = unsafe { _mm_set1_ps(x) };
        Sse2(half, half)
    }

    #[inline(always)]
    fn from_array(lanes: [f32; LANES]) -> Self {
        unsafe { Sse2(_mm_loadu_ps(lanes.as_ptr()), _mm_loadu_ps(lanes.as_ptr().add(4))) }
    }

    #[inline(always)]
    fn to_array(self) -> [f32; LANES] {
        let mut lanes = [0.0; LANES];
        unsafe {
            _mm_storeu_ps(lanes.as_mut_ptr(), self.0);
            _mm_storeu_ps(lanes.as_mut_ptr().add(4), self.1);
        }
        lanes
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        unsafe { Sse2(_mm_sqrt_ps(self.0), _mm_sqrt_ps(self.1)) }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        unsafe {
            let sign = _mm_set1_ps(-0.0);
            Sse2(_mm_andnot_ps(sign, self.0), _mm_andnot_ps(sign, self.1))
        }
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Sse2Mask {
        unsafe { Sse2Mask(_mm_cmplt_ps(self.0, other.0), _mm_cmplt_ps(self.1, other.1)) }
    }

    #[inline(always)]
    fn le(self, other: Self) -> Sse2Mask {
        unsafe { Sse2Mask(_mm_cmple_ps(self.0, other.0), _mm_cmple_ps(self.1, other.1)) }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        unsafe { Sse2(_mm_max_ps(self.0, other.0), _mm_max_ps(self.1, other.1)) }
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        unsafe { Sse2(_mm_min_ps(self.0, other.0), _mm_min_ps(self.1, other.1)) }
    }

    #[inline(always)]
    fn to_whole(self) -> [u32; LANES] {
        let mut whole = [0; LANES];
        unsafe {
            // Whole numbers below 2^23 are exact, and adding 2^23 puts them into the lowest bits.
            let (power, low) = (_mm_set1_ps(8_388_608.0), _mm_set1_epi32(0x007f_ffff));
            let halves = [self.0, self.1].map(|h| _mm_and_si128(_mm_castps_si128(_mm_add_ps(h, power)), low));
            _mm_storeu_si128(whole.as_mut_ptr().cast(), halves[0]);
            _mm_storeu_si128(whole.as_mut_ptr().add(4).cast(), halves[1]);
        }
        whole
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
            let mut both = [0_i32; LANES];
            for lane in 0..LANES {
                // SAFETY: four bytes at an index that was found to be at or below the last at which they are in the list.
                both[lane] = unsafe {
                    list.as_ptr().add((index[lane] + offsets[k]) as usize).cast::<i32>().read_unaligned()
                };
            }
            unsafe {
                let halves =
                    [_mm_loadu_si128(both.as_ptr().cast()), _mm_loadu_si128(both.as_ptr().add(4).cast())];
                let low = halves.map(|h| _mm_cvtepi32_ps(_mm_srai_epi32::<16>(_mm_slli_epi32::<16>(h))));
                let high = halves.map(|h| _mm_cvtepi32_ps(_mm_srai_epi32::<16>(h)));
                pairs[k] = [Sse2(low[0], low[1]), Sse2(high[0], high[1])];
            }
        }
        pairs
    }

    #[inline(always)]
    unsafe fn gather_raw(rows: *const Row, length: usize, index: &[u32; LANES]) -> [Self; LANES] {
        let mut columns = [Self::zero(); LANES];
        for half in 0..2 {
            let mut low = [unsafe { _mm_setzero_ps() }; 4];
            let mut high = low;
            for lane in 0..4 {
                let at = index[4 * half + lane] as usize;
                assert!(at < length, "row {at} of {length}");
                // SAFETY: the index is below the length.
                let row: *const f32 = unsafe { rows.add(at).cast() };
                (low[lane], high[lane]) = unsafe { (_mm_load_ps(row), _mm_load_ps(row.add(4))) };
            }
            let (low, high) = (transpose(low), transpose(high));
            for k in 0..4 {
                if half == 0 {
                    (columns[k].0, columns[k + 4].0) = (low[k], high[k]);
                } else {
                    (columns[k].1, columns[k + 4].1) = (low[k], high[k]);
                }
            }
        }
        columns
    }

    #[inline(always)]
    fn scatter(rows: &[Cell<Row>], index: &[u32; LANES], values: [Self; LANES]) {
        let [a, b, c, d, e, f, g, h] = values;
        let quarters = [
            (transpose([a.0, b.0, c.0, d.0]), transpose([e.0, f.0, g.0, h.0])),
            (transpose([a.1, b.1, c.1, d.1]), transpose([e.1, f.1, g.1, h.1])),
        ];
        for half in 0..2 {
            for lane in 0..4 {
                let row: *mut f32 = rows[index[4 * half + lane] as usize].as_ptr().cast();
                unsafe {
                    _mm_store_ps(row, quarters[half].0[lane]);
                    _mm_store_ps(row.add(4), quarters[half].1[lane]);
                }
            }
        }
    }
}

/// Four rows of four to four columns.
#[inline(always)]
fn transpose(r: [__m128; 4]) -> [__m128; 4] {
    unsafe {
        let (a, b) = (_mm_unpacklo_ps(r[0], r[1]), _mm_unpackhi_ps(r[0], r[1]));
        let (c, d) = (_mm_unpacklo_ps(r[2], r[3]), _mm_unpackhi_ps(r[2], r[3]));
        [_mm_movelh_ps(a, c), _mm_movehl_ps(c, a), _mm_movelh_ps(b, d), _mm_movehl_ps(d, b)]
    }
}

impl LaneMask<Sse2> for Sse2Mask {
    #[inline(always)]
    fn select(self, yes: Sse2, no: Sse2) -> Sse2 {
        unsafe {
            Sse2(
                _mm_or_ps(_mm_and_ps(self.0, yes.0), _mm_andnot_ps(self.0, no.0)),
                _mm_or_ps(_mm_and_ps(self.1, yes.1), _mm_andnot_ps(self.1, no.1)),
            )
        }
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        unsafe { (_mm_movemask_ps(self.0) | _mm_movemask_ps(self.1) << 4) as u32 }
    }

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        unsafe {
            let (all, low) = (_mm_set1_epi32(bits as i32), _mm_setr_epi32(1, 2, 4, 8));
            let high = _mm_slli_epi32::<4>(low);
            let set = |own| _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_and_si128(all, own), own));
            Sse2Mask(set(low), set(high))
        }
    }
}

macro_rules! lanewise {
    ($type:ident, $trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                unsafe { $type($intrinsic(self.0, other.0), $intrinsic(self.1, other.1)) }
            }
        }
    };
}
lanewise!(Sse2, Add, add, _mm_add_ps);
lanewise!(Sse2, Sub, sub, _mm_sub_ps);
lanewise!(Sse2, Mul, mul, _mm_mul_ps);
lanewise!(Sse2, Div, div, _mm_div_ps);
lanewise!(Sse2Mask, BitAnd, bitand, _mm_and_ps);
lanewise!(Sse2Mask, BitOr, bitor, _mm_or_ps);

impl Neg for Sse2 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        unsafe {
            let sign = _mm_set1_ps(-0.0);
            Sse2(_mm_xor_ps(sign, self.0), _mm_xor_ps(sign, self.1))
        }
    }
}

impl AddAssign for Sse2 {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Sse2 {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
