//! Threads: how many the physics may use.
//!
//! The result of a step does not depend on it; only its duration does.

use std::fmt;
use std::num::NonZeroU16;

/// A pool of threads that physics runs in.
#[derive(Debug)]
pub struct Threads {
    /// `None` where there are no threads: in WebAssembly all is done on the caller's.
    pool: Option<rayon::ThreadPool>,
}

/// The system did not give us the threads.
#[derive(Debug)]
pub struct ThreadsError {
    cause: rayon::ThreadPoolBuildError,
}

impl fmt::Display for ThreadsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the physics threads cannot be started: {}; ask for fewer", self.cause)
    }
}

impl std::error::Error for ThreadsError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.cause)
    }
}

impl Threads {
    /// As many threads as the machine has cores.
    ///
    /// # Errors
    /// When the system refuses to start them.
    pub fn all() -> Result<Self, ThreadsError> {
        // To rayon, 0 means one per core.
        Self::build(0)
    }

    /// So many threads.
    ///
    /// # Errors
    /// When the system refuses to start them.
    pub fn exactly(count: NonZeroU16) -> Result<Self, ThreadsError> {
        Self::build(usize::from(count.get()))
    }

    fn build(count: usize) -> Result<Self, ThreadsError> {
        if cfg!(target_family = "wasm") {
            return Ok(Threads { pool: None });
        }
        rayon::ThreadPoolBuilder::new()
            .num_threads(count)
            .thread_name(|i| format!("forerun-step-{i}"))
            .build()
            .map(|pool| Threads { pool: Some(pool) })
            .map_err(|cause| ThreadsError { cause })
    }

    /// Does `work` on a thread of the pool; parallel loops in it use the others too.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
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
