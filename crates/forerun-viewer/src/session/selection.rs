//! Selection: the bodies that the user has picked.

use forerun::BodyId;

/// Bodies that were picked. The last one picked is the one that panels show.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// In the order in which they were picked.
    bodies: Vec<BodyId>,
    /// Are picked as soon as they are there.
    coming: Vec<BodyId>,
}

impl Selection {
    /// Picks one body and no other.
    pub fn pick(&mut self, body: BodyId) {
        self.pick_all([body]);
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
        self.coming.clear();
    }

    /// Picks these and no others, as soon as they are there: they were added at a frame that is not shown yet.
    pub fn pick_coming(&mut self, bodies: Vec<BodyId>) {
        self.coming = bodies;
    }

    /// Picks none.
    pub fn clear(&mut self) {
        self.pick_all([]);
    }

    /// Forgets those that are not there any more.
    pub fn keep(&mut self, there: impl Fn(BodyId) -> bool) {
        if self.coming.iter().any(|body| there(*body)) {
            let coming = std::mem::take(&mut self.coming);
            self.pick_all(coming);
        }
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
