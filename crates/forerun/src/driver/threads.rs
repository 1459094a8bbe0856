//! Threads: how many the physics may use.
//!
//! The result of a step does not depend on it; only its duration does.

use std::fmt;
use std::num::NonZeroU16;

/// A pool of threads that physics runs in.
pub struct Threads {
    pool: Option<rayon::ThreadPool>,
}

/// The system did not give us the threads.
#[derive(Debug)]
pub struct ThreadsError {
    wanted: NonZeroU16,
    cause: rayon::ThreadPoolBuildError,
}

impl fmt::Display for ThreadsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} physics threads cannot be started: {}; ask for fewer", self.wanted, self.cause)
    }
}

impl std::error::Error for ThreadsError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.cause)
    }
}

impl Threads {
    /// As many threads as the machine has cores, shared with everybody in the process.
    #[must_use]
    pub const fn all() -> Self {
        Threads { pool: None }
    }

    /// `count` threads of our own.
    ///
    /// # Errors
    /// When the system refuses to start them.
    pub fn exactly(count: NonZeroU16) -> Result<Self, ThreadsError> {
        rayon::ThreadPoolBuilder::new()
            .num_threads(usize::from(count.get()))
            .thread_name(|i| format!("forerun-step-{i}"))
            .build()
            .map(|pool| Threads { pool: Some(pool) })
            .map_err(|cause| ThreadsError { wanted: count, cause })
    }

    /// Does `work` inside the pool; parallel loops in it use the pool's threads.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

impl fmt::Debug for Threads {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.pool {
            Some(pool) => write!(f, "Threads({})", pool.current_num_threads()),
            None => f.write_str("Threads(all)"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_sees_as_many_threads_as_were_asked_for() {
        let three = NonZeroU16::new(3).expect("3 is not 0");
        let threads = Threads::exactly(three).expect("three threads are few");
        assert_eq!(threads.install(rayon::current_num_threads), 3);
    }
}
