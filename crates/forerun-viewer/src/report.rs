//! Report: the state of the viewer as plain values, for scripts that play it with mouse and keys and check what came of it.

use serde::Serialize;

use crate::session::{Play, Session, Stage};
use crate::view::View;

/// What a script may ask about.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// `loading`, `playing` or `failed`.
    pub stage: &'static str,
    /// Why it failed.
    pub failure: Option<String>,
    /// What is open.
    pub scene: String,
    /// Pictures drawn so far.
    pub pictures: u64,
    /// How it is shown.
    pub view: View,
    /// The scene that plays.
    pub play: Option<PlayReport>,
}

/// A scene that plays.
#[derive(Clone, Debug, Serialize)]
pub struct PlayReport {
    /// Display time. Seconds.
    pub time_s: f64,
    /// Seconds.
    pub horizon_s: f64,
    /// Seconds.
    pub oldest_s: f64,
    /// The last frame that is true for all bodies.
    pub valid_to: u64,
    /// Whether the user paused it.
    pub paused: bool,
    /// How fast it is to go.
    pub speed: f64,
    /// How many bodies are drawn.
    pub bodies: usize,
    /// Ids of the bodies that are picked.
    pub selected: Vec<u32>,
    /// Where the last one picked is. Metres.
    pub selected_position: Option<[f32; 3]>,
    /// How fast the last one picked is. m/s.
    pub selected_speed: Option<f32>,
    /// The last message to the user.
    pub notice: Option<String>,
}

impl Report {
    /// The state after `pictures` pictures.
    #[must_use]
    pub fn of(session: &Session, view: &View, pictures: u64) -> Report {
        let (stage, failure) = match &session.stage {
            Stage::Loading(_) => ("loading", None),
            Stage::Playing(_) => ("playing", None),
            Stage::Failed(message) => ("failed", Some(message.clone())),
        };
        Report {
            stage,
            failure,
            scene: session.source.name(),
            pictures,
            view: *view,
            play: session.play().map(PlayReport::of),
        }
    }
}

impl PlayReport {
    fn of(play: &Play) -> PlayReport {
        let snapshot = &play.picture.snapshot;
        let seconds = snapshot.frame_seconds();
        let active = play.selection.active().and_then(|body| play.sample(body));
        PlayReport {
            time_s: play.picture.time_s,
            horizon_s: snapshot.horizon().seconds(seconds),
            oldest_s: snapshot.oldest().seconds(seconds),
            valid_to: snapshot.valid_to().0,
            paused: play.paused,
            speed: play.speed,
            bodies: play.samples.len(),
            selected: play.selection.bodies().iter().map(|body| body.0).collect(),
            selected_position: active.map(|sample| sample.pose.position.to_array()),
            selected_speed: active.map(|sample| sample.velocity.length()),
            notice: play.notice.clone(),
        }
    }
}
