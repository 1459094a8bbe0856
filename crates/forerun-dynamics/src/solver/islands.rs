//! Islands: dynamic bodies joined by contacts. Fixed and kinematic bodies belong to every island that they touch, and join none.

/// For each body the lowest body of its island.
#[derive(Debug, Default)]
pub(crate) struct Islands {
    root: Vec<u32>,
}

impl Islands {
    /// The islands of `count` bodies under these contacts (index pairs).
    pub(crate) fn find(
        count: usize,
        dynamic: impl Fn(usize) -> bool,
        contacts: impl Iterator<Item = (u32, u32)>,
    ) -> Islands {
        let mut root: Vec<u32> = (0..count as u32).collect();
        for (a, b) in contacts {
            if dynamic(a as usize) && dynamic(b as usize) {
                let (a, b) = (find(&mut root, a), find(&mut root, b));
                // The lower body is the root: the label does not depend on the order of the contacts.
                let (low, high) = (a.min(b), a.max(b));
                root[high as usize] = low;
            }
        }
        for i in 0..count as u32 {
            root[i as usize] = find(&mut root, i);
        }
        Islands { root }
    }

    /// The lowest body of the island that body `i` is in.
    pub(crate) fn root(&self, i: usize) -> usize {
        self.root[i] as usize
    }
}

fn find(root: &mut [u32], mut i: u32) -> u32 {
    while root[i as usize] != i {
        let above = root[root[i as usize] as usize];
        root[i as usize] = above;
        i = above;
    }
    i
}
