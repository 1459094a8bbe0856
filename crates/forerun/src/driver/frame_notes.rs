//! Frame notes: what the physics thread remarks about each frame, for who draws it.
//!
//! Promise: neither side ever waits. A note is one atomic word in a ring, tagged with its frame; a reader that comes too late
//! or too early finds another frame's tag and gets nothing.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::Frame;

/// How one frame was computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameNote {
    /// Most slices that an island's frame was cut into, any time that it was computed; 1 when none was.
    pub slices_max: u8,
    /// Areas in which a body moved; none unless [`DecoupledSettings::count_areas`](crate::DecoupledSettings::count_areas) asks for it.
    pub areas_active: Option<u32>,
}

const AREAS_BITS: u32 = 24;
/// What stands for areas that were not counted; so many are counted as one less.
const NOT_COUNTED: u32 = (1 << AREAS_BITS) - 1;
const SLICES_BITS: u32 = 8;

/// The notes of the last frames.
#[derive(Debug)]
pub(crate) struct FrameNotes {
    ring: Box<[AtomicU64]>,
}

impl FrameNotes {
    /// Room for the notes of `frames` frames.
    pub(crate) fn with_capacity(frames: usize) -> Self {
        // Slices are never 0, so a word of zeros is the note of no frame.
        FrameNotes { ring: (0..frames.max(1)).map(|_| AtomicU64::new(0)).collect() }
    }

    /// Only the physics thread writes. A frame that is computed again keeps the most slices: those islands that were cut may not have been among
    /// those computed again.
    pub(crate) fn write(&self, frame: Frame, note: FrameNote) {
        let areas = u64::from(note.areas_active.map_or(NOT_COUNTED, |areas| areas.min(NOT_COUNTED - 1)));
        let before = self.read(frame).map_or(1, |before| before.slices_max);
        let slices = u64::from(note.slices_max.max(before));
        let word = tag(frame) << (AREAS_BITS + SLICES_BITS) | slices << AREAS_BITS | areas;
        // The word says all there is to say, so it needs no order with other memory.
        self.ring[self.place(frame)].store(word, Ordering::Relaxed);
    }

    pub(crate) fn read(&self, frame: Frame) -> Option<FrameNote> {
        let word = self.ring[self.place(frame)].load(Ordering::Relaxed);
        let slices_max = (word >> AREAS_BITS) as u8;
        let written = slices_max != 0 && word >> (AREAS_BITS + SLICES_BITS) == tag(frame);
        let areas = word as u32 & ((1 << AREAS_BITS) - 1);
        let areas_active = (areas != NOT_COUNTED).then_some(areas);
        written.then_some(FrameNote { slices_max, areas_active })
    }

    fn place(&self, frame: Frame) -> usize {
        (frame.0 % self.ring.len() as u64) as usize
    }
}

fn tag(frame: Frame) -> u64 {
    frame.0 & u64::from(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_that_is_computed_again_keeps_its_most_slices() {
        let notes = FrameNotes::with_capacity(4);
        notes.write(Frame(2), FrameNote { slices_max: 8, areas_active: Some(77) });
        notes.write(Frame(2), FrameNote { slices_max: 2, areas_active: Some(5) });
        assert_eq!(notes.read(Frame(2)), Some(FrameNote { slices_max: 8, areas_active: Some(5) }));
        notes.write(Frame(6), FrameNote { slices_max: 2, areas_active: Some(5) });
        assert_eq!(notes.read(Frame(6)), Some(FrameNote { slices_max: 2, areas_active: Some(5) }));
    }

    #[test]
    fn a_note_is_read_as_written_until_the_ring_comes_round() {
        let notes = FrameNotes::with_capacity(4);
        let note = FrameNote { slices_max: 8, areas_active: Some(77) };
        assert_eq!(notes.read(Frame(0)), None);
        notes.write(Frame(2), note);
        assert_eq!(notes.read(Frame(2)), Some(note));
        assert_eq!(notes.read(Frame(6)), None);
        notes.write(Frame(6), FrameNote { slices_max: 0, areas_active: Some(u32::MAX) });
        assert_eq!(notes.read(Frame(2)), None);
        assert_eq!(
            notes.read(Frame(6)),
            Some(FrameNote { slices_max: 1, areas_active: Some((1 << 24) - 2) })
        );
        notes.write(Frame(7), FrameNote { slices_max: 1, areas_active: None });
        assert_eq!(notes.read(Frame(7)), Some(FrameNote { slices_max: 1, areas_active: None }));
    }
}
