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
}

#[allow(clippy::disallowed_types, reason = "see above")]
impl WindowPace {
    pub(super) fn new() -> WindowPace {
        WindowPace { next: Instant::now(), stirred: Instant::now() }
    }

    /// Something happened: the next picture is due now.
    pub(super) fn stir(&mut self) {
        self.stirred = Instant::now();
        self.next = self.stirred;
    }

    /// A picture has been drawn; whether nothing in it moves.
    pub(super) fn drawn(&mut self, still: bool) {
        let now = Instant::now();
        let at_rest = still && now.duration_since(self.stirred) > STIRRED;
        self.next = if at_rest { now + STILL } else { now };
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
