//! Memory: which frames are kept.
//!
//! Promise: the display's frame and the next are kept whatever they cost. Beyond that the numbers of frames and the number of bytes are
//! budgets of their own: when bytes run out, the oldest past goes first, then the lookahead gets shorter.

use std::sync::Arc;

use forerun_dynamics::bounds;

use crate::areas::Until;
use crate::commanding::ignored;
use crate::{Frame, Timeline};

impl Timeline {
    /// Tells where the display is. Frames older than `past` before it are forgotten, unless the physics still needs them.
    pub fn set_display(&mut self, frame: Frame) {
        if frame != self.display {
            self.shrunk = false;
        }
        self.display = frame;
        let wanted = frame.minus(u64::from(self.settings.past));
        self.forget_before(wanted);
        self.memory_cut &= self.oldest() > wanted;
    }

    /// Whether another frame may be computed; past frames that stand in its way are forgotten.
    pub(crate) fn has_room(&mut self) -> bool {
        let Some(max) = self.settings.bytes_max else { return true };
        let needed = self.tables.last_bytes();
        self.forget_past(max.saturating_sub(needed));
        let fits = !self.shrunk && self.tables.bytes() + needed <= max;
        fits || self.horizon() < self.depth_min()
    }

    /// Forgets the oldest past, then the farthest future, until the states fit into memory.
    pub(crate) fn fit_memory(&mut self) {
        let Some(max) = self.settings.bytes_max else { return };
        self.forget_past(max);
        while self.tables.bytes() > max && self.horizon() > self.depth_min() {
            self.forget_after(self.horizon().minus(1));
            // Not tried again before the display has moved on.
            self.shrunk = true;
        }
    }

    /// Whether bytes bound what is kept.
    pub(crate) fn is_memory_bound(&self) -> bool {
        let full = |max: usize| self.tables.bytes() + self.tables.last_bytes() > max;
        self.shrunk || self.memory_cut || self.settings.bytes_max.is_some_and(full)
    }

    /// The last frame that is computed however little memory there is.
    fn depth_min(&self) -> Frame {
        self.display.max(self.oldest()).next()
    }

    fn forget_past(&mut self, bytes: usize) {
        while self.tables.bytes() > bytes && self.oldest() < self.display.min(self.valid_to().minus(1)) {
            self.forget_before(self.oldest().next());
            self.memory_cut = true;
        }
    }

    fn forget_before(&mut self, wanted: Frame) {
        let oldest = wanted.min(self.valid_to().minus(1));
        if oldest <= self.oldest() {
            return;
        }
        self.tables.forget_before(oldest);
        let commanded = match self.log.begins_by(oldest) {
            true => Arc::make_mut(&mut self.log).forget_to(oldest),
            false => Default::default(),
        };
        // Snapshots share the definitions: to touch them is to copy, so only where there is something to forget.
        if !commanded.is_empty() || self.definitions.has_gravity_before(oldest) {
            Arc::make_mut(&mut self.definitions).forget_before(oldest, commanded.into_iter());
        }
        // Also where no command is left of what was taken back.
        if self.undo.begins_by(oldest) {
            Arc::make_mut(&mut self.undo).forget_to(oldest);
        }
        if self.effects.keys().next().is_some_and(|first| *first <= oldest) {
            let effects = Arc::make_mut(&mut self.effects);
            *effects = effects.split_off(&oldest.next());
        }
        self.areas.forget_before(oldest);
    }

    /// Makes `last` the horizon, as if what lies beyond it had never been computed.
    fn forget_after(&mut self, last: Frame) {
        let now = Arc::clone(self.table(last));
        let environment = self.definitions.environment(last);
        for body in now.differences(self.table(self.horizon())) {
            let there = self.definitions.body(body, last).zip(now.get(body));
            let bound = there.map(|(body, state)| bounds::swept_bound(body, state, &environment));
            self.areas.visit(body, last, bound.as_ref(), Until::FurtherNotice);
        }
        self.tables.forget_after(last);
        self.stale.split_off(&last);
        if self.effects.keys().next_back().is_some_and(|latest| *latest > last) {
            let forgotten = Arc::make_mut(&mut self.effects).split_off(&last.next());
            self.stats.ignored -= forgotten.values().map(|effects| ignored(effects)).sum::<u64>();
        }
    }
}
