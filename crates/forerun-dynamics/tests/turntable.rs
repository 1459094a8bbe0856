//! What a turning kinematic body carries goes round with it.

mod common;

use common::{cuboid, run, world_of};
use forerun_dynamics::BodyKind;
use forerun_geometry::Vec3;

/// Case A18, short: friction 0.5 holds up to 1.81 rad/s at 1.5 m. With the arms of the frame's beginning the cube went 91 mm outwards.
#[test]
fn a_cube_on_a_turntable_stays_where_it_is() {
    let (spin, way) = (1.6, 1.5);
    let mut table = cuboid(Vec3::new(2.0, 0.1, 2.0), Vec3::new(0.0, -0.1, 0.0));
    table.kind = BodyKind::Kinematic;
    table.angular_velocity = Vec3::Y * spin;
    let mut cube = cuboid(Vec3::splat(0.125), Vec3::new(way, 0.125, 0.0));
    cube.velocity = Vec3::new(0.0, 0.0, -spin * way);
    cube.angular_velocity = Vec3::Y * spin;
    let mut world = world_of(&[table, cube]);
    run(&mut world, 120);
    let place = world.states()[1].position;
    let distance = (place.x * place.x + place.z * place.z).sqrt();
    assert!((distance - way).abs() < 0.005, "{distance} m from the middle after 2 s");
}
