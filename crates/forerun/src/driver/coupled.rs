//! Coupled: the traditional model, step then show, for comparison (dissertation, section 3.1).
//!
//! Each cycle computes one frame and shows it. The time step of a cycle is what the cycle before took in real time,
//! Δt(n) = T_C(n-1) + T_E(n-1), so a slow step makes the next one long, and imprecise; hence the limits.

use std::time::Duration;

use std::sync::Arc;

use forerun_timeline::{Certainty, Change, PartsError, Sample, Snapshot, Stats, Timeline, TimelineSettings};

use super::direct_change::{ChangeError, apply};
use super::driver_error::DriverError;
use super::frame_notes::FrameNote;
use super::picture::Picture;
use super::stage_times::{StageTimes, StageWatch};
use crate::dynamics::{StepReport, Unobserved, World};
use crate::{BodyDef, BodyId, BodyState, Clock, Frame, Threads};
pub(super) use cast::Cast;

/// A display's clock may leave out the rest of a longer cycle: who waits for longer may be asleep.
const CYCLE_MAX: Duration = Duration::from_secs(1);

/// What the sum of many times may be wrong by.
const HAIR: Duration = Duration::from_micros(10);

/// Between which lengths a time step is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepLimits {
    /// Shortest step. Seconds, 0.00001 or more.
    pub min_s: f64,
    /// Longest step. Seconds, from `min_s` to 1. A cycle that takes longer leaves the animation behind real time for good.
    pub max_s: f64,
}

impl StepLimits {
    fn check(&self) -> Result<(), DriverError> {
        let StepLimits { min_s, max_s } = *self;
        let (shortest, longest) = (0.000_01, 1.0);
        let refused = |field, message| Err(DriverError::Setting { field, message });
        if !(shortest..=longest).contains(&min_s) {
            return refused("min_s", format!("must be from {shortest} to {longest}, is {min_s}"));
        }
        if !(min_s..=longest).contains(&max_s) {
            return refused("max_s", format!("must be from min_s ({min_s}) to {longest}, is {max_s}"));
        }
        Ok(())
    }
}

impl Default for StepLimits {
    /// 1 ms to 42 ms: the dissertation wants 24 pictures per second, and no step that shows less than that.
    fn default() -> Self {
        StepLimits { min_s: 0.001, max_s: 0.042 }
    }
}

/// The traditional driver. It has no queue: the physics time is the display time, and whoever shows a picture waits for it.
#[derive(Debug)]
pub struct Coupled {
    world: World,
    clock: Clock,
    threads: Threads,
    limits: StepLimits,
    slow_down: Duration,
    cycle_start: Option<Duration>,
    /// How long the last step took.
    cost: Duration,
    time_s: f64,
    /// When the first cycle since the last pause began, and the time that was shown then.
    began: Option<(Duration, f64)>,
    /// Length of the last step against that of its cycle.
    rate: f64,
    slices_max: u32,
    cast: Cast,
    stage_watch: Option<StageWatch>,
    stage_times: StageTimes,
}

impl Coupled {
    /// A driver for `world`, whose present states are those of time 0.
    ///
    /// # Errors
    /// When a limit is out of its range, or the world's environment is one that no step can be done in.
    pub fn new(
        world: World,
        clock: Clock,
        threads: Threads,
        limits: StepLimits,
    ) -> Result<Self, DriverError> {
        let cast = Cast::of(&world);
        Self::of_cast((world, cast), 0.0, clock, threads, limits)
    }

    /// A driver that goes on from what a snapshot shows at a time (seconds), with the same bodies by the same names. What a timeline has besides, its
    /// commands and its past, stays behind.
    ///
    /// # Errors
    /// As [`Coupled::new`], and when `time_s` is not a finite number.
    pub fn of_snapshot(
        snapshot: &Snapshot,
        time_s: f64,
        clock: Clock,
        threads: Threads,
        limits: StepLimits,
    ) -> Result<Self, DriverError> {
        if !time_s.is_finite() {
            let message = format!("must be a finite number, is {time_s}");
            return Err(DriverError::Setting { field: "time_s", message });
        }
        Self::of_cast(Cast::of_snapshot(snapshot, time_s), time_s, clock, threads, limits)
    }

    fn of_cast(
        (world, cast): (World, Cast),
        time_s: f64,
        clock: Clock,
        threads: Threads,
        limits: StepLimits,
    ) -> Result<Self, DriverError> {
        limits.check()?;
        world.environment.check().map_err(DriverError::Environment)?;
        Ok(Coupled {
            world,
            clock,
            threads,
            limits,
            slow_down: Duration::ZERO,
            cycle_start: None,
            cost: Duration::ZERO,
            time_s,
            began: None,
            rate: 1.0,
            slices_max: 1,
            cast,
            stage_watch: None,
            stage_times: StageTimes::default(),
        })
    }

    /// Measures how long the stages of each cycle take; see [`Coupled::stage_times`].
    #[must_use]
    pub fn with_stage_times(mut self) -> Self {
        self.stage_watch = Some(StageWatch::new(self.clock.clone()));
        self
    }

    /// Makes every step this much slower, to see what a slow scene does.
    #[must_use]
    pub fn with_slow_down(mut self, per_frame: Duration) -> Self {
        self.slow_down = per_frame;
        self
    }

    /// One cycle: steps by the time that has passed since the last call began. The states to show are then in [`Coupled::world`].
    ///
    /// The first call steps nothing: it shows the initial states.
    pub fn show(&mut self) -> StepReport {
        self.cycle(self.clock.now())
    }

    /// [`Coupled::show`] for a display with a clock of its own, which shows the picture at this time (seconds from some moment on): what steps is
    /// the time between two pictures by that clock.
    pub fn show_at(&mut self, now_s: f64) -> StepReport {
        self.cycle(moment(now_s))
    }

    /// Whether the last step has ended by a display's clock (seconds): it takes as long by that one as it did by the driver's. Until then the traditional
    /// model has nothing new to show.
    #[must_use]
    pub fn is_due(&self, now_s: f64) -> bool {
        let cost = self.cost.min(CYCLE_MAX);
        self.cycle_start.is_none_or(|start| moment(now_s) + HAIR >= start + cost)
    }

    fn cycle(&mut self, now: Duration) -> StepReport {
        let Some(before) = self.cycle_start.replace(now) else {
            self.began = Some((now, self.time_s));
            return StepReport { slices_max: 1, ..StepReport::default() };
        };
        let cycle_s = now.saturating_sub(before).as_secs_f64();
        let step_s = cycle_s.clamp(self.limits.min_s, self.limits.max_s);
        self.rate = if cycle_s > 0.0 { step_s / cycle_s } else { 1.0 };
        let begun = self.clock.now();
        let world = &mut self.world;
        let before = world.environment.settings.rest_frames();
        world.environment.settings.frame_seconds = step_s as f32;
        let full = world.environment.settings.rest_frames();
        recount_rest(world.states_mut(), before, full);
        let report = match &mut self.stage_watch {
            Some(watch) => {
                watch.begin();
                let report = self.threads.install(|| world.step(&mut *watch));
                let (seconds, other_s) = watch.end();
                let number = self.stage_times.number + 1;
                self.stage_times =
                    StageTimes { number, extended: true, seconds, other_s, ..self.stage_times };
                report
            }
            None => self.threads.install(|| world.step(&mut Unobserved)),
        };
        self.slices_max = report.slices_max;
        if !self.slow_down.is_zero() {
            self.clock.wait_until(self.clock.now() + self.slow_down);
        }
        self.cost = self.clock.now().saturating_sub(begun);
        self.time_s += step_s;
        report
    }

    /// How much time the physics has computed, which is also what is shown. Seconds.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Length of the last step. Seconds.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        f64::from(self.world.environment.settings.frame_seconds)
    }

    /// How long the last step took, for which who shows pictures had to wait. Seconds.
    #[must_use]
    pub fn cost_s(&self) -> f64 {
        self.cost.as_secs_f64()
    }

    /// The bodies and their states.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The names of the bodies of [`Coupled::world`], in their order there.
    #[must_use]
    pub fn names(&self) -> &[BodyId] {
        self.cast.names()
    }

    /// Time goes on from here with the next cycle, however long it is until then: the next call of [`Coupled::show`] steps nothing.
    pub fn pause(&mut self) {
        self.cycle_start = None;
        self.cost = Duration::ZERO;
    }

    /// All bodies as they are to be drawn, in the order of their ids. `samples` is emptied first and keeps its memory.
    pub fn sample_all(&self, samples: &mut Vec<(BodyId, Sample)>) {
        samples.clear();
        let bodies = self.cast.names().iter().zip(self.world.bodies()).zip(self.world.states());
        samples.extend(bodies.map(|((id, body), state)| {
            let BodyState { velocity, angular_velocity, .. } = *state;
            let certainty = Certainty::Exact;
            (*id, Sample { pose: body.own_pose(state), velocity, angular_velocity, certainty })
        }));
    }

    /// What there is to draw, with a snapshot of this one moment: to be queried and looked into like those of the other driver. It costs a copy of all states,
    /// and its samples say that they are held: [`Coupled::sample_all`] gives the same poses for less. There is no past to seek in and no work to report.
    pub fn picture(&mut self) -> Picture {
        let frame = self.frame();
        let snapshot = self.cast.snapshot(&self.world, frame);
        let now = self.cycle_start.unwrap_or_default();
        let (began, began_s) = self.began.unwrap_or((now, self.time_s));
        let slices_max = u8::try_from(self.slices_max).unwrap_or(u8::MAX);
        Picture {
            snapshot: Arc::new(snapshot),
            time_s: self.time_s,
            wished_s: if self.cycle_start.is_some() {
                began_s + now.saturating_sub(began).as_secs_f64()
            } else {
                self.time_s
            },
            real_s: now.as_secs_f64(),
            rate: self.rate,
            frame,
            note: Some(FrameNote { slices_max, areas_active: None }),
            dropped_to: None,
            stats: Stats::default(),
        }
    }

    /// The last frame, of the length that frames had at first, at or before the time that is shown.
    fn frame(&self) -> Frame {
        Frame((self.time_s / f64::from(self.cast.frame_seconds())).max(0.0) as u64)
    }

    /// A timeline that goes on from here, with the same bodies by the same names and frames of the length that they had at first. Its oldest frame is the
    /// last at or before the time that is shown.
    ///
    /// # Errors
    /// When a body is in a state that no timeline accepts.
    pub fn timeline(&self, settings: TimelineSettings) -> Result<Timeline, PartsError> {
        Timeline::from_parts(self.cast.parts(&self.world, self.frame(), settings))
    }

    /// How long the stages of the last cycle took, and how many cycles there were; bodies are not counted. All 0 without
    /// [`Coupled::with_stage_times`].
    #[must_use]
    pub fn stage_times(&self) -> StageTimes {
        StageTimes { frame: self.frame(), ..self.stage_times }
    }

    /// A change by the user, in force from the next cycle on. A body to be added takes the name [`Coupled::coming_body`].
    ///
    /// # Errors
    /// When there is no such body, or a plain world cannot do it; then nothing changed.
    pub fn change(&mut self, change: &Change) -> Result<(), ChangeError> {
        apply(&mut self.world, &mut self.cast, change)
    }

    /// Adds a body from the next cycle on.
    ///
    /// # Errors
    /// When the definition is not possible.
    pub fn add(&mut self, def: BodyDef) -> Result<BodyId, ChangeError> {
        let body = self.coming_body();
        self.change(&Change::Add { body, def: Box::new(def) })?;
        Ok(body)
    }

    /// The name that the next body added gets.
    #[must_use]
    pub fn coming_body(&self) -> BodyId {
        self.cast.coming_body()
    }
}

/// A clock's time (seconds) as a moment; a number that is none is the clock's beginning.
fn moment(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

/// Rest is counted in frames, and these have another length now: as much of the wait for rest is over as was before, and what is at rest stays so.
fn recount_rest(states: &mut [BodyState], full_before: u32, full: u32) {
    if full == full_before || full_before == 0 {
        return;
    }
    for state in states {
        state.rest = if state.rest >= full_before {
            full.saturating_add(u32::from(state.rest > full_before))
        } else {
            // Rounded to nearest, so that lengths which vary to and fro take nothing away.
            let scaled = u64::from(state.rest) * u64::from(full) + u64::from(full_before / 2);
            ((scaled / u64::from(full_before)) as u32).min(full.saturating_sub(1))
        };
    }
}

mod cast;

#[cfg(test)]
mod tests;
