//! Stage times: how long each stage of each computed frame took, for plots.
//!
//! Only where a clock is given is anything measured. Promise: neither side ever waits. What was measured goes into a ring of atomic words; a reader
//! that comes too late, or while an entry is being written, gets nothing instead of something mixed (a sequence lock: Boehm, *Can seqlocks get
//! along with programming language memory models?*, 2012).

use std::sync::atomic::{AtomicU64, Ordering, fence};

use forerun_timeline::{Advance, Progress, Timeline};

use crate::dynamics::{Observer, Stage};
use crate::{Clock, Frame};

/// Entries that are kept: at 60 frames a second the last 17 s, less while edits are worked off.
const KEPT: usize = 1024;

/// How long one frame took, and what was done for it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageTimes {
    /// Counts the computed frames: 0, 1, 2, ... A frame that is computed again is counted again.
    pub number: u64,
    /// The frame whose states were computed.
    pub frame: Frame,
    /// Whether it is a new one, beyond the old horizon; else it was computed again for an edit.
    pub extended: bool,
    /// Bodies that were advanced to it.
    pub recomputed: u32,
    /// Bodies whose state there is another one than before; of a new frame: that moved.
    pub affected: u32,
    /// Time of each stage, in the order of [`Stage::ALL`]. What lies between two stages is counted to the later one. Seconds of the physics thread's
    /// clock, not of its processor: it includes what others took it for.
    pub seconds: [f32; 6],
    /// The rest: storing states, commands, areas. Seconds.
    pub other_s: f32,
}

impl StageTimes {
    /// Time of one stage. Seconds.
    #[must_use]
    pub fn of(&self, stage: Stage) -> f32 {
        self.seconds[stage as usize]
    }

    /// Time of the whole frame. Seconds.
    #[must_use]
    pub fn total_s(&self) -> f32 {
        self.seconds.iter().sum::<f32>() + self.other_s
    }
}

/// Watches the stages with a clock.
#[derive(Debug)]
pub(super) struct StageWatch {
    clock: Clock,
    last_s: f64,
    seconds: [f64; 6],
}

impl Observer for StageWatch {
    fn after(&mut self, stage: Stage) {
        let now_s = self.clock.now().as_secs_f64();
        self.seconds[stage as usize] += now_s - self.last_s;
        self.last_s = now_s;
    }
}

impl StageWatch {
    pub(super) fn new(clock: Clock) -> StageWatch {
        StageWatch { clock, last_s: 0.0, seconds: [0.0; 6] }
    }

    /// Begins a frame.
    pub(super) fn begin(&mut self) {
        self.seconds = [0.0; 6];
        self.last_s = self.clock.now().as_secs_f64();
    }

    /// Ends it: the times of the stages, and of the rest after the last of them.
    pub(super) fn end(&self) -> ([f32; 6], f32) {
        let other_s = self.clock.now().as_secs_f64() - self.last_s;
        (self.seconds.map(|seconds| seconds as f32), other_s as f32)
    }

    /// One frame of work, and how long it took.
    pub(super) fn advance(&mut self, timeline: &mut Timeline, times: &StageTimesRing) -> Progress {
        self.begin();
        let progress = timeline.advance_observed(self);
        if let Progress::Advanced(Advance { frame, recomputed, affected, extended, .. }) = progress {
            let (seconds, other_s) = self.end();
            times.write(&StageTimes { number: 0, frame, extended, recomputed, affected, seconds, other_s });
        }
        progress
    }
}

/// Words of an entry, after its number: frame; bodies recomputed and affected; 8 halves: six stages, the rest, whether the frame is a new one.
const WORDS: usize = 6;

#[derive(Debug, Default)]
struct Slot {
    /// One more than the number of what is written; 0 while there is nothing, or it is being written.
    tag: AtomicU64,
    words: [AtomicU64; WORDS],
}

/// The times of the last frames. One side writes, the other reads.
#[derive(Debug)]
pub(super) struct StageTimesRing {
    ring: Box<[Slot]>,
    /// How many were written.
    written: AtomicU64,
}

impl StageTimesRing {
    pub(super) fn new() -> StageTimesRing {
        StageTimesRing { ring: (0..KEPT).map(|_| Slot::default()).collect(), written: AtomicU64::new(0) }
    }

    /// Writes the next entry, which gets the next number. Only one thread writes.
    pub(super) fn write(&self, times: &StageTimes) {
        let number = self.written.load(Ordering::Relaxed);
        let slot = &self.ring[(number % KEPT as u64) as usize];
        slot.tag.store(0, Ordering::Relaxed);
        // Whoever reads a word of what follows also reads that it is being written.
        fence(Ordering::Release);
        for (place, word) in slot.words.iter().zip(packed(times)) {
            place.store(word, Ordering::Relaxed);
        }
        slot.tag.store(number + 1, Ordering::Release);
        self.written.store(number + 1, Ordering::Release);
    }

    /// Adds those numbered from `from` on that are still kept; the number of the first that is not written yet.
    pub(super) fn read(&self, from: u64, found: &mut Vec<StageTimes>) -> u64 {
        let written = self.written.load(Ordering::Acquire);
        let oldest = written.saturating_sub(KEPT as u64);
        found.extend((from.max(oldest)..written).filter_map(|number| self.entry(number)));
        written
    }

    fn entry(&self, number: u64) -> Option<StageTimes> {
        let slot = &self.ring[(number % KEPT as u64) as usize];
        if slot.tag.load(Ordering::Acquire) != number + 1 {
            return None;
        }
        let words = std::array::from_fn(|k| slot.words[k].load(Ordering::Relaxed));
        fence(Ordering::Acquire);
        (slot.tag.load(Ordering::Relaxed) == number + 1).then(|| unpacked(number, words))
    }
}

fn packed(times: &StageTimes) -> [u64; WORDS] {
    let pair = |low: u32, high: u32| u64::from(low) | u64::from(high) << 32;
    let s = times.seconds.map(f32::to_bits);
    [
        times.frame.0,
        pair(times.recomputed, times.affected),
        pair(s[0], s[1]),
        pair(s[2], s[3]),
        pair(s[4], s[5]),
        pair(times.other_s.to_bits(), u32::from(times.extended)),
    ]
}

fn unpacked(number: u64, words: [u64; WORDS]) -> StageTimes {
    let (low, high) = (|word: u64| word as u32, |word: u64| (word >> 32) as u32);
    let [frame, bodies, a, b, c, d] = words;
    StageTimes {
        number,
        frame: Frame(frame),
        extended: high(d) != 0,
        recomputed: low(bodies),
        affected: high(bodies),
        seconds: [low(a), high(a), low(b), high(b), low(c), high(c)].map(f32::from_bits),
        other_s: f32::from_bits(low(d)),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn times(frame: u64) -> StageTimes {
        let part = |k: u32| (frame as u32 * 8 + k) as f32;
        StageTimes {
            number: frame,
            frame: Frame(frame),
            extended: frame.is_multiple_of(2),
            recomputed: frame as u32,
            affected: frame as u32 / 2,
            seconds: std::array::from_fn(|k| part(k as u32)),
            other_s: part(6),
        }
    }

    #[test]
    fn what_was_written_is_read_once_and_the_last_are_kept() {
        let ring = StageTimesRing::new();
        let mut found = Vec::new();
        assert_eq!(ring.read(0, &mut found), 0);
        (0..3).for_each(|frame| ring.write(&times(frame)));
        assert_eq!(ring.read(0, &mut found), 3);
        assert_eq!(found, [times(0), times(1), times(2)]);
        (3..KEPT as u64 + 10).for_each(|frame| ring.write(&times(frame)));
        found.clear();
        let next = ring.read(3, &mut found);
        assert_eq!((next, found.len()), (KEPT as u64 + 10, KEPT));
        assert_eq!((found[0], found[KEPT - 1]), (times(10), times(KEPT as u64 + 9)));
        found.clear();
        assert_eq!(ring.read(next, &mut found), next);
        assert_eq!(found, []);
    }

    #[test]
    fn a_reader_beside_the_writer_gets_nothing_mixed() {
        let ring = StageTimesRing::new();
        std::thread::scope(|scope| {
            scope.spawn(|| (0..200_000).for_each(|frame| ring.write(&times(frame))));
            let (mut next, mut found) = (0, Vec::new());
            while next < 200_000 {
                next = ring.read(next, &mut found);
            }
            assert!(found.iter().all(|entry| *entry == times(entry.number)));
        });
    }

    #[test]
    fn time_is_counted_to_the_stage_that_ends_and_what_is_left_to_the_rest() {
        let clock = Clock::by_hand();
        let mut watch = StageWatch::new(clock.clone());
        clock.turn(Duration::from_secs(5));
        watch.begin();
        for (stage, millis) in [(Stage::Collisions, 30), (Stage::Contacts, 20), (Stage::Contacts, 7)] {
            clock.turn(Duration::from_millis(millis));
            watch.after(stage);
        }
        clock.turn(Duration::from_millis(3));
        let (seconds, other_s) = watch.end();
        assert_eq!((seconds, other_s), ([0.03, 0.0, 0.0, 0.027, 0.0, 0.0], 0.003));
    }
}
