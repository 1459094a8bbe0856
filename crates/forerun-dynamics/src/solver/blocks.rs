//! Blocks: contacts laid out eight abreast.
//!
//! Contacts are ordered by level, then by colour: within a colour no dynamic body appears twice, so that the lanes of a block never write the
//! same body. The colour of a contact depends on its island alone; which lane it lands in does not change its result.

use super::batch::Ends;
use super::contact_graph::ContactGraph;
use crate::lanes::{LANES, Lanes, Portable, Record, V8};

/// Padding: a lane without a contact.
pub(crate) const NO_CONTACT: u32 = u32::MAX;

/// Colours within a level. Contacts that find no free colour get a block each.
const COLOURS: usize = 64;

/// One contact point in each lane.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct PointRow<F> {
    pub(crate) normal: V8<F>,
    /// Mass-scaled angular parts of the Jacobian.
    pub(crate) first: V8<F>,
    pub(crate) second: V8<F>,
    /// 1 / (J Jᵀ); 0 where there is no point.
    pub(crate) inverse_k: F,
    /// Separation at the start of the frame.
    pub(crate) separation: F,
    /// Normal impulse of the running substep.
    pub(crate) impulse: F,
}

/// The mean of a contact's points as one row: converges faster than the points alone.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct CentreRow<F> {
    pub(crate) normal: V8<F>,
    pub(crate) first: V8<F>,
    pub(crate) second: V8<F>,
    pub(crate) inverse_k: F,
    pub(crate) inverse_count: F,
}

/// Friction of a contact: two tangents and the twist about the normal, at the mean point.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct FrictionRows<F> {
    pub(crate) tangents: [V8<F>; 2],
    pub(crate) first: [V8<F>; 2],
    pub(crate) second: [V8<F>; 2],
    /// Inverse of the 2 x 2 effective mass matrix: 11, 12, 22.
    pub(crate) inverse_k: [F; 3],
    pub(crate) impulses: [F; 2],
    pub(crate) twist_first: V8<F>,
    pub(crate) twist_second: V8<F>,
    pub(crate) twist_inverse_k: F,
    pub(crate) twist_impulse: F,
    /// Mean distance of the points from their centre.
    pub(crate) radius: F,
    pub(crate) static_coefficient: F,
    pub(crate) kinetic_coefficient: F,
}

/// Impulses of eight contacts, as they are applied in one substep.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Impulses<F> {
    pub(crate) points: [F; 4],
    pub(crate) tangents: [F; 2],
    pub(crate) twist: F,
}

/// Eight contacts.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Block<F> {
    pub(crate) first: [u32; LANES],
    pub(crate) second: [u32; LANES],
    /// Where the sides are written: their own rows, or, for sides that no impulse moves, a row that nobody reads. What happens to an island must
    /// not reach the others through the ground that they share.
    pub(crate) first_out: [u32; LANES],
    pub(crate) second_out: [u32; LANES],
    /// Index of the contact, or [`NO_CONTACT`].
    pub(crate) source: [u32; LANES],
    pub(crate) first_scale: F,
    pub(crate) second_scale: F,
    /// 1 where impulses move the body, else 0.
    pub(crate) first_answers: F,
    pub(crate) second_answers: F,
    /// How much of the push out of overlap each side takes; less for the lower one.
    pub(crate) first_yields: F,
    pub(crate) second_yields: F,
    pub(crate) points: [PointRow<F>; 4],
    pub(crate) centre: CentreRow<F>,
    pub(crate) friction: FrictionRows<F>,
    pub(crate) restitution: F,
    /// The part of the first guess that is momentum: it is taken off before the second substep.
    pub(crate) momentum: Impulses<F>,
}

/// Blocks, in whatever form their numbers are.
pub(crate) struct Contacts;

// SAFETY: a block is repr(C), of numbers and indices.
#[allow(unsafe_code, reason = "says of the layout what kernels rely on")]
unsafe impl Record for Contacts {
    type Of<F: Lanes> = Block<F>;
}

impl<F: Lanes> Block<F> {
    /// A block without contacts: every lane is the dummy body against itself. The row after the dummy's is for what nobody reads.
    pub(crate) fn empty(dummy: u32) -> Self {
        let (z, v) = (F::zero(), V8::zero());
        let point =
            PointRow { normal: v, first: v, second: v, inverse_k: z, separation: F::splat(1e6), impulse: z };
        Block {
            first: [dummy; LANES],
            second: [dummy; LANES],
            first_out: [dummy + 1; LANES],
            second_out: [dummy + 1; LANES],
            source: [NO_CONTACT; LANES],
            first_scale: z,
            second_scale: z,
            first_answers: z,
            second_answers: z,
            first_yields: z,
            second_yields: z,
            points: [point; 4],
            centre: CentreRow { normal: v, first: v, second: v, inverse_k: z, inverse_count: z },
            friction: FrictionRows {
                tangents: [v; 2],
                first: [v; 2],
                second: [v; 2],
                inverse_k: [z; 3],
                impulses: [z; 2],
                twist_first: v,
                twist_second: v,
                twist_inverse_k: z,
                twist_impulse: z,
                radius: z,
                static_coefficient: z,
                kinetic_coefficient: z,
            },
            restitution: z,
            momentum: Impulses { points: [z; 4], tangents: [z; 2], twist: z },
        }
    }
}

/// The blocks of the chosen contacts (indices, rising) in the order in which they are solved; only indices are filled in.
pub(crate) fn arrange(
    chosen: &[u32],
    yields: &[bool],
    graph: &ContactGraph,
    contacts: &[Ends],
) -> Vec<Block<Portable>> {
    let count = yields.len();
    let by_level = sorted_by_level(chosen, graph, contacts);
    let mut colouring = Colouring { stamp: vec![u32::MAX; count], used: vec![0; count] };
    let mut blocks = Vec::with_capacity(chosen.len() / 4 + 8);
    let mut colours = Vec::new();
    let mut rest = by_level.as_slice();
    while let Some(&head) = rest.first() {
        let level = graph.contact_level(&contacts[head as usize]);
        let length = rest.partition_point(|&k| graph.contact_level(&contacts[k as usize]) == level);
        let (here, after) = rest.split_at(length);
        colours.clear();
        colours.extend(here.iter().map(|&k| colouring.colour(level, &contacts[k as usize], yields)));
        place(here, &colours, (contacts, yields), &mut blocks);
        rest = after;
    }
    blocks
}

/// Indices of the contacts by level; those of one level in their own order.
fn sorted_by_level(chosen: &[u32], graph: &ContactGraph, contacts: &[Ends]) -> Vec<u32> {
    let levels: Vec<u32> = chosen.iter().map(|&k| graph.contact_level(&contacts[k as usize])).collect();
    let top = levels.iter().copied().max().unwrap_or(0) as usize;
    let mut starts = vec![0u32; top + 2];
    for &l in &levels {
        starts[l as usize + 1] += 1;
    }
    for l in 0..=top {
        starts[l + 1] += starts[l];
    }
    let mut order = vec![0; chosen.len()];
    for (&k, &l) in chosen.iter().zip(&levels) {
        order[starts[l as usize] as usize] = k;
        starts[l as usize] += 1;
    }
    order
}

/// Greedy colours of one level after the other.
struct Colouring {
    /// The level for which `used` is valid.
    stamp: Vec<u32>,
    used: Vec<u64>,
}

impl Colouring {
    fn colour(&mut self, level: u32, contact: &Ends, yields: &[bool]) -> u8 {
        let ends = [contact.first as usize, contact.second as usize];
        let mut used = 0;
        for i in ends.into_iter().filter(|&i| yields[i]) {
            if self.stamp[i] != level {
                self.stamp[i] = level;
                self.used[i] = 0;
            }
            used |= self.used[i];
        }
        let colour = (!used).trailing_zeros().min(COLOURS as u32 - 1) as u8;
        for i in ends.into_iter().filter(|&i| yields[i]) {
            self.used[i] |= 1 << colour;
        }
        colour
    }
}

/// Puts the contacts of one level into blocks, colour by colour.
fn place(
    here: &[u32],
    colours: &[u8],
    (contacts, yields): (&[Ends], &[bool]),
    blocks: &mut Vec<Block<Portable>>,
) {
    let dummy = yields.len() as u32;
    const OVERFLOW: usize = COLOURS - 1;
    let mut count = [0usize; COLOURS];
    for &c in colours {
        count[c as usize] += 1;
    }
    let mut base = [0usize; COLOURS];
    let mut end = blocks.len();
    for c in 0..COLOURS {
        base[c] = end;
        end += if c == OVERFLOW { count[c] } else { count[c].div_ceil(LANES) };
    }
    blocks.resize(end, Block::empty(dummy));
    let mut filled = [0usize; COLOURS];
    for (&k, &c) in here.iter().zip(colours) {
        let c = c as usize;
        let (step, lane) =
            if c == OVERFLOW { (filled[c], 0) } else { (filled[c] / LANES, filled[c] % LANES) };
        filled[c] += 1;
        let block = &mut blocks[base[c] + step];
        let contact = &contacts[k as usize];
        block.first[lane] = contact.first;
        block.second[lane] = contact.second;
        let out = |body: u32| if yields[body as usize] { body } else { dummy + 1 };
        block.first_out[lane] = out(contact.first);
        block.second_out[lane] = out(contact.second);
        block.source[lane] = k;
    }
}
