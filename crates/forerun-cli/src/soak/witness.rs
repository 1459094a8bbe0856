//! Witness: looks at every picture as a viewer would. Did time go back, did a body jump?

use std::collections::BTreeSet;
use std::sync::Arc;

use forerun::timeline::{Certainty, Sample};
use forerun::{Blending, BodyId, Frame, Offset, Picture, Snapshot, Vec3};
use serde::Serialize;

/// A body goes by more than so many times what its velocity and the blend explain: a jump.
const JUMP: f32 = 1.5;

/// What needs no explanation: bodies that overlap are pushed apart without a velocity. Metres.
const ALLOWED_M: f32 = 0.03;

/// A push that is not seen for so long is not waited for.
const PUSH_PICTURES_MAX: u64 = 600;

/// What was seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Seen {
    pub(crate) pictures: u64,
    /// Pictures whose time was before that of the picture before.
    pub(crate) backward_steps: u64,
    /// Pictures whose time went on by more than 1.05 of what passed.
    pub(crate) forward_jumps: u64,
    /// Bodies that went farther from one picture to the next than 1.5 times what explains it: their velocities, the blend, or the states
    /// that they went through.
    pub(crate) teleports: u64,
    /// The farthest beyond that. Metres.
    pub(crate) teleport_max_m: f32,
    /// Bodies that went farther than their velocities say because the physics pushed them apart, or many frames lay between two pictures.
    pub(crate) pushed_apart: u64,
    /// Pictures whose clock was slowed because physics was late.
    pub(crate) slowed_pictures: u64,
    /// Slowest that the clock went, as a factor.
    pub(crate) rate_min: f64,
    /// Longest from the end of a slow-down below half speed to full speed. Seconds.
    pub(crate) recovery_max_s: f64,
    /// Most that display time was behind. Seconds.
    pub(crate) delay_max_s: f64,
    /// What of it was left at the end. Seconds.
    pub(crate) delay_end_s: f64,
    /// Bodies in pictures that were shown as they went on before, or held, because physics was late with them.
    pub(crate) late_bodies: u64,
    /// Pictures in which the dragged body was shown late.
    pub(crate) dragged_late: u64,
    /// Fewest frames that were ahead of a picture, the first second left out; none when there was no more than that.
    pub(crate) ahead_min: Option<u64>,
    /// Pushes by the local user that were followed until they were seen.
    pub(crate) pushes_seen: u64,
    /// Those of them that were seen in the second picture after the one they were given in, or before.
    pub(crate) pushes_in_two: u64,
    /// Pictures from a push to the first that shows it, at most.
    pub(crate) push_pictures_max: u64,
    /// Bodies in pictures that were drawn off the truth, to lead them back.
    pub(crate) blended_bodies: u64,
    /// Farthest that a body was drawn off the truth. Metres.
    pub(crate) off_max_m: f32,
}

/// Compares each picture with the one before.
#[derive(Debug)]
pub(super) struct Witness {
    pub(super) seen: Seen,
    /// Of the picture before.
    samples: Vec<(BodyId, Sample)>,
    time_s: f64,
    real_s: f64,
    frame: Frame,
    /// Since when the clock has been recovering. Seconds.
    slow_since_s: Option<f64>,
    /// Bodies that commands put elsewhere, and at which frames.
    moves: BTreeSet<(BodyId, Frame)>,
    /// A push that has not been seen yet.
    push: Option<Push>,
}

/// A push, what was known before it, and pictures since.
#[derive(Debug)]
struct Push {
    body: BodyId,
    before: Arc<Snapshot>,
    pictures: u64,
}

impl Witness {
    pub(super) fn new() -> Witness {
        let seen = Seen { rate_min: 1.0, ..Seen::default() };
        Witness {
            seen,
            samples: Vec::new(),
            time_s: 0.0,
            real_s: 0.0,
            frame: Frame(0),
            slow_since_s: None,
            moves: BTreeSet::new(),
            push: None,
        }
    }

    /// A command puts a body elsewhere at a frame: that is no jump of the display.
    pub(super) fn expect_move(&mut self, body: BodyId, frame: Frame) {
        self.moves.insert((body, frame));
    }

    /// The local user pushed a body: when is it seen? One push at a time is followed.
    pub(super) fn expect_push(&mut self, body: BodyId, picture: &Picture) {
        let before = Arc::clone(&picture.snapshot);
        self.push.get_or_insert(Push { body, before, pictures: 0 });
    }

    pub(super) fn look_at_dragged(&mut self, dragged: Option<BodyId>, samples: &[(BodyId, Sample)]) {
        let sample = samples.iter().find(|(body, _)| Some(*body) == dragged);
        self.seen.dragged_late +=
            u64::from(sample.is_some_and(|(_, sample)| sample.certainty > Certainty::Presumed));
    }

    /// A push is seen when the body is elsewhere than it would have been.
    fn look_for_push(&mut self, picture: &Picture) {
        let Some(push) = &mut self.push else { return };
        push.pictures += 1;
        if push.pictures > PUSH_PICTURES_MAX {
            // Taken back, it seems, before anybody could see it; and what was known before it is not to be kept for ever.
            self.push = None;
            return;
        }
        let now = picture.snapshot.sample(push.body, picture.time_s);
        let then = push.before.sample(push.body, picture.time_s);
        let Some((now, then)) = now.zip(then) else {
            self.push = None;
            return;
        };
        if now.certainty <= Certainty::Presumed && now.pose != then.pose {
            self.seen.pushes_seen += 1;
            self.seen.pushes_in_two += u64::from(push.pictures <= 2);
            self.seen.push_pictures_max = self.seen.push_pictures_max.max(push.pictures);
            self.push = None;
        }
    }

    pub(super) fn look(
        &mut self,
        picture: &Picture,
        samples: &[(BodyId, Sample)],
        (blending, offsets): (Blending, &[(BodyId, Offset)]),
    ) {
        let first = self.seen.pictures == 0;
        self.seen.pictures += 1;
        let (advance_s, passed_s) = (picture.time_s - self.time_s, picture.real_s - self.real_s);
        if !first {
            self.seen.backward_steps += u64::from(advance_s < 0.0);
            self.seen.forward_jumps += u64::from(advance_s > 1.05 * passed_s + 1e-9);
            self.look_at_bodies((picture, advance_s, passed_s), samples, offsets);
        }
        self.look_at_clock(picture);
        self.look_for_push(picture);
        if picture.time_s > 1.0 {
            let ahead = picture.snapshot.horizon().since(picture.frame);
            self.seen.ahead_min = Some(self.seen.ahead_min.map_or(ahead, |least| least.min(ahead)));
        }
        self.seen.late_bodies +=
            samples.iter().filter(|(_, sample)| sample.certainty > Certainty::Presumed).count() as u64;
        self.seen.blended_bodies += u64::from(blending.bodies);
        self.seen.off_max_m = self.seen.off_max_m.max(blending.off_max_m);
        (self.time_s, self.real_s, self.frame) = (picture.time_s, picture.real_s, picture.frame);
        self.samples.clear();
        self.samples.extend_from_slice(samples);
    }

    fn look_at_clock(&mut self, picture: &Picture) {
        let seen = &mut self.seen;
        seen.slowed_pictures += u64::from(picture.is_slowed());
        seen.rate_min = seen.rate_min.min(picture.rate);
        seen.delay_end_s = (picture.wished_s - picture.time_s).max(0.0);
        seen.delay_max_s = seen.delay_max_s.max(seen.delay_end_s);
        // It recovers from the moment on that there is something to show again.
        let ahead = picture.snapshot.horizon().since(picture.frame);
        let stands = picture.rate < 0.5 && ahead < 2;
        if stands {
            self.slow_since_s = Some(picture.real_s);
        } else if !picture.is_slowed()
            && let Some(since_s) = self.slow_since_s.take()
        {
            seen.recovery_max_s = seen.recovery_max_s.max(picture.real_s - since_s);
        }
    }

    fn look_at_bodies(
        &mut self,
        (picture, advance_s, passed_s): (&Picture, f64, f64),
        samples: &[(BodyId, Sample)],
        offsets: &[(BodyId, Offset)],
    ) {
        let faded = (1.0 / Blending::left_after(passed_s) - 1.0) as f32;
        let mut before = self.samples.iter().peekable();
        for (body, sample) in samples {
            while before.next_if(|(other, _)| other < body).is_some() {}
            let Some((_, was)) = before.next_if(|(other, _)| other == body) else { continue };
            let offset = offsets.binary_search_by_key(body, |(id, _)| *id);
            let offset_m = offset.map_or(0.0, |index| offsets[index].1.position.length());
            let speed = sample.velocity.length().max(was.velocity.length());
            let explained = speed * advance_s as f32 + offset_m * faded;
            let moved = sample.pose.position.distance(was.pose.position);
            let beyond = moved - JUMP * explained - ALLOWED_M;
            if beyond > 0.0 && !self.is_moved(*body, picture.frame) {
                if moved <= self.path_m(*body, picture) + offset_m * faded + 1e-3 {
                    self.seen.pushed_apart += 1;
                    continue;
                }
                self.seen.teleports += 1;
                self.seen.teleport_max_m = self.seen.teleport_max_m.max(beyond);
            }
        }
        let shown = self.frame;
        self.moves.retain(|(_, frame)| *frame >= shown);
    }

    /// How far a body went since the picture before, from state to state, as is known now. Metres.
    fn path_m(&self, body: BodyId, picture: &Picture) -> f32 {
        let snapshot = &picture.snapshot;
        let frames = (self.frame.0 + 1..=picture.frame.0).map(Frame);
        let at_frames = frames.map(|frame| frame.seconds(snapshot.frame_seconds()));
        let times = std::iter::once(self.time_s).chain(at_frames).chain([picture.time_s]);
        let places: Vec<Vec3> = times
            .filter_map(|time_s| snapshot.sample(body, time_s))
            .map(|sample| sample.pose.position)
            .collect();
        places.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
    }

    /// Whether a command put the body elsewhere since the picture before.
    fn is_moved(&self, body: BodyId, now: Frame) -> bool {
        self.moves.range((body, self.frame)..=(body, now)).next().is_some()
    }
}
