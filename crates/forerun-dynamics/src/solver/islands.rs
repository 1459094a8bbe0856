//! Islands: dynamic bodies joined by contacts. Fixed and kinematic bodies belong to every island that they touch, and join none.

use super::batch::Ends;

/// For each body the lowest body of its island.
#[derive(Clone, Debug, Default)]
pub(crate) struct Roots {
    root: Vec<u32>,
}

impl Roots {
    /// Everybody is an island.
    pub(crate) fn separate(&mut self, count: usize) {
        self.root.clear();
        self.root.extend(0..count as u32);
    }

    /// Makes one island of two.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        // The lower body is the root: the label does not depend on the order of the contacts.
        let (low, high) = (a.min(b), a.max(b));
        self.root[high as usize] = low;
    }

    /// Once all are joined: [`Roots::root`] may be asked.
    pub(crate) fn settle(&mut self) {
        // The root is lower, and settled before.
        for i in 0..self.root.len() {
            self.root[i] = self.root[self.root[i] as usize];
        }
    }

    /// The lowest body of the island that body `i` is in.
    pub(crate) fn root(&self, i: usize) -> usize {
        self.root[i] as usize
    }

    fn find(&mut self, mut i: u32) -> u32 {
        let root = &mut self.root;
        while root[i as usize] != i {
            let above = root[root[i as usize] as usize];
            root[i as usize] = above;
            i = above;
        }
        i
    }
}

/// For each body of a batch the number of its island; those that do not yield share a number of their own.
#[derive(Debug, Default)]
pub(crate) struct Islands {
    number: Vec<u32>,
    count: u32,
    roots: Roots,
}

impl Islands {
    /// Islands of so many bodies each, one after the other, and then `others` that do not yield.
    pub(crate) fn in_rows(&mut self, sizes: impl Iterator<Item = usize>, others: usize) {
        self.number.clear();
        self.count = 0;
        for size in sizes {
            self.number.resize(self.number.len() + size, self.count);
            self.count += 1;
        }
        self.number.resize(self.number.len() + others, self.count);
    }

    /// The islands of bodies, of which the first `dynamic` yield, under these contacts (index pairs).
    pub(crate) fn find(&mut self, dynamic: usize, others: usize, contacts: impl Iterator<Item = (u32, u32)>) {
        self.roots.separate(dynamic);
        for (a, b) in contacts {
            if (a as usize) < dynamic && (b as usize) < dynamic {
                self.roots.join(a, b);
            }
        }
        self.roots.settle();
        self.number.clear();
        self.count = 0;
        for i in 0..dynamic {
            let root = self.roots.root(i);
            if root == i {
                self.number.push(self.count);
                self.count += 1;
            } else {
                self.number.push(self.number[root]);
            }
        }
        self.number.resize(dynamic + others, self.count);
    }

    /// The number of the island that body `i` is in.
    pub(crate) fn root(&self, i: usize) -> usize {
        self.number[i] as usize
    }

    /// The number of the island that a contact belongs to.
    pub(crate) fn of(&self, ends: &Ends) -> usize {
        // Bodies that do not yield have the highest number.
        self.root(ends.first as usize).min(self.root(ends.second as usize))
    }

    /// By body: the number of its island.
    pub(crate) fn numbers(&self) -> &[u32] {
        &self.number
    }

    /// How many islands there are.
    pub(crate) fn count(&self) -> usize {
        self.count as usize
    }
}
