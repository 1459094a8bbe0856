//! Lanes: eight numbers at a time, with the same bits on every processor.
//!
//! Kernels are written once over `Lanes` and compiled for plain arrays and, on x86-64, for SSE2, AVX2 and AVX-512; `dispatched!` chooses at run
//! time, see [`InstructionSet`]. Only + - * / sqrt and comparisons, no fused multiply-add, so that all forms give equal bits.
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
#[cfg(target_arch = "x86_64")]
mod sse2;
#[cfg(all(test, target_arch = "x86_64"))]
mod tests;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
pub use instruction_set::{InstructionSet, in_use, limit_to};
pub(crate) use portable::Portable;
#[cfg(target_arch = "x86_64")]
pub(crate) use sse2::Sse2;

/// How many contacts are solved side by side. Eight was measured to beat four and sixteen.
pub(crate) const LANES: usize = 8;

/// Eight numbers.
///
/// # Safety
/// Implementations are eight f32, 32 bytes at that alignment, for which every bit pattern is valid.
#[allow(unsafe_code, reason = "blocks of one form are read as blocks of another")]
pub(crate) unsafe trait Lanes:
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

    fn splat(x: f32) -> Self;
    fn from_array(lanes: [f32; LANES]) -> Self;
    fn to_array(self) -> [f32; LANES];
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;

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
        // SAFETY: a cell is laid out as what is in it, and is not shared between threads but by `Shared::cells`, whose callers keep out of each other's way.
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

    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }

    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }

    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    // The second where either is NaN, or both are 0.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.gt(other).select(self, other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.lt(other).select(self, other)
    }
}

/// Eight truth values.
pub(crate) trait LaneMask<F: Lanes<Mask = Self>>:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self>
{
    /// Per lane: `yes` where set, else `no`.
    fn select(self, yes: F, no: F) -> F;

    /// Bit `i` is lane `i`.
    fn bits(self) -> u32;

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
pub(crate) struct Row(pub(crate) [f32; LANES]);

/// Eight vectors.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct V8<F> {
    pub(crate) x: F,
    pub(crate) y: F,
    pub(crate) z: F,
}

/// Linear and angular parts of eight bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Twist8<F> {
    pub(crate) linear: V8<F>,
    pub(crate) angular: V8<F>,
}

impl<F: Lanes> V8<F> {
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        V8 { x: F::zero(), y: F::zero(), z: F::zero() }
    }

    /// One vector per lane.
    #[inline(always)]
    pub(crate) fn from_arrays(lanes: [[f32; LANES]; 3]) -> Self {
        V8 { x: F::from_array(lanes[0]), y: F::from_array(lanes[1]), z: F::from_array(lanes[2]) }
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> F {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        V8 {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// Component by component.
    #[inline(always)]
    pub(crate) fn times(self, other: Self) -> Self {
        V8 { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }

    #[inline(always)]
    pub(crate) fn length(self) -> F {
        self.dot(self).sqrt()
    }
}

impl<F: Lanes> Add for V8<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        V8 { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<F: Lanes> Sub for V8<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        V8 { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl<F: Lanes> Mul<F> for V8<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: F) -> Self {
        V8 { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<F: Lanes> Neg for V8<F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        V8 { x: -self.x, y: -self.y, z: -self.z }
    }
}

/// Rows to be written here and there, in whatever order.
pub(crate) fn cells(rows: &mut [Row]) -> &[Cell<Row>] {
    Cell::from_mut(rows).as_slice_of_cells()
}

impl<F: Lanes> Twist8<F> {
    /// Of the rows of eight bodies.
    #[inline(always)]
    pub(crate) fn of([a, b, c, d, e, f, ..]: [F; LANES]) -> Self {
        Twist8 { linear: V8 { x: a, y: b, z: c }, angular: V8 { x: d, y: e, z: f } }
    }
}

/// Writes the parts back. Of lanes that share an index the last is kept: only a row that nobody reads may be shared.
#[inline(always)]
pub(crate) fn scatter_twist<F: Lanes>(rows: &[Cell<Row>], index: &[u32; LANES], twist: &Twist8<F>) {
    let (l, a) = (twist.linear, twist.angular);
    F::scatter(rows, index, [l.x, l.y, l.z, a.x, a.y, a.z, F::zero(), F::zero()]);
}

/// Records that are made of eight numbers in whatever form, and of plain integers.
///
/// # Safety
/// `Of<F>` is `repr(C)`, holds `F`s and integers alone, and for every `F` the same ones in the same places.
#[allow(unsafe_code, reason = "blocks of one form are read as blocks of another")]
pub(crate) unsafe trait Record {
    /// The record with its numbers as `F`.
    type Of<F: Lanes>;
}

/// The same records, their numbers read in another form.
#[inline(always)]
pub(crate) fn recast<F: Lanes, R: Record>(records: &[R::Of<Portable>]) -> &[R::Of<F>] {
    const { assert_alike::<R::Of<Portable>, R::Of<F>>() };
    // SAFETY: `Record` promises the same layout, `Lanes` that every bit pattern is valid.
    #[allow(unsafe_code, reason = "see above")]
    unsafe {
        std::slice::from_raw_parts(records.as_ptr().cast(), records.len())
    }
}

/// As [`recast`], to be changed.
#[inline(always)]
pub(crate) fn recast_mut<F: Lanes, R: Record>(records: &mut [R::Of<Portable>]) -> &mut [R::Of<F>] {
    const { assert_alike::<R::Of<Portable>, R::Of<F>>() };
    // SAFETY: as in `recast`.
    #[allow(unsafe_code, reason = "see above")]
    unsafe {
        std::slice::from_raw_parts_mut(records.as_mut_ptr().cast(), records.len())
    }
}

const fn assert_alike<A, B>() {
    assert!(size_of::<A>() == size_of::<B>() && align_of::<A>() == align_of::<B>());
}

/// Defines a function that runs the given kernel in the fastest form that may be used.
macro_rules! dispatched {
    ($(#[$meta:meta])* $vis:vis fn $name:ident $(<$K:ident: $bound:ident>)? ($($arg:ident: $type:ty),* $(,)?) => $kernel:ident) => {
        $(#[$meta])*
        $vis fn $name $(<$K: $bound>)? ($($arg: $type),*) {
            #[cfg(target_arch = "x86_64")]
            {
                use $crate::lanes::{Avx2, InstructionSet, Sse2};
                #[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq")]
                fn avx512 $(<$K: $bound>)? ($($arg: $type),*) {
                    $kernel::<Avx2 $(, $K)?>($($arg),*);
                }
                #[target_feature(enable = "avx2")]
                fn avx2 $(<$K: $bound>)? ($($arg: $type),*) {
                    $kernel::<Avx2 $(, $K)?>($($arg),*);
                }
                // SAFETY: `in_use` names only what the processor has.
                #[allow(unsafe_code, reason = "the calls that need processor features, checked by in_use")]
                match $crate::lanes::in_use() {
                    InstructionSet::Avx512 => return unsafe { avx512 $(::<$K>)? ($($arg),*) },
                    InstructionSet::Avx2 => return unsafe { avx2 $(::<$K>)? ($($arg),*) },
                    InstructionSet::Sse2 => return $kernel::<Sse2 $(, $K)?>($($arg),*),
                    InstructionSet::Portable => {}
                }
            }
            $kernel::<$crate::lanes::Portable $(, $K)?>($($arg),*);
        }
    };
}
pub(crate) use dispatched;
