//! Records: what is made of lanes, stored in one form and read in another.

use super::{Lanes, Portable};

/// Records that are made of eight numbers in whatever form, and of plain integers.
///
/// # Safety
/// `Of<F>` is `repr(C)`, holds `F`s and integers alone, and for every `F` the same ones in the same places.
#[allow(unsafe_code, reason = "blocks of one form are read as blocks of another")]
pub unsafe trait Record {
    /// The record with its numbers as `F`.
    type Of<F: Lanes>;
}

/// The same records, their numbers read in another form.
#[inline(always)]
pub fn recast<F: Lanes, R: Record>(records: &[R::Of<Portable>]) -> &[R::Of<F>] {
    const { assert_alike::<R::Of<Portable>, R::Of<F>>() };
    // SAFETY: `Record` promises the same layout, `Lanes` that every bit pattern is valid.
    #[allow(unsafe_code, reason = "see above")]
    unsafe {
        std::slice::from_raw_parts(records.as_ptr().cast(), records.len())
    }
}

/// As [`recast`], to be changed.
#[inline(always)]
pub fn recast_mut<F: Lanes, R: Record>(records: &mut [R::Of<Portable>]) -> &mut [R::Of<F>] {
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
