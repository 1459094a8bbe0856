//! Roots: which of some things hang together, directly or by others.

/// Things by their numbers, each in a group with others; at first by itself.
pub(super) struct Roots {
    /// Of each thing one of its group with a lower number, itself for the lowest.
    parents: Vec<u32>,
}

impl Roots {
    pub(super) fn new(count: usize) -> Roots {
        Roots { parents: (0..count as u32).collect() }
    }

    /// The lowest of the group that a thing is in.
    pub(super) fn root(&mut self, mut thing: u32) -> u32 {
        while self.parents[thing as usize] != thing {
            // Halving the way keeps later ways short.
            let parent = self.parents[thing as usize];
            self.parents[thing as usize] = self.parents[parent as usize];
            thing = self.parents[thing as usize];
        }
        thing
    }

    /// Puts the groups of two things together. Returns whether they were apart.
    pub(super) fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
        a != b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_named_by_their_lowest_and_long_chains_take_no_longer() {
        let count = 1 << 19;
        let mut roots = Roots::new(count);
        // Neighbours in twos from the end: every link is below all before it.
        for k in (2..count as u32).rev() {
            assert!(roots.join(k, k - 2));
        }
        assert!((0..count as u32).all(|k| roots.root(k) == k % 2));
        assert!(!roots.join(4, 100) && roots.join(4, 101) && roots.root(7) == 0);
    }
}
