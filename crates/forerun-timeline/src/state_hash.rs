//! State hash: all states of a frame in 64 bits, to tell whether two runs are the same.

use forerun_dynamics::BodyState;

use crate::{Frame, Timeline};

impl Timeline {
    /// A 64-bit hash of all states at a frame, the same on every platform (FNV-1a over their bits, in the order of the bodies' names):
    /// that of [`World::state_hash`](forerun_dynamics::World::state_hash) where no body was removed. `None` when the frame is not kept, or not
    /// known to be true.
    #[must_use]
    pub fn state_hash(&self, frame: Frame) -> Option<u64> {
        let table = self.tables.get(frame).filter(|_| frame <= self.valid_to())?;
        Some(table.iter().fold(0xcbf2_9ce4_8422_2325, |hash, (_, state)| absorb(hash, state)))
    }
}

fn absorb(hash: u64, state: &BodyState) -> u64 {
    let bytes = state.bits().into_iter().flat_map(u32::to_le_bytes);
    bytes.fold(hash, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Progress, TimelineSettings};
    use forerun_dynamics::{BodyDef, Environment, Unobserved, World};
    use forerun_geometry::Vec3;
    use forerun_geometry::shape::{Shape, Sphere};

    #[test]
    fn the_hash_is_that_of_a_world() {
        let bodies = [0.0, 0.7].map(|x| BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 })).at(Vec3::X * x));
        let mut world = World::new(Environment::default());
        for body in &bodies {
            world.add(body).unwrap();
        }
        let settings = TimelineSettings { lookahead: 10, ..TimelineSettings::default() };
        let mut timeline = Timeline::new(&bodies, Environment::default(), settings).unwrap();
        while timeline.advance() != Progress::Idle {}
        for frame in 0..=10 {
            assert_eq!(timeline.state_hash(Frame(frame)), Some(world.state_hash()), "frame {frame}");
            world.step(&mut Unobserved);
        }
        assert_eq!(timeline.state_hash(Frame(11)), None);
        let push = crate::Change::SetVelocity {
            body: forerun_dynamics::BodyId(0),
            velocity: Vec3::X,
            angular_velocity: Vec3::ZERO,
        };
        timeline.change(Frame(5), push).unwrap();
        assert!(timeline.state_hash(Frame(4)).is_some() && timeline.state_hash(Frame(5)).is_none());
    }
}
