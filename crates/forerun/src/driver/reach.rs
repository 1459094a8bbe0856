//! Reach: how far ahead physics computes while the user keeps changing things.
//!
//! A user who drags a body changes it on every picture, and each change throws away what was computed after it (the dissertation's closing
//! remark, chapter 6). So each batch of commands that comes before physics was through with the one before shortens the reach, and each picture
//! lets it grow again: a drag that costs little keeps the queue full, one that costs much keeps it short, and a single push does nothing to it.

/// Frames ahead that are worth computing now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Reach {
    frames: u32,
    full: u32,
}

/// Never less than this (or the whole lookahead): what carries the display over a few slow frames.
const FRAMES_MIN: u32 = 10;

impl Reach {
    /// The whole lookahead.
    pub(super) const fn new(lookahead: u32) -> Self {
        Reach { frames: lookahead, full: lookahead }
    }

    pub(super) const fn frames(self) -> u32 {
        self.frames
    }

    /// Commands came before all was done.
    pub(super) fn shorten(&mut self) {
        self.frames = (self.frames / 4).max(FRAMES_MIN.min(self.full));
    }

    /// A picture was shown.
    pub(super) fn grow(&mut self) {
        self.frames = self.frames.saturating_add(self.frames / 2 + 1).min(self.full);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_command_is_soon_forgotten_and_a_drag_keeps_it_short() {
        let mut reach = Reach::new(100);
        reach.shorten();
        assert_eq!(reach.frames(), 25);
        let grown: Vec<u32> = (0..5)
            .map(|_| {
                reach.grow();
                reach.frames()
            })
            .collect();
        assert_eq!(grown, [38, 58, 88, 100, 100]);
        for _ in 0..10 {
            reach.shorten();
            reach.grow();
        }
        assert_eq!(reach.frames(), 16);
    }

    #[test]
    fn a_short_lookahead_is_never_exceeded() {
        let mut reach = Reach::new(3);
        reach.shorten();
        assert_eq!(reach.frames(), 3);
        reach.grow();
        assert_eq!(reach.frames(), 3);
    }

    #[test]
    fn the_longest_lookahead_is_grown_back_to() {
        let mut reach = Reach::new(u32::MAX);
        reach.grow();
        assert_eq!(reach.frames(), u32::MAX);
        reach.shorten();
        for _ in 0..5 {
            reach.grow();
        }
        assert_eq!(reach.frames(), u32::MAX);
    }
}
