//! News: the last thing that the user is to be told, and how many there were: the same may be said twice.

/// What was told last, and how often something was.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct News<T> {
    last: Option<T>,
    count: u64,
}

impl<T> Default for News<T> {
    fn default() -> Self {
        News { last: None, count: 0 }
    }
}

impl<T> News<T> {
    /// Tells something.
    pub fn tell(&mut self, news: T) {
        self.last = Some(news);
        self.count += 1;
    }

    /// It is no longer so.
    pub fn forget(&mut self) {
        self.last = None;
    }

    /// What was told last.
    #[must_use]
    pub fn last(&self) -> Option<&T> {
        self.last.as_ref()
    }

    /// What was told last, unless nothing was since there were so many, which are then so many as there are.
    pub fn since(&self, heard: &mut u64) -> Option<&T> {
        let new = std::mem::replace(heard, self.count) != self.count;
        self.last.as_ref().filter(|_| new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_twice_is_heard_twice_and_each_once() {
        let (mut news, mut heard) = (News::default(), 0);
        assert_eq!(news.since(&mut heard), None);
        for _ in 0..2 {
            news.tell("no");
            assert_eq!(news.since(&mut heard), Some(&"no"));
            assert_eq!(news.since(&mut heard), None);
        }
        news.tell("no");
        news.forget();
        assert_eq!((news.since(&mut heard), news.last()), (None, None));
    }
}
