//! Shared: what several threads work at: lists, each at places of its own, and a least.
#![allow(unsafe_code, reason = "hands out parts of one list to several threads")]

use std::cell::Cell;
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// The least of what several threads find, whoever comes first.
pub(crate) struct Least(Mutex<f32>);

impl Default for Least {
    fn default() -> Self {
        Least(Mutex::new(f32::MAX))
    }
}

impl Least {
    /// Has `find` lower a number of its own, and notes it.
    pub(crate) fn note(&self, find: impl FnOnce(&mut f32)) {
        let mut found = f32::MAX;
        find(&mut found);
        let mut least = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *least = least.min(found);
    }

    pub(crate) fn get(self) -> f32 {
        self.0.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A list that is lent to threads which keep out of each other's places.
pub(crate) struct Shared<'a, T> {
    start: *mut T,
    len: usize,
    lent: PhantomData<&'a mut [T]>,
}

// SAFETY: it is a `&mut [T]` of which each thread uses other places, as its functions demand.
unsafe impl<T: Send> Sync for Shared<'_, T> {}

impl<'a, T> Shared<'a, T> {
    pub(crate) fn of(list: &'a mut [T]) -> Self {
        Shared { start: list.as_mut_ptr(), len: list.len(), lent: PhantomData }
    }

    /// Some places in a row.
    ///
    /// # Safety
    /// While they are held nobody else uses them.
    #[allow(clippy::mut_from_ref, reason = "that nobody else has these places is what the caller promises")]
    pub(crate) unsafe fn part(&self, range: Range<usize>) -> &mut [T] {
        assert!(range.start <= range.end && range.end <= self.len);
        // SAFETY: the range is in the list, which is lent for as long as this lives; the caller promises that it is nobody else's.
        unsafe { std::slice::from_raw_parts_mut(self.start.add(range.start), range.len()) }
    }

    /// All places, to be read and written one by one.
    ///
    /// # Safety
    /// While one thread writes a place no other one reads or writes it.
    pub(crate) unsafe fn cells(&self) -> &[Cell<T>] {
        // SAFETY: a cell is laid out as what is in it; the list is lent for as long as this lives; the caller promises the rest.
        unsafe { std::slice::from_raw_parts(self.start.cast(), self.len) }
    }
}
