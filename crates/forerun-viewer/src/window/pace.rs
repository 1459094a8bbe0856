//! When the next picture is drawn: at once while something moves, now and then while nothing does.

use std::time::Duration;

#[allow(
    clippy::disallowed_types,
    reason = "the window's event loop waits until moments of this clock; no physics sees it"
)]
use std::time::Instant;

use winit::event_loop::ControlFlow;

/// Between two pictures while nothing moves: files, dialogs and physics are looked at so often.
const STILL: Duration = Duration::from_millis(100);
/// After something happened, pictures follow each other for so long: menus open softly, tooltips come late.
const STIRRED: Duration = Duration::from_millis(700);

/// When the next picture is drawn.
#[derive(Debug)]
#[allow(clippy::disallowed_types, reason = "see above")]
pub(super) struct WindowPace {
    next: Instant,
    stirred: Instant,
    /// Whether the next picture is put off, as nothing moves.
    waits: bool,
}

#[allow(clippy::disallowed_types, reason = "see above")]
impl WindowPace {
    pub(super) fn new() -> WindowPace {
        WindowPace { next: Instant::now(), stirred: Instant::now(), waits: false }
    }

    /// Something happened: the next picture is due now.
    pub(super) fn stir(&mut self) {
        self.stirred = Instant::now();
        self.next = self.stirred;
    }

    /// A picture has been drawn; whether nothing in it moves.
    pub(super) fn drawn(&mut self, still: bool) {
        let now = Instant::now();
        self.waits = still && now.duration_since(self.stirred) > STIRRED;
        self.next = if self.waits { now + STILL } else { now };
    }

    /// Whether the picture that is drawn now was put off on purpose: how long it was after the one before tells nothing.
    pub(super) fn has_waited(&self) -> bool {
        self.waits
    }

    /// Whether the next picture is due.
    pub(super) fn is_due(&self) -> bool {
        Instant::now() >= self.next
    }

    /// How the event loop waits for it.
    pub(super) fn wait(&self) -> ControlFlow {
        if self.is_due() { ControlFlow::Poll } else { ControlFlow::WaitUntil(self.next) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_wait_only_when_nothing_moves_and_nothing_has_happened_for_a_while() {
        let mut pace = WindowPace::new();
        pace.drawn(true);
        assert!(pace.is_due() && !pace.has_waited(), "something has just happened");
        std::thread::sleep(STIRRED + Duration::from_millis(1));
        pace.drawn(false);
        assert!(pace.is_due() && !pace.has_waited(), "something moves");
        pace.drawn(true);
        assert!(!pace.is_due() && pace.has_waited());
        // A key wakes it; that picture, too, was put off.
        pace.stir();
        assert!(pace.is_due() && pace.has_waited());
        pace.drawn(true);
        assert!(pace.is_due() && !pace.has_waited());
    }
}
