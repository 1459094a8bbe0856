//! Block on a slope: Coulomb friction stops a block, or lets it slide, where the formula says, even with restitution 1.
//!
//! Guendelman, Bridson, Fedkiw, *Nonconvex Rigid Bodies with Stacking* (2003), section 9; the numbers are those of the authors' own
//! test (PhysBAM, Sliding_Test): g = 9.8 m/s², a 20 degree plane, a cube of half extent 0.05 m. Block and plane also as distance fields.

use forerun::dynamics::{BodyDef, Mass, Material, World};
use forerun::geometry::shape::{Cuboid, mesh_make};
use forerun::geometry::{Quat, Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{GRAVITY_98, Slope, angle_between, doubled, environment, watch, world};

const G: f64 = 9.8;
const HALF: f32 = 0.05;
/// Frames a second, and what a position may be off. Parts of the distance.
const RATES: [(u32, f64); 3] = [(60, 0.03), (240, 0.01), (1000, 0.005)];
const VELOCITY_OFF: f64 = 0.01;
const HOP_M: f64 = 1e-4;
const CREEP_M: f64 = 1e-4;
const TILT_DEGREES: f64 = 0.1;

/// What slides on what.
#[derive(Clone, Copy, Debug)]
enum Pairing {
    HalfSpace,
    Cuboid,
    MeshOnHalfSpace,
    MeshOnMesh,
}

impl Pairing {
    const ALL: [Pairing; 4] =
        [Pairing::HalfSpace, Pairing::Cuboid, Pairing::MeshOnHalfSpace, Pairing::MeshOnMesh];

    /// The plane's, where the block is a cuboid.
    fn name(self) -> &'static str {
        match self {
            Pairing::HalfSpace => "half-space",
            Pairing::Cuboid => "cuboid",
            Pairing::MeshOnHalfSpace => "mesh on half-space",
            Pairing::MeshOnMesh => "mesh on mesh",
        }
    }

    fn block(self) -> Shape {
        let half_extents = Vec3::splat(HALF);
        match self {
            Pairing::HalfSpace | Pairing::Cuboid => solid_box(half_extents),
            Pairing::MeshOnHalfSpace | Pairing::MeshOnMesh => mesh_box(half_extents),
        }
    }

    fn plane(self, slope: Slope, material: Material) -> BodyDef {
        let half_extents = Vec3::new(20.0, 1.0, 20.0);
        let shape = match self {
            Pairing::HalfSpace | Pairing::MeshOnHalfSpace => None,
            Pairing::Cuboid => Some(solid_box(half_extents)),
            Pairing::MeshOnMesh => Some(mesh_box(half_extents)),
        };
        let mut def = shape.map_or_else(
            || slope.ground(),
            |shape| {
                let mut def = BodyDef::fixed(shape);
                def.pose = slope.pose(Vec3::new(0.0, -half_extents.y, 0.0), Quat::IDENTITY);
                def
            },
        );
        def.material = material;
        def
    }
}

/// What the formula says of a slide that starts at `speed` (m/s): constant acceleration, then rest.
#[derive(Clone, Copy, Debug)]
struct Slide {
    speed: f64,
    acceleration: f64,
}

impl Slide {
    fn stops_at(self) -> f64 {
        if self.acceleration < 0.0 { -self.speed / self.acceleration } else { f64::INFINITY }
    }

    fn distance(self, time: f64) -> f64 {
        let t = time.min(self.stops_at());
        self.speed * t + 0.5 * self.acceleration * t * t
    }

    fn velocity(self, time: f64) -> f64 {
        if time < self.stops_at() { self.speed + self.acceleration * time } else { 0.0 }
    }
}

/// The worst that was seen.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    position: f64,
    velocity: f64,
    hop: f64,
    tilt: f64,
    stopped_at: f64,
}

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for (rate, position_off) in RATES {
        for pairing in Pairing::ALL {
            stopping(pairing, rate, position_off, &mut figures);
            sliding(pairing, rate, position_off, &mut figures);
        }
        three_cubes(rate, position_off, &mut figures);
    }
    figures
}

fn solid_box(half_extents: Vec3) -> Shape {
    Shape::Cuboid(Cuboid { half_extents })
}

fn mesh_box(half_extents: Vec3) -> Shape {
    // Fixed sizes, within the ranges that the maker names.
    mesh_make::cuboid(half_extents).expect("a box is possible").into()
}

/// A block on a 20 degree plane, with restitution 1 on both.
fn block(pairing: Pairing, friction: f32, speed: f32) -> (Slope, [BodyDef; 2]) {
    let slope = Slope::degrees(20.0);
    let material = Material::new(friction, 1.0);
    let mut block = BodyDef::new(pairing.block());
    block.pose = slope.pose(Vec3::new(0.0, HALF, 0.0), Quat::IDENTITY);
    block.velocity = slope.rotation() * Vec3::new(speed, 0.0, 0.0);
    block.mass = Mass::Total(1.0);
    block.material = material;
    (slope, [pairing.plane(slope, material), block])
}

/// Follows the block and compares it with the formula.
fn follow(defs: &[BodyDef], slope: Slope, slide: Slide, rate: u32) -> (Worst, World) {
    let mut world = world(environment(GRAVITY_98, rate), defs);
    let mut worst = Worst::default();
    let up = doubled(slope.rotation() * Vec3::Y);
    watch(&mut world, 3.0, |time, states| {
        let block = &states[1];
        let [x, y, _] = slope.local(block.position);
        let [speed, ..] = slope.local(block.velocity);
        worst.position = worst.position.max((x - slide.distance(time)).abs());
        worst.velocity = worst.velocity.max((speed - slide.velocity(time)).abs());
        worst.hop = worst.hop.max(y - f64::from(HALF));
        worst.tilt = worst.tilt.max(angle_between(doubled(block.rotation * Vec3::Y), up));
        if speed > 1e-3 {
            worst.stopped_at = time;
        }
    });
    (worst, world)
}

/// (a) Friction 0.5, thrown downhill at 1.25 m/s: stops after 0.623655 m and stays.
fn stopping(pairing: Pairing, rate: u32, position_off: f64, figures: &mut Vec<Figure>) {
    let (slope, defs) = block(pairing, 0.5, 1.25);
    let slide = Slide { speed: 1.25, acceleration: G * (slope.sin() - 0.5 * slope.cos()) };
    let (worst, mut world) = follow(&defs, slope, slide, rate);
    let [stop, ..] = slope.local(world.states()[1].position);
    let mut creep = 0.0f64;
    watch(&mut world, 10.0, |_, states| {
        creep = creep.max((slope.local(states[1].position)[0] - stop).abs());
    });
    let distance = slide.distance(3.0);
    let name = |what: &str| format!("(a) {}, 1/{rate}: {what}", pairing.name());
    figures.extend([
        Figure::at_most(name("worst position, part of the way"), worst.position / distance, position_off),
        Figure::at_most(name("stop point, part of the way"), (stop / distance - 1.0).abs(), position_off),
        Figure::at_most(name("worst speed, part of the first"), worst.velocity / 1.25, VELOCITY_OFF),
        Figure::reported(name("stop time off, s"), worst.stopped_at - slide.stops_at()),
        Figure::at_most(name("hop, m"), worst.hop, HOP_M),
        Figure::at_most(name("creep in 10 s, m"), creep, CREEP_M),
        Figure::at_most(name("tilt, degrees"), worst.tilt, TILT_DEGREES),
    ]);
}

/// (b) Friction 0.25, let go: slides 2.0991 m in 2 s.
fn sliding(pairing: Pairing, rate: u32, position_off: f64, figures: &mut Vec<Figure>) {
    let (slope, defs) = block(pairing, 0.25, 0.0);
    let slide = Slide { speed: 0.0, acceleration: G * (slope.sin() - 0.25 * slope.cos()) };
    let (worst, _) = follow(&defs, slope, slide, rate);
    let name = |what: &str| format!("(b) {}, 1/{rate}: {what}", pairing.name());
    figures.extend([
        Figure::at_most(
            name("worst position, part of the way"),
            worst.position / slide.distance(3.0),
            position_off,
        ),
        Figure::at_most(
            name("worst speed, part of the last"),
            worst.velocity / slide.velocity(3.0),
            VELOCITY_OFF,
        ),
        Figure::at_most(name("hop, m"), worst.hop, HOP_M),
        Figure::at_most(name("tilt, degrees"), worst.tilt, TILT_DEGREES),
    ]);
}

/// (c) Three cubes at 20 m/s on level ground, the third with a rider: all stop after 40.816 m, and the rider stays.
fn three_cubes(rate: u32, position_off: f64, figures: &mut Vec<Figure>) {
    // The geometric mean of the rider's friction and the cube's is 2.
    let material = Material::new(0.5, 1.0);
    let rider_material = Material::new(8.0, 1.0);
    let cube = |position: Vec3, mass: f32, material: Material| {
        let mut def = BodyDef::new(solid_box(Vec3::ONE)).at(position);
        def.velocity = Vec3::new(20.0, 0.0, 0.0);
        def.mass = Mass::Total(mass);
        def.material = material;
        def
    };
    let mut ground = BodyDef::fixed(Shape::half_space());
    ground.material = material;
    let defs = [
        ground,
        cube(Vec3::new(0.0, 1.0, -4.0), 1.0, material),
        cube(Vec3::new(0.0, 1.0, 0.0), 2.0, material),
        cube(Vec3::new(0.0, 1.0, 4.0), 1.0, material),
        cube(Vec3::new(0.0, 3.0, 4.0), 1.0, rider_material),
    ];
    let mut world = world(environment(GRAVITY_98, rate), &defs);
    let (mut hop, mut slip, mut tilt) = (0.0f64, 0.0f64, 0.0f64);
    watch(&mut world, 6.0, |_, states| {
        for (state, height) in states[1..].iter().zip([1.0, 1.0, 1.0, 3.0]) {
            hop = hop.max(f64::from(state.position.y) - height);
            tilt = tilt.max(angle_between(doubled(state.rotation * Vec3::Y), [0.0, 1.0, 0.0]));
        }
        slip = slip
            .max(f64::from((states[4].position - states[3].position - Vec3::new(0.0, 2.0, 0.0)).length()));
    });
    let distance = 20.0 * 20.0 / (2.0 * 0.5 * G);
    let stops: Vec<f64> = world.states()[1..4].iter().map(|s| f64::from(s.position.x)).collect();
    let worst = stops.iter().map(|stop| (stop / distance - 1.0).abs()).fold(0.0, f64::max);
    let (least, most) = stops.iter().fold((f64::MAX, 0.0f64), |(a, b), &s| (a.min(s), b.max(s)));
    let name = |what: &str| format!("(c) 1/{rate}: {what}");
    figures.extend([
        Figure::at_most(name("worst stop point, part of the way"), worst, position_off),
        Figure::at_most(name("spread of the stop points, part of the way"), (most - least) / distance, 0.01),
        Figure::at_most(name("slip of the rider, m"), slip, 0.01),
        Figure::at_most(name("hop, m"), hop, HOP_M),
        Figure::at_most(name("tilt, degrees"), tilt, TILT_DEGREES),
    ]);
}
