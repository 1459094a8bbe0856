//! Touch table: who touched whom in the step that led to a frame, in blocks that frames share.
//!
//! A touch belongs to one of its two bodies, the lower of those that are dynamic: so the ground has no list of all that lies on it, and
//! whoever is computed again brings its whole list along. Touches are a function of the states of the frame before, as states are, and
//! are kept under the same promise: [`with`](TouchTable::with) replaces the lists of the bodies that were advanced, and the others stand.
//!
//! An island at a fixpoint is not solved and keeps the touches of the frame before. That is what solving it would tell: at a fixpoint
//! its states, and so what it would be pushed with, are those of the frame before.

use std::sync::Arc;

use forerun_dynamics::{BodyId, Touch, Touches};

use crate::affected::Affected;
use crate::frame_table::{BLOCK_BODIES, Entry};
use crate::shared_list::{CHUNK, SharedList};

/// A touch and whose it is.
#[derive(Clone, Copy, Debug)]
struct Owned {
    owner: BodyId,
    touch: Touch,
}

/// The touches of neighbours by id, sorted by owner, then pair.
type Block = Arc<[Owned]>;

/// The touches of all bodies at one frame. Empty, and without memory, where they are not recorded.
#[derive(Clone, Debug, Default)]
pub(crate) struct TouchTable {
    blocks: SharedList<Block>,
}

/// The lists of touches of the bodies that were advanced.
#[derive(Debug)]
pub(crate) struct Told {
    /// Whose lists these are. Sorted.
    owners: Vec<BodyId>,
    /// Sorted by owner, then pair.
    touches: Vec<Owned>,
}

impl Told {
    /// What a step told. `advanced` (sorted) are those with a next state, or known to be gone; `before` is the table of the frame that the
    /// step left; `outdated` one of whose lists none is to stand, whether its owner still is there or not.
    pub(crate) fn new(
        advanced: &[Entry],
        group: &Affected,
        touches: &Touches,
        before: &TouchTable,
        outdated: Option<&TouchTable>,
    ) -> Told {
        let mut owners: Vec<BodyId> = advanced.iter().map(|(body, _)| *body).collect();
        if let Some(outdated) = outdated {
            owners.extend(outdated.blocks.iter().flat_map(|block| block.iter()).map(|owned| owned.owner));
            owners.sort_unstable();
            owners.dedup();
        }
        let dynamic = |body: BodyId| {
            let found = group.members.binary_search_by_key(&body, |member| member.id);
            found.is_ok_and(|index| group.members[index].body.is_dynamic())
        };
        let owned = touches.list.iter().map(|touch| Owned {
            owner: if dynamic(touch.first) { touch.first } else { touch.second },
            touch: *touch,
        });
        let mut told: Vec<Owned> = owned.filter(|o| owners.binary_search(&o.owner).is_ok()).collect();
        for (member, _) in group.members.iter().zip(&touches.resting).filter(|(_, resting)| **resting) {
            told.extend(before.of(member.id));
        }
        told.sort_by_key(|owned| (owned.owner, owned.touch.first, owned.touch.second));
        Told { owners, touches: told }
    }
}

impl TouchTable {
    /// All touches, sorted by owner.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Touch> {
        self.blocks.iter().flat_map(|block| block.iter()).map(|owned| &owned.touch)
    }

    /// The touches of each table in the blocks that the two do not share.
    pub(crate) fn unshared<'a>(&'a self, other: &'a TouchTable) -> (Vec<&'a Touch>, Vec<&'a Touch>) {
        let (mut mine, mut theirs) = (Vec::new(), Vec::new());
        for (_, a, b) in self.blocks.unshared(&other.blocks) {
            for index in 0..a.len().max(b.len()) {
                let (a, b) = (a.get(index), b.get(index));
                if !matches!((a, b), (Some(a), Some(b)) if Arc::ptr_eq(a, b)) {
                    mine.extend(a.into_iter().flat_map(|block| block.iter()).map(|owned| &owned.touch));
                    theirs.extend(b.into_iter().flat_map(|block| block.iter()).map(|owned| &owned.touch));
                }
            }
        }
        (mine, theirs)
    }

    /// This table with other lists. Blocks that come out as in `before`, the table of the frame before, are shared with it.
    pub(crate) fn with(&self, told: &Told, before: &TouchTable) -> TouchTable {
        let mut table = self.clone();
        let mut touches = told.touches.as_slice();
        for owners in told.owners.chunk_by(|a, b| block_of(*a) == block_of(*b)) {
            let index = block_of(owners[0]);
            let mine = touches.partition_point(|owned| block_of(owned.owner) <= index);
            let (new, rest) = touches.split_at(mine);
            touches = rest;
            table.replace(index, owners, new, before);
        }
        table
    }

    /// Replaces the lists of some owners of one block.
    fn replace(&mut self, index: usize, owners: &[BodyId], new: &[Owned], before: &TouchTable) {
        let old = self.blocks.get(index).map_or(&[][..], |block| block);
        let others = old.iter().filter(|owned| owners.binary_search(&owned.owner).is_err());
        let mut block: Vec<Owned> = others.chain(new).copied().collect();
        // Stable, and two sorted runs: one look.
        block.sort_by_key(|owned| owned.owner);
        if same_bits(old, &block) {
            return;
        }
        let shared = before.blocks.get(index).filter(|shared| same_bits(shared, &block));
        let block = shared.map_or_else(|| Block::from(block), Arc::clone);
        if index >= self.blocks.len() {
            self.blocks.grow(index + 1, &Block::from([]));
        }
        if let Some(place) = self.blocks.get_mut(index) {
            *place = block;
        }
        self.blocks.share_chunk(index, &before.blocks, Arc::ptr_eq);
    }

    /// Whether all memory is shared with another table.
    pub(crate) fn shares_all(&self, other: &TouchTable) -> bool {
        self.blocks.shares_all(&other.blocks)
    }

    /// Memory that `before` does not share. Bytes.
    pub(crate) fn bytes_beyond(&self, before: Option<&TouchTable>) -> usize {
        let nothing = SharedList::default();
        let chunks = self.blocks.unshared(before.map_or(&nothing, |before| &before.blocks));
        let own = chunks.map(|(_, mine, theirs)| {
            let shared = |index, block| matches!(theirs.get(index), Some(old) if Arc::ptr_eq(old, block));
            let own = mine.iter().enumerate().filter(|(index, block)| !shared(*index, *block));
            own.map(|(_, block)| size_of_val(&**block)).sum::<usize>() + size_of_val(mine)
        });
        own.sum::<usize>() + self.blocks.len().div_ceil(CHUNK) * size_of::<usize>()
    }

    fn of(&self, owner: BodyId) -> &[Owned] {
        let block = self.blocks.get(block_of(owner)).map_or(&[][..], |block| block);
        let from = block.partition_point(|owned| owned.owner < owner);
        let to = block.partition_point(|owned| owned.owner <= owner);
        &block[from..to]
    }
}

fn block_of(owner: BodyId) -> usize {
    owner.0 as usize / BLOCK_BODIES
}

fn same_bits(a: &[Owned], b: &[Owned]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.owner == b.owner && a.touch.same_bits(&b.touch))
}
