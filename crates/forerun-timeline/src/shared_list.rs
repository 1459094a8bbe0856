//! Shared list: a growing list in chunks that copies share.
//!
//! Promise: a copy costs one reference count per 32 entries, and a write copies at most the chunk that it is in. So timelines, their
//! forks and snapshots share what none of them has changed since, whatever there is beside it.

use std::sync::Arc;

/// Entries of one chunk.
pub(crate) const CHUNK: usize = 32;

/// Entries 0, 1, 2, ... up to its length.
#[derive(Clone, Debug)]
pub(crate) struct SharedList<T> {
    /// All full but the last.
    chunks: Vec<Arc<Vec<T>>>,
}

impl<T> Default for SharedList<T> {
    fn default() -> Self {
        SharedList { chunks: Vec::new() }
    }
}

impl<T: Clone> SharedList<T> {
    pub(crate) fn len(&self) -> usize {
        self.chunks.last().map_or(0, |last| CHUNK * (self.chunks.len() - 1) + last.len())
    }

    pub(crate) fn get(&self, index: usize) -> Option<&T> {
        self.chunks.get(index / CHUNK)?.get(index % CHUNK)
    }

    /// The entry, no longer shared; `None` beyond the end.
    pub(crate) fn get_mut(&mut self, index: usize) -> Option<&mut T> {
        let chunk = self.chunks.get_mut(index / CHUNK)?;
        if index % CHUNK < chunk.len() { Arc::make_mut(chunk).get_mut(index % CHUNK) } else { None }
    }

    pub(crate) fn push(&mut self, entry: T) {
        match self.chunks.last_mut().filter(|last| last.len() < CHUNK) {
            Some(last) => Arc::make_mut(last).push(entry),
            None => self.chunks.push(Arc::new(vec![entry])),
        }
    }

    /// Makes it at least so long.
    pub(crate) fn grow(&mut self, len: usize, entry: &T) {
        for _ in self.len()..len {
            self.push(entry.clone());
        }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &T> {
        self.chunks.iter().flat_map(|chunk| chunk.iter())
    }

    /// Where this list and another do not share memory: the index of the first entry of each such chunk, and what both have there.
    pub(crate) fn unshared<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = (usize, &'a [T], &'a [T])> {
        (0..self.chunks.len().max(other.chunks.len())).filter_map(|index| {
            let (mine, theirs) = (self.chunks.get(index), other.chunks.get(index));
            let shared = matches!((mine, theirs), (Some(a), Some(b)) if Arc::ptr_eq(a, b));
            let entries = |chunk: Option<&'a Arc<Vec<T>>>| chunk.map_or(&[][..], |chunk| chunk.as_slice());
            (!shared).then(|| (CHUNK * index, entries(mine), entries(theirs)))
        })
    }

    /// Takes over the other list's chunk around an entry when it has the same entries by `same`.
    pub(crate) fn share_chunk(&mut self, index: usize, other: &Self, same: impl Fn(&T, &T) -> bool) {
        let chunk = index / CHUNK;
        if let (Some(mine), Some(theirs)) = (self.chunks.get_mut(chunk), other.chunks.get(chunk))
            && mine.len() == theirs.len()
            && mine.iter().zip(theirs.iter()).all(|(a, b)| same(a, b))
        {
            *mine = Arc::clone(theirs);
        }
    }

    /// Whether all memory is shared with another list.
    pub(crate) fn shares_all(&self, other: &Self) -> bool {
        self.chunks.len() == other.chunks.len()
            && self.chunks.iter().zip(&other.chunks).all(|(a, b)| Arc::ptr_eq(a, b))
    }
}

impl<T: Clone> FromIterator<T> for SharedList<T> {
    fn from_iter<I: IntoIterator<Item = T>>(entries: I) -> Self {
        let mut list = SharedList::default();
        entries.into_iter().for_each(|entry| list.push(entry));
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_write_to_a_copy_touches_one_chunk_and_not_the_original() {
        let original: SharedList<u32> = (0..100).collect();
        let mut copy = original.clone();
        assert!(copy.shares_all(&original));
        *copy.get_mut(40).unwrap() = 7;
        assert_eq!((original.get(40), copy.get(40)), (Some(&40), Some(&7)));
        let differing: Vec<usize> = copy.unshared(&original).map(|(first, ..)| first).collect();
        assert_eq!(differing, [32]);
        *copy.get_mut(40).unwrap() = 40;
        copy.share_chunk(40, &original, |a, b| a == b);
        assert!(copy.shares_all(&original));
    }

    #[test]
    fn lists_of_different_length_differ_where_one_ends() {
        let mut list: SharedList<u32> = (0..64).collect();
        let short = list.clone();
        list.grow(70, &9);
        assert_eq!((list.len(), list.get(69), list.get(70)), (70, Some(&9), None));
        assert!(list.get_mut(70).is_none() && !list.shares_all(&short));
        let tail: Vec<(usize, usize, usize)> =
            list.unshared(&short).map(|(first, a, b)| (first, a.len(), b.len())).collect();
        assert_eq!(tail, [(64, 6, 0)]);
        assert_eq!(list.iter().count(), 70);
    }
}
