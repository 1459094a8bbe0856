//! Making: what takes a while and nobody waits for, in a thread of its own.

use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Something that is being made.
#[derive(Debug)]
pub struct Making<T> {
    made: Receiver<T>,
}

/// Begins to make something.
#[must_use]
pub fn make<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Making<T> {
    let (sender, made) = channel();
    // When nobody waits for it any more, it is not wanted.
    std::thread::spawn(move || drop(sender.send(work())));
    Making { made }
}

impl<T> Making<T> {
    /// What was made, once it is.
    ///
    /// # Errors
    /// When that ended early.
    pub fn poll(&mut self) -> Option<Result<T, String>> {
        match self.made.try_recv() {
            Ok(made) => Some(Ok(made)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err("the thread that makes it has ended early".to_owned()))
            }
        }
    }
}
