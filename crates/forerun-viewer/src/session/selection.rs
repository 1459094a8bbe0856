//! Selection: the bodies that the user has picked.

use forerun::BodyId;

/// Bodies that were picked. The last one picked is the one that panels show.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// In the order in which they were picked.
    bodies: Vec<BodyId>,
}

impl Selection {
    /// Picks one body and no other.
    pub fn pick(&mut self, body: BodyId) {
        self.bodies = vec![body];
    }

    /// Picks one more, or no longer.
    pub fn toggle(&mut self, body: BodyId) {
        match self.bodies.iter().position(|picked| *picked == body) {
            Some(at) => drop(self.bodies.remove(at)),
            None => self.bodies.push(body),
        }
    }

    /// Picks these and no others.
    pub fn pick_all(&mut self, bodies: impl IntoIterator<Item = BodyId>) {
        self.bodies = bodies.into_iter().collect();
    }

    /// Picks none.
    pub fn clear(&mut self) {
        self.bodies.clear();
    }

    /// Forgets those that are not there any more.
    pub fn keep(&mut self, there: impl Fn(BodyId) -> bool) {
        self.bodies.retain(|body| there(*body));
    }

    /// The body that panels show.
    #[must_use]
    pub fn active(&self) -> Option<BodyId> {
        self.bodies.last().copied()
    }

    /// All of them, in the order in which they were picked.
    #[must_use]
    pub fn bodies(&self) -> &[BodyId] {
        &self.bodies
    }

    /// Whether a body is picked.
    #[must_use]
    pub fn has(&self, body: BodyId) -> bool {
        self.bodies.contains(&body)
    }
}
