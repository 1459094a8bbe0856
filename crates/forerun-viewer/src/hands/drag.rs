//! Drag: a spring between the place where a body was taken and the mouse. In a pause, when no spring pulls, the body is put where the mouse is.

use forerun::dynamics::Spring;
use forerun::{BodyHit, BodyId, Change, Pose, Vec3};

use super::sight::Sight;
use crate::session::{Last, Play};
use crate::view::Grip;

/// The mouse may move so far between press and release of a click. Pixels.
const CLICK_PIXELS: f32 = 4.0;

/// A body that is dragged.
#[derive(Debug)]
pub(super) struct Drag {
    body: BodyId,
    /// Where it was taken, in its own frame.
    anchor: Vec3,
    /// Where it was when it was taken.
    pose: Pose,
    /// Where the mouse holds it, in the world.
    target: Vec3,
    pressed: [f32; 2],
    /// Whether the mouse has moved far enough for a drag.
    moves: bool,
    /// What was last said about it.
    last: Option<Last>,
    /// Whether that was a spring, which has to be let go.
    held: bool,
}

impl Drag {
    /// Takes a body where it was hit; none if nothing moves it.
    pub(super) fn of(play: &Play, hit: &BodyHit, pressed: [f32; 2]) -> Option<Drag> {
        play.body(hit.body).filter(|body| body.is_dynamic())?;
        let pose = play.sample(hit.body)?.pose;
        let anchor = pose.rotation.conjugate() * (hit.point - pose.position);
        let (body, target) = (hit.body, hit.point);
        Some(Drag { body, anchor, pose, target, pressed, moves: false, last: None, held: false })
    }

    pub(super) fn body(&self) -> BodyId {
        self.body
    }

    pub(super) fn moves(&self) -> bool {
        self.moves
    }

    /// From the body to the mouse, for the picture.
    pub(super) fn line(&self, play: &Play) -> Option<[Vec3; 2]> {
        let pose = play.sample(self.body).filter(|_| self.moves)?.pose;
        Some([pose.position + pose.rotation * self.anchor, self.target])
    }

    /// The mouse is here now, with Shift or without; whether the drag goes on. It has ended when the body is not there any more, or time went back.
    pub(super) fn go_on(
        &mut self,
        play: &mut Play,
        sight: &Sight<'_>,
        (pointer, along_ground): ([f32; 2], bool),
        grip: &Grip,
    ) -> bool {
        if play.sample(self.body).is_none() || play.is_before(self.last) {
            self.finish(play);
            return false;
        }
        let [x, y] = [pointer[0] - self.pressed[0], pointer[1] - self.pressed[1]];
        if !self.moves && x.hypot(y) < CLICK_PIXELS {
            return true;
        }
        let normal = if along_ground { Vec3::Y } else { sight.camera.forward() };
        let before = self.target;
        self.target = sight.on_plane(pointer, self.target, normal).unwrap_or(self.target);
        if !self.moves {
            play.begin("drag");
        }
        // A spring goes on pulling to where it was told.
        if !self.moves || self.target != before || self.held == play.paused {
            self.tell(play, grip);
        }
        self.moves = true;
        true
    }

    fn tell(&mut self, play: &mut Play, grip: &Grip) {
        let body = self.body;
        let changed_mode = self.held == play.paused;
        if changed_mode {
            self.last = None;
        }
        if play.paused {
            if let Some(sample) = play.sample(body).filter(|_| changed_mode) {
                self.pose = sample.pose;
            }
            self.let_go(play);
            let taken_at = self.pose.position + self.pose.rotation * self.anchor;
            let position = self.pose.position + (self.target - taken_at);
            let first = self.last.is_none();
            self.last =
                play.give_instead(self.last, Change::Move { body, pose: Pose { position, ..self.pose } });
            if first {
                play.show_edit(self.last);
            }
        } else {
            let (anchor, target) = (self.anchor, self.target);
            let spring = Spring { anchor, target, frequency_hz: grip.frequency, damping_ratio: 1.0 };
            self.last = play.give_on(self.last, Change::Hold { body, spring });
            self.held = true;
        }
    }

    fn let_go(&mut self, play: &mut Play) {
        // The traditional driver knows only those who are there, and no spring holds the others.
        let there = !play.is_coupled() || play.sample(self.body).is_some();
        if std::mem::take(&mut self.held) && there {
            play.give_after(self.last, Change::Release { body: self.body });
        }
    }

    /// Whether there is something to be taken back of it.
    fn finish(&mut self, play: &mut Play) -> bool {
        self.let_go(play);
        play.end()
    }

    /// The mouse lets go.
    pub(super) fn end(mut self, play: &mut Play) {
        self.finish(play);
    }

    /// As if it had never been taken.
    pub(super) fn cancel(mut self, play: &mut Play) {
        if self.finish(play) {
            play.undo();
        }
    }
}
