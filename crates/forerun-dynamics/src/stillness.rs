//! Stillness: what the last step left at rest, and nobody comes near, need not be looked at again.
//!
//! This is memoisation, not memory: an island at a fixpoint stays as it is while its bodies, their states, the environment and whoever comes near are
//! the same. So a world that is asked for its states after every frame gives the same bits whether it forgets or not.

use crate::scratch::fill;
use crate::solver::Roots;
use crate::{BodyState, Environment, Member};

/// What a world knows of its bodies at rest.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stillness {
    /// By body: whether the last step found it in an island at a fixpoint, and nothing was changed from outside since.
    rested: Vec<bool>,
    /// Whether the last step left everybody as they were.
    everybody: bool,
    environment: Environment,
    roots: Roots,
    disturbed: Vec<bool>,
    /// By body: whether it rests and nobody comes near in the coming frame. Empty where nobody does.
    pub(crate) still: Vec<bool>,
}

impl Stillness {
    /// Something was changed from outside.
    pub(crate) fn forget(&mut self) {
        self.rested.clear();
        self.everybody = false;
    }

    /// Whether the coming step gives what the last gave: all states as they are.
    pub(crate) fn everybody(&self, environment: &Environment) -> bool {
        self.everybody && self.environment == *environment
    }

    /// Finds those who stay at rest in the coming frame, and takes their pairs out: whoever may meet one that moves does not, nor do those beside it.
    pub(crate) fn set_apart(
        &mut self,
        members: &[Member],
        environment: &Environment,
        pairs: &mut Vec<(u32, u32)>,
    ) {
        let Stillness { rested, roots, disturbed, still, .. } = self;
        still.clear();
        if self.environment != *environment || !rested.contains(&true) {
            return;
        }
        roots.separate(members.len());
        fill(disturbed, members.len(), false);
        let disturbs = |i: usize| {
            let member = &members[i];
            !rested[i] && (member.body.is_dynamic() || member.drives())
        };
        for &(i, j) in &*pairs {
            let (a, b) = (i as usize, j as usize);
            if rested[a] && rested[b] {
                roots.join(i, j);
            } else {
                disturbed[a] |= disturbs(b);
                disturbed[b] |= disturbs(a);
            }
        }
        roots.settle();
        for i in 0..members.len() {
            disturbed[roots.root(i)] |= disturbed[i];
        }
        still.extend((0..members.len()).map(|i| rested[i] && !disturbed[roots.root(i)]));
        pairs.retain(|&(i, j)| !still[i as usize] && !still[j as usize]);
    }

    /// Notes what a step found.
    pub(crate) fn note(
        &mut self,
        (before, after): (&[BodyState], &[BodyState]),
        resting: &[bool],
        environment: &Environment,
    ) {
        self.environment = *environment;
        self.rested.clear();
        self.rested.extend(resting);
        let stays = |((before, after), resting): ((&BodyState, &BodyState), &bool)| {
            // What is stopped again and again because it is not finite is reported again and again.
            *resting || before.same_bits(after) && after.is_finite()
        };
        self.everybody = before.iter().zip(after).zip(resting).all(stays);
    }
}
