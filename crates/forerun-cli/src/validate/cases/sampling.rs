//! Sampling: what is shown between stored states, against the exact path through them.
//!
//! Free flight follows the parabola and the constant spin; across an impact the straight line is off by at most |Δv| h / 4, and never below the floor;
//! a resting body stays where it is; at a frame the stored pose comes out bit for bit.

use forerun::dynamics::{BodyDef, BodyId, BodyState, Material};
use forerun::geometry::shape::{Cuboid, Sphere};
use forerun::geometry::{Shape, Vec3};
use forerun::timeline::{Change, Frame, Progress, Sample, Timeline, TimelineSettings};

use crate::validate::Figure;
use crate::validate::lab::{cross, dot, doubled, environment, length};

const RATE: u32 = 60;
const H: f64 = 1.0 / RATE as f64;
const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);
/// The bounds of the analysis times this are the limits.
const ALLOWANCE: f64 = 1.05;
const FLIGHT_M: f64 = 1e-6;
const SPIN_RAD: f64 = 1e-5;
const VISIBLE_M: f64 = 0.005;
/// Samples in each frame, at irrational parts of it.
const SAMPLES: u32 = 8;
const GOLDEN: f64 = 0.618_033_988_749_894_9;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    flight(&mut figures);
    bounce(&mut figures);
    chain(&mut figures);
    rest(&mut figures);
    figures
}

/// A body between two frames.
struct Between<'a> {
    body: BodyId,
    states: (&'a BodyState, &'a BodyState),
    /// Seconds since the first of the two.
    time: f64,
    sample: Sample,
}

/// Computes so many frames.
///
/// # Panics
/// When a definition is refused: the case is fixed, so that this is a mistake in it.
fn timeline(defs: &[BodyDef], gravity: Vec3, frames: u32) -> Timeline {
    let settings = TimelineSettings { lookahead: frames, ..TimelineSettings::default() };
    let mut timeline =
        Timeline::new(defs, environment(gravity, RATE), settings).expect("the bodies are possible");
    while timeline.advance() != Progress::Idle {}
    timeline
}

/// Visits the samples of all bodies at irrational times. Returns in how many poses the samples at the frames differ from the stored states.
fn watch(timeline: &Timeline, mut visit: impl FnMut(&Between)) -> u32 {
    let snapshot = timeline.snapshot();
    let frame_seconds = f64::from(snapshot.frame_seconds());
    let mut differ = 0;
    for k in 0..snapshot.horizon().0 {
        for body in timeline.bodies_at(Frame(k)) {
            let (Some(a), Some(b)) = (timeline.state(body, Frame(k)), timeline.state(body, Frame(k + 1)))
            else {
                continue;
            };
            let stored = timeline.body_at(body, Frame(k)).map(|made| made.own_pose(a));
            let shown = snapshot.sample(body, k as f64 * frame_seconds).map(|sample| sample.pose);
            differ += u32::from(stored != shown);
            for s in 1..=SAMPLES {
                let part = (f64::from(s) * GOLDEN).fract();
                let time = part * frame_seconds;
                if let Some(sample) = snapshot.sample(body, (k as f64 + part) * frame_seconds) {
                    visit(&Between { body, states: (a, b), time, sample });
                }
            }
        }
    }
    differ
}

/// Where a body that flies freely is, so long after a state (before it, when negative).
fn flown(state: &BodyState, gravity: Vec3, time: f64) -> [f64; 3] {
    let (x, v, g) = (doubled(state.position), doubled(state.velocity), doubled(gravity));
    [0, 1, 2].map(|k| x[k] + v[k] * time + 0.5 * g[k] * time * time)
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    length([0, 1, 2].map(|k| a[k] - b[k]))
}

fn ball(radius: f32, position: Vec3, velocity: Vec3, material: Material) -> BodyDef {
    let mut def = BodyDef::new(Shape::Sphere(Sphere { radius })).at(position);
    def.velocity = velocity;
    def.material = material;
    def
}

/// A ball that falls, and one that is thrown with a spin of 20 rad/s.
fn flight(figures: &mut Vec<Figure>) {
    let fall = ball(0.1, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO, Material::default());
    let mut thrown = ball(0.1, Vec3::new(2.0, 1.0, 0.0), Vec3::new(1.0, 4.0, 2.0), Material::default());
    thrown.angular_velocity = Vec3::new(12.0, 16.0, 0.0);
    let (mut worst, mut turned) = ([0.0f64; 2], 0.0f64);
    let differ = watch(&timeline(&[fall, thrown], GRAVITY, 45), |b| {
        let off = distance(doubled(b.sample.pose.position), flown(b.states.0, GRAVITY, b.time));
        worst[b.body.0 as usize] = worst[b.body.0 as usize].max(off);
        turned = turned.max(turn_off(b));
    });
    figures.extend([
        Figure::at_most("free fall: off the parabola, m", worst[0], FLIGHT_M * ALLOWANCE),
        Figure::at_most("thrown: off the parabola, m", worst[1], FLIGHT_M * ALLOWANCE),
        Figure::at_most("thrown: off the constant spin, rad", turned, SPIN_RAD * ALLOWANCE),
        Figure::at_most("flight: poses at a frame that are not the stored bits", f64::from(differ), 0.0),
    ]);
}

/// Angle between the shown orientation and the stored one turned on at the stored spin. Radians.
fn turn_off(b: &Between) -> f64 {
    let w = doubled(b.states.0.angular_velocity);
    let (rate, q) = (length(w), b.states.0.rotation);
    let (sin, cos) = (0.5 * rate * b.time).sin_cos();
    let scale = if rate > 0.0 { sin / rate } else { 0.0 };
    let (v, u) = (w.map(|w| w * scale), [q.x, q.y, q.z].map(f64::from));
    let (s, qw) = (cos, f64::from(q.w));
    let crossed = cross(v, u);
    let exact = [0, 1, 2].map(|k| s * u[k] + qw * v[k] + crossed[k]);
    let exact_w = s * qw - dot(v, u);
    let r = b.sample.pose.rotation;
    let shown = [r.x, r.y, r.z].map(f64::from);
    let shown_w = f64::from(r.w);
    let sign = if dot(shown, exact) + shown_w * exact_w < 0.0 { -1.0 } else { 1.0 };
    let difference = [0, 1, 2].map(|k| shown[k] - sign * exact[k]);
    // |q - p| is half the angle between them.
    2.0 * (length(difference).powi(2) + (shown_w - sign * exact_w).powi(2)).sqrt()
}

/// An elastic ball that meets the floor at 5 m/s.
fn bounce(figures: &mut Vec<Figure>) {
    const RADIUS: f32 = 0.1;
    let material = Material::new(0.0, 1.0);
    let mut ground = BodyDef::fixed(Shape::half_space());
    ground.material = material;
    let start = Vec3::new(0.0, RADIUS + 5.0 * 5.0 / (2.0 * 9.81), 0.0);
    let mut worst = 0.0f64;
    let mut below = 0.0f64;
    let differ = watch(&timeline(&[ground, ball(RADIUS, start, Vec3::ZERO, material)], GRAVITY, 300), |b| {
        if b.body.0 == 0 {
            return;
        }
        let shown = doubled(b.sample.pose.position);
        below = below.max(f64::from(RADIUS) - shown[1]);
        if b.states.0.velocity.y < 0.0 && b.states.1.velocity.y > 0.0 {
            // On the way down until the two arcs cross, on the way up from there.
            let (down, up) = (flown(b.states.0, GRAVITY, b.time), flown(b.states.1, GRAVITY, b.time - H));
            let exact = if down[1] > up[1] { down } else { up };
            worst = worst.max(distance(shown, exact));
        }
    });
    figures.extend([
        Figure::at_most("bounce: off the arcs across an impact, m", worst, 10.0 * H / 4.0 * ALLOWANCE),
        Figure::at_most("bounce: below the floor, m", below, VISIBLE_M),
        Figure::at_most("bounce: poses at a frame that are not the stored bits", f64::from(differ), 0.0),
    ]);
}

/// Six balls in a row with small gaps; the first impact is in the middle of a frame.
fn chain(figures: &mut Vec<Figure>) {
    const SPEED: f32 = 20.0;
    let material = Material::new(0.0, 1.0);
    let mut defs = vec![ball(1.0, Vec3::new(-10.15, 0.0, 0.0), Vec3::new(SPEED, 0.0, 0.0), material)];
    defs.extend((0..5).map(|i| ball(1.0, Vec3::new(-4.0 + 2.02 * i as f32, 0.0, 0.0), Vec3::ZERO, material)));
    let (mut worst, mut outside) = (0.0f64, 0.0f64);
    watch(&timeline(&defs, Vec3::ZERO, 60), |b| {
        let (first, last) = b.states;
        let change = f64::from((last.velocity - first.velocity).length());
        let shown = f64::from(b.sample.pose.position.x);
        let (x0, x1) = (f64::from(first.position.x), f64::from(last.position.x));
        outside = outside.max(x0.min(x1) - shown).max(shown - x0.max(x1));
        if change > 1e-3 {
            let (before, after) = (flown(first, Vec3::ZERO, b.time), flown(last, Vec3::ZERO, b.time - H));
            let slows = first.velocity.x > last.velocity.x;
            let exact = if slows { before[0].min(after[0]) } else { before[0].max(after[0]) };
            worst = worst.max((shown - exact).abs() / (change * H / 4.0));
        }
    });
    figures.extend([
        Figure::at_most("chain: off across an impact, part of |Δv| h / 4", worst, ALLOWANCE),
        Figure::at_most("chain: outside the two keyframes, m", outside, VISIBLE_M),
    ]);
}

/// Three boxes on the ground, pushed at frame 60: shown between their two keyframes.
fn rest(figures: &mut Vec<Figure>) {
    let mut defs = vec![BodyDef::fixed(Shape::half_space())];
    let half_extents = Vec3::splat(0.5);
    defs.extend((0..3).map(|i| {
        BodyDef::new(Shape::Cuboid(Cuboid { half_extents })).at(Vec3::new(0.0, 0.5 + i as f32, 0.0))
    }));
    let mut timeline = timeline(&defs, GRAVITY, 240);
    let impulse = Vec3::new(600.0, 0.0, 0.0);
    let pushed = timeline.change(Frame(60), Change::Push { body: BodyId(3), impulse, at_point: None });
    debug_assert!(pushed.is_ok(), "the command is possible");
    while timeline.advance() != Progress::Idle {}
    let mut outside = 0.0f64;
    let differ = watch(&timeline, |b| {
        let shown = doubled(b.sample.pose.position);
        let ends = (doubled(b.states.0.position), doubled(b.states.1.position));
        outside = outside.max(distance(shown, ends.0) + distance(shown, ends.1) - distance(ends.0, ends.1));
    });
    figures.extend([
        Figure::at_most("rest: outside the two keyframes, m", outside, VISIBLE_M),
        Figure::at_most("rest: poses at a frame that are not the stored bits", f64::from(differ), 0.0),
    ]);
}
