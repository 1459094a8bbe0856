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

use super::decoupled::Picture;
use crate::BodyId;

/// After this an offset is down to 5 %. Seconds.
const BLEND_S: f64 = 0.15;

/// `BLEND_S` divided by ln 20. Seconds.
const TIME_CONSTANT_S: f64 = BLEND_S / 2.995_732_273_553_991;

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
    pub(super) fn sample_all(
        &mut self,
        picture: &Picture,
        samples: &mut Vec<(BodyId, Sample)>,
    ) -> Blending {
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
        let now = Drawn {
            snapshot: Arc::clone(&picture.snapshot),
            time_s: picture.time_s,
            real_s: picture.real_s,
        };
        let Some(before) = self.drawn.replace(now) else { return };
        if !Arc::ptr_eq(&before.snapshot, &picture.snapshot) {
            for body in picture.snapshot.may_differ(&before.snapshot, before.time_s) {
                self.correct(body, &before, &picture.snapshot);
            }
        }
        let passed_s = (picture.real_s - before.real_s).max(0.0);
        if passed_s > 0.0 && !self.offsets.is_empty() {
            let factor = (-passed_s / TIME_CONSTANT_S).exp() as f32;
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
