//! Clock: real time, or a hand-turned one for tests.
//!
//! Promise: readings never go backwards. *Architecture invariant:* no other room reads the time.

use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;
#[allow(clippy::disallowed_types, reason = "the driver's clock is the one place that reads time")]
use std::time::Instant;

/// Where a driver reads the time and waits. Clones show the same time.
#[derive(Clone, Debug)]
pub struct Clock {
    source: Source,
}

#[derive(Clone, Debug)]
enum Source {
    #[allow(clippy::disallowed_types, reason = "the driver's clock is the one place that reads time")]
    System(Instant),
    Hand(Arc<Hand>),
    Host(fn() -> f64),
}

#[derive(Debug, Default)]
struct Hand {
    now: Mutex<Duration>,
    turned: Condvar,
}

impl Clock {
    /// The system's monotonic clock, 0 now. WebAssembly has none: there it stands at 0, and [`Clock::host`] is the one to take.
    #[must_use]
    #[allow(clippy::disallowed_types, reason = "the driver's clock is the one place that reads time")]
    pub fn system() -> Self {
        if cfg!(target_family = "wasm") {
            return Clock::by_hand();
        }
        Clock { source: Source::System(Instant::now()) }
    }

    /// A clock that stands at 0 until somebody turns it.
    #[must_use]
    pub fn by_hand() -> Self {
        Clock { source: Source::Hand(Arc::default()) }
    }

    /// A clock that the host has: seconds that never go back, since some moment. For where there is no system clock, as in a browser.
    #[must_use]
    pub fn host(seconds: fn() -> f64) -> Self {
        Clock { source: Source::Host(seconds) }
    }

    /// Time since the clock was made, or since the host's own beginning.
    #[must_use]
    pub fn now(&self) -> Duration {
        match &self.source {
            Source::System(start) => start.elapsed(),
            // A panic elsewhere leaves a Duration whole, so a poisoned lock is as good as any.
            Source::Hand(hand) => *hand.now.lock().unwrap_or_else(PoisonError::into_inner),
            Source::Host(seconds) => Duration::try_from_secs_f64(seconds()).unwrap_or_default(),
        }
    }

    /// Turns a hand-turned clock on, and wakes who waits for it. The system clock turns by itself: nothing happens.
    pub fn turn(&self, by: Duration) {
        if let Source::Hand(hand) = &self.source {
            *hand.now.lock().unwrap_or_else(PoisonError::into_inner) += by;
            hand.turned.notify_all();
        }
    }

    /// Sleeps until the clock shows `time`; returns at once if it does already.
    ///
    /// On a hand-turned clock somebody else must turn it. A host's clock is watched without a pause: where there is no sleep, that is how to wait.
    pub fn wait_until(&self, time: Duration) {
        match &self.source {
            Source::System(start) => {
                std::thread::sleep(time.saturating_sub(start.elapsed()));
            }
            Source::Host(_) => {
                while self.now() < time {
                    std::hint::spin_loop();
                }
            }
            Source::Hand(hand) => {
                let mut now = hand.now.lock().unwrap_or_else(PoisonError::into_inner);
                while *now < time {
                    now = hand.turned.wait(now).unwrap_or_else(PoisonError::into_inner);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_turned_clock_stands_still_until_turned() {
        let clock = Clock::by_hand();
        assert_eq!(clock.now(), Duration::ZERO);
        clock.turn(Duration::from_millis(30));
        assert_eq!(clock.now(), Duration::from_millis(30));
    }

    #[test]
    fn who_waits_is_woken_by_the_turn_that_reaches_the_time() {
        let clock = Clock::by_hand();
        let waiter = std::thread::spawn({
            let clock = clock.clone();
            move || {
                clock.wait_until(Duration::from_secs(2));
                clock.now()
            }
        });
        clock.turn(Duration::from_secs(1));
        clock.turn(Duration::from_secs(1));
        assert_eq!(waiter.join().ok(), Some(Duration::from_secs(2)));
    }

    #[test]
    fn the_system_clock_waits_and_never_goes_back() {
        let clock = Clock::system();
        let before = clock.now();
        clock.wait_until(before + Duration::from_millis(5));
        assert!(clock.now() >= before + Duration::from_millis(5));
        clock.wait_until(before);
    }
}
