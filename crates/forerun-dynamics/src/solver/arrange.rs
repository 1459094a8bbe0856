//! Arrange: which contact goes into which lane of which block.

use super::batch::Ends;
use super::blocks::Arranged;
use super::contact_graph::ContactGraph;
use super::points::Kind;
use crate::lanes::LANES;

/// Colours within a level. Contacts that find no free colour get a block each.
const COLOURS: usize = 64;
const OVERFLOW: usize = COLOURS - 1;

/// What the order of the contacts follows from.
#[derive(Clone, Copy)]
pub(crate) struct Order<'a> {
    pub(crate) graph: &'a ContactGraph,
    pub(crate) contacts: &'a [Ends],
    /// By body: whether impulses move it.
    pub(crate) yields: &'a [bool],
}

/// Memory for arranging.
#[derive(Debug, Default)]
pub(crate) struct Arranger {
    levels: Vec<u32>,
    starts: Vec<u32>,
    by_level: Vec<u32>,
    colouring: Colouring,
    colours: Vec<u8>,
}

/// Greedy colours of one level after the other.
#[derive(Debug, Default)]
struct Colouring {
    /// The level for which `used` is valid.
    stamp: Vec<u32>,
    used: Vec<u64>,
}

impl Arranger {
    /// Forgets the colours of all bodies.
    pub(crate) fn begin(&mut self, bodies: usize) {
        self.colouring.stamp.clear();
        self.colouring.stamp.resize(bodies, u32::MAX);
        self.colouring.used.resize(bodies, 0);
    }

    /// Adds blocks for the chosen contacts (indices, rising) of whole islands, in the order in which they are solved; only indices are filled in.
    pub(crate) fn add<K: Kind>(&mut self, chosen: &[u32], order: &Order, out: &mut Arranged<K>) {
        self.sort_by_level(chosen, order);
        out.reserve(chosen.len().div_ceil(LANES) + chosen.len() / 32 + self.starts.len());
        let level_of = |k: u32| order.graph.contact_level(&order.contacts[k as usize]);
        let mut from = 0;
        while from < self.by_level.len() {
            let level = level_of(self.by_level[from]);
            let end = self.starts[level as usize] as usize;
            let here = &self.by_level[from..end];
            self.colours.clear();
            for &k in here {
                self.colours.push(self.colouring.colour(level, &order.contacts[k as usize], order.yields));
            }
            place(here, &self.colours, order, out);
            from = end;
        }
    }

    /// Contacts by level; those of one level in their own order. `starts` ends as the end of each level.
    fn sort_by_level(&mut self, chosen: &[u32], order: &Order) {
        self.levels.clear();
        self.levels.extend(chosen.iter().map(|&k| order.graph.contact_level(&order.contacts[k as usize])));
        let top = self.levels.iter().copied().max().unwrap_or(0) as usize;
        self.starts.clear();
        self.starts.resize(top + 2, 0);
        for &level in &self.levels {
            self.starts[level as usize + 1] += 1;
        }
        for level in 0..=top {
            self.starts[level + 1] += self.starts[level];
        }
        self.by_level.resize(chosen.len(), 0);
        for (&k, &level) in chosen.iter().zip(&self.levels) {
            let next = &mut self.starts[level as usize];
            self.by_level[*next as usize] = k;
            *next += 1;
        }
    }
}

impl Colouring {
    fn colour(&mut self, level: u32, contact: &Ends, yields: &[bool]) -> u8 {
        let ends = [contact.first as usize, contact.second as usize];
        let mut used = 0;
        for i in ends {
            if yields[i] {
                if self.stamp[i] != level {
                    self.stamp[i] = level;
                    self.used[i] = 0;
                }
                used |= self.used[i];
            }
        }
        let colour = (!used).trailing_zeros().min(OVERFLOW as u32) as u8;
        for i in ends {
            if yields[i] {
                self.used[i] |= 1 << colour;
            }
        }
        colour
    }
}

/// Puts the contacts of one level into blocks, colour by colour.
fn place<K: Kind>(here: &[u32], colours: &[u8], order: &Order, out: &mut Arranged<K>) {
    let dummy = order.yields.len() as u32;
    let mut count = [0u32; COLOURS];
    for &c in colours {
        count[c as usize] += 1;
    }
    // First block of each colour, and how many contacts are already in its blocks.
    let mut base = [0u32; COLOURS];
    for c in (0..COLOURS).filter(|&c| count[c] > 0) {
        base[c] = out.count as u32;
        let blocks = if c == OVERFLOW { count[c] } else { count[c].div_ceil(LANES as u32) };
        for k in 0..blocks {
            // Contacts without a colour may share bodies: each is a run of its own.
            if k == 0 || c == OVERFLOW {
                out.runs.push(out.count as u32);
            }
            out.add(dummy);
        }
    }
    let mut filled = [0u32; COLOURS];
    for (&k, &c) in here.iter().zip(colours) {
        let c = c as usize;
        let at = filled[c] as usize;
        filled[c] += 1;
        let (step, lane) = if c == OVERFLOW { (at, 0) } else { (at / LANES, at % LANES) };
        let block = &mut out.blocks[base[c] as usize + step];
        let contact = &order.contacts[k as usize];
        let written = |body: u32| if order.yields[body as usize] { body } else { dummy + 1 };
        block.first_row[lane] = contact.first;
        block.second_row[lane] = contact.second;
        block.first_out[lane] = written(contact.first);
        block.second_out[lane] = written(contact.second);
        out.details[base[c] as usize + step].source[lane] = k;
    }
}
