//! Shares: an island cut into regions, so that several threads can do its blocks in an order that gives the bits of one.
//!
//! Gauss-Seidel gives the same result whoever does the work, as long as blocks that move a common body come in their order. A run (one level, one
//! colour) moves no body twice; every run is cut into as many parts as there are shares. Contacts are ordered by body, so that a share is a region of
//! the island, and waits for another one only where the two meet: no barrier stands between runs, only between passes.

use std::ops::Range;

use crate::scratch::fill;

/// Blocks of a share that are done in one go: few enough that a neighbour does not wait long, many enough to be worth the call.
const BLOCKS_PER_PART: u32 = 8;
/// No share has moved the body yet.
const NOBODY: (u32, u32) = (u32::MAX, 0);

/// Some blocks in a row of one share, and what has to be done before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Part {
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// A share, and how many of its parts have to be done before.
    pub(crate) after: (u32, u32),
}

/// Who does which blocks of an island, and who waits for whom.
#[derive(Debug, Default)]
pub(crate) struct Shares {
    shares: Vec<Vec<Part>>,
    /// How many there are; the others are memory to be used again.
    count: usize,
    /// Per body, while they are made: the share that moved it last, and how many parts that had then.
    last: Vec<(u32, u32)>,
    /// Per share: whether its last part may grow.
    open: Vec<bool>,
    /// Per share and other share: how many of the other's parts it is known to come after.
    known: Vec<u32>,
}

impl Shares {
    /// Shares out the blocks of `runs`, which follow each other. `bodies` tells which bodies (below `body_count`) a block moves.
    pub(crate) fn make<I: Iterator<Item = u32> + Clone>(
        &mut self,
        count: usize,
        runs: impl Iterator<Item = Range<usize>>,
        body_count: usize,
        bodies: impl Fn(usize) -> I,
    ) {
        self.count = count;
        self.shares.resize(count.max(self.shares.len()), Vec::new());
        self.shares.iter_mut().for_each(Vec::clear);
        fill(&mut self.last, body_count, NOBODY);
        fill(&mut self.open, count, false);
        fill(&mut self.known, count * count, 0);
        for run in runs {
            let cut = |share: usize| run.start + share * run.len() / count;
            for share in 0..count {
                // Both ends first, the last one before the first: the neighbours wait for them, and what is between gives them time.
                let (start, end) = (cut(share), cut(share + 1));
                for block in (end.saturating_sub(1).max(start)..end).chain(start..end.saturating_sub(1)) {
                    self.add(share, block as u32, bodies(block));
                }
            }
        }
    }

    /// Makes it no shares at all.
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    /// How many shares there are.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// The parts of a share, in its order.
    pub(crate) fn parts(&self, share: usize) -> &[Part] {
        &self.shares[share]
    }

    fn add(&mut self, share: usize, block: u32, bodies: impl Iterator<Item = u32> + Clone) {
        let count = self.count;
        let mut waits = false;
        for body in bodies.clone() {
            let (other, parts) = self.last[body as usize];
            if other == NOBODY.0 || other as usize == share {
                continue;
            }
            let known = &mut self.known[share * count + other as usize];
            if parts > *known {
                *known = parts;
                waits = true;
                // What is waited for ends where it is: what follows may wait for this share.
                self.open[other as usize] = false;
                let start = Part { start: block, end: block, after: (other, parts) };
                self.shares[share].push(start);
            }
        }
        if waits {
            self.open[share] = true;
        }
        let parts = &mut self.shares[share];
        let grows = self.open[share]
            && parts.last().is_some_and(|p| p.end == block && p.end - p.start < BLOCKS_PER_PART);
        if grows {
            parts.last_mut().expect("it was looked at").end = block + 1;
        } else {
            parts.push(Part { start: block, end: block + 1, after: (share as u32, 0) });
            self.open[share] = true;
        }
        let here = (share as u32, parts.len() as u32);
        for body in bodies {
            self.last[body as usize] = here;
        }
    }
}
