//! Machine: what of a late picture is not ours. Processors that others use, memory, busy threads.
//!
//! A thread beside the display sleeps from picture to picture and does nothing else. Where it is late too, or the display thread was ready
//! to run and was given no processor, the machine was late, and not a display that waited for something.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use forerun::Clock;
use serde::Serialize;

/// How late a series of pictures was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Lateness {
    /// Intervals longer than two of what they should be.
    pub(crate) late: u64,
    /// Milliseconds.
    pub(crate) interval_p999_ms: f64,
    /// Milliseconds.
    pub(crate) interval_max_ms: f64,
}

impl Lateness {
    /// Of intervals in seconds; late are those over `limit_s`.
    pub(crate) fn of(intervals_s: &[f64], limit_s: f64) -> Lateness {
        let mut sorted = intervals_s.to_vec();
        sorted.sort_by(f64::total_cmp);
        let rank = (0.999 * sorted.len() as f64).ceil() as usize;
        let at = |place: usize| sorted.get(place.wrapping_sub(1)).map_or(0.0, |s| 1000.0 * s);
        Lateness {
            late: sorted.iter().filter(|s| **s > limit_s).count() as u64,
            interval_p999_ms: at(rank),
            interval_max_ms: at(sorted.len()),
        }
    }
}

/// A thread that sleeps from picture to picture.
#[derive(Debug)]
pub(crate) struct Sleeper {
    stopping: Arc<AtomicBool>,
    thread: JoinHandle<Vec<(f64, f64)>>,
}

impl Sleeper {
    /// Sleeps against the same clock as the display. `None` when the system gives no thread.
    pub(crate) fn start(clock: &Clock, interval: Duration) -> Option<Sleeper> {
        let stopping = Arc::new(AtomicBool::new(false));
        let (clock, stop) = (clock.clone(), Arc::clone(&stopping));
        let sleep = move || {
            let mut naps = Vec::new();
            let mut last = clock.now();
            while !stop.load(Ordering::Relaxed) {
                clock.wait_until(last + interval);
                let now = clock.now();
                naps.push((last.as_secs_f64(), now.as_secs_f64()));
                last = now;
            }
            naps
        };
        let thread = std::thread::Builder::new().name("soak-sleeper".to_owned()).spawn(sleep).ok()?;
        Some(Sleeper { stopping, thread })
    }

    /// From when to when each nap was. Seconds. On a hand-turned clock somebody has to turn it on once more.
    pub(crate) fn stop(self, clock: &Clock, interval: Duration) -> Vec<(f64, f64)> {
        self.stopping.store(true, Ordering::Relaxed);
        clock.turn(interval);
        // It does nothing that could panic.
        self.thread.join().unwrap_or_default()
    }
}

/// Threads that keep processors busy.
#[derive(Debug)]
pub(crate) struct Hogs {
    stopping: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Hogs {
    pub(crate) fn start(count: u16) -> Hogs {
        let stopping = Arc::new(AtomicBool::new(false));
        let hog = |index: u16| {
            let stop = Arc::clone(&stopping);
            let name = format!("soak-hog-{index}");
            let burn = move || {
                while !stop.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            };
            std::thread::Builder::new().name(name).spawn(burn).ok()
        };
        let threads = (0..count).filter_map(hog).collect();
        Hogs { stopping, threads }
    }
}

impl Drop for Hogs {
    fn drop(&mut self) {
        self.stopping.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // A hog does nothing that could panic.
            let _ = thread.join();
        }
    }
}

/// What this thread had of its processor so far. Seconds.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Share {
    /// It ran.
    pub(crate) ran_s: f64,
    /// It was ready to run and had none.
    pub(crate) waited_s: f64,
}

impl Share {
    /// So far, where the system tells it (Linux); else zeros, which explain nothing.
    pub(crate) fn now() -> Share {
        let text = fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
        let mut seconds = text.split_whitespace().map(|field| 1e-9 * field.parse().unwrap_or(0.0));
        Share { ran_s: seconds.next().unwrap_or(0.0), waited_s: seconds.next().unwrap_or(0.0) }
    }
}

/// Memory that is resident, where the system tells it (Linux). MiB.
pub(crate) fn resident_mib() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lateness_counts_what_is_over_the_limit() {
        let mut intervals = vec![0.016; 1999];
        intervals.push(0.05);
        let lateness = Lateness::of(&intervals, 0.033);
        assert_eq!(lateness, Lateness { late: 1, interval_p999_ms: 16.0, interval_max_ms: 50.0 });
        assert_eq!(Lateness::of(&[], 0.033), Lateness::default());
    }

    #[test]
    fn the_sleeper_says_how_long_its_naps_were() {
        let clock = Clock::by_hand();
        let interval = Duration::from_millis(10);
        let sleeper = Sleeper::start(&clock, interval).expect("a thread");
        let naps = sleeper.stop(&clock, interval);
        assert!(naps.iter().all(|(from, to)| to - from >= 0.01), "{naps:?}");
    }
}
