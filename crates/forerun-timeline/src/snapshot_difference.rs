//! Snapshot difference: who is shown elsewhere by a newer snapshot, found by looking at what the two do not share.

use std::sync::Arc;

use forerun_dynamics::BodyId;

use crate::{Frame, Snapshot};

impl Snapshot {
    /// The bodies that the two snapshots may show in different places at a time (seconds). Sorted. There may be more than truly are: those with
    /// other states at the frames around the time, those that commands act on there, and those that wait in either to be recomputed.
    /// Costs a look at the blocks of states that the two do not share.
    #[must_use]
    pub fn may_differ(&self, other: &Snapshot, seconds: f64) -> Vec<BodyId> {
        let moment = self.moment(seconds);
        let next = if moment.part > 0.0 { moment.frame.next() } else { moment.frame };
        let mut bodies = self.differing_at(other, moment.frame);
        if next > moment.frame {
            bodies.extend(self.differing_at(other, next));
        }
        for snapshot in [self, other] {
            let waiting = snapshot.doubtful.iter().filter(|doubt| doubt.known_to < next);
            bodies.extend(waiting.map(|doubt| doubt.body));
            bodies.extend(snapshot.effects.get(&next).into_iter().flat_map(|effects| effects.keys()));
        }
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    }

    fn differing_at(&self, other: &Snapshot, frame: Frame) -> Vec<BodyId> {
        match (self.tables.get(frame), other.tables.get(frame)) {
            (Some(mine), Some(theirs)) if Arc::ptr_eq(mine, theirs) => Vec::new(),
            (Some(mine), Some(theirs)) => mine.differences(theirs),
            (Some(table), None) | (None, Some(table)) => table.iter().map(|(body, _)| body).collect(),
            (None, None) => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Change, Progress, Timeline, TimelineSettings};
    use forerun_dynamics::{BodyDef, Environment};
    use forerun_geometry::Vec3;
    use forerun_geometry::shape::{Shape, Sphere};

    fn balls() -> Timeline {
        let ball = |x: f32| BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 })).at(Vec3::X * x);
        let bodies: Vec<BodyDef> = (0..100).map(|i| ball(3.0 * i as f32)).collect();
        let mut timeline =
            Timeline::new(&bodies, Environment::default(), TimelineSettings::default()).unwrap();
        while timeline.advance() != Progress::Idle {}
        timeline
    }

    #[test]
    fn only_whom_a_command_reached_may_differ_and_only_from_there_on() {
        let mut timeline = balls();
        let before = timeline.snapshot();
        let frame_s = f64::from(before.frame_seconds());
        let push = Change::Push { body: BodyId(7), impulse: Vec3::Y * 900.0, at_point: None };
        timeline.change(Frame(20), push).unwrap();
        // Heard, not computed: it waits from the frame before on.
        let heard = timeline.snapshot();
        assert_eq!(heard.may_differ(&before, 19.0 * frame_s), []);
        assert_eq!(heard.may_differ(&before, 19.5 * frame_s), [BodyId(7)]);
        while timeline.advance() != Progress::Idle {}
        let after = timeline.snapshot();
        assert_eq!(after.may_differ(&before, 19.0 * frame_s), []);
        assert_eq!(after.may_differ(&before, 60.3 * frame_s), [BodyId(7)]);
        assert_eq!(before.may_differ(&after, 60.0 * frame_s), [BodyId(7)]);
        assert_eq!(after.may_differ(&after, 60.0 * frame_s), []);
    }
}
