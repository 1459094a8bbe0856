//! What the command line asks of the viewer: begin at a time, stand still, keep a picture and end.

use super::Screenshot;
use crate::capture::{Shot, Want};
use crate::session::Stage;
use crate::viewer::Viewer;

/// How far behind the time that was asked for is near enough. Seconds.
const NEAR_S: f64 = 1e-3;

/// What is left to be done.
#[derive(Debug)]
pub(super) struct Errand {
    /// Display time to go to, once physics has come there. Seconds.
    pub(super) time_s: Option<f64>,
    /// Whether display time is to stand still.
    pub(super) paused: bool,
    /// The picture to keep.
    pub(super) screenshot: Option<Screenshot>,
}

impl Errand {
    /// After each picture; whether the viewer is to end.
    pub(super) fn run(&mut self, viewer: &mut Viewer) -> bool {
        let age_s = viewer.series.pictures.last().map_or(0.0, |picture| picture.row.time_real_s);
        if let Some(shot) = viewer.capture.handed.take() {
            return self.screenshot.take().is_some_and(|screenshot| screenshot.keep(&shot));
        }
        if let (Stage::Failed(message), Some(_)) = (&viewer.session.stage, &self.screenshot) {
            eprintln!("there is nothing to draw: {message}");
            return true;
        }
        let Some(play) = viewer.session.play_mut() else { return false };
        if self.paused {
            play.set_paused(true);
            self.paused = false;
        }
        if let Some(time_s) = self.time_s {
            // No faster than physics: what is not computed yet cannot be gone to.
            play.seek(time_s);
            if play.picture.time_s >= time_s - NEAR_S {
                self.time_s = None;
            }
        } else if self.screenshot.as_ref().is_some_and(|screenshot| age_s >= screenshot.after_s) {
            viewer.capture.wants.push(Want::Hand);
        }
        false
    }
}

impl Screenshot {
    /// Writes it; that it has been done.
    fn keep(&self, shot: &Shot) -> bool {
        let kept =
            shot.png().and_then(|file| std::fs::write(&self.path, file).map_err(|error| error.to_string()));
        if let Err(error) = kept {
            eprintln!("cannot write {}: {error}", self.path.display());
        }
        true
    }
}
