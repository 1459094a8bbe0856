//! Session: the display loop of a soak.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use forerun::timeline::Progress;
use forerun::timeline::check::{Mismatch, Random};
use forerun::{
    Clock, Decoupled, DecoupledSettings, DriverError, Fork, Hinder, Scene, Threads, TimelineSettings,
    timeline_of,
};

use super::SoakSettings;
use super::editor::{Done, Editor, Edits};
use super::machine::{Hogs, Lateness, Share, Sleeper, resident_mib};
use super::oracle::{Log, compare};
use super::witness::{Seen, Witness};
use crate::failure::Failure;

/// Past that is kept. Longer than commands are late and forks take to come, so that no command is forgotten before it is noted.
const PAST: u32 = 600;
const MIB: f64 = 1_048_576.0;
/// From one look at the commands to the next. Frames.
const LEARN_EVERY: u64 = 120;
/// The machine is as late as it was for the sleeper for so long before and after. Seconds.
const NEAR_S: f64 = 0.1;
/// Real time that is given to what has to come. It comes within a stall, on any machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// What a soak found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Soaked {
    pub(crate) seen: Seen,
    pub(crate) edits: Edits,
    pub(crate) refused: u64,
    pub(crate) commands: u64,
    pub(crate) bodies: u64,
    pub(crate) stalls: u64,
    pub(crate) stalled_s: f64,
    /// Frames that physics worked on: new ones, and again.
    pub(crate) frames_ahead: u64,
    pub(crate) frames_again: u64,
    /// From one picture to the next.
    pub(crate) pictures: Lateness,
    /// The thread beside it that only slept.
    pub(crate) sleeper: Lateness,
    /// Late pictures that the machine does not explain.
    pub(crate) late_ours: u64,
    /// From the beginning of a picture until it could be drawn.
    pub(crate) work: Lateness,
    /// Processor time of the display thread from picture to picture, with what the soak itself does there.
    pub(crate) ran: Lateness,
    /// Memory each second. Seconds, MiB.
    pub(crate) memory: Vec<(f64, f64)>,
    /// Of it, the stored states, which follow how much moves. Seconds, MiB.
    pub(crate) states: Vec<(f64, f64)>,
    pub(crate) frames_compared: u64,
    pub(crate) mismatches: u64,
    pub(crate) first_mismatch: Option<Mismatch>,
}

/// What the physics thread counts.
#[derive(Debug, Default)]
struct Stalls {
    calm: AtomicBool,
    count: AtomicU64,
    microseconds: AtomicU64,
}

/// One picture: when it began and ended (seconds), and what its thread had of a processor by then.
#[derive(Clone, Copy, Debug, Default)]
struct Moment {
    began_s: f64,
    ended_s: f64,
    share: Share,
}

/// Plays the scene while it is edited and its physics stalls, and compares what is kept at the end with a full simulation.
///
/// # Errors
/// When the scene is not possible, the driver fails, or there is no full simulation to compare with.
pub(crate) fn soak(
    scene: &Scene,
    settings: &SoakSettings,
    clock: &Clock,
    on_picture: &mut dyn FnMut(f64),
) -> Result<Soaked, Failure> {
    let kept = TimelineSettings { lookahead: settings.lookahead, past: PAST, ..TimelineSettings::default() };
    let threads = settings.threads.map_or_else(Threads::all, Threads::exactly)?;
    let stalls = Arc::new(Stalls::default());
    let timeline = timeline_of(scene, kept)?;
    let hinder = hinder(settings, clock, &stalls);
    let driver = Decoupled::start_hindered(timeline, DecoupledSettings::new(threads), hinder)?;
    let mut session = Session {
        driver,
        settings,
        clock,
        editor: Editor::new(settings.seed),
        witness: Witness::new(),
        log: Log::default(),
        learned: 0,
        moments: Vec::new(),
        soaked: Soaked::default(),
    };
    session.fill()?;
    let interval = Duration::from_secs_f64(1.0 / settings.fps);
    let hogs = Hogs::start(settings.hogs);
    let sleeper = Sleeper::start(clock, interval);
    let played = session.play(interval, on_picture);
    drop(hogs);
    let naps = sleeper.map_or_else(Vec::new, |sleeper| sleeper.stop(clock, interval));
    stalls.calm.store(true, Ordering::Relaxed);
    // On a hand-turned clock nobody else ends a stall.
    clock.turn(Duration::from_secs_f64(settings.stall_s + settings.slow_s));
    played?;
    let last = session.last_fork()?;
    session.judge_time(&naps);
    let Session { mut soaked, log, editor, witness, driver, .. } = session;
    drop(driver);
    let compared = compare(last.timeline(), &log, &scene.bodies()?, scene.environment())?;
    soaked.seen = witness.seen;
    soaked.edits = editor.edits;
    soaked.commands = log.len() as u64;
    soaked.bodies = last.timeline().bodies_at(last.timeline().horizon()).len() as u64;
    soaked.stalls = stalls.count.load(Ordering::Relaxed);
    soaked.stalled_s = 1e-6 * stalls.microseconds.load(Ordering::Relaxed) as f64;
    (soaked.frames_compared, soaked.mismatches) = (compared.frames, compared.mismatches);
    soaked.first_mismatch = compared.first;
    Ok(soaked)
}

/// Stalls of random length at random times.
fn hinder(settings: &SoakSettings, clock: &Clock, stalls: &Arc<Stalls>) -> Hinder {
    let SoakSettings { stall_s, stall_every_s, slow_s, .. } = *settings;
    let (clock, stalls) = (clock.clone(), Arc::clone(stalls));
    let mut random = Random::new(settings.seed ^ 0x57a1_1000);
    let mut part = move || 0.5 + 0.5 * f64::from(random.signed());
    let mut next_s = 2.0 * stall_every_s * part();
    Box::new(move || {
        if stalls.calm.load(Ordering::Relaxed) {
            return;
        }
        let now = clock.now();
        if slow_s > 0.0 {
            clock.wait_until(now + Duration::from_secs_f64(slow_s));
        }
        if stall_s > 0.0 && now.as_secs_f64() >= next_s {
            let stall = Duration::from_secs_f64(stall_s * part());
            stalls.count.fetch_add(1, Ordering::Relaxed);
            stalls.microseconds.fetch_add(stall.as_micros() as u64, Ordering::Relaxed);
            clock.wait_until(now + stall);
            next_s = (now + stall).as_secs_f64() + 2.0 * stall_every_s * part();
        }
    })
}

struct Session<'a> {
    driver: Decoupled,
    settings: &'a SoakSettings,
    clock: &'a Clock,
    editor: Editor,
    witness: Witness,
    log: Log,
    /// The display frame of the last look at the commands.
    learned: u64,
    moments: Vec<Moment>,
    soaked: Soaked,
}

impl Session<'_> {
    /// Lets physics run ahead before the first picture.
    fn fill(&mut self) -> Result<(), Failure> {
        let wanted = u64::from(self.settings.prefill.min(self.settings.lookahead));
        let real = Clock::system();
        while self.driver.last_picture().snapshot.horizon().0 < wanted && real.now() < PATIENCE {
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(())
    }

    fn play(&mut self, interval: Duration, on_picture: &mut dyn FnMut(f64)) -> Result<(), Failure> {
        let length = Duration::from_secs_f64(self.settings.seconds);
        let start = self.clock.now();
        let (mut due, mut samples) = (Duration::ZERO, Vec::new());
        let mut second = 0;
        self.driver.request_fork()?;
        while due < length {
            self.clock.wait_until(start + due);
            let began = self.clock.now();
            let picture = self.driver.show((began - start).as_secs_f64())?;
            let blending = self.driver.sample_all(&picture, &mut samples);
            let ended = self.clock.now();
            self.moments.push(Moment {
                began_s: began.as_secs_f64(),
                ended_s: ended.as_secs_f64(),
                share: Share::now(),
            });
            self.witness.look(&picture, &samples, (blending, self.driver.offsets()));
            if self.editor.falls(self.settings.edits_per_second, interval.as_secs_f64()) {
                let before = self.editor.edits;
                match self.editor.edit(&mut self.driver, &picture, &samples)? {
                    Done::Something => {}
                    Done::Moved(body, frame) => self.witness.expect_move(body, frame),
                    Done::Pushed(body) => self.witness.expect_push(body, &picture),
                }
                if self.editor.edits.taken_back() != before.taken_back() {
                    // Looked at at once: what was taken back may soon be too old to be seen missing.
                    self.learned = 0;
                }
            }
            if self.settings.drag {
                let dragged = self.editor.drag(&mut self.driver, &picture, &samples)?;
                self.witness.look_at_dragged(dragged, &samples);
            }
            self.keep_log(picture.frame.0)?;
            let shown_s = (began - start).as_secs_f64();
            if shown_s as u64 >= second {
                second += 1;
                self.soaked.memory.extend(resident_mib().map(|mib| (shown_s, mib)));
                self.soaked.states.push((shown_s, picture.stats.state_bytes as f64 / MIB));
            }
            on_picture(shown_s);
            due = (due + interval).max(self.clock.now() - start);
        }
        Ok(())
    }

    /// Looks at the commands now and then, before the physics forgets them.
    fn keep_log(&mut self, displayed: u64) -> Result<(), Failure> {
        while let Some(fork) = self.driver.take_fork() {
            self.log.learn(fork.timeline());
        }
        self.soaked.refused += self.driver.refusals().len() as u64;
        if displayed >= self.learned + LEARN_EVERY {
            match self.driver.request_fork() {
                Ok(()) => self.learned = displayed,
                // The next picture asks again.
                Err(DriverError::QueueFull) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    /// A fork of all that was heard, with all that it keeps computed.
    fn last_fork(&mut self) -> Result<Fork, Failure> {
        while let Some(fork) = self.driver.take_fork() {
            self.log.learn(fork.timeline());
        }
        self.driver.request_fork()?;
        let real = Clock::system();
        loop {
            if let Some(mut fork) = self.driver.take_fork() {
                self.log.learn(fork.timeline());
                let stats = fork.timeline().stats();
                (self.soaked.frames_ahead, self.soaked.frames_again) =
                    (stats.ahead.frames, stats.edits.frames);
                while fork.timeline_mut().advance() != Progress::Idle {}
                return Ok(fork);
            }
            if real.now() > PATIENCE {
                return Err(Failure::Check("the physics thread does not answer any more".to_owned()));
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Which pictures were late, and which of them the machine explains.
    fn judge_time(&mut self, naps: &[(f64, f64)]) {
        let interval_s = 1.0 / self.settings.fps;
        let limit_s = 2.0 * interval_s;
        let pairs = self.moments.windows(2).map(|pair| (pair[0], pair[1]));
        let intervals: Vec<f64> = pairs.clone().map(|(a, b)| b.began_s - a.began_s).collect();
        let work: Vec<f64> = self.moments.iter().map(|moment| moment.ended_s - moment.began_s).collect();
        let nap_lengths: Vec<f64> = naps.iter().map(|(from, to)| to - from).collect();
        self.soaked.pictures = Lateness::of(&intervals, limit_s);
        self.soaked.work = Lateness::of(&work, interval_s);
        let ran: Vec<f64> = pairs.clone().map(|(a, b)| b.share.ran_s - a.share.ran_s).collect();
        self.soaked.ran = Lateness::of(&ran, interval_s);
        self.soaked.sleeper = Lateness::of(&nap_lengths, limit_s);
        let slept_in = |from_s: f64, to_s: f64| {
            // A nap that was longer than it should be, at the same time or nearly.
            let near = |(from, to): &(f64, f64)| *from < to_s + NEAR_S && from_s < *to + NEAR_S;
            naps.iter().any(|nap| nap.1 - nap.0 > 1.5 * interval_s && near(nap))
        };
        let ours = pairs.filter(|(before, now)| {
            let waited_s = now.share.waited_s - before.share.waited_s;
            let late_s = now.began_s - before.began_s;
            late_s > limit_s && late_s - waited_s > limit_s && !slept_in(before.began_s, now.began_s)
        });
        self.soaked.late_ours = ours.count() as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> SoakSettings {
        SoakSettings {
            seconds: 8.0,
            fps: 60.0,
            edits_per_second: 6.0,
            drag: false,
            stall_s: 2.0,
            stall_every_s: 2.0,
            slow_s: 0.0,
            lookahead: 60,
            prefill: 0,
            hogs: 0,
            threads: std::num::NonZeroU16::new(1),
            seed: 5,
        }
    }

    /// Against a clock that is turned on by a picture at a time, so that stalls have their length in pictures on any machine.
    fn soaked(scene: &str, settings: &SoakSettings) -> Soaked {
        let scene = Scene::open(scene).expect("a built-in scene");
        let clock = Clock::by_hand();
        let turned = clock.clone();
        let interval = Duration::from_secs_f64(1.0 / settings.fps);
        let soaked = soak(&scene, settings, &clock, &mut |_| {
            // Physics that does not stall has time for some frames.
            std::thread::sleep(Duration::from_millis(1));
            turned.turn(interval);
        });
        soaked.expect("the scene plays")
    }

    #[test]
    fn edits_and_stalls_leave_neither_a_jump_nor_a_wrong_bit() {
        for (fps, seed) in [(60.0, 5), (144.0, 6)] {
            let settings = SoakSettings { fps, seed, ..settings() };
            let soaked = soaked("islands:4", &settings);
            let Soaked { seen, edits, .. } = &soaked;
            assert!(seen.pictures as f64 >= 8.0 * fps - 1.0 && soaked.stalls > 0, "{soaked:?}");
            assert!(edits.local > 5 && edits.late > 0 && edits.undone + edits.retracted > 0, "{edits:?}");
            assert_eq!((seen.backward_steps, seen.forward_jumps, seen.teleports), (0, 0, 0), "{seen:?}");
            assert!(soaked.frames_compared > 100 && soaked.commands > 10, "{soaked:?}");
            assert_eq!((soaked.mismatches, soaked.first_mismatch), (0, None));
        }
    }

    #[test]
    fn a_body_that_is_dragged_keeps_the_display_fed() {
        let settings =
            SoakSettings { drag: true, stall_s: 0.0, prefill: 60, edits_per_second: 0.5, ..settings() };
        let soaked = soaked("islands:4", &settings);
        let seen = &soaked.seen;
        assert!(soaked.edits.dragged > 470, "{soaked:?}");
        assert_eq!((seen.backward_steps, seen.forward_jumps, seen.teleports), (0, 0, 0), "{seen:?}");
        assert_eq!((soaked.mismatches, soaked.first_mismatch), (0, None));
    }

    #[test]
    fn a_stall_slows_the_clock_and_one_that_is_over_lets_it_recover() {
        let settings = SoakSettings { lookahead: 30, edits_per_second: 0.0, ..settings() };
        let soaked = soaked("stack:3", &settings);
        let seen = &soaked.seen;
        assert!(seen.slowed_pictures > 20 && seen.rate_min < 0.5 && seen.delay_max_s > 0.3, "{soaked:?}");
        assert!(seen.recovery_max_s <= 2.0, "{seen:?}");
        assert_eq!((seen.backward_steps, seen.forward_jumps, seen.teleports), (0, 0, 0), "{seen:?}");
    }
}
