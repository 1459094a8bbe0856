//! Order: pairs sorted by their first, then their second index.

/// A body with more partners than this has them sorted by ticking them off a list.
const MANY: usize = 48;

/// Memory for the sort.
#[derive(Clone, Debug, Default)]
pub(super) struct PairOrder {
    /// Where the pairs of a first index begin, then where they end.
    ends: Vec<u32>,
    /// One bit for each index.
    ticks: Vec<u64>,
}

impl PairOrder {
    /// A counting sort over the first, and a short sort for each. `sorted` is replaced.
    pub(super) fn sort(&mut self, pairs: &[(u32, u32)], count: usize, sorted: &mut Vec<(u32, u32)>) {
        let ends = &mut self.ends;
        ends.clear();
        ends.resize(count + 1, 0);
        for &(i, _) in pairs {
            ends[i as usize + 1] += 1;
        }
        for i in 0..count {
            ends[i + 1] += ends[i];
        }
        sorted.resize(pairs.len(), (0, 0));
        for &pair in pairs {
            let at = &mut ends[pair.0 as usize];
            sorted[*at as usize] = pair;
            *at += 1;
        }
        let mut start = 0;
        for &end in &ends[..count] {
            let partners = &mut sorted[start..end as usize];
            start = end as usize;
            match partners.len() {
                0 | 1 => {}
                2..=MANY => partners.sort_unstable_by_key(|pair| pair.1),
                _ => tick_off(&mut self.ticks, count, partners),
            }
        }
    }
}

/// Sorts pairs of one first index, whose second ones are below `count` and differ.
fn tick_off(ticks: &mut Vec<u64>, count: usize, pairs: &mut [(u32, u32)]) {
    ticks.clear();
    ticks.resize(count.div_ceil(64), 0);
    for &(_, j) in pairs.iter() {
        ticks[j as usize / 64] |= 1 << (j % 64);
    }
    let mut next = pairs.iter_mut();
    for (word, &bits) in ticks.iter().enumerate() {
        let mut bits = bits;
        while bits != 0 {
            if let Some(pair) = next.next() {
                pair.1 = word as u32 * 64 + bits.trailing_zeros();
            }
            bits &= bits - 1;
        }
    }
}
