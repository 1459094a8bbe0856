//! Frame table: the states of all bodies at one frame, in blocks that frames share.
//!
//! Promise: a block that is the same as in the frame before, or as before an edit, is the same memory. So resting blocks cost
//! nothing, copies of a timeline cost what differs, and finding what differs costs a look at the blocks that are not shared.

use std::sync::Arc;

use forerun_dynamics::{BodyId, BodyState};
use forerun_geometry::{Quat, Vec3};

use crate::shared_list::{CHUNK, SharedList};
use crate::touch_table::{Told, TouchTable};

/// Bodies of one block: neighbours by id.
pub(crate) const BLOCK_BODIES: usize = 32;

/// What stands where there is no body, so that equal blocks have equal bits.
const ABSENT: BodyState = BodyState {
    position: Vec3::ZERO,
    rotation: Quat::IDENTITY,
    velocity: Vec3::ZERO,
    angular_velocity: Vec3::ZERO,
    rest: 0,
};

#[derive(Clone, Debug)]
struct Block {
    /// Bit `i` is set where body `i` of the block exists.
    present: u32,
    states: [BodyState; BLOCK_BODIES],
}

impl Block {
    const EMPTY: Block = Block { present: 0, states: [ABSENT; BLOCK_BODIES] };

    fn get(&self, slot: usize) -> Option<&BodyState> {
        (self.present >> slot & 1 == 1).then(|| &self.states[slot])
    }

    fn set(&mut self, slot: usize, state: Option<BodyState>) {
        let bit = 1 << slot;
        self.present = if state.is_some() { self.present | bit } else { self.present & !bit };
        self.states[slot] = state.unwrap_or(ABSENT);
    }

    fn same_bits(&self, other: &Block) -> bool {
        self.present == other.present && self.states.iter().zip(&other.states).all(|(a, b)| a.same_bits(b))
    }
}

/// The states of all bodies at one frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrameTable {
    blocks: SharedList<Arc<Block>>,
    population: u32,
    touches: TouchTable,
}

/// A state to be stored; `None` where the body is not there.
pub(crate) type Entry = (BodyId, Option<BodyState>);

impl FrameTable {
    /// A table of the first states of bodies 0, 1, 2, ...
    pub(crate) fn new(states: &[BodyState]) -> FrameTable {
        let blocks = states.chunks(BLOCK_BODIES).map(|states| {
            let mut block = Block::EMPTY;
            for (slot, state) in states.iter().enumerate() {
                block.set(slot, Some(*state));
            }
            Arc::new(block)
        });
        let population = states.len() as u32;
        FrameTable { blocks: blocks.collect(), population, touches: TouchTable::default() }
    }

    /// How many bodies there are.
    pub(crate) fn population(&self) -> usize {
        self.population as usize
    }

    /// The state of a body, if it is there.
    pub(crate) fn get(&self, body: BodyId) -> Option<&BodyState> {
        let (block, slot) = place(body);
        self.blocks.get(block)?.get(slot)
    }

    /// All bodies and their states, in the order of their ids.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (BodyId, &BodyState)> {
        self.blocks.iter().enumerate().flat_map(|(index, block)| {
            (0..BLOCK_BODIES).filter_map(move |slot| Some((body_at(index, slot), block.get(slot)?)))
        })
    }

    /// The bodies whose bits differ, or that are only in one of the tables, in the order of their ids.
    pub(crate) fn differences(&self, other: &FrameTable) -> Vec<BodyId> {
        let mut differing = Vec::new();
        for (first, mine, theirs) in self.blocks.unshared(&other.blocks) {
            for index in 0..mine.len().max(theirs.len()) {
                let (mine, theirs) = (mine.get(index), theirs.get(index));
                if matches!((mine, theirs), (Some(a), Some(b)) if Arc::ptr_eq(a, b)) {
                    continue;
                }
                for slot in 0..BLOCK_BODIES {
                    let (a, b) = (mine.and_then(|m| m.get(slot)), theirs.and_then(|t| t.get(slot)));
                    if !same_entry(a, b) {
                        differing.push(body_at(first + index, slot));
                    }
                }
            }
        }
        differing
    }

    /// This table with other entries (sorted by id), and the bodies for which that made a difference. Blocks that come out as in
    /// `before`, the table of the frame before, are shared with it.
    pub(crate) fn with_entries(
        self: &Arc<FrameTable>,
        entries: &[Entry],
        before: &Arc<FrameTable>,
    ) -> (Arc<FrameTable>, Vec<BodyId>) {
        let differs = |(body, state): &&Entry| !same_entry(self.get(*body), state.as_ref());
        let changes: Vec<&Entry> = entries.iter().filter(differs).collect();
        let changed: Vec<BodyId> = changes.iter().map(|(body, _)| *body).collect();
        if changed.is_empty() {
            return (Arc::clone(self), changed);
        }
        let mut table = FrameTable::clone(self);
        let mut written = Vec::new();
        for (body, state) in changes {
            let (index, slot) = place(*body);
            if index >= table.blocks.len() {
                table.blocks.grow(index + 1, &Arc::new(Block::EMPTY));
            }
            // It was just made so long.
            let Some(block) = table.blocks.get_mut(index) else { continue };
            let block = Arc::make_mut(block);
            table.population += u32::from(state.is_some());
            table.population -= u32::from(block.get(slot).is_some());
            block.set(slot, *state);
            if written.last() != Some(&index) {
                written.push(index);
            }
        }
        table.share(&written, before);
        if table.shares_all(before) {
            return (Arc::clone(before), changed);
        }
        (Arc::new(table), changed)
    }

    /// Who touched whom in the step that led to the frame.
    pub(crate) fn touches(&self) -> &TouchTable {
        &self.touches
    }

    /// This table with other lists of touches. What comes out as in `before`, the table of the frame before, is shared with it.
    pub(crate) fn with_touches(
        self: Arc<FrameTable>,
        told: &Told,
        before: &Arc<FrameTable>,
    ) -> Arc<FrameTable> {
        let touches = self.touches.with(told, &before.touches);
        if touches.shares_all(&self.touches) {
            return self;
        }
        let table = FrameTable { touches, ..FrameTable::clone(&self) };
        if table.shares_all(before) { Arc::clone(before) } else { Arc::new(table) }
    }

    fn shares_all(&self, other: &FrameTable) -> bool {
        self.blocks.shares_all(&other.blocks) && self.touches.shares_all(&other.touches)
    }

    /// Takes over the blocks of `before` that have the bits of those written (sorted).
    fn share(&mut self, written: &[usize], before: &FrameTable) {
        for index in written {
            if let (Some(mine), Some(old)) = (self.blocks.get_mut(*index), before.blocks.get(*index))
                && old.same_bits(mine)
            {
                *mine = Arc::clone(old);
            }
        }
        let mut chunks: Vec<usize> = written.iter().map(|index| index / CHUNK).collect();
        chunks.dedup();
        for chunk in chunks {
            self.blocks.share_chunk(chunk * CHUNK, &before.blocks, Arc::ptr_eq);
        }
    }

    /// Memory that `before` does not share. Bytes.
    pub(crate) fn bytes_beyond(&self, before: Option<&FrameTable>) -> usize {
        let nothing = SharedList::default();
        let chunks = self.blocks.unshared(before.map_or(&nothing, |before| &before.blocks));
        let own = chunks.map(|(_, mine, theirs)| {
            let shared = |(index, block)| matches!(theirs.get(index), Some(old) if Arc::ptr_eq(old, block));
            let own = mine.iter().enumerate().filter(|entry| !shared(*entry)).count();
            own * size_of::<Block>() + size_of_val(mine)
        });
        let own: usize = own.sum();
        let touches = self.touches.bytes_beyond(before.map(|before| &before.touches));
        own + touches + self.blocks.len().div_ceil(CHUNK) * size_of::<usize>() + size_of::<FrameTable>()
    }
}

fn place(body: BodyId) -> (usize, usize) {
    (body.0 as usize / BLOCK_BODIES, body.0 as usize % BLOCK_BODIES)
}

fn body_at(block: usize, slot: usize) -> BodyId {
    BodyId((block * BLOCK_BODIES + slot) as u32)
}

/// Whether two entries are the same, bit for bit.
pub(crate) fn same_entry(a: Option<&BodyState>, b: Option<&BodyState>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => a.same_bits(b),
        (None, None) => true,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(x: f32) -> BodyState {
        BodyState { position: Vec3::new(x, 0.0, 0.0), ..ABSENT }
    }

    fn table(count: usize) -> Arc<FrameTable> {
        let states: Vec<BodyState> = (0..count).map(|i| state(i as f32)).collect();
        Arc::new(FrameTable::new(&states))
    }

    #[test]
    fn entries_are_written_and_found() {
        let old = table(100);
        let entries = [(BodyId(3), Some(state(-1.0))), (BodyId(40), None), (BodyId(200), Some(state(7.0)))];
        let (new, changed) = old.with_entries(&entries, &old);
        assert_eq!(changed, [BodyId(3), BodyId(40), BodyId(200)]);
        assert_eq!(new.get(BodyId(3)), Some(&state(-1.0)));
        assert_eq!(new.get(BodyId(40)), None);
        assert_eq!(new.get(BodyId(200)), Some(&state(7.0)));
        assert_eq!(new.get(BodyId(201)), None);
        assert_eq!(new.population(), 100);
        assert_eq!(new.iter().count(), 100);
        assert_eq!(new.differences(&old), changed);
        assert_eq!(old.differences(&new), changed);
    }

    #[test]
    fn equal_entries_share_everything() {
        let old = table(100);
        let (new, changed) = old.with_entries(&[(BodyId(50), Some(state(50.0)))], &old);
        assert!(changed.is_empty() && Arc::ptr_eq(&old, &new));
    }

    #[test]
    fn untouched_blocks_are_shared() {
        let old = table(100);
        let (new, _) = old.with_entries(&[(BodyId(50), Some(state(0.5)))], &old);
        let shared = old.blocks.iter().zip(new.blocks.iter()).filter(|(a, b)| Arc::ptr_eq(a, b)).count();
        assert_eq!(shared, 3);
    }

    #[test]
    fn a_block_that_comes_out_as_the_frame_before_is_shared_with_it() {
        let before = table(100);
        let (stored, _) = before.with_entries(&[(BodyId(50), Some(state(0.5)))], &before);
        let (new, changed) = stored.with_entries(&[(BodyId(50), Some(state(50.0)))], &before);
        assert_eq!(changed, [BodyId(50)]);
        assert!(Arc::ptr_eq(&new, &before));
    }
}
