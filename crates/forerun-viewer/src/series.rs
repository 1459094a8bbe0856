//! Series: what plots show, of the last minute or so: one row a picture, one a computed frame, one an edit.
//!
//! Promise: bounded. Every series is a ring; what is old goes.

mod csv;
mod ring;

pub use csv::{edits_csv, pictures_csv, steps_csv};
pub use ring::Ring;

use forerun::{Certainty, Picture, QueueRow, StageTimes};

use crate::session::Play;

/// Pictures that are kept: a minute of 60 a second.
const PICTURES: usize = 3600;
/// Computed frames that are kept.
const STEPS: usize = 3600;
/// Edits that are kept.
const EDITS: usize = 256;

/// What an edit cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EditRow {
    /// When it had been worked off. Real time since the scene began, seconds.
    pub time_real_s: f64,
    /// What it cost.
    pub edit: forerun::Edit,
}

/// One picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PictureRow {
    /// As in `queue.csv`.
    pub row: QueueRow,
    /// What display time would be if physics had never been late: real time, as pauses, speed and jumps have it. Seconds.
    pub wished_s: f64,
}

/// One computed frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepRow {
    /// When the display heard of it. Real time since the scene began, seconds.
    pub time_real_s: f64,
    /// How long its stages took.
    pub times: StageTimes,
}

/// What plots show of a scene.
#[derive(Debug)]
pub struct Series {
    /// One row a picture.
    pub pictures: Ring<PictureRow>,
    /// One row a computed frame.
    pub steps: Ring<StepRow>,
    /// One row an edit.
    pub edits: Ring<EditRow>,
    /// Whether the plots are held: nothing is added.
    pub held: bool,
    scene: u64,
    /// The window's clock when the scene began.
    began_s: f64,
    last_real_s: Option<f64>,
    done: Done,
    heard: Vec<StageTimes>,
}

/// What had been done by the picture before.
#[derive(Clone, Copy, Debug, Default)]
struct Done {
    computed: u64,
    recomputed: u64,
    steps: u64,
    edit: forerun::Edit,
    edit_open: bool,
}

impl Default for Series {
    fn default() -> Self {
        Series {
            pictures: Ring::with_capacity(PICTURES),
            steps: Ring::with_capacity(STEPS),
            edits: Ring::with_capacity(EDITS),
            held: false,
            scene: 0,
            began_s: 0.0,
            last_real_s: None,
            done: Done::default(),
            heard: Vec::new(),
        }
    }
}

impl Series {
    /// Takes the picture that is shown at a time of the window's clock (seconds). `scene` counts the scenes that were opened.
    pub fn take(&mut self, play: &Play, scene: u64, real_s: f64) {
        if self.scene != scene {
            *self = Series { scene, began_s: real_s, held: self.held, ..Series::default() };
        }
        let real_s = real_s - self.began_s;
        let row = self.row(play, real_s);
        self.take_steps(play, real_s);
        let edit = self.finished_edit(&play.picture, real_s);
        if !self.held {
            self.pictures.push(PictureRow { row, wished_s: play.picture.wished_s });
            edit.into_iter().for_each(|edit| self.edits.push(edit));
        }
    }

    /// The next picture does not count how long it is after the last one: it was put off on purpose, as nothing moved.
    pub fn leave_out_interval(&mut self) {
        self.last_real_s = None;
    }

    fn row(&mut self, play: &Play, real_s: f64) -> QueueRow {
        let picture = &play.picture;
        let snapshot = &picture.snapshot;
        let seconds = snapshot.frame_seconds();
        let low = picture.dropped_to.map_or(snapshot.valid_to(), |frame| frame.min(snapshot.valid_to()));
        let queue_min = small(snapshot.queue_min(picture.time_s));
        let slices_max = picture.note.map_or(1, |note| u32::from(note.slices_max));
        let starved =
            play.samples.iter().filter(|(_, sample)| sample.certainty > Certainty::Presumed).count();
        let interval_s = self.last_real_s.map_or(0.0, |last| real_s - last);
        let (ahead, edits) = (picture.stats.ahead.recomputed, picture.stats.edits.recomputed);
        let row = QueueRow {
            time_real_s: real_s,
            time_display_s: picture.time_s,
            time_physics_s: snapshot.valid_to().seconds(seconds),
            time_physics_low_s: low.seconds(seconds),
            queue_min,
            queue_max: small(snapshot.queue_max(picture.time_s)),
            queue_low: queue_min.min(small(low.since(picture.frame))),
            starved: starved as u32,
            slices_max,
            time_step_s: f64::from(seconds) / f64::from(slices_max.max(1)),
            areas_active: picture.note.and_then(|note| note.areas_active).unwrap_or(0),
            computed: (ahead + edits).saturating_sub(self.done.computed),
            recomputed: edits.saturating_sub(self.done.recomputed),
            interval_ms: interval_s * 1e3,
            wait_ms: play.coupled().map_or(0.0, |coupled| coupled.cost_s() * 1e3),
            clock_rate: picture.rate,
        };
        self.done.computed = ahead + edits;
        self.done.recomputed = edits;
        self.last_real_s = Some(real_s);
        row
    }

    fn take_steps(&mut self, play: &Play, real_s: f64) {
        self.heard.clear();
        if let Some(coupled) = play.coupled() {
            let times = coupled.stage_times();
            if times.number != self.done.steps {
                self.done.steps = times.number;
                self.heard.push(times);
            }
        } else {
            self.done.steps = play.driver.stage_times(self.done.steps, &mut self.heard);
        }
        if !self.held {
            self.heard
                .iter()
                .for_each(|times| self.steps.push(StepRow { time_real_s: real_s, times: *times }));
        }
    }

    /// An edit that has been worked off since the picture before: its numbers stand still once everything is true again.
    fn finished_edit(&mut self, picture: &Picture, real_s: f64) -> Option<EditRow> {
        let edit = picture.stats.last_edit;
        self.done.edit_open |= edit != self.done.edit;
        self.done.edit = edit;
        let all_true = picture.snapshot.valid_to() == picture.snapshot.horizon();
        let finished = self.done.edit_open && all_true && edit.commands > 0;
        self.done.edit_open &= !finished;
        finished.then_some(EditRow { time_real_s: real_s, edit })
    }
}

/// Queues are bounded by the lookahead, which is far below 2³².
fn small(count: u64) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
