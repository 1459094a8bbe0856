//! Lanes in AVX registers.
//!
//! # Safety
//! Every function here uses AVX instructions without asking. All are inlined into functions that [`dispatched!`](crate::dispatched) makes and calls
//! only after AVX2 has been detected; nothing else may use [`Avx2`]. With AVX-512 the same code has 32 registers.
#![allow(unsafe_code, reason = "one of the rooms that use processor intrinsics")]

use std::arch::x86_64::*;
use std::cell::Cell;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Sub, SubAssign};

use super::{LANES, LaneMask, Lanes, Row, last_pair, out_of_range};

/// Eight numbers in a register.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Avx2(__m256);

/// Eight truth values, each all ones or all zeros.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Avx2Mask(__m256);

// SAFETY: eight f32 at the alignment of 32; every bit pattern is valid.
unsafe impl Lanes for Avx2 {
    type Mask = Avx2Mask;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Avx2(unsafe { _mm256_set1_ps(x) })
    }

    #[inline(always)]
    fn from_array(lanes: [f32; LANES]) -> Self {
        Avx2(unsafe { _mm256_loadu_ps(lanes.as_ptr()) })
    }

    #[inline(always)]
    fn to_array(self) -> [f32; LANES] {
        let mut lanes = [0.0; LANES];
        unsafe { _mm256_storeu_ps(lanes.as_mut_ptr(), self.0) };
        lanes
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Avx2(unsafe { _mm256_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Avx2(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Avx2Mask {
        Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Avx2Mask {
        Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) })
    }

    // The processor's own max and min are the comparisons of the trait: the second where either is NaN, or both are 0.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Avx2(unsafe { _mm256_max_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Avx2(unsafe { _mm256_min_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn to_whole(self) -> [u32; LANES] {
        let mut whole = [0; LANES];
        unsafe {
            // Whole numbers below 2^23 are exact, and adding 2^23 puts them into the lowest bits.
            let bits = _mm256_castps_si256(_mm256_add_ps(self.0, _mm256_set1_ps(8_388_608.0)));
            let low = _mm256_and_si256(bits, _mm256_set1_epi32(0x007f_ffff));
            _mm256_storeu_si256(whole.as_mut_ptr().cast(), low);
        }
        whole
    }

    #[inline(always)]
    fn gather_pairs<const N: usize>(
        list: &[i16],
        index: &[u32; LANES],
        offsets: &[u32; N],
    ) -> [[Self; 2]; N] {
        let places = unsafe { _mm256_loadu_si256(index.as_ptr().cast()) };
        let below = last_pair(list.len(), offsets).is_some_and(|last| unsafe { up_to(places, last as i32) });
        if !below {
            out_of_range(index, list.len());
        }
        let mut pairs = [[Self::zero(); 2]; N];
        for k in 0..N {
            // SAFETY: four bytes at an index that was found to be at or below the last at which they are in the list.
            unsafe {
                let start = list.as_ptr().add(offsets[k] as usize).cast();
                let both = _mm256_i32gather_epi32::<2>(start, places);
                let low = _mm256_srai_epi32::<16>(_mm256_slli_epi32::<16>(both));
                let high = _mm256_srai_epi32::<16>(both);
                pairs[k] = [Avx2(_mm256_cvtepi32_ps(low)), Avx2(_mm256_cvtepi32_ps(high))];
            }
        }
        pairs
    }

    #[inline(always)]
    unsafe fn gather_raw(rows: *const Row, length: usize, index: &[u32; LANES]) -> [Self; LANES] {
        assert_below(index, length);
        let mut r = [unsafe { _mm256_setzero_ps() }; LANES];
        for lane in 0..LANES {
            // SAFETY: the index was found to be below the length.
            r[lane] = unsafe { _mm256_load_ps(rows.add(index[lane] as usize).cast()) };
        }
        let [a, b, c, d, e, f, g, h] = transpose(r);
        [Avx2(a), Avx2(b), Avx2(c), Avx2(d), Avx2(e), Avx2(f), Avx2(g), Avx2(h)]
    }

    #[inline(always)]
    fn scatter(rows: &[Cell<Row>], index: &[u32; LANES], values: [Self; LANES]) {
        assert_below(index, rows.len());
        let [a, b, c, d, e, f, g, h] = values;
        let columns = transpose([a.0, b.0, c.0, d.0, e.0, f.0, g.0, h.0]);
        for lane in 0..LANES {
            // SAFETY: the index was found to be below the length.
            unsafe {
                _mm256_store_ps(rows.get_unchecked(index[lane] as usize).as_ptr().cast(), columns[lane])
            };
        }
    }
}

/// Panics unless all indices are below the length.
#[inline(always)]
fn assert_below(index: &[u32; LANES], length: usize) {
    let last = (length.min(1 << 31) as u32).wrapping_sub(1) as i32;
    // SAFETY: as all of this room.
    if length == 0 || !unsafe { up_to(_mm256_loadu_si256(index.as_ptr().cast()), last) } {
        out_of_range(index, length);
    }
}

/// Whether no index is above `last`: eight checks in one.
#[inline(always)]
unsafe fn up_to(index: __m256i, last: i32) -> bool {
    unsafe {
        let last = _mm256_set1_epi32(last);
        _mm256_movemask_epi8(_mm256_cmpeq_epi32(_mm256_max_epu32(index, last), last)) == -1
    }
}

/// Eight rows of eight to eight columns.
#[inline(always)]
fn transpose(r: [__m256; 8]) -> [__m256; 8] {
    unsafe {
        let (a0, a1) = (_mm256_unpacklo_ps(r[0], r[1]), _mm256_unpackhi_ps(r[0], r[1]));
        let (a2, a3) = (_mm256_unpacklo_ps(r[2], r[3]), _mm256_unpackhi_ps(r[2], r[3]));
        let (a4, a5) = (_mm256_unpacklo_ps(r[4], r[5]), _mm256_unpackhi_ps(r[4], r[5]));
        let (a6, a7) = (_mm256_unpacklo_ps(r[6], r[7]), _mm256_unpackhi_ps(r[6], r[7]));
        let (b0, b1) = (_mm256_shuffle_ps::<0x44>(a0, a2), _mm256_shuffle_ps::<0xee>(a0, a2));
        let (b2, b3) = (_mm256_shuffle_ps::<0x44>(a1, a3), _mm256_shuffle_ps::<0xee>(a1, a3));
        let (b4, b5) = (_mm256_shuffle_ps::<0x44>(a4, a6), _mm256_shuffle_ps::<0xee>(a4, a6));
        let (b6, b7) = (_mm256_shuffle_ps::<0x44>(a5, a7), _mm256_shuffle_ps::<0xee>(a5, a7));
        [
            _mm256_permute2f128_ps::<0x20>(b0, b4),
            _mm256_permute2f128_ps::<0x20>(b1, b5),
            _mm256_permute2f128_ps::<0x20>(b2, b6),
            _mm256_permute2f128_ps::<0x20>(b3, b7),
            _mm256_permute2f128_ps::<0x31>(b0, b4),
            _mm256_permute2f128_ps::<0x31>(b1, b5),
            _mm256_permute2f128_ps::<0x31>(b2, b6),
            _mm256_permute2f128_ps::<0x31>(b3, b7),
        ]
    }
}

impl LaneMask<Avx2> for Avx2Mask {
    #[inline(always)]
    fn select(self, yes: Avx2, no: Avx2) -> Avx2 {
        Avx2(unsafe { _mm256_blendv_ps(no.0, yes.0, self.0) })
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        (unsafe { _mm256_movemask_ps(self.0) }) as u32
    }

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        unsafe {
            let own = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let set = _mm256_and_si256(_mm256_set1_epi32(bits as i32), own);
            Avx2Mask(_mm256_castsi256_ps(_mm256_cmpeq_epi32(set, own)))
        }
    }
}

macro_rules! lanewise {
    ($type:ident, $trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                $type(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}
lanewise!(Avx2, Add, add, _mm256_add_ps);
lanewise!(Avx2, Sub, sub, _mm256_sub_ps);
lanewise!(Avx2, Mul, mul, _mm256_mul_ps);
lanewise!(Avx2, Div, div, _mm256_div_ps);
lanewise!(Avx2Mask, BitAnd, bitand, _mm256_and_ps);
lanewise!(Avx2Mask, BitOr, bitor, _mm256_or_ps);

impl Neg for Avx2 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Avx2(unsafe { _mm256_xor_ps(_mm256_set1_ps(-0.0), self.0) })
    }
}

impl AddAssign for Avx2 {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Avx2 {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
