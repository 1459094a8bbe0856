//! Stats: what a timeline did, and what it keeps.

use crate::Frame;

/// One frame of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Advance {
    /// The frame whose states were computed.
    pub frame: Frame,
    /// Bodies that were advanced to it.
    pub recomputed: u32,
    /// Bodies whose state there is another one than before; of a new frame: that moved.
    pub affected: u32,
    /// Most slices that an island's frame was cut into.
    pub slices_max: u32,
    /// Whether the frame is a new one, beyond the old horizon.
    pub extended: bool,
}

/// Sums of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Body-frames whose stored bits were replaced by others.
    pub affected: u64,
    /// Body-frames that were advanced.
    pub recomputed: u64,
    /// Frames that were worked on.
    pub frames: u64,
    /// Bodies that were stopped because their next state was not finite, each time it happened.
    pub quarantined: u64,
}

/// What a batch of commands cost: those that came between two moments at which everything was true.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Edit {
    /// The earliest frame at which one of the commands acts.
    pub frame: Frame,
    /// How many commands were accepted, taken back or replaced.
    pub commands: u32,
    /// Body-frames whose stored bits were replaced by others.
    pub affected: u64,
    /// Body-frames that were advanced for it.
    pub recomputed: u64,
    /// Body-frames of a full re-simulation: all bodies that are there, times all frames from [`frame`](Edit::frame) to the horizon.
    pub full: u64,
    /// Frames that were worked on.
    pub frames: u64,
}

/// What a timeline has done so far, and keeps now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Work on new frames.
    pub ahead: Counters,
    /// Re-simulation, all together.
    pub edits: Counters,
    /// Re-simulation for the last batch of commands.
    pub last_edit: Edit,
    /// Commands in force that did nothing: their body was not there, or the result would not have been finite.
    pub ignored: u64,
    /// Most slices that an island's frame was cut into.
    pub slices_max: u32,
    /// Frames kept before the display's.
    pub past_frames: u64,
    /// Frames computed beyond the display's.
    pub lookahead_frames: u64,
    /// Memory of the stored states. Bytes.
    pub state_bytes: usize,
    /// Whether memory ([`TimelineSettings::bytes_max`](crate::TimelineSettings::bytes_max)), and not the number of frames, bounds what is kept or computed.
    pub memory_bound: bool,
}

impl Counters {
    pub(crate) fn add(&mut self, done: &Advance, quarantined: u32) {
        self.affected += u64::from(done.affected);
        self.recomputed += u64::from(done.recomputed);
        self.frames += 1;
        self.quarantined += u64::from(quarantined);
    }
}

impl Edit {
    pub(crate) fn add(&mut self, done: &Advance) {
        self.affected += u64::from(done.affected);
        self.recomputed += u64::from(done.recomputed);
        self.frames += 1;
    }
}
