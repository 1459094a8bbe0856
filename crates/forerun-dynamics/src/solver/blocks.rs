//! Blocks: contacts laid out eight abreast.
//!
//! Contacts are ordered by level, then by colour: within a colour no dynamic body appears twice, so that the lanes of a block never write the
//! same body, nor do the blocks of a run. The colour of a contact depends on its island alone; which lane it lands in does not change its result.

use std::ops::Range;

use super::points::{Kind, Point, Side};
use super::shares::Shares;
use crate::lanes::{LANES, LaneMask, Lanes, Portable, Record, V8};

/// Padding: a lane without a contact.
pub(crate) const NO_CONTACT: u32 = u32::MAX;

/// Impulses of eight contacts.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Impulses<F> {
    pub(crate) points: [F; 4],
    /// Along the two tangents and about the normal.
    pub(crate) friction: [F; 3],
}

/// Friction of a contact: two tangents and the twist about the normal, at its centre.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Friction<F> {
    /// What a unit impulse at each point does to the slip along the tangents and to the twist.
    pub(crate) drag: [[F; 4]; 3],
    /// Inverse of the 2 x 2 effective mass matrix of the tangents: 11, 12, 22.
    pub(crate) inverse_k: [F; 3],
    pub(crate) twist_inverse_k: F,
    /// Of the running substep: along the tangents and about the normal.
    pub(crate) impulses: [F; 3],
    /// Mean distance of the points from their centre.
    pub(crate) radius: F,
    pub(crate) static_coefficient: F,
    pub(crate) kinetic_coefficient: F,
}

/// Eight contacts: what every sweep reads.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Block<F: Lanes, K: Kind> {
    pub(crate) first_row: [u32; LANES],
    pub(crate) second_row: [u32; LANES],
    /// Where the sides are written: their own rows, or, for sides that no impulse moves, a row that nobody reads. What happens to an island must
    /// not reach the others through the ground that they share.
    pub(crate) first_out: [u32; LANES],
    pub(crate) second_out: [u32; LANES],
    pub(crate) normal: V8<F>,
    pub(crate) tangent: V8<F>,
    pub(crate) first: Side<F>,
    pub(crate) second: Side<F>,
    pub(crate) points: [K::Point<F>; 4],
    /// 1 / (J Jᵀ) of each point; 0 where there is none.
    pub(crate) inverse_k: [F; 4],
    /// Normal impulses of the running substep.
    pub(crate) impulses: [F; 4],
    /// How fast each point may approach: so that its gap closes within the substep and no more.
    pub(crate) allowed: [F; 4],
    /// What a unit impulse at one point does to the speed at another: 10, 20, 21, 30, 31, 32.
    pub(crate) coupling: [F; 6],
    /// What a unit impulse at every point does to the speed at each.
    pub(crate) row_sums: [F; 4],
    /// 1 / (sum of the row sums).
    pub(crate) mean_gain: F,
    pub(crate) friction: Friction<F>,
}

/// Eight contacts: what only some stages read.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Detail<F> {
    /// Index of the contact, or [`NO_CONTACT`].
    pub(crate) source: [u32; LANES],
    /// Separation of each point at the start of the frame.
    pub(crate) separation: [F; 4],
    /// 1 / number of points.
    pub(crate) inverse_count: F,
    pub(crate) restitution: F,
    /// 1 where impulses move the body, else 0.
    pub(crate) first_answers: F,
    pub(crate) second_answers: F,
    /// How much of the push out of overlap each side takes; less for the lower one.
    pub(crate) first_yields: F,
    pub(crate) second_yields: F,
    /// The part of the first guess that is momentum: it is taken off before the second substep.
    pub(crate) momentum: Impulses<F>,
    /// By how much the arm of each side turns in a substep, where it is that of a kinematic body; along the contact's axes.
    pub(crate) carries: [V8<F>; 2],
}

/// [`Block`]s, in whatever form their numbers are.
pub(crate) struct BlocksOf<K>(std::marker::PhantomData<K>);
/// [`Detail`]s, in whatever form their numbers are.
pub(crate) struct DetailsOf;

// SAFETY: both are repr(C), of numbers and indices, as are the points of all kinds.
#[allow(unsafe_code, reason = "says of the layout what kernels rely on")]
unsafe impl<K: Kind> Record for BlocksOf<K> {
    type Of<F: Lanes> = Block<F, K>;
}
#[allow(unsafe_code, reason = "says of the layout what kernels rely on")]
unsafe impl Record for DetailsOf {
    type Of<F: Lanes> = Detail<F>;
}

impl<F: Lanes, K: Kind> Block<F, K> {
    /// All zero.
    fn nothing() -> Self {
        let (z, v) = (F::zero(), V8::zero());
        let side = Side { scale: z, offset: v, turns: [v; 3] };
        Block {
            first_row: [0; LANES],
            second_row: [0; LANES],
            first_out: [0; LANES],
            second_out: [0; LANES],
            normal: v,
            tangent: v,
            first: side,
            second: side,
            points: [K::Point::new(v, v); 4],
            inverse_k: [z; 4],
            impulses: [z; 4],
            allowed: [z; 4],
            coupling: [z; 6],
            row_sums: [z; 4],
            mean_gain: z,
            friction: Friction {
                drag: [[z; 4]; 3],
                inverse_k: [z; 3],
                twist_inverse_k: z,
                impulses: [z; 3],
                radius: z,
                static_coefficient: z,
                kinetic_coefficient: z,
            },
        }
    }

    /// Where there is a `q`-th point.
    #[inline(always)]
    pub(crate) fn is_point(&self, q: usize) -> F::Mask {
        self.inverse_k[q].gt(F::zero())
    }
}

impl<F: Lanes> Detail<F> {
    /// All zero.
    fn nothing() -> Self {
        let z = F::zero();
        Detail {
            source: [NO_CONTACT; LANES],
            separation: [z; 4],
            inverse_count: z,
            restitution: z,
            first_answers: z,
            second_answers: z,
            first_yields: z,
            second_yields: z,
            momentum: Impulses { points: [z; 4], friction: [z; 3] },
            carries: [V8::zero(); 2],
        }
    }

    /// Whether any of the guessed impulses is momentum.
    #[inline(always)]
    pub(crate) fn has_momentum(&self) -> bool {
        let Impulses { points: [a, b, c, d], friction: [e, f, g] } = self.momentum;
        let most = a.abs().max(b.abs()).max(c.abs()).max(d.abs()).max(e.abs()).max(f.abs()).max(g.abs());
        most.gt(F::zero()).any()
    }
}

/// What an island needs. Of the island alone, so that it gets the same in any company.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Class {
    /// No more than others.
    Easy,
    /// More passes that push out overlap.
    Overlapping,
    /// Also, to find what its contacts carry: the load pass fails to place its weight. It moves fast, so that it is not worth much trouble.
    Rushing,
    /// The same, but it moves slowly or not at all: heaps.
    Heap,
    /// As exact a solution as can be had: the same, and it is high and small (arches, card houses).
    Delicate,
}

impl Class {
    pub(crate) const COUNT: usize = 5;
}

/// The blocks of one kind, in the order in which they are solved.
#[derive(Debug, Default)]
pub(crate) struct Arranged<K: Kind> {
    /// By the class of their island.
    pub(crate) blocks: Vec<Block<Portable, K>>,
    /// One a block.
    pub(crate) details: Vec<Detail<Portable>>,
    /// How many blocks are of a class, or of one before it.
    pub(crate) ends: [usize; Class::COUNT],
    /// Where each level and colour begins among the blocks: blocks of one run share no body that impulses move.
    pub(crate) runs: Vec<u32>,
    /// How many blocks have been added; the others are memory to be used again.
    pub(crate) count: usize,
    /// Which thread does which blocks; none where one does them all.
    pub(crate) shares: Shares,
}

impl<K: Kind> Arranged<K> {
    /// Where the blocks of a class are.
    pub(crate) fn of(&self, class: Class) -> Range<usize> {
        let start = match class {
            Class::Easy => 0,
            _ => self.ends[class as usize - 1],
        };
        start..self.ends[class as usize]
    }

    /// Forgets all blocks but not their memory.
    pub(crate) fn clear(&mut self) {
        self.ends = [0; Class::COUNT];
        self.count = 0;
        self.runs.clear();
        self.shares.clear();
    }

    /// Makes room for so many more blocks at once.
    pub(crate) fn reserve(&mut self, more: usize) {
        let missing = (self.count + more).saturating_sub(self.blocks.len());
        self.blocks.reserve(missing);
        self.details.reserve(missing);
    }

    /// One more block, without contacts: every lane reads the dummy body and writes the row after it.
    pub(crate) fn add(&mut self, dummy: u32) -> (&mut Block<Portable, K>, &mut Detail<Portable>) {
        if self.count == self.blocks.len() {
            self.blocks.push(Block::nothing());
            self.details.push(Detail::nothing());
        }
        let at = self.count;
        self.count += 1;
        let (block, detail) = (&mut self.blocks[at], &mut self.details[at]);
        block.first_row = [dummy; LANES];
        block.second_row = [dummy; LANES];
        block.first_out = [dummy + 1; LANES];
        block.second_out = [dummy + 1; LANES];
        detail.source = [NO_CONTACT; LANES];
        (block, detail)
    }

    /// Lets go of the blocks that were not added since they were forgotten.
    pub(crate) fn finish(&mut self) {
        self.blocks.truncate(self.count);
        self.details.truncate(self.count);
    }
}
