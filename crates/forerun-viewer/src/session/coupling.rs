//! Coupling: the same scene under the traditional driver, for comparison, and back. One switch; what is shown goes on from where it is.

use std::time::Duration;

use forerun::{Coupled, Decoupled, StepLimits};

use super::Play;
use crate::host::Host;

impl Play {
    /// Whether the traditional driver plays: it has neither a past nor a future, and who shows a picture waits for its step.
    #[must_use]
    pub fn is_coupled(&self) -> bool {
        self.coupled.is_some()
    }

    /// The traditional driver, in coupled mode.
    #[must_use]
    pub fn coupled(&self) -> Option<&Coupled> {
        self.coupled.as_ref()
    }

    /// The scene goes on from the state shown under the traditional driver. What was done before cannot be taken back any more.
    pub(super) fn couple(&mut self, host: &Host) -> Result<(), String> {
        let snapshot = &self.picture.snapshot;
        let threads = host.threads()?;
        let coupled =
            Coupled::of_snapshot(snapshot, self.picture.time_s, host.clock(), threads, StepLimits::default())
                .map_err(|error| error.to_string())?;
        self.coupled = Some(coupled.with_stage_times());
        self.rewinding = false;
        if self.to_undo().1 + self.to_redo().1 > 0 {
            let why = "the other driver goes on from the states that are shown, and knows no commands";
            self.notice.tell(format!("What was done so far cannot be undone any more: {why}."));
        }
        self.forget_the_future();
        Ok(())
    }

    /// A timeline goes on from the state shown; the driver before is returned, to be ended.
    pub(super) fn decouple(&mut self, host: &Host) -> Result<Option<Decoupled>, String> {
        let Some(coupled) = self.coupled.take() else { return Ok(None) };
        let restarted = coupled
            .timeline(host.timeline_settings())
            .map_err(|error| error.to_string())
            .and_then(|timeline| host.restart(timeline));
        match restarted {
            Ok((driver, link)) => {
                self.link = link;
                let before = std::mem::replace(&mut self.driver, driver);
                self.picture = self.driver.last_picture();
                self.forget_the_future();
                Ok(Some(before))
            }
            Err(message) => {
                self.coupled = Some(coupled);
                Err(message)
            }
        }
    }

    fn forget_the_future(&mut self) {
        self.history.clear();
        self.editing = None;
        self.questions = super::questions::Questions::default();
        self.tell_speed();
    }

    /// One cycle of the traditional driver, at the session's clock (seconds): the step, and then what there is to show. It takes as long by that clock as it
    /// did by the machine's: a film, whose clock goes on by one picture at a time, stutters as the window does.
    pub(super) fn show_coupled(&mut self, real_s: f64) {
        let Some(coupled) = &mut self.coupled else { return };
        if self.paused {
            coupled.pause();
        } else if coupled.is_due(real_s) {
            coupled.show_at(real_s);
        }
        self.picture = coupled.picture();
        coupled.sample_all(&mut self.samples);
    }

    /// Makes every step of the traditional driver this much slower.
    pub(super) fn slow_coupled(&mut self, slow_down: Duration) {
        self.coupled = self.coupled.take().map(|coupled| coupled.with_slow_down(slow_down));
    }
}
