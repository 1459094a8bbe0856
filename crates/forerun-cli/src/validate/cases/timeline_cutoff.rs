//! Early cutoff: an edit that makes no difference costs a frame, one that is taken back costs the frames between; one whose difference is
//! in the rest or in the velocity alone goes on.

use forerun::dynamics::Material;
use forerun::timeline::{Change, Frame, Timeline};
use forerun::{BodyDef, BodyId, BodyKind, Cuboid, Environment, Pose, Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::built_in;
use crate::validate::timelines::{computed, edit, push, wrong};

const FRAMES: u32 = 300;
const EDIT: Frame = Frame(100);

pub(crate) fn run() -> Vec<Figure> {
    let mut scene = built_in("many_pyramids:4");
    let cube = || BodyDef::new(Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) }));
    let faller = BodyId(scene.0.len() as u32);
    let wall = BodyId(faller.0 + 1);
    scene.0.push(cube().at(Vec3::new(0.0, 900.0, 0.0)));
    let mut far = cube().at(Vec3::new(500.0, 0.5, 0.0));
    far.kind = BodyKind::Kinematic;
    scene.0.push(far);
    let before = computed(&scene, FRAMES);
    let mut figures = Vec::new();
    no_ops(&mut figures, &before, &scene, faller);
    taken_back(&mut figures, &before, &scene, wall);
    hidden(&mut figures, &before, &scene, faller);
    figures
}

/// Edits after which everything is as it was.
fn no_ops(figures: &mut Vec<Figure>, before: &Timeline, scene: &(Vec<BodyDef>, Environment), body: BodyId) {
    let Some(state) = before.state(body, EDIT).copied() else { return };
    let comes = BodyId(before.names() as u32);
    let def = Box::new(BodyDef::fixed(Shape::half_space()));
    let changes = [
        vec![push(before, body, Vec3::ZERO)],
        vec![Change::Move { body, pose: Pose::new(state.position, state.rotation) }],
        vec![Change::SetMaterial { body, material: Material::default() }],
        vec![Change::SetGravityScale { body, scale: 1.0 }],
        vec![Change::Add { body: comes, def }, Change::Remove { body: comes }],
    ];
    let (mut frames, mut affected, mut differ) = (0, 0, 0.0);
    for batch in changes {
        let mut timeline = before.fork();
        let _ = timeline.reserve_body();
        let work = edit(&mut timeline, batch.into_iter().map(|change| (EDIT, change)));
        frames = frames.max(work.len());
        affected += work.iter().map(|done| done.affected).sum::<u32>();
        differ += wrong(&timeline, scene);
    }
    figures.extend([
        Figure::at_most("no-op: frames computed again", frames as f64, 1.0),
        Figure::at_most("no-op: states changed", f64::from(affected), 0.0),
        Figure::at_most("no-op: states that are not those of a full run", differ, 0.0),
    ]);
}

/// A wall far away is moved out, and back after 1, 10 and 100 frames.
fn taken_back(
    figures: &mut Vec<Figure>,
    before: &Timeline,
    scene: &(Vec<BodyDef>, Environment),
    wall: BodyId,
) {
    let to = |x: f32| Change::Move { body: wall, pose: Pose::from_position(Vec3::new(x, 0.5, 0.0)) };
    for n in [1, 10, 100] {
        let mut timeline = before.fork();
        let work = edit(&mut timeline, [(EDIT, to(600.0)), (EDIT.plus(n), to(500.0))]);
        let name = format!("taken back after {n} frames: frames computed again");
        figures.push(Figure::at_most(name, work.len() as f64, (n + 2) as f64));
        figures.push(Figure::at_most(
            format!("taken back after {n} frames: states that are not those of a full run"),
            wrong(&timeline, scene),
            0.0,
        ));
    }
}

/// Differences that do not show in a pose at the frame of the edit.
fn hidden(figures: &mut Vec<Figure>, before: &Timeline, scene: &(Vec<BodyDef>, Environment), faller: BodyId) {
    // A body of a pyramid that counts how long it was quiet; else any of them.
    let rest = |frame: u64| before.state(BodyId(1), Frame(frame)).map_or(0, |state| state.rest);
    let full = before.environment_at(Frame(0)).settings.rest_frames();
    let counting = (1..u64::from(FRAMES)).find(|frame| (2..full).contains(&rest(*frame)));
    let velocity = before.state(faller, EDIT).map_or(Vec3::ZERO, |state| state.velocity);
    let faster = Change::SetVelocity {
        body: faller,
        velocity: velocity + Vec3::Y * 1e-3,
        angular_velocity: Vec3::ZERO,
    };
    let edits = [
        ("rest alone", counting.map(|frame| (Frame(frame), push(before, BodyId(1), Vec3::ZERO)))),
        ("velocity alone", Some((EDIT, faster))),
    ];
    for (what, change) in edits {
        let mut timeline = before.fork();
        let work = edit(&mut timeline, change);
        figures.extend([
            Figure::at_least(format!("{what} differs: frames computed again"), work.len() as f64, 2.0),
            Figure::at_most(
                format!("{what} differs: states that are not those of a full run"),
                wrong(&timeline, scene),
                0.0,
            ),
        ]);
    }
}
