//! Quality: what a step's time was paid for, from poses and velocities alone, by one code for all engines.
//!
//! The motions of any engine are put into a world of ours that never steps, and our meters look at that world.

use forerun::dynamics::{World, meter};
use forerun::{Body, BodyKind, BodyState, Scene, Shape, Vec3};
use serde::{Deserialize, Serialize};

use crate::engine::Motion;
use crate::stage::world_awake;

/// The meters look at every so many frames.
const EVERY: u32 = 10;

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Quality {
    /// Deepest overlap of two bodies at any time looked at. Metres.
    pub(crate) overlap_max_m: f32,
    /// The same at the end.
    pub(crate) overlap_end_m: f32,
    /// Most mechanical energy over that at frame 0; none where the scene starts without energy above the origin.
    pub(crate) energy_max_over_initial: Option<f64>,
    /// Mean speed of the dynamic bodies at the end. m/s.
    pub(crate) speed_end: f64,
    /// What only this scene can tell.
    pub(crate) own: Own,
    /// Bodies whose motion was not finite at the end.
    pub(crate) not_finite: usize,
    /// The most hulls that a mesh of the scene was cut into for this engine; 0: none was cut.
    pub(crate) hulls_per_mesh: usize,
}

/// A scene's own guard.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Own {
    /// Of a stack or pyramid: how far its top stands below where touching boxes would hold it, and how far any body has wandered sideways. Metres.
    Stands { low_m: f32, sideways_m: f32 },
    /// Of dominoes: how many have fallen, of how many.
    Fallen { count: usize, of: usize },
    /// Of all other scenes: bodies whose centre is below a ground, within a fixed box, or lower than all fixed boxes.
    Lost { count: usize },
}

impl Quality {
    /// The scene's own guard in words.
    pub(crate) fn own_text(&self) -> String {
        let mm = |metres: f32| format!("{:.1}", 1000.0 * metres);
        let own = match &self.own {
            Own::Stands { low_m, sideways_m } => {
                format!("{} mm low, {} mm sideways", mm(*low_m), mm(*sideways_m))
            }
            Own::Fallen { count, of } => format!("{count} of {of} fell"),
            Own::Lost { count } => format!("{count} lost"),
        };
        if self.not_finite > 0 { format!("{own}, {} not finite", self.not_finite) } else { own }
    }

    /// The same as a number that grows with what is wrong: metres or bodies. How many dominoes fell is right or wrong in no direction.
    pub(crate) fn own_badness(&self) -> f32 {
        match &self.own {
            Own::Stands { low_m, sideways_m } => low_m.abs().max(*sideways_m),
            Own::Fallen { .. } => 0.0,
            Own::Lost { count } => *count as f32,
        }
    }
}

/// Looks at the motions of an engine.
pub(crate) struct Meter {
    scene_name: String,
    start: World,
    now: World,
    energy_start_j: f64,
    energy_max_j: f64,
    overlap_max_m: f32,
    not_finite: usize,
}

impl Meter {
    pub(crate) fn new(scene: &Scene) -> Result<Self, String> {
        let start = world_awake(scene)?;
        let energy_start_j = meter::mechanical_energy_j(&start);
        Ok(Meter {
            scene_name: scene.name.clone(),
            now: start.clone(),
            start,
            energy_start_j,
            energy_max_j: energy_start_j,
            overlap_max_m: 0.0,
            not_finite: 0,
        })
    }

    pub(crate) fn is_due(frame: u32, frames: u32) -> bool {
        frame.is_multiple_of(EVERY) || frame + 1 == frames
    }

    /// One motion for each body of the scene. A motion that is not finite is counted and otherwise left out.
    pub(crate) fn look_at(&mut self, motions: &[Motion]) {
        let states: Vec<BodyState> = (self.now.bodies().iter().zip(motions))
            .map(|(body, m)| body.state_at(&m.pose, m.velocity, m.angular_velocity))
            .collect();
        self.not_finite = states.iter().filter(|state| !state.is_finite()).count();
        for (old, new) in self.now.states_mut().iter_mut().zip(states) {
            if new.is_finite() {
                *old = new;
            }
        }
        self.energy_max_j = self.energy_max_j.max(meter::mechanical_energy_j(&self.now));
        self.overlap_max_m = self.overlap_max_m.max(meter::deepest_overlap_m(&self.now));
    }

    pub(crate) fn finish(self, hulls_per_mesh: usize) -> Quality {
        let positive = self.energy_start_j > 0.0;
        Quality {
            overlap_max_m: self.overlap_max_m,
            overlap_end_m: meter::deepest_overlap_m(&self.now),
            energy_max_over_initial: positive.then_some(self.energy_max_j / self.energy_start_j),
            speed_end: meter::mean_speed(&self.now),
            own: own(&self.scene_name, &self.start, &self.now),
            not_finite: self.not_finite,
            hulls_per_mesh,
        }
    }
}

fn own(scene_name: &str, start: &World, end: &World) -> Own {
    match scene_name {
        "stack" => {
            // Boxes lie one on the other: the centre of the highest is at the sum of the heights below and half its own.
            let mut boxes: Vec<(f32, f32)> = dynamic(start)
                .filter_map(|(body, state)| Some((state.position.y, half_height(body)?)))
                .collect();
            boxes.sort_by(|a, b| a.0.total_cmp(&b.0));
            let heights: f32 = boxes.iter().map(|(_, half)| 2.0 * half).sum();
            let stands_at = heights - boxes.last().map_or(0.0, |(_, half)| *half);
            Own::Stands { low_m: stands_at - highest_m(end), sideways_m: sideways_m(start, end) }
        }
        "pyramid" | "large_pyramid" | "many_pyramids" => {
            Own::Stands { low_m: highest_m(start) - highest_m(end), sideways_m: sideways_m(start, end) }
        }
        "dominoes" | "interaction" => {
            let is_flat = |state: &BodyState, body: &Body| {
                let up = body.own_pose(state).rotation * Vec3::Y;
                up.y.abs() < std::f32::consts::FRAC_1_SQRT_2
            };
            let count = dynamic(end).filter(|(body, state)| is_flat(state, body)).count();
            Own::Fallen { count, of: dynamic(end).count() }
        }
        _ => Own::Lost { count: lost(end) },
    }
}

fn dynamic(world: &World) -> impl Iterator<Item = (&Body, &BodyState)> {
    world.bodies().iter().zip(world.states()).filter(|(body, _)| body.is_dynamic())
}

fn half_height(body: &Body) -> Option<f32> {
    if let Shape::Cuboid(cuboid) = &body.shape { Some(cuboid.half_extents.y) } else { None }
}

fn highest_m(world: &World) -> f32 {
    dynamic(world).map(|(_, state)| state.position.y).fold(f32::NEG_INFINITY, f32::max)
}

fn sideways_m(start: &World, end: &World) -> f32 {
    let moved = |(a, b): ((&Body, &BodyState), (&Body, &BodyState))| {
        let way = b.1.position - a.1.position;
        Vec3::new(way.x, 0.0, way.z).length()
    };
    dynamic(start).zip(dynamic(end)).map(moved).fold(0.0, f32::max)
}

fn lost(world: &World) -> usize {
    let fixed =
        || (world.bodies().iter().zip(world.states())).filter(|(body, _)| body.kind == BodyKind::Fixed);
    let is_inside = |(body, state): (&Body, &BodyState), position: Vec3| {
        let own = body.own_pose(state).inverse_transform_point(position);
        match &body.shape {
            Shape::HalfSpace => own.y < 0.0,
            Shape::Cuboid(cuboid) => own.abs().cmplt(cuboid.half_extents).all(),
            _ => false,
        }
    };
    let boxes = fixed().filter(|(body, _)| matches!(body.shape, Shape::Cuboid(_)));
    let bottoms = boxes.map(|(body, state)| body.shape.aabb(&body.own_pose(state)).min.y);
    let lowest = bottoms.fold(f32::INFINITY, f32::min);
    let is_lost = |position: Vec3| {
        fixed().any(|fixed| is_inside(fixed, position)) || (lowest.is_finite() && position.y < lowest)
    };
    dynamic(world).filter(|(_, state)| is_lost(state.position)).count()
}

#[cfg(test)]
mod tests {
    use forerun::{Pose, Quat};

    use super::*;

    fn motions(world: &World, place: impl Fn(usize, Vec3) -> Pose) -> Vec<Motion> {
        let still = |(i, (body, state)): (usize, (&Body, &BodyState))| Motion {
            pose: place(i, body.own_pose(state).position),
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
        };
        world.bodies().iter().zip(world.states()).enumerate().map(still).collect()
    }

    #[test]
    fn a_stack_put_down_a_little_low_is_measured_as_such() {
        let scene = Scene::open("stack:3").unwrap();
        let mut meter = Meter::new(&scene).unwrap();
        // Body 0 is the ground; each box is 10 mm into the one below.
        let standing = motions(&meter.start, |i, _| {
            Pose::from_position(Vec3::new(
                0.02,
                if i == 0 { 0.0 } else { i as f32 - 0.5 - 0.01 * i as f32 },
                0.0,
            ))
        });
        meter.look_at(&standing);
        let quality = meter.finish(0);
        assert!((quality.overlap_end_m - 0.01).abs() < 1e-5, "{}", quality.overlap_end_m);
        let Own::Stands { low_m, sideways_m } = quality.own else { panic!("{:?}", quality.own) };
        assert!((low_m - 0.03).abs() < 1e-5 && (sideways_m - 0.02).abs() < 1e-5, "{low_m} {sideways_m}");
        assert_eq!(quality.energy_max_over_initial, Some(1.0));
    }

    #[test]
    fn fallen_dominoes_and_lost_bodies_are_counted() {
        let meter = Meter::new(&Scene::open("dominoes:4").unwrap()).unwrap();
        let mut end = meter.start.clone();
        end.states_mut()[2].rotation = Quat::from_rotation_z(1.5);
        assert_eq!(own("dominoes", &meter.start, &end), Own::Fallen { count: 1, of: 4 });
        end.states_mut()[3].position.y = -0.1;
        assert_eq!(own("rain", &meter.start, &end), Own::Lost { count: 1 });
        let pit = Meter::new(&Scene::open("rain:10").unwrap()).unwrap();
        assert_eq!(own("rain", &pit.start, &pit.start), Own::Lost { count: 0 });
    }

    /// The ground is a box of 2 m whose top is at 0.
    #[test]
    fn rocks_in_the_ground_and_below_it_are_lost() {
        let meter = Meter::new(&Scene::open("convex_pile:4").unwrap()).unwrap();
        let mut end = meter.start.clone();
        assert_eq!(own("convex_pile", &meter.start, &end), Own::Lost { count: 0 });
        end.states_mut()[2].position.y = -0.1;
        end.states_mut()[3].position.y = -30.0;
        assert_eq!(own("convex_pile", &meter.start, &end), Own::Lost { count: 2 });
    }

    #[test]
    fn a_motion_that_is_not_finite_is_counted_and_left_out() {
        let mut meter = Meter::new(&Scene::open("stack:2").unwrap()).unwrap();
        let broken =
            motions(&meter.start, |i, place| Pose::from_position(if i == 1 { Vec3::NAN } else { place }));
        meter.look_at(&broken);
        let quality = meter.finish(0);
        assert_eq!(quality.not_finite, 1);
        assert!(quality.overlap_end_m.is_finite());
    }

    /// The same rock twice, turned at random, one in the other by up to half its size: by our meter and by parry, which looks for the
    /// shortest way out in a way of its own.
    #[cfg(feature = "engines")]
    #[test]
    fn overlap_of_two_rocks_is_the_one_that_parry_finds() {
        use rapier3d::math::{Pose as ParryPose, Rotation, Vector};
        use rapier3d::parry::query::contact;
        use rapier3d::prelude::SharedShape;

        let mut world = world_awake(&Scene::open("convex_pile:2").unwrap()).unwrap();
        let Shape::Hull(hull) = world.bodies()[1].shape.clone() else { panic!("not a hull") };
        let points: Vec<Vector> = hull.vertices.iter().map(|v| Vector::new(v.x, v.y, v.z)).collect();
        let rock = SharedShape::convex_hull(&points).unwrap();
        let parry_pose = |pose: &Pose| {
            let (p, q) = (pose.position, pose.rotation);
            ParryPose::from_parts(Vector::new(p.x, p.y, p.z), Rotation::from_xyzw(q.x, q.y, q.z, q.w))
        };
        // Directions and turns that fill the sphere without a generator: multiples of irrational parts of a turn.
        for i in 0..60_i32 {
            let part = |irrational: f32| 6.283_185_5 * (i as f32 * irrational).fract();
            let turn = Quat::from_rotation_y(part(0.618_034)) * Quat::from_rotation_x(part(0.414_214));
            let way = Quat::from_rotation_z(part(0.732_051)) * (turn * Vec3::X);
            let high = Vec3::Y * 100.0;
            let poses = [Pose::from_position(high), Pose::new(high + way * (2.0 + 0.03 * i as f32), turn)];
            for (i, pose) in [1, 2].into_iter().zip(&poses) {
                let state = world.bodies()[i].state_at(pose, Vec3::ZERO, Vec3::ZERO);
                world.states_mut()[i] = state;
            }
            let ours = meter::deepest_overlap_m(&world);
            let [a, b] = poses.each_ref().map(parry_pose);
            let found = contact(&a, &*rock, &b, &*rock, 0.0).unwrap();
            let parrys = found.map_or(0.0, |found| -found.dist);
            assert!((ours - parrys).abs() < 2e-3 + 0.02 * parrys, "{i}: {ours} m, parry {parrys} m");
        }
    }
}
