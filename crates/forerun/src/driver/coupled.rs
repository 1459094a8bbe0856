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
        let now = self.clock.now();
        let Some(before) = self.cycle_start.replace(now) else {
            self.began = Some((now, self.time_s));
            return StepReport { slices_max: 1, ..StepReport::default() };
        };
        let cycle_s = now.saturating_sub(before).as_secs_f64();
        let step_s = cycle_s.clamp(self.limits.min_s, self.limits.max_s);
        self.rate = if cycle_s > 0.0 { step_s / cycle_s } else { 1.0 };
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
mod tests {
    use super::*;
    use crate::{BodyDef, Cuboid, Environment, Shape, Sphere, Vec3};

    fn coupled(clock: &Clock) -> Coupled {
        let mut world = World::new(Environment::default());
        let ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.1 })).at(Vec3::Y * 100.0);
        world.add(&ball).expect("a plain ball");
        Coupled::new(world, clock.clone(), Threads::all().expect("threads"), StepLimits::default())
            .expect("the limits are possible")
    }

    #[test]
    fn impossible_limits_and_environments_are_refused_at_the_start() {
        let refused = |limits: (f64, f64), environment: Environment| {
            let limits = StepLimits { min_s: limits.0, max_s: limits.1 };
            let threads = Threads::all().expect("threads");
            Coupled::new(World::new(environment), Clock::by_hand(), threads, limits).err()
        };
        assert_eq!(refused((0.000_01, 1.0), Environment::default()), None);
        assert_eq!(refused((0.02, 0.02), Environment::default()), None);
        for (limits, at_fault) in [
            ((0.0, 0.04), "min_s"),
            ((f64::NAN, 0.04), "min_s"),
            ((0.01, 1.5), "max_s"),
            ((0.04, 0.01), "max_s"),
            ((0.01, f64::NAN), "max_s"),
        ] {
            let error = refused(limits, Environment::default());
            assert!(
                matches!(error, Some(DriverError::Setting { field, .. }) if field == at_fault),
                "{error:?}"
            );
        }
        let mut environment = Environment::default();
        environment.settings.substeps = 0;
        let error = refused((0.001, 0.042), environment).map(|error| error.to_string());
        assert_eq!(error.as_deref(), Some("environment: substeps: must be from 1 to 64, is 0"));
    }

    #[test]
    fn a_step_is_as_long_as_the_cycle_before() {
        let clock = Clock::by_hand();
        let mut driver = coupled(&clock);
        driver.show();
        for (cycle_ms, step_ms) in [(20, 20.0), (35, 35.0), (500, 42.0), (0, 1.0)] {
            clock.turn(Duration::from_millis(cycle_ms));
            let before = driver.time_s();
            driver.show();
            assert!((1000.0 * (driver.time_s() - before) - step_ms).abs() < 1e-9, "cycle of {cycle_ms} ms");
        }
    }

    #[test]
    fn rest_is_a_matter_of_time_and_not_of_how_many_frames_it_took() {
        let clock = Clock::by_hand();
        let mut world = World::default();
        world.add(&BodyDef::fixed(Shape::HalfSpace)).expect("the ground");
        let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
        world.add(&BodyDef::new(cube).at(Vec3::Y * 0.5)).expect("a plain cube");
        world.environment.settings.overlap_allowed_m = 0.0;
        let threads = Threads::all().expect("threads");
        let mut driver =
            Coupled::new(world, clock.clone(), threads, StepLimits::default()).expect("defaults");
        let cycles = |driver: &mut Coupled, count: u32, millis: u64| {
            for _ in 0..count {
                clock.turn(Duration::from_millis(millis));
                driver.show();
            }
            let rest = driver.world().states()[1].rest;
            (rest, driver.world().environment.settings.rest_frames())
        };
        // A tenth of a second of quiet is a twentieth of what it takes, however few frames that now is.
        cycles(&mut driver, 101, 1);
        let (rest, full) = cycles(&mut driver, 1, 42);
        assert!((2..=4).contains(&rest), "{rest} of {full}");
        let (rest, full) = cycles(&mut driver, 200, 20);
        assert_eq!(rest, full + 1, "at rest");
        for millis in [21, 17, 30, 1] {
            let (rest, full) = cycles(&mut driver, 1, millis);
            assert_eq!(rest, full + 1, "still at rest in a cycle of {millis} ms");
        }
    }

    #[test]
    fn a_cycle_beyond_the_longest_step_is_never_made_up_for() {
        let clock = Clock::by_hand();
        let mut driver = coupled(&clock);
        driver.show();
        clock.turn(Duration::from_secs(1));
        driver.show();
        for _ in 0..100 {
            clock.turn(Duration::from_millis(33));
            driver.show();
        }
        assert!((clock.now().as_secs_f64() - driver.time_s() - 0.958).abs() < 1e-9);
    }

    /// A timeline of a ball that falls and two boxes on the ground, one of which is soon gone.
    fn falling() -> Timeline {
        let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
        let mut ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 })).at(Vec3::Y * 30.0);
        ball.velocity = Vec3::X;
        let bodies = [
            BodyDef::fixed(Shape::HalfSpace),
            BodyDef::new(cube.clone()).at(Vec3::new(5.0, 0.5, 0.0)),
            BodyDef::new(cube).at(Vec3::new(9.0, 0.5, 0.0)),
            ball,
        ];
        let mut timeline = Timeline::new(&bodies, Environment::default(), TimelineSettings::default())
            .expect("plain bodies");
        timeline.change(Frame(10), Change::Remove { body: BodyId(1) }).expect("it is there");
        timeline
            .change(Frame(20), Change::SetGravityScale { body: BodyId(3), scale: 0.5 })
            .expect("it is there");
        while timeline.advance() != forerun_timeline::Progress::Idle {}
        timeline
    }

    #[test]
    fn it_goes_on_from_what_another_driver_shows_and_back_again() {
        let (clock, threads) = (Clock::by_hand(), Threads::all().expect("threads"));
        let snapshot = falling().snapshot();
        let time_s = 60.25 / 60.0;
        let limits = StepLimits::default();
        let mut driver =
            Coupled::of_snapshot(&snapshot, time_s, clock.clone(), threads, limits).expect("finite");
        assert_eq!(driver.names(), [0, 2, 3].map(BodyId));
        let mut drawn = Vec::new();
        driver.sample_all(&mut drawn);
        let mut shown = Vec::new();
        snapshot.sample_all(time_s, &mut shown);
        assert_eq!(drawn, shown);
        // The first cycle shows that, the next goes on: with half the gravity, as the command said.
        driver.show();
        let before = drawn[2].1;
        for _ in 0..30 {
            clock.turn(Duration::from_millis(20));
            driver.show();
        }
        driver.sample_all(&mut drawn);
        let after = drawn[2].1;
        assert!((after.velocity.y - (before.velocity.y - 0.5 * 9.81 * 0.6)).abs() < 1e-3, "{after:?}");
        assert!((driver.time_s() - (time_s + 0.6)).abs() < 1e-9);
        let picture = driver.picture();
        assert_eq!((picture.time_s, picture.frame), (driver.time_s(), Frame(96)));
        assert!((picture.wished_s - driver.time_s()).abs() < 1e-9 && (picture.rate - 1.0).abs() < 1e-9);
        let mut queried = Vec::new();
        picture.snapshot.sample_all(picture.time_s, &mut queried);
        assert_eq!(queried.len(), 3);
        for ((id, queried), (body, drawn)) in queried.iter().zip(&drawn) {
            assert_eq!((id, queried.pose.position), (body, drawn.pose.position));
        }
        assert!(picture.snapshot.inspect(picture.frame).is_some());

        let timeline = driver.timeline(TimelineSettings::default()).expect("plain states");
        assert_eq!((timeline.oldest(), timeline.display()), (Frame(96), Frame(96)));
        assert_eq!(timeline.bodies_at(Frame(96)), driver.names());
        assert_eq!(timeline.environment_at(Frame(96)).settings.frame_seconds, 1.0 / 60.0);
        for (name, state) in driver.names().iter().zip(driver.world().states()) {
            let there = timeline.state(*name, Frame(96)).expect("it is there");
            assert_eq!((there.position, there.velocity), (state.position, state.velocity));
        }
        assert_eq!(timeline.body_at(BodyId(3), Frame(96)).map(|body| body.gravity_scale), Some(0.5));
        // Names go on where they were.
        assert_eq!((timeline.names(), driver.coming_body()), (4, BodyId(4)));
    }

    #[test]
    fn bodies_come_and_go_and_keep_their_names() {
        let clock = Clock::by_hand();
        let mut driver = coupled(&clock);
        let ball = || BodyDef::new(Shape::Sphere(Sphere { radius: 0.1 }));
        assert_eq!(driver.add(ball().at(Vec3::X * 5.0)), Ok(BodyId(1)));
        assert_eq!(driver.picture().snapshot.bodies_at(Frame(0)).count(), 2);
        assert_eq!(driver.change(&Change::Remove { body: BodyId(0) }), Ok(()));
        let gone = Change::Remove { body: BodyId(0) };
        assert_eq!(driver.change(&gone), Err(ChangeError::UnknownBody(BodyId(0))));
        let velocity =
            Change::SetVelocity { body: BodyId(1), velocity: Vec3::Z, angular_velocity: Vec3::ZERO };
        assert_eq!(driver.change(&velocity), Ok(()));
        assert_eq!(driver.add(ball().at(Vec3::X * 8.0)), Ok(BodyId(2)));
        assert_eq!(driver.names(), [1, 2].map(BodyId));
        let snapshot = driver.picture().snapshot;
        assert_eq!(snapshot.bodies_at(Frame(0)).collect::<Vec<_>>(), [1, 2].map(BodyId));
        assert_eq!(snapshot.state(BodyId(1), Frame(0)).map(|state| state.velocity), Some(Vec3::Z));
        // A world of which it is not known how its bodies were made is brought to a timeline all the same.
        let mut worldly = coupled(&clock);
        worldly.change(&Change::SetGravityScale { body: BodyId(0), scale: 2.0 }).expect("it is there");
        let timeline = worldly.timeline(TimelineSettings::default()).expect("plain states");
        let (is, was) = (timeline.body_at(BodyId(0), Frame(0)).expect("there"), &worldly.world().bodies()[0]);
        assert_eq!((is.gravity_scale, is.frame), (2.0, was.frame));
        assert!((is.inverse_mass / was.inverse_mass - 1.0).abs() < 1e-6);
    }

    #[test]
    fn after_a_pause_time_goes_on_where_it_stood_and_stages_are_measured() {
        let clock = Clock::by_hand();
        let mut driver = coupled(&clock).with_stage_times();
        driver.show();
        clock.turn(Duration::from_millis(20));
        driver.show();
        assert_eq!(driver.stage_times().number, 1);
        driver.pause();
        clock.turn(Duration::from_secs(60));
        driver.show();
        assert!((driver.time_s() - 0.02).abs() < 1e-9);
        clock.turn(Duration::from_millis(30));
        driver.show();
        assert!((driver.time_s() - 0.05).abs() < 1e-9);
        assert!((driver.picture().wished_s - 0.05).abs() < 1e-9);
        // A hand-turned clock stands during a step.
        assert_eq!((driver.stage_times().number, driver.stage_times().total_s()), (2, 0.0));
    }
}
