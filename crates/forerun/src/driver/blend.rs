//! Blend: what was drawn is not contradicted by a jump.
//!
//! A newer snapshot may say something else about the last display time than what was drawn then: a command came late from a network, one was
//! taken back, or a body that was extrapolated is now known. The difference becomes an offset of that body, which dies away in real
//! time; display time goes on. Who differs is found by comparing what the two snapshots do not share, so nothing costs nothing.
//!
//! Promise: a body whose states around the last display time are the same in both snapshots is drawn exactly as the snapshot says.
//!
//! The offset dies away exponentially: that has no memory, so that a body which is corrected at every picture is drawn towards the truth
//! all the same, and it never overshoots.

use std::sync::Arc;

use forerun_geometry::{Quat, Vec3};
use forerun_timeline::{Sample, Snapshot};

use super::picture::Picture;
use crate::BodyId;

/// An offset is divided by e in this. Seconds.
const TIME_CONSTANT_S: f64 = Blending::SECONDS / LN_20;
const LN_20: f64 = 2.995_732_273_553_991;

/// What nobody sees any more. Metres, and radians.
const DONE_M: f32 = 5e-4;
const DONE_RAD: f32 = 1e-3;

/// How far a body is drawn off the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    /// What is added to its position. Metres.
    pub position: Vec3,
    /// How it is turned after that, in the world.
    pub rotation: Quat,
}

impl Offset {
    const NONE: Offset = Offset { position: Vec3::ZERO, rotation: Quat::IDENTITY };

    /// How far the body is turned off the truth. Radians.
    #[must_use]
    pub fn angle_rad(&self) -> f32 {
        let q = self.rotation;
        let (sine, cosine) = (Vec3::new(q.x, q.y, q.z).length(), q.w.abs());
        (2.0 * f64::from(sine).atan2(f64::from(cosine))) as f32
    }

    fn applied_to(&self, mut sample: Sample) -> Sample {
        sample.pose.position += self.position;
        sample.pose.rotation = (self.rotation * sample.pose.rotation).normalize();
        sample
    }

    fn between(drawn: &Sample, truth: &Sample) -> Offset {
        Offset {
            position: drawn.pose.position - truth.pose.position,
            rotation: (drawn.pose.rotation * truth.pose.rotation.conjugate()).normalize(),
        }
    }

    /// What is left of it; none when nobody would see it, or it is no number that can be drawn.
    fn faded(&self, factor: f32) -> Option<Offset> {
        let Quat { x, y, z, w } = self.rotation;
        // The short way round.
        let q = if w < 0.0 { Quat::from_xyzw(-x, -y, -z, -w) } else { self.rotation };
        let faded = Offset { position: self.position * factor, rotation: Quat::IDENTITY.slerp(q, factor) };
        let seen = faded.position.length() > DONE_M || faded.angle_rad() > DONE_RAD;
        (seen && faded.position.is_finite() && faded.rotation.is_finite()).then_some(faded)
    }
}

/// How far a picture is off the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Blending {
    /// Bodies that are drawn elsewhere than they are.
    pub bodies: u32,
    /// The farthest of them. Metres.
    pub off_max_m: f32,
    /// The most turned of them. Radians.
    pub off_max_rad: f32,
}

impl Blending {
    /// What a body is drawn off the truth is down to 5 % after this. Seconds.
    pub const SECONDS: f64 = 0.15;

    /// What is left of an offset after some seconds, as a factor.
    #[must_use]
    pub fn left_after(seconds: f64) -> f64 {
        (-seconds / TIME_CONSTANT_S).exp()
    }
}

/// The offsets, and what was drawn last.
#[derive(Debug, Default)]
pub(super) struct Blend {
    /// Sorted by body.
    offsets: Vec<(BodyId, Offset)>,
    drawn: Option<Drawn>,
}

#[derive(Debug)]
struct Drawn {
    snapshot: Arc<Snapshot>,
    time_s: f64,
    real_s: f64,
}

impl Blend {
    /// The bodies of a picture as they are to be drawn. `samples` is emptied first and keeps its memory.
    pub(super) fn sample_all(&mut self, picture: &Picture, samples: &mut Vec<(BodyId, Sample)>) -> Blending {
        self.take_up(picture);
        picture.snapshot.sample_all(picture.time_s, samples);
        self.apply(samples)
    }

    /// Forgets what was drawn: display time is elsewhere on purpose.
    pub(super) fn forget(&mut self) {
        *self = Blend::default();
    }

    pub(super) fn offsets(&self) -> &[(BodyId, Offset)] {
        &self.offsets
    }

    /// Brings the offsets up to this picture.
    fn take_up(&mut self, picture: &Picture) {
        let now =
            Drawn { snapshot: Arc::clone(&picture.snapshot), time_s: picture.time_s, real_s: picture.real_s };
        let Some(before) = self.drawn.replace(now) else { return };
        if !Arc::ptr_eq(&before.snapshot, &picture.snapshot) {
            for body in picture.snapshot.may_differ(&before.snapshot, before.time_s) {
                self.correct(body, &before, &picture.snapshot);
            }
        }
        let passed_s = (picture.real_s - before.real_s).max(0.0);
        if passed_s > 0.0 && !self.offsets.is_empty() {
            let factor = Blending::left_after(passed_s) as f32;
            self.offsets.retain_mut(|(_, offset)| match offset.faded(factor) {
                Some(faded) => {
                    *offset = faded;
                    true
                }
                None => false,
            });
        }
    }

    /// The offset of a body is such that it would have been drawn where it was.
    fn correct(&mut self, body: BodyId, before: &Drawn, snapshot: &Snapshot) {
        let place = self.offsets.binary_search_by_key(&body, |(id, _)| *id);
        let was = before.snapshot.sample(body, before.time_s);
        let is = snapshot.sample(body, before.time_s);
        // A body that appears or is gone has nothing to be blended with.
        let Some((was, is)) = was.zip(is) else {
            if let Ok(index) = place {
                self.offsets.remove(index);
            }
            return;
        };
        if was.pose == is.pose {
            return;
        }
        let old = place.map_or(Offset::NONE, |index| self.offsets[index].1);
        let offset = Offset::between(&old.applied_to(was), &is);
        match place {
            Ok(index) => self.offsets[index].1 = offset,
            Err(index) => self.offsets.insert(index, (body, offset)),
        }
    }

    fn apply(&mut self, samples: &mut [(BodyId, Sample)]) -> Blending {
        let mut blending = Blending::default();
        self.offsets.retain(|(body, offset)| {
            let Ok(index) = samples.binary_search_by_key(body, |(id, _)| *id) else { return false };
            let sample = &mut samples[index].1;
            *sample = offset.applied_to(*sample);
            blending.bodies += 1;
            blending.off_max_m = blending.off_max_m.max(offset.position.length());
            blending.off_max_rad = blending.off_max_rad.max(offset.angle_rad());
            true
        });
        blending
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BodyDef, Change, Environment, Frame, Pose, Shape, Sphere, Timeline, TimelineSettings};
    use forerun_timeline::{Progress, Stats};

    const FRAME_S: f64 = (1.0_f32 / 60.0) as f64;
    const PICTURE_S: f64 = 1.0 / 144.0;

    /// Twenty balls that fly side by side and turn.
    fn timeline() -> Timeline {
        let ball = |i: u16| BodyDef {
            velocity: Vec3::X * 2.0,
            angular_velocity: Vec3::Y * 3.0,
            gravity_scale: 0.0,
            ..BodyDef::new(Shape::Sphere(Sphere { radius: 0.3 })).at(Vec3::Z * (2.0 * f32::from(i)))
        };
        let bodies: Vec<BodyDef> = (0..20).map(ball).collect();
        let mut timeline =
            Timeline::new(&bodies, Environment::default(), TimelineSettings::default()).expect("plain balls");
        run(&mut timeline);
        timeline
    }

    fn run(timeline: &mut Timeline) {
        while timeline.advance() != Progress::Idle {}
    }

    fn picture(snapshot: &Arc<Snapshot>, time_s: f64) -> Picture {
        Picture {
            snapshot: Arc::clone(snapshot),
            time_s,
            wished_s: time_s,
            real_s: time_s,
            rate: 1.0,
            frame: Frame((time_s / FRAME_S) as u64),
            note: None,
            dropped_to: None,
            stats: Stats::default(),
        }
    }

    #[test]
    fn a_contradicted_body_goes_from_where_it_was_drawn_to_where_it_is() {
        let mut timeline = timeline();
        let (before, mut blend) = (timeline.snapshot(), Blend::default());
        let mut samples = Vec::new();
        let start_s = 40.3 * FRAME_S;
        blend.sample_all(&picture(&before, start_s), &mut samples);
        let mut drawn = samples[7].1.pose;
        // Somebody says late that it was put elsewhere, and turned, ten frames ago.
        let turned = glam_quat(1.2);
        let pose = Pose { position: drawn.position + Vec3::new(0.0, 0.8, -0.3), rotation: turned };
        timeline.change(Frame(30), Change::Move { body: BodyId(7), pose }).expect("a plain change");
        run(&mut timeline);
        let after = timeline.snapshot();
        let mut off = f32::INFINITY;
        for step in 1..=72_u16 {
            let time_s = start_s + f64::from(step) * PICTURE_S;
            let blending = blend.sample_all(&picture(&after, time_s), &mut samples);
            let (shown, truth) = (samples[7].1.pose, after.sample(BodyId(7), time_s).expect("there").pose);
            let moved = shown.position.distance(drawn.position);
            // The jump of 0.9 m is spread: no picture shows more than 14 % of it, and its own motion.
            assert!(moved < 0.15 + 2.0 * PICTURE_S as f32, "picture {step} jumps by {moved}");
            assert!(blending.off_max_m < off || off == 0.0, "picture {step}: {blending:?} after {off}");
            assert!((shown.position.distance(truth.position) - blending.off_max_m).abs() < 1e-4);
            off = blending.off_max_m;
            if step == 22 {
                assert!(off < 0.08 && blending.off_max_rad < 0.12, "after 0.15 s: {blending:?}");
            }
            // The others are drawn as they are, to the bit.
            for (body, sample) in samples.iter().filter(|(body, _)| *body != BodyId(7)) {
                assert_eq!(Some(*sample), after.sample(*body, time_s));
            }
            drawn = shown;
        }
        assert!(blend.offsets().is_empty(), "half a second later it is where it is");
    }

    fn glam_quat(angle: f64) -> Quat {
        Quat::from_xyzw((0.5 * angle).sin() as f32, 0.0, 0.0, (0.5 * angle).cos() as f32)
    }

    #[test]
    fn a_body_that_was_extrapolated_is_led_back_to_what_came_out() {
        let mut timeline = timeline();
        let mut samples = Vec::new();
        let mut blend = Blend::default();
        let time_s = 50.9 * FRAME_S;
        // Told, not computed: it is drawn as it went on before.
        let velocity = Vec3::Z * -8.0;
        let change = Change::SetVelocity { body: BodyId(0), velocity, angular_velocity: Vec3::ZERO };
        timeline.change(Frame(46), change).expect("a plain change");
        let late = timeline.snapshot();
        blend.sample_all(&picture(&late, time_s), &mut samples);
        let drawn = samples[0].1;
        assert!(drawn.certainty > forerun_timeline::Certainty::Presumed);
        run(&mut timeline);
        let known = timeline.snapshot();
        let blending = blend.sample_all(&picture(&known, time_s), &mut samples);
        assert!(samples[0].1.pose.position.distance(drawn.pose.position) < 1e-5);
        assert!(blending.bodies == 1 && blending.off_max_m > 0.4, "{blending:?}");
    }

    #[test]
    fn what_is_gone_or_new_is_not_blended() {
        let mut timeline = timeline();
        let mut samples = Vec::new();
        let mut blend = Blend::default();
        let time_s = 50.0 * FRAME_S;
        blend.sample_all(&picture(&timeline.snapshot(), time_s), &mut samples);
        timeline.change(Frame(20), Change::Remove { body: BodyId(3) }).expect("a plain change");
        let def = BodyDef::new(Shape::Sphere(Sphere { radius: 0.3 })).at(Vec3::Y * 30.0);
        let body = timeline.reserve_body();
        timeline.change(Frame(20), Change::Add { body, def: Box::new(def) }).expect("a plain change");
        run(&mut timeline);
        let blending = blend.sample_all(&picture(&timeline.snapshot(), time_s), &mut samples);
        assert_eq!(blending, Blending::default());
        assert!(samples.iter().any(|(id, _)| *id == body) && samples.iter().all(|(id, _)| *id != BodyId(3)));
    }

    #[test]
    fn a_correction_at_every_picture_still_ends_near_the_truth() {
        let mut timeline = timeline();
        let mut samples = Vec::new();
        let mut blend = Blend::default();
        let mut worst = 0.0_f32;
        for step in 0..60_u16 {
            let time_s = (20.5 + f64::from(step)) * FRAME_S;
            let shown = blend.sample_all(&picture(&timeline.snapshot(), time_s), &mut samples);
            worst = worst.max(shown.off_max_m);
            // Every picture somebody says that it was 2 cm to the side five frames ago.
            let frame = Frame(20 + u64::from(step) - 5);
            let was = timeline.snapshot().sample(BodyId(1), frame.seconds(FRAME_S as f32)).expect("there");
            let pose = Pose { position: was.pose.position + Vec3::Y * 0.02, ..was.pose };
            timeline.change(frame, Change::Move { body: BodyId(1), pose }).expect("a plain change");
            run(&mut timeline);
        }
        // 0.02 m / (1 - e^(-dt/tau)) is the limit of the sum.
        assert!(worst > 0.02 && worst < 0.075, "{worst} m");
    }
}
