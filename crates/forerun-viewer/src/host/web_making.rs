//! Making: what takes a while. A page has no thread for it: it is made at once, in a picture where it is not noticed if the caller can help it.

/// Something that was made.
#[derive(Debug)]
pub struct Making<T> {
    made: Option<T>,
}

/// Makes something.
#[must_use]
pub fn make<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Making<T> {
    Making { made: Some(work()) }
}

impl<T> Making<T> {
    /// What was made.
    ///
    /// # Errors
    /// None here.
    pub fn poll(&mut self) -> Option<Result<T, String>> {
        self.made.take().map(Ok)
    }
}
