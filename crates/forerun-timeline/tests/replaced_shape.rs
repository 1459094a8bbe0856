//! Replaced shape: another shape under the same name reaches whoever stands on it.

use forerun_dynamics::{BodyDef, BodyId, Environment};
use forerun_geometry::Vec3;
use forerun_geometry::shape::{Cuboid, Shape};
use forerun_timeline::check::{full_run, mismatches};
use forerun_timeline::{Change, Command, Frame, Order, Progress, Timeline, TimelineSettings};

fn slab(thick: f32) -> Box<BodyDef> {
    Box::new(BodyDef::fixed(Shape::Cuboid(Cuboid { half_extents: Vec3::new(2.0, thick, 2.0) })))
}

fn finish(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

#[test]
fn a_body_added_by_another_definition_is_another_body() {
    let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.25) });
    let bodies = [BodyDef::new(cube).at(Vec3::Y)];
    for replace in [true, false] {
        let mut timeline =
            Timeline::new(&bodies, Environment::default(), TimelineSettings::default()).unwrap();
        let body = timeline.reserve_body();
        assert_eq!(body, BodyId(1));
        let key = timeline.change(Frame(5), Change::Add { body, def: slab(0.1) }).unwrap();
        finish(&mut timeline);
        let command = Command { key, change: Change::Add { body, def: slab(0.4) } };
        if replace {
            timeline.obey(Order::Replace(command.clone())).unwrap();
        } else {
            timeline.obey(Order::Retract(key)).unwrap();
            timeline.obey(Order::Submit(command.clone())).unwrap();
        }
        finish(&mut timeline);
        let full = full_run(&bodies, [command], Environment::default(), 100).unwrap();
        assert_eq!(mismatches(&timeline, &full), (0, None), "replace: {replace}");
    }
}
