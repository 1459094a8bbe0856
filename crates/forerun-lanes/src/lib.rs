//! Lanes: eight numbers at a time, with the same bits on every processor.
//!
//! Kernels are written once over [`Lanes`] and compiled for plain arrays and, on x86-64, for SSE2, AVX2 and AVX-512; [`dispatched!`] chooses at run
//! time, see [`InstructionSet`]. Only + - * / sqrt and comparisons, no fused multiply-add, so that all forms give equal bits.
//!
//! *Architecture invariant:* whatever the processor, the same bits. *Architecture invariant:* only kernels that [`dispatched!`] calls are run in a
//! form that not every processor has.
#![allow(
    clippy::needless_range_loop,
    reason = "kernels walk several short arrays side by side; closures would not be compiled for the instruction set"
)]

use std::cell::Cell;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Sub, SubAssign};

#[cfg(target_arch = "x86_64")]
mod avx2;
mod instruction_set;
mod portable;
mod records;
#[cfg(target_arch = "x86_64")]
mod sse2;
#[cfg(all(test, target_arch = "x86_64"))]
mod tests;
mod vectors;

#[cfg(target_arch = "x86_64")]
#[doc(hidden)]
pub use avx2::Avx2;
pub use instruction_set::{InstructionSet, in_use, limit_to};
pub use portable::Portable;
pub use records::{Record, recast, recast_mut};
#[cfg(target_arch = "x86_64")]
pub use sse2::Sse2;
pub use vectors::{Twist8, V8, scatter_twist};

/// How many numbers go together. Eight was measured to beat four and sixteen.
pub const LANES: usize = 8;

/// Eight numbers.
///
/// # Safety
/// Implementations are eight f32, 32 bytes at that alignment, for which every bit pattern is valid.
#[allow(unsafe_code, reason = "blocks of one form are read as blocks of another")]
pub unsafe trait Lanes:
    Copy
    + Send
    + Sync
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// Eight truth values.
    type Mask: LaneMask<Self>;

    /// The same number in all lanes.
    fn splat(x: f32) -> Self;

    /// The numbers, the first in lane 0.
    fn from_array(lanes: [f32; LANES]) -> Self;

    /// The numbers, lane 0 first.
    fn to_array(self) -> [f32; LANES];

    /// Square roots, correctly rounded.
    fn sqrt(self) -> Self;

    /// Numbers without their signs.
    fn abs(self) -> Self;

    /// Where this is below `other`: never where either is not a number.
    fn lt(self, other: Self) -> Self::Mask;

    /// Where this is below `other` or equal to it: never where either is not a number.
    fn le(self, other: Self) -> Self::Mask;

    /// As unsigned integers. They must be whole numbers from 0 below 2^23: of others the lowest bits of something are given, the same on every processor.
    fn to_whole(self) -> [u32; LANES];

    /// For each offset and lane the number at `index + offset` of a list, and the one right behind it.
    ///
    /// # Panics
    /// When one of them is not in the list.
    fn gather_pairs<const N: usize>(list: &[i16], index: &[u32; LANES], offsets: &[u32; N])
    -> [[Self; 2]; N];

    /// Rows of eight bodies, turned so that each number of the record is one value.
    ///
    /// # Safety
    /// `rows` are so many rows in memory; while the eight of the index are read nobody writes them.
    #[allow(
        unsafe_code,
        reason = "rows that nobody writes and rows that others write elsewhere are read alike"
    )]
    unsafe fn gather_raw(rows: *const Row, length: usize, index: &[u32; LANES]) -> [Self; LANES];

    /// As [`Lanes::gather_raw`], of rows to which only this thread writes, or others at other places.
    #[inline(always)]
    fn gather_cells(rows: &[Cell<Row>], index: &[u32; LANES]) -> [Self; LANES] {
        // SAFETY: a cell is laid out as what is in it, and cannot be shared between threads; whoever makes cells of shared memory keeps others from writing what is read.
        #[allow(unsafe_code, reason = "see above")]
        unsafe {
            Self::gather_raw(rows.as_ptr().cast(), rows.len(), index)
        }
    }

    /// Writes the rows of eight bodies. Of lanes that share an index the last is kept: only a row that nobody reads may be shared.
    fn scatter(rows: &[Cell<Row>], index: &[u32; LANES], values: [Self; LANES]);

    /// As [`Lanes::gather_raw`], of rows that nobody writes.
    #[inline(always)]
    fn gather(rows: &[Row], index: &[u32; LANES]) -> [Self; LANES] {
        // SAFETY: nobody writes what is shared.
        #[allow(unsafe_code, reason = "see above")]
        unsafe {
            Self::gather_raw(rows.as_ptr(), rows.len(), index)
        }
    }

    /// 0 in all lanes.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }

    /// 1 in all lanes.
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }

    /// Where this is above `other`: never where either is not a number.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// The larger; `other` where either is not a number, or both are 0.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.gt(other).select(self, other)
    }

    /// The smaller; `other` where either is not a number, or both are 0.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.lt(other).select(self, other)
    }
}

/// Eight truth values.
pub trait LaneMask<F: Lanes<Mask = Self>>:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self>
{
    /// Per lane: `yes` where set, else `no`.
    fn select(self, yes: F, no: F) -> F;

    /// Bit `i` is lane `i`.
    fn bits(self) -> u32;

    /// Lane `i` is bit `i`.
    fn from_bits(bits: u32) -> Self;

    /// Whether any lane is set.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }

    /// Per lane: `yes` where set, else `no`.
    #[inline(always)]
    fn select_v(self, yes: V8<F>, no: V8<F>) -> V8<F> {
        V8 { x: self.select(yes.x, no.x), y: self.select(yes.y, no.y), z: self.select(yes.z, no.z) }
    }
}

/// One body's linear and angular part, padded to a lane's width: velocities and displacements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub struct Row(pub [f32; LANES]);

/// Rows to be written here and there, in whatever order.
pub fn cells(rows: &mut [Row]) -> &[Cell<Row>] {
    Cell::from_mut(rows).as_slice_of_cells()
}

/// The last index at which a pair with these offsets starts in a list of this length, if there is one.
#[inline(always)]
fn last_pair<const N: usize>(length: usize, offsets: &[u32; N]) -> Option<u32> {
    let mut most = 0;
    for offset in offsets {
        most = most.max(*offset);
    }
    // Indices stay below 2^31, so that a register of signed integers holds them.
    let length = u32::try_from(length).unwrap_or(u32::MAX).min(1 << 31);
    length.checked_sub(2)?.checked_sub(most)
}

#[cold]
#[inline(never)]
fn out_of_range(index: &[u32; LANES], length: usize) -> ! {
    panic!("places {index:?} of {length}");
}

/// Defines a function that runs the given kernel, which is generic over [`Lanes`] and `#[inline(always)]`, in the fastest form that may be used.
#[macro_export]
macro_rules! dispatched {
    ($(#[$meta:meta])* $vis:vis fn $name:ident $(<$K:ident: $bound:ident>)? ($($arg:ident: $type:ty),* $(,)?) $(-> $result:ty)? => $kernel:ident) => {
        $(#[$meta])*
        $vis fn $name $(<$K: $bound>)? ($($arg: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                use $crate::{Avx2, InstructionSet, Sse2};
                #[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq")]
                fn avx512 $(<$K: $bound>)? ($($arg: $type),*) $(-> $result)? {
                    $kernel::<Avx2 $(, $K)?>($($arg),*)
                }
                #[target_feature(enable = "avx2")]
                fn avx2 $(<$K: $bound>)? ($($arg: $type),*) $(-> $result)? {
                    $kernel::<Avx2 $(, $K)?>($($arg),*)
                }
                // SAFETY: `in_use` names only what the processor has.
                #[allow(unsafe_code, reason = "the calls that need processor features, checked by in_use")]
                match $crate::in_use() {
                    InstructionSet::Avx512 => return unsafe { avx512 $(::<$K>)? ($($arg),*) },
                    InstructionSet::Avx2 => return unsafe { avx2 $(::<$K>)? ($($arg),*) },
                    InstructionSet::Sse2 => return $kernel::<Sse2 $(, $K)?>($($arg),*),
                    InstructionSet::Portable => {}
                }
            }
            $kernel::<$crate::Portable $(, $K)?>($($arg),*)
        }
    };
}
