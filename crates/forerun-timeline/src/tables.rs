//! Tables: the states of all bodies over consecutive frames.
//!
//! Promise: frames that are alike are one entry, so that an hour of rest costs what a frame of it does; and memory is known at any moment
//! without counting.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::Frame;
use crate::frame_table::FrameTable;

/// Equal tables from a frame to before that of the next run.
#[derive(Clone, Debug)]
struct Run {
    from: Frame,
    table: Arc<FrameTable>,
    /// Memory that the run before does not share.
    bytes: usize,
}

/// The tables from [`oldest`](Tables::oldest) to [`horizon`](Tables::horizon).
#[derive(Clone, Debug)]
pub(crate) struct Tables {
    horizon: Frame,
    /// By frame, neighbours different; never empty.
    runs: VecDeque<Run>,
    bytes: usize,
}

impl Tables {
    /// One table, at `frame`.
    pub(crate) fn new(frame: Frame, table: Arc<FrameTable>) -> Tables {
        let bytes = table.bytes_beyond(None);
        Tables { horizon: frame, runs: VecDeque::from([Run { from: frame, table, bytes }]), bytes }
    }

    pub(crate) fn oldest(&self) -> Frame {
        self.runs[0].from
    }

    pub(crate) fn horizon(&self) -> Frame {
        self.horizon
    }

    /// Memory of all tables, an upper bound: what is shared with the frame before is counted once. Bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes + self.runs.len() * size_of::<Run>()
    }

    /// Memory of the last frame beyond the one before it. Bytes.
    pub(crate) fn last_bytes(&self) -> usize {
        let last = &self.runs[self.runs.len() - 1];
        if last.from == self.horizon { last.bytes + size_of::<Run>() } else { 0 }
    }

    pub(crate) fn get(&self, frame: Frame) -> Option<&Arc<FrameTable>> {
        (frame >= self.oldest() && frame <= self.horizon).then(|| &self.runs[self.run_of(frame)].table)
    }

    /// The table at a frame from the oldest to the horizon.
    pub(crate) fn at(&self, frame: Frame) -> &Arc<FrameTable> {
        &self.runs[self.run_of(frame)].table
    }

    /// The first frame of each run of equal tables, and the table.
    pub(crate) fn runs(&self) -> impl DoubleEndedIterator<Item = (Frame, &Arc<FrameTable>)> {
        self.runs.iter().map(|run| (run.from, &run.table))
    }

    /// Adds the table after the horizon.
    pub(crate) fn push(&mut self, table: Arc<FrameTable>) {
        self.horizon = self.horizon.next();
        if !Arc::ptr_eq(&self.runs[self.runs.len() - 1].table, &table) {
            self.runs.push_back(Run { from: self.horizon, table, bytes: 0 });
            self.count(self.runs.len() - 1);
        }
    }

    /// Replaces the table at a stored frame.
    pub(crate) fn set(&mut self, frame: Frame, table: Arc<FrameTable>) {
        self.set_run(frame, frame, table);
    }

    /// Replaces the tables from a stored frame to another, that one too, by one table.
    pub(crate) fn set_run(&mut self, from: Frame, to: Frame, table: Arc<FrameTable>) {
        let index = self.run_of(from);
        if Arc::ptr_eq(&self.runs[index].table, &table) && self.end_of(index) > to {
            return;
        }
        // The frames become a run of their own, and join their neighbours where they are alike.
        let index = self.split_at(from, index);
        let last = self.run_of(to);
        if to < self.horizon && self.end_of(last) > to.next() {
            self.split_at(to.next(), last);
        }
        for run in self.runs.drain(index + 1..=last) {
            self.bytes -= run.bytes;
        }
        self.runs[index].table = table;
        self.count(index);
        self.count(index + 1);
        self.join(index + 1);
        self.join(index);
    }

    /// Moves the horizon on: the frames after it are as the last one is.
    pub(crate) fn extend_to(&mut self, horizon: Frame) {
        self.horizon = self.horizon.max(horizon);
    }

    /// Forgets the tables before a frame that is stored.
    pub(crate) fn forget_before(&mut self, oldest: Frame) {
        let first = self.run_of(oldest);
        for run in self.runs.drain(..first) {
            self.bytes -= run.bytes;
        }
        self.runs[0].from = oldest;
        if first > 0 {
            self.count(0);
        }
    }

    /// Forgets the tables after a frame that is stored.
    pub(crate) fn forget_after(&mut self, last: Frame) {
        let kept = self.run_of(last) + 1;
        for run in self.runs.drain(kept..) {
            self.bytes -= run.bytes;
        }
        self.horizon = last;
    }

    fn run_of(&self, frame: Frame) -> usize {
        self.runs.partition_point(|run| run.from <= frame) - 1
    }

    /// The first frame after a run.
    fn end_of(&self, index: usize) -> Frame {
        self.runs.get(index + 1).map_or(self.horizon.next(), |next| next.from)
    }

    /// Makes a run begin at a frame that run `index` contains; its index.
    fn split_at(&mut self, frame: Frame, index: usize) -> usize {
        if self.runs[index].from == frame {
            return index;
        }
        let table = Arc::clone(&self.runs[index].table);
        self.runs.insert(index + 1, Run { from: frame, table, bytes: 0 });
        index + 1
    }

    /// Joins a run with the one before it when they are alike.
    fn join(&mut self, index: usize) {
        if index == 0 || index >= self.runs.len() {
            return;
        }
        if Arc::ptr_eq(&self.runs[index - 1].table, &self.runs[index].table) {
            self.bytes -= self.runs[index].bytes;
            self.runs.remove(index);
            self.count(index);
        }
    }

    /// Counts the memory of a run, if it is there, anew.
    fn count(&mut self, index: usize) {
        if index >= self.runs.len() {
            return;
        }
        let before = index.checked_sub(1).map(|before| &*self.runs[before].table);
        let bytes = self.runs[index].table.bytes_beyond(before);
        self.bytes = self.bytes + bytes - self.runs[index].bytes;
        self.runs[index].bytes = bytes;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun_dynamics::{BodyDef, BodyId, BodyState};
    use forerun_geometry::Vec3;
    use forerun_geometry::shape::{Shape, Sphere};

    fn state(x: f32) -> BodyState {
        let ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 })).at(Vec3::X * x);
        forerun_dynamics::Body::new(&ball).unwrap().1
    }

    fn table(x: f32) -> Arc<FrameTable> {
        Arc::new(FrameTable::new(&vec![state(x); 100]))
    }

    /// The frames' values by a plain list, and the same in tables; after every change both must agree.
    struct Both {
        plain: VecDeque<Arc<FrameTable>>,
        oldest: Frame,
        tables: Tables,
    }

    impl Both {
        fn agree(&self) {
            assert_eq!(self.tables.oldest(), self.oldest);
            assert_eq!(self.tables.horizon(), self.oldest.plus(self.plain.len() as u64 - 1));
            for (index, table) in self.plain.iter().enumerate() {
                assert!(Arc::ptr_eq(self.tables.at(self.oldest.plus(index as u64)), table), "{index}");
            }
            assert!(self.tables.get(self.tables.horizon().next()).is_none());
            let neighbours = self.tables.runs.iter().zip(self.tables.runs.iter().skip(1));
            for (a, b) in neighbours {
                assert!(a.from < b.from && !Arc::ptr_eq(&a.table, &b.table));
            }
            let mut before = None;
            let mut bytes = 0;
            for run in &self.tables.runs {
                bytes += run.table.bytes_beyond(before);
                before = Some(&*run.table);
            }
            assert_eq!(self.tables.bytes, bytes);
        }
    }

    #[test]
    fn runs_say_what_a_plain_list_says() {
        let values: Vec<Arc<FrameTable>> = (0..4).map(|i| table(i as f32)).collect();
        let mut random = crate::check::Random::new(3);
        let first = Arc::clone(&values[0]);
        let mut both = Both {
            plain: VecDeque::from([Arc::clone(&first)]),
            oldest: Frame(0),
            tables: Tables::new(Frame(0), first),
        };
        for _ in 0..3000 {
            let value = Arc::clone(&values[random.below(4) as usize]);
            let at = random.below(both.plain.len() as u64);
            match random.below(20) {
                0 => {
                    both.plain.drain(..at as usize);
                    both.oldest = both.oldest.plus(at);
                    both.tables.forget_before(both.oldest);
                }
                1 => {
                    both.plain.truncate(at as usize + 1);
                    both.tables.forget_after(both.oldest.plus(at));
                }
                2..12 => {
                    both.plain.push_back(Arc::clone(&value));
                    both.tables.push(value);
                }
                12 => {
                    let last = Arc::clone(&both.plain[both.plain.len() - 1]);
                    both.plain.extend(vec![last; at as usize % 5]);
                    both.tables.extend_to(both.oldest.plus(both.plain.len() as u64 - 1));
                }
                13..15 => {
                    let to = at + random.below(both.plain.len() as u64 - at);
                    (at..=to).for_each(|index| both.plain[index as usize] = Arc::clone(&value));
                    both.tables.set_run(both.oldest.plus(at), both.oldest.plus(to), value);
                }
                _ => {
                    both.plain[at as usize] = Arc::clone(&value);
                    both.tables.set(both.oldest.plus(at), value);
                }
            }
            both.agree();
        }
    }

    #[test]
    fn an_hour_of_rest_costs_what_a_frame_does() {
        let resting = table(0.0);
        let mut tables = Tables::new(Frame(0), Arc::clone(&resting));
        let once = tables.bytes();
        for _ in 0..216_000 {
            let (next, _) = resting.with_entries(&[(BodyId(3), Some(state(0.0)))], &resting);
            tables.push(next);
        }
        assert_eq!(tables.bytes(), once);
    }
}
