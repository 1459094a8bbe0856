//! What a display sees of a timeline besides its states: what is inside frames, areas and their clocks, marks along the time, previews.

mod scenes;

use forerun_dynamics::{BodyDef, BodyId, Environment};
use forerun_geometry::shape::{Shape, Sphere};
use forerun_geometry::{Pose, Vec3};
use forerun_timeline::{
    Change, CommandError, Frame, Preview, PreviewRun, Previewed, Progress, Timeline, TimelineSettings,
};

fn run(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

/// Six piles of four boxes on one ground, 60 frames of them.
fn piles() -> Timeline {
    let settings = TimelineSettings { lookahead: 60, past: 1000, ..TimelineSettings::default() };
    let mut timeline =
        Timeline::new(&scenes::all().swap_remove(0).1, Environment::default(), settings).unwrap();
    run(&mut timeline);
    timeline
}

fn push(body: u32, impulse: f32) -> Change {
    Change::Push { body: BodyId(body), impulse: Vec3::new(0.0, 0.0, impulse), at_point: None }
}

#[test]
fn a_frame_is_looked_into_as_it_was_stepped() {
    let mut timeline = piles();
    timeline.change(Frame(20), push(4, 9000.0)).unwrap();
    run(&mut timeline);
    let snapshot = timeline.snapshot();
    let inspection = snapshot.inspect(Frame(10)).unwrap();
    assert_eq!(inspection.frame, Frame(10));
    let islands: Vec<(u32, u32)> = inspection.step.islands.iter().map(|i| (i.island.0, i.bodies)).collect();
    assert_eq!(islands, [(1, 4), (5, 4), (9, 4), (13, 4), (17, 4), (21, 4)]);
    let levels: Vec<Option<u32>> = inspection.step.bodies[1..9].iter().map(|body| body.level).collect();
    assert_eq!(levels, [1, 2, 3, 4, 1, 2, 3, 4].map(Some));
    // Every pile stands on the ground with its whole weight.
    let weight = 4.0 * 1000.0 * 9.81 * snapshot.frame_seconds();
    for pile in 0..6 {
        let standing = inspection.step.contacts.iter().filter(|c| c.second == BodyId(4 * pile + 1));
        let impulse: f32 = standing.map(|contact| contact.impulse()).sum();
        assert!((impulse / weight - 1.0).abs() < 0.02, "pile {pile}: {impulse} of {weight} N s");
    }
    // The pushed box slides off.
    let after = snapshot.inspect(Frame(20)).unwrap();
    let rubs =
        after.step.contacts.iter().filter(|c| c.second == BodyId(4)).map(|c| c.friction.z).sum::<f32>();
    assert!(rubs < -10.0, "{rubs} N s");
    assert_eq!(snapshot.inspect(Frame(61)), None);
}

#[test]
fn areas_have_the_bodies_that_visit_them_and_clocks_that_commands_set_back() {
    let ball = |x: f32, y: f32| BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 })).at(Vec3::new(x, y, 0.5));
    let bodies = [BodyDef::fixed(Shape::HalfSpace), ball(0.5, 0.5), ball(40.5, 100.0)];
    let settings = TimelineSettings { lookahead: 160, area_m: Some(2.0), ..TimelineSettings::default() };
    let mut timeline = Timeline::new(&bodies, Environment::default(), settings).unwrap();
    run(&mut timeline);
    let snapshot = timeline.snapshot();
    let areas = snapshot.areas(Frame(150));
    assert!(areas.iter().all(|area| area.clock == Frame(160) && area.visitors == 1));
    assert!(areas.windows(2).all(|pair| pair[0].area < pair[1].area));
    for body in [1, 2] {
        let position = snapshot.state(BodyId(body), Frame(150)).unwrap().position;
        let here = areas.iter().find(|area| {
            let (min, max) = (area.bounds.min, area.bounds.max);
            min.cmple(position).all() && position.cmplt(max).all()
        });
        let here = here.expect("it is somewhere");
        assert_eq!(here.bounds.max - here.bounds.min, Vec3::splat(2.0));
        assert_eq!(Vec3::from_array(here.area.map(|c| 2.0 * c as f32)), here.bounds.min);
        // The one that lies, and has come to rest, is not active; the one that falls is.
        assert_eq!(here.active, body == 2, "{here:?}");
    }
    assert_eq!(snapshot.areas(Frame(161)), []);
    assert_eq!(timeline.areas_active(Frame(150)) as usize, areas.iter().filter(|area| area.active).count());
    // A command puts the areas of its body out of date, and no others.
    timeline
        .change(Frame(155), Change::Push { body: BodyId(2), impulse: Vec3::X * 400.0, at_point: None })
        .unwrap();
    let clocks = |areas: Vec<forerun_timeline::InspectedArea>| -> Vec<([i32; 3], Frame)> {
        areas.iter().filter(|area| area.clock < Frame(160)).map(|area| (area.area, area.clock)).collect()
    };
    let waiting = clocks(timeline.snapshot().areas(Frame(154)));
    assert!(!waiting.is_empty() && waiting.iter().all(|(area, clock)| area[0] >= 18 && *clock == Frame(154)));
    assert_eq!(waiting, timeline.area_clocks());
    run(&mut timeline);
    assert_eq!(clocks(timeline.snapshot().areas(Frame(154))), []);
}

#[test]
fn snapshots_know_the_commands_what_they_cost_and_what_waits() {
    let mut timeline = piles();
    let empty = timeline.snapshot();
    assert!(!empty.can_undo() && !empty.can_redo() && empty.commands().next().is_none());
    assert_eq!((empty.waiting(), empty.edits().count()), (vec![], 0));
    let late = timeline.change(Frame(40), push(8, 3000.0)).unwrap();
    let early = timeline.change(Frame(20), push(4, 3000.0)).unwrap();
    let beyond = timeline.change(Frame(500), push(4, 3000.0)).unwrap();
    let snapshot = timeline.snapshot();
    let keys: Vec<_> = snapshot.commands().map(|(key, _)| *key).collect();
    assert_eq!(keys, [early, late, beyond]);
    assert!(snapshot.commands().eq(timeline.commands()));
    assert_eq!(snapshot.waiting(), [(Frame(19), 1), (Frame(39), 1)]);
    assert_eq!([4, 8, 12].map(|body| snapshot.known_to(BodyId(body))), [19, 39, 60].map(Frame));
    assert!(snapshot.can_undo() && !snapshot.can_redo());
    run(&mut timeline);
    timeline.undo().unwrap();
    timeline.retract(&late);
    let undone = timeline.snapshot();
    assert!(undone.can_undo() && undone.can_redo());
    assert_eq!(undone.commands().map(|(key, _)| *key).collect::<Vec<_>>(), [early]);
    run(&mut timeline);
    assert!(timeline.snapshot().edits().eq(timeline.edits()));
    assert_eq!(timeline.snapshot().edits().map(|edit| edit.commands).collect::<Vec<_>>(), [3, 1]);
    // What was taken before has not changed.
    assert_eq!(snapshot.commands().count(), 3);
    timeline.set_display(Frame(60));
    for _ in 0..3 {
        run(&mut timeline);
        timeline.set_display(Frame(timeline.horizon().0));
    }
}

#[test]
fn commands_that_are_no_longer_kept_are_forgotten_by_later_snapshots() {
    let settings = TimelineSettings { lookahead: 60, past: 5, ..TimelineSettings::default() };
    let mut timeline =
        Timeline::new(&scenes::all().swap_remove(0).1, Environment::default(), settings).unwrap();
    // Commands act after the oldest frame, which is 7 once frame 12 is shown.
    for frame in [7, 9] {
        timeline.change(Frame(frame), push(4, 100.0)).unwrap();
    }
    run(&mut timeline);
    let before = timeline.snapshot();
    timeline.set_display(Frame(12));
    run(&mut timeline);
    let frames = |snapshot: &forerun_timeline::Snapshot| -> Vec<u64> {
        snapshot.commands().map(|(key, _)| key.frame.0).collect()
    };
    assert_eq!((frames(&before), frames(&timeline.snapshot())), (vec![7, 9], vec![9]));
}

fn previewed(timeline: &Timeline, preview: Preview) -> Result<Previewed, CommandError> {
    let mut run = PreviewRun::new(timeline.fork(), preview)?;
    while run.advance() {}
    Ok(run.so_far())
}

#[test]
fn a_preview_is_what_then_happens_and_changes_nothing() {
    let mut timeline = piles();
    let before = timeline.fork();
    let throw = |body: BodyId| {
        let mut ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.4 })).at(Vec3::new(-4.0, 1.5, 0.0));
        ball.velocity = Vec3::new(15.0, 2.0, 0.0);
        Change::Add { body, def: Box::new(ball) }
    };
    // Further than what is computed, and with a name that is given later.
    let (at, frames) = (Frame(25), 60);
    let name = BodyId(timeline.names() as u32 + 3);
    let preview = Preview { frame: at, changes: vec![throw(name), push(4, 500.0)], frames, bodies: vec![] };
    let told = previewed(&timeline, preview.clone()).unwrap();
    assert_eq!((told.frame, told.to), (at, Frame(85)));
    assert_eq!(timeline.diff(&before), None);
    assert_eq!(timeline.commands().count(), 0);

    while timeline.names() <= name.0 as usize {
        timeline.reserve_body();
    }
    timeline.set_lookahead(frames + 25);
    timeline.change(at, throw(name)).unwrap();
    timeline.change(at, push(4, 500.0)).unwrap();
    run(&mut timeline);
    let mut most = 0.0_f32;
    for trail in &told.trails {
        assert_eq!(trail.from, if trail.body == name { at } else { Frame(24) });
        assert_eq!(trail.poses.len() as u64, told.to.since(trail.from) + 1);
        for (k, pose) in trail.poses.iter().enumerate() {
            let frame = trail.from.plus(k as u64);
            let (body, state) =
                (timeline.body_at(trail.body, frame).unwrap(), timeline.state(trail.body, frame).unwrap());
            let truth: Pose = body.own_pose(state);
            assert_eq!((pose.position, pose.rotation), (truth.position, truth.rotation), "{frame}");
            most = most.max((pose.position - trail.poses[0].position).length());
        }
    }
    assert!(most > 2.0, "the ball flies");
    // Those that come out otherwise, and no others.
    let bodies: Vec<u32> = told.trails.iter().map(|trail| trail.body.0).collect();
    assert!(bodies.contains(&1) && bodies.contains(&4) && bodies.contains(&name.0), "{bodies:?}");
    assert!(!bodies.contains(&0) && !bodies.contains(&24), "{bodies:?}");
    // Asked by name: these alone.
    let named = Preview { bodies: vec![BodyId(24), BodyId(999)], ..preview };
    let told = previewed(&before, named).unwrap();
    assert_eq!(told.trails.iter().map(|trail| trail.body).collect::<Vec<_>>(), [BodyId(24)]);
}

#[test]
fn a_preview_that_is_not_possible_says_why() {
    let timeline = piles();
    let preview = |frame, change| Preview { frame, changes: vec![change], frames: 10, bodies: vec![] };
    let refused = previewed(&timeline, preview(Frame(0), push(4, 1.0)));
    assert_eq!(refused, Err(CommandError::TooOld { frame: Frame(0), oldest: Frame(0) }));
    let refused = previewed(&timeline, preview(Frame(5), push(400, 1.0)));
    assert_eq!(refused, Err(CommandError::UnknownBody(BodyId(400))));
    let far = Change::Add { body: BodyId(u32::MAX), def: Box::new(BodyDef::fixed(Shape::HalfSpace)) };
    let refused = previewed(&timeline, preview(Frame(5), far));
    assert_eq!(refused, Err(CommandError::UnknownBody(BodyId(u32::MAX))));
}

#[test]
fn a_preview_tells_of_a_bounded_number_of_bodies_and_of_the_one_that_is_thrown_in_any_case() {
    let ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.1 }));
    let balls: Vec<BodyDef> = (0..200_u8).map(|i| ball.clone().at(Vec3::X * f32::from(i))).collect();
    let settings = TimelineSettings { lookahead: 5, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(&balls, Environment::default(), settings).unwrap();
    run(&mut timeline);
    let name = BodyId(200);
    let add = Change::Add { body: name, def: Box::new(ball.at(Vec3::Y * 3.0)) };
    let bodies = (0..201).map(BodyId).collect();
    let preview = Preview { frame: Frame(2), changes: vec![add], frames: 3, bodies };
    let told: Vec<BodyId> =
        previewed(&timeline, preview.clone()).unwrap().trails.iter().map(|t| t.body).collect();
    assert_eq!(told, (0..127).chain([200]).map(BodyId).collect::<Vec<_>>());
    // The farther it looks the fewer they are.
    let told = previewed(&timeline, Preview { frames: 1000, ..preview }).unwrap();
    assert_eq!(told.trails.len(), 65);
    assert!(told.trails.iter().any(|trail| trail.body == name && trail.poses.len() == 1001));
}
