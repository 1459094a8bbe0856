//! Forks, and orders that take others back: what parts, what is shared, what comes out as if nothing had been.

mod scenes;

use forerun_dynamics::{BodyDef, BodyId, Environment};
use forerun_geometry::Vec3;
use forerun_timeline::check::mismatches;
use forerun_timeline::{
    Change, Command, CommandError, CommandKey, Difference, Frame, Order, Progress, Timeline, TimelineSettings,
};

fn run(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

/// Six piles of four boxes on one ground.
fn piles() -> Vec<BodyDef> {
    scenes::all().swap_remove(0).1
}

fn timeline() -> Timeline {
    let settings = TimelineSettings { lookahead: 60, past: 1000, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(&piles(), Environment::default(), settings).unwrap();
    run(&mut timeline);
    timeline
}

fn push(body: u32, impulse: f32) -> Change {
    Change::Push { body: BodyId(body), impulse: Vec3::new(0.0, 0.0, impulse), at_point: None }
}

#[test]
fn forks_part_where_their_commands_do() {
    let timeline = timeline();
    let (mut left, mut right) = (timeline.fork(), timeline.fork());
    left.change(Frame(20), push(4, 3000.0)).unwrap();
    right.change(Frame(30), push(4, 3000.0)).unwrap();
    right.change(Frame(30), push(8, 3000.0)).unwrap();
    // What is not true yet is not compared.
    assert_eq!(left.diff(&timeline), None);
    run(&mut left);
    run(&mut right);
    let parted = |frame, bodies: &[u32]| {
        Some(Difference { frame: Frame(frame), bodies: bodies.iter().copied().map(BodyId).collect() })
    };
    // Those beneath are woken.
    assert_eq!(left.diff(&timeline), parted(20, &[3, 4]));
    assert_eq!(timeline.diff(&right), parted(30, &[3, 4, 7, 8]));
    assert_eq!(left.diff(&right), parted(20, &[3, 4]));
    // The original knows nothing of it.
    assert_eq!(timeline.commands().count(), 0);
    assert!(timeline.state(BodyId(4), Frame(40)) != left.state(BodyId(4), Frame(40)));
}

#[test]
fn a_fork_pays_for_what_it_changes() {
    let timeline = timeline();
    let mut fork = timeline.fork();
    fork.change(Frame(50), push(4, 300.0)).unwrap();
    run(&mut fork);
    let edit = fork.stats().last_edit;
    assert_eq!((edit.frame, edit.commands), (Frame(50), 1));
    assert_eq!(edit.full, 25 * 11);
    // Four boxes of a pile, and those that it may lean on.
    assert!(edit.recomputed >= 10 && edit.recomputed <= 8 * 11, "{edit:?}");
    assert!(edit.affected <= edit.recomputed && edit.frames <= 11, "{edit:?}");
}

#[test]
fn a_fork_that_is_adopted_takes_the_timelines_place() {
    let mut timeline = timeline();
    timeline.set_display(Frame(10));
    run(&mut timeline);
    let mut fork = timeline.fork();
    let body = fork.reserve_body();
    let key = fork.change(Frame(15), Change::Remove { body: BodyId(7) }).unwrap();
    let def = BodyDef::new(piles()[1].shape.clone()).at(Vec3::new(30.0, 5.0, 0.0));
    fork.change(Frame(16), Change::Add { body, def: Box::new(def) }).unwrap();
    run(&mut fork);
    let kept = fork.clone();
    timeline.set_display(Frame(14));
    timeline.adopt(fork);
    assert_eq!((timeline.display(), timeline.diff(&kept)), (Frame(14), None));
    run(&mut timeline);
    assert_eq!(timeline.horizon(), Frame(74));
    assert!(timeline.state(BodyId(7), Frame(20)).is_none() && timeline.state(body, Frame(20)).is_some());
    // It goes on as one that had all this from the start.
    assert!(timeline.retract(&key));
    run(&mut timeline);
    assert!(timeline.state(BodyId(7), Frame(20)).is_some());
    assert_eq!(timeline.audit(Frame(40)), None);
}

#[test]
fn undo_brings_every_bit_back_and_redo_does_it_again() {
    let mut timeline = timeline();
    let mut stages = vec![timeline.clone()];
    let body = timeline.reserve_body();
    let def = BodyDef::new(piles()[1].shape.clone()).at(Vec3::new(1.3, 6.0, 0.0));
    let first = timeline.change(Frame(12), push(4, 2000.0)).unwrap();
    for order in [
        None,
        Some(Order::Submit(Command {
            key: CommandKey { frame: Frame(5), source: 0, sequence: 40 },
            change: Change::Add { body, def: Box::new(def) },
        })),
        Some(Order::Replace(Command { key: first, change: push(8, -2500.0) })),
        Some(Order::Retract(first)),
    ] {
        order.map_or(Ok(()), |order| timeline.obey(order)).unwrap();
        run(&mut timeline);
        assert!(mismatches(&timeline, stages.last().unwrap()).0 > 0);
        stages.push(timeline.clone());
    }
    for stage in stages.iter().rev().skip(1) {
        timeline.undo().unwrap();
        run(&mut timeline);
        assert_eq!(mismatches(&timeline, stage), (0, None));
    }
    assert_eq!(timeline.undo(), Err(CommandError::NothingToUndo));
    for stage in stages.iter().skip(1) {
        timeline.redo().unwrap();
        run(&mut timeline);
        assert_eq!(mismatches(&timeline, stage), (0, None));
    }
    assert_eq!(timeline.redo(), Err(CommandError::NothingToRedo));
    // A new order ends what could be done again; others' commands are theirs to take back.
    timeline.undo().unwrap();
    let key = CommandKey { frame: Frame(9), source: 7, sequence: 0 };
    timeline.obey(Order::Submit(Command { key, change: push(2, 100.0) })).unwrap();
    timeline.redo().unwrap();
    timeline.undo().unwrap();
    timeline.change(Frame(30), push(2, 100.0)).unwrap();
    assert_eq!(timeline.redo(), Err(CommandError::NothingToRedo));
}

#[test]
fn what_is_too_old_is_not_undone() {
    let settings = TimelineSettings { lookahead: 20, past: 10, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(&piles(), Environment::default(), settings).unwrap();
    timeline.change(Frame(5), push(4, 2000.0)).unwrap();
    let kept = timeline.change(Frame(25), push(4, 2000.0)).unwrap();
    timeline.undo().unwrap();
    timeline.redo().unwrap();
    run(&mut timeline);
    for display in 0..30 {
        timeline.set_display(Frame(display));
        run(&mut timeline);
    }
    assert_eq!(timeline.undo(), Ok(kept));
    assert_eq!(timeline.undo(), Err(CommandError::NothingToUndo));
}

#[test]
fn a_replacement_that_is_refused_leaves_the_command() {
    let mut timeline = timeline();
    let body = timeline.reserve_body();
    let def = BodyDef::new(piles()[1].shape.clone()).at(Vec3::new(30.0, 5.0, 0.0));
    let add = Change::Add { body, def: Box::new(def) };
    let key = timeline.change(Frame(5), add.clone()).unwrap();
    run(&mut timeline);
    let before = timeline.clone();
    for bad in [push(4, f32::NAN), push(999, 1.0)] {
        assert!(timeline.replace(&key, bad).is_err());
    }
    run(&mut timeline);
    assert_eq!(mismatches(&timeline, &before), (0, None));
    assert_eq!(timeline.change(Frame(8), add), Err(CommandError::BodyExists(body)));
    let unknown = CommandKey { sequence: 99, ..key };
    assert_eq!(timeline.replace(&unknown, push(4, 1.0)), Err(CommandError::UnknownCommand(unknown)));
    timeline.replace(&key, push(4, 500.0)).unwrap();
    run(&mut timeline);
    assert!(timeline.state(body, Frame(8)).is_none());
    let parted = timeline.diff(&before).unwrap();
    assert_eq!((parted.frame, parted.bodies), (Frame(5), vec![BodyId(3), BodyId(4), body]));
}
