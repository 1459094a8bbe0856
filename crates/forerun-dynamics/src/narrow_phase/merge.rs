//! Merge: contacts found in two ways, in the order of their pairs.

use super::Contact;

/// Adds `more` to `contacts`. Both are in the order of their pairs, and no pair is in both; several contacts of a pair stay in their order.
pub(super) fn insert(contacts: &mut Vec<Contact>, more: &[Contact]) {
    let Some(&last) = more.last() else { return };
    let (mut from, mut to) = (contacts.len(), contacts.len() + more.len());
    contacts.resize(to, last);
    let key = |contact: &Contact| (contact.first, contact.second);
    // From the end, so that nothing is overwritten that is still to be moved.
    for contact in more.iter().rev() {
        while from > 0 && key(&contacts[from - 1]) > key(contact) {
            from -= 1;
            to -= 1;
            contacts[to] = contacts[from];
        }
        to -= 1;
        contacts[to] = *contact;
    }
}

#[cfg(test)]
mod tests {
    use forerun_geometry::{ContactPoint, Manifold, Vec3};

    use super::*;

    /// The number tells several contacts of a pair apart.
    fn contact(&(first, second, count): &(u32, u32, u32)) -> Contact {
        let point = ContactPoint { position: Vec3::ZERO, normal: Vec3::Y, separation: 0.0 };
        Contact { first, second, manifold: Manifold { normal: Vec3::Y, points: [point; 4], count } }
    }

    fn check(a: &[(u32, u32, u32)], b: &[(u32, u32, u32)]) {
        let mut merged: Vec<Contact> = a.iter().map(contact).collect();
        insert(&mut merged, &b.iter().map(contact).collect::<Vec<_>>());
        let mut expected: Vec<Contact> = a.iter().chain(b).map(contact).collect();
        expected.sort_by_key(|c| (c.first, c.second));
        assert_eq!(merged, expected);
    }

    #[test]
    fn two_lists_become_one() {
        let (a, b) = ([(0, 1, 1), (2, 5, 1), (2, 9, 1)], [(0, 3, 1), (0, 3, 2), (0, 3, 3), (7, 8, 1)]);
        check(&a, &b);
        check(&b, &a);
        check(&a, &[]);
        check(&[], &b);
        check(&a, &[(3, 4, 1)]);
        check(&a, &[(0, 0, 1)]);
    }
}
