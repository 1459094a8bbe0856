//! A list that keeps the last of what was put into it.

use std::collections::VecDeque;

/// The last of what was pushed, the oldest first.
#[derive(Clone, Debug, PartialEq)]
pub struct Ring<T> {
    rows: VecDeque<T>,
    capacity: usize,
}

impl<T> Ring<T> {
    /// Keeps so many, at least 1.
    #[must_use]
    pub fn with_capacity(capacity: usize) -> Ring<T> {
        Ring { rows: VecDeque::new(), capacity: capacity.max(1) }
    }

    /// Puts one in; the oldest goes when there are too many.
    pub fn push(&mut self, row: T) {
        if self.rows.len() == self.capacity {
            self.rows.pop_front();
        }
        self.rows.push_back(row);
    }

    /// The oldest first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &T> + ExactSizeIterator {
        self.rows.iter()
    }

    /// The one put in last.
    #[must_use]
    pub fn last(&self) -> Option<&T> {
        self.rows.back()
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.rows.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_goes_first() {
        let mut ring = Ring::with_capacity(3);
        (0..5).for_each(|i| ring.push(i));
        assert_eq!(ring.iter().copied().collect::<Vec<_>>(), [2, 3, 4]);
        assert_eq!(ring.last(), Some(&4));
    }
}
