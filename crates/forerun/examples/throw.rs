//! One ball, many directions: throws it through forks of a timeline, shows the best throw, and times all that against as many copies of
//! a whole world. Every fork must end bit for bit as its copy does.
//!
//! ```text
//! cargo run --release --example throw [SCENE] [DIRECTIONS]
//! ```

#![allow(clippy::print_stdout, reason = "an example talks to whoever runs it")]

use std::error::Error;
use std::fmt::Write as _;

use forerun::dynamics::Unobserved;
use forerun::timeline::Progress;
use forerun::{
    BodyDef, BodyId, BodyState, Change, Clock, Frame, Scene, Shape, Sphere, Timeline, TimelineSettings, Vec3,
    World, timeline_of, world_of,
};

/// The piles come to rest before the throw.
const SETTLED: Frame = Frame(300);

/// Frames that a throw is followed for.
const FLIGHT: u32 = 120;

const SPEED_M_PER_S: f32 = 28.0;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "islands:25".to_owned());
    let count: u32 = arguments.next().map_or(Ok(200), |text| text.parse())?;
    let scene = Scene::open(&name)?;
    let clock = Clock::system();
    let seconds = |from: std::time::Duration| (clock.now() - from).as_secs_f64();

    // From beside the scene, over the ground.
    let middle = scene.bodies()?.iter().map(|def| def.pose.position.z).fold(0.0, f32::max);
    let from = Vec3::new(0.0, 2.0, middle + 16.0);
    let settings = TimelineSettings { lookahead: FLIGHT, past: 1, ..TimelineSettings::default() };
    let mut timeline = timeline_of(&scene, settings)?;
    timeline.set_display(SETTLED);
    finish(&mut timeline);
    let bodies = timeline.bodies_at(SETTLED).len();
    println!("{name}: {bodies} bodies at rest, {count} throws of {FLIGHT} frames");

    let began = clock.now();
    let mut throws = Vec::new();
    for index in 0..count {
        let direction = direction(index, count);
        let fork = thrown(&timeline, &ball(from, direction))?;
        throws.push(Throw { direction, score: score(&timeline, &fork), fork });
    }
    let forks_s = seconds(began);
    let best =
        throws.iter().max_by(|a, b| a.score.total_cmp(&b.score)).ok_or("no directions: ask for 1 or more")?;
    let Vec3 { x, y, z } = best.direction;
    println!("best direction ({x:.3}, {y:.3}, {z:.3}): boxes moved {:.1} m in all", best.score);
    std::fs::write("throw.svg", picture(&timeline, &throws, best, from))?;
    println!("all paths and where the best throw leaves the boxes: throw.svg");

    let mut settled = world_of(&scene)?;
    step(&mut settled, SETTLED.0 as u32);
    let began = clock.now();
    let mut alike = 0;
    for throw in &throws {
        let copy = copied(&settled, &ball(from, throw.direction))?;
        alike += u32::from(ends_as(&throw.fork, &copy));
    }
    let copies_s = seconds(began);
    println!(
        "{count} forks {forks_s:.3} s; {count} copies of the world {copies_s:.3} s: {:.1} times as long",
        copies_s / forks_s
    );
    println!("{alike} of {count} forks end bit for bit as their copies do");

    let forked = clock.now();
    let again: Vec<Timeline> = throws.iter().map(|throw| throw.fork.fork()).collect();
    println!("a fork of all that: {:.1} us", 1e6 * seconds(forked) / again.len() as f64);
    timeline.adopt(best.fork.fork());
    println!("adopted: the timeline goes on from the best throw at {}", timeline.display());
    if alike == count { Ok(()) } else { Err("a fork and its copy differ".into()) }
}

struct Throw {
    direction: Vec3,
    score: f32,
    fork: Timeline,
}

/// A fan of directions towards the piles.
fn direction(index: u32, count: u32) -> Vec3 {
    let columns = (count as f32).sqrt().ceil() as u32;
    let part = |i: u32, n: u32| (i as f32 + 0.5) / n as f32 - 0.5;
    let across = part(index % columns, columns);
    let up = part(index / columns, count.div_ceil(columns));
    Vec3::new(1.2 * across, 0.12 + 0.35 * up, -1.0).normalize()
}

fn ball(from: Vec3, direction: Vec3) -> BodyDef {
    let mut ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.8 })).at(from);
    ball.velocity = direction * SPEED_M_PER_S;
    ball
}

/// A fork in which the ball is thrown, computed to its end.
fn thrown(timeline: &Timeline, ball: &BodyDef) -> Outcome<Timeline> {
    let mut fork = timeline.fork();
    let body = fork.reserve_body();
    fork.change(SETTLED.next(), Change::Add { body, def: Box::new(ball.clone()) })?;
    finish(&mut fork);
    Ok(fork)
}

/// A copy of the whole world in which the ball is thrown, stepped to the end.
fn copied(settled: &World, ball: &BodyDef) -> Outcome<World> {
    let mut world = settled.clone();
    step(&mut world, 1);
    world.add(ball)?;
    step(&mut world, FLIGHT - 1);
    Ok(world)
}

fn step(world: &mut World, frames: u32) {
    for _ in 0..frames {
        world.step(&mut Unobserved);
    }
}

fn finish(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

/// How far all boxes together were moved. Metres.
fn score(before: &Timeline, after: &Timeline) -> f32 {
    let end = after.horizon();
    let moved = |body: BodyId| {
        let (from, to) = (before.state(body, SETTLED)?, after.state(body, end)?);
        Some((to.position - from.position).length())
    };
    before.bodies_at(SETTLED).into_iter().filter_map(moved).sum()
}

fn ends_as(fork: &Timeline, world: &World) -> bool {
    let same = |(index, state): (usize, &BodyState)| {
        fork.state(BodyId(index as u32), fork.horizon()).is_some_and(|other| other.same_bits(state))
    };
    world.states().iter().enumerate().all(same)
}

/// Seen from above, one metre is ten units: boxes before (grey) and after the best throw (red where they moved), all paths of the ball.
fn picture(timeline: &Timeline, throws: &[Throw], best: &Throw, from: Vec3) -> String {
    let side = 10.0 * (from.z + 5.0);
    let mut svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='{:.0} {:.0} {:.0} {:.0}'>\n",
        -side,
        -side,
        2.0 * side,
        2.0 * side
    );
    let mut square = |state: &BodyState, fill: &str| {
        let Vec3 { x, z, .. } = state.position * 10.0;
        let _ = writeln!(
            svg,
            "<rect x='{:.1}' y='{:.1}' width='10' height='10' fill='{fill}'/>",
            x - 5.0,
            z - 5.0
        );
    };
    let moving = |body: &BodyId| timeline.body_at(*body, SETTLED).is_some_and(|body| body.is_dynamic());
    let boxes: Vec<BodyId> = timeline.bodies_at(SETTLED).into_iter().filter(moving).collect();
    let end = best.fork.horizon();
    for body in &boxes {
        let states = timeline.state(*body, SETTLED).zip(best.fork.state(*body, end));
        let Some((before, after)) = states else { continue };
        let moved = (after.position - before.position).length() > 0.1;
        square(before, "#ddd");
        square(after, if moved { "#c33" } else { "#999" });
    }
    for throw in throws {
        let is_best = throw.direction == best.direction;
        let body = BodyId(timeline.names() as u32);
        let path: Vec<String> = (SETTLED.0..=end.0)
            .filter_map(|frame| throw.fork.state(body, Frame(frame)))
            .map(|state| format!("{:.1},{:.1}", 10.0 * state.position.x, 10.0 * state.position.z))
            .collect();
        let (colour, width) = if is_best { ("#c00", 4) } else { ("#06c", 1) };
        let _ = writeln!(
            svg,
            "<polyline points='{}' fill='none' stroke='{colour}' stroke-width='{width}' opacity='0.6'/>",
            path.join(" ")
        );
    }
    svg + "</svg>\n"
}
