//! What the command line asks of the viewer: begin at a time, stand still, keep a picture and end.

use super::Screenshot;
use crate::capture::{Shot, Want};
use crate::session::Stage;
use crate::viewer::Viewer;

/// As the command line has it: a file that cannot be read or written.
const BAD_INPUT: i32 = 2;

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
    /// After each picture; the exit code, when the viewer is to end.
    pub(super) fn run(&mut self, viewer: &mut Viewer) -> Option<i32> {
        let age_s = viewer.series.pictures.last().map_or(0.0, |picture| picture.row.time_real_s);
        if let Some(shot) = viewer.capture.handed.take() {
            return self.screenshot.take().map(|screenshot| told(screenshot.keep(&shot)));
        }
        if let (Stage::Failed(message), Some(_)) = (&viewer.session.stage, &self.screenshot) {
            return Some(told(Err(format!("there is nothing to draw: {message}"))));
        }
        let play = viewer.session.play_mut()?;
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
        None
    }
}

/// Says what went wrong, as the command line does; the exit code.
fn told(done: Result<(), String>) -> i32 {
    match done {
        Ok(()) => 0,
        Err(message) => {
            eprintln!("error: {message}");
            BAD_INPUT
        }
    }
}

impl Screenshot {
    fn keep(&self, shot: &Shot) -> Result<(), String> {
        let path = self.path.display();
        let kept =
            shot.png().and_then(|file| std::fs::write(&self.path, file).map_err(|error| error.to_string()));
        kept.map_err(|error| {
            format!("cannot write the screenshot {path}: {error}: give --screenshot a file in a folder that can be written to")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_screenshot_that_cannot_be_written_is_bad_input() {
        let shot = Shot { size: [2, 1], pixels: vec![[9; 4]; 2] };
        let name = format!("forerun-errand-{}.png", std::process::id());
        let [fine, bad] = ["", "no/such/folder"].map(|folder| std::env::temp_dir().join(folder).join(&name));
        let keep = |path| Screenshot { path, after_s: 0.0 }.keep(&shot);
        assert_eq!(told(keep(fine.clone())), 0);
        std::fs::remove_file(fine).expect("it was written just now");
        let refused = keep(bad.clone());
        assert!(
            refused.as_ref().is_err_and(|error| error.contains(&bad.display().to_string())),
            "{refused:?}"
        );
        assert_eq!(told(refused), BAD_INPUT);
    }
}
