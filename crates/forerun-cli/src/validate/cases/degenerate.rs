//! Degenerate contacts: tips on tips, tips in holes and cracks, flush edges, edges inside a floor, and bodies that begin inside each other.
//!
//! The tests of Erleben (*Methodology for Assessing Mesh-Based Contact Point Methods*, ACM TOG 2018) with the places and speeds of rigid-ipc's fixtures of
//! them: spikes are pyramids of 1 x 1 x 3 m, wedges prisms of 1 x 3 x 2 m, without friction and restitution; g = 9.8 m/s², frames of 10 ms. Holes and cracks are
//! 1 m wide and 2 m deep. Overlap recovery is Box3D's sample of that name.

use forerun::dynamics::{BodyDef, BodyState, Material, World};
use forerun::geometry::shape::{Mesh, mesh_make};
use forerun::geometry::{Pose, Quat, Shape, Vec3};

use crate::validate::Figure;
use crate::validate::gauge::Gauge;
use crate::validate::lab::{
    GRAVITY_98, angle_between, doubled, environment, fastest, mechanical_energy, moved, turned, watch, world,
};

const RATE: u32 = 100;
const ENERGY_GAIN_MAX: f64 = 0.01;
/// Whoever is deeper in another has gone through it. Metres
const THROUGH: f64 = 0.05;
const HOP_MAX: f64 = 0.001;
const HEADING_MAX: f64 = 0.5;
const SMOOTH: Material = Material::new(0.0, 0.0);
/// Where what has slid off lands, and heights are measured from. Metres
const FLOOR: f32 = -3.0;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for trial in trials() {
        trial.run(&mut figures);
    }
    flush_edges(&mut figures);
    for floor in Floor::ALL {
        internal_edges(floor, &mut figures);
        sliding_spike(floor, &mut figures);
    }
    overlap_recovery(&mut figures);
    figures
}

/// A pyramid on a square of 1 m, 3 m high, its base at y = 0.
fn spike() -> Vec<Vec3> {
    let base = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
    base.iter().map(|&(x, z)| Vec3::new(x, 0.0, z)).chain([Vec3::Y * 3.0]).collect()
}

/// A roof 1 m wide, 3 m high and 2 m long, its base at y = 0 and its edge along z.
fn wedge() -> Vec<Vec3> {
    [-1.0, 1.0]
        .iter()
        .flat_map(|&z| [Vec3::new(-0.5, 0.0, z), Vec3::new(0.5, 0.0, z), Vec3::new(0.0, 3.0, z)])
        .collect()
}

fn hull(points: &[Vec3]) -> Shape {
    Shape::hull(points).expect("a spike and a wedge have a volume")
}

/// A convex shape as a mesh.
fn mesh(points: &[Vec3]) -> Shape {
    let Shape::Hull(hull) = hull(points) else { unreachable!("a hull is a hull") };
    let corners: Vec<Vec3> = hull.triangles().flatten().collect();
    let triangles = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Shape::mesh(corners, triangles).expect("the faces of a hull close a mesh")
}

fn upside_down() -> Quat {
    Quat::from_xyzw(0.0, 0.0, 1.0, 0.0)
}

/// About y, by a right angle.
fn across() -> Quat {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    Quat::from_xyzw(0.0, half, 0.0, half)
}

/// Something sharp that comes down upside down on or into something fixed.
struct Trial {
    name: &'static str,
    falling: BodyDef,
    fixed: Vec<BodyDef>,
    /// The shapes that the gauge is to see, in the order of all bodies but the floor.
    seen: Vec<Shape>,
    seconds: f64,
}

fn falling(shape: Shape, position: Vec3, velocity: Vec3) -> BodyDef {
    let mut def = BodyDef::new(shape).at(position);
    def.pose.rotation = upside_down();
    def.velocity = velocity;
    def
}

fn on_tip(name: &'static str, upper: (Shape, &[Vec3]), lower: (Shape, &[Vec3]), turn: Quat) -> Trial {
    let mut fixed = BodyDef::fixed(lower.0).at(Vec3::Y * FLOOR);
    fixed.pose.rotation = turn;
    Trial {
        name,
        falling: falling(upper.0, Vec3::Y * 3.0001, Vec3::ZERO),
        fixed: vec![fixed],
        seen: vec![hull(upper.1), hull(lower.1)],
        seconds: 5.0,
    }
}

/// In a hole or a crack whose floor is 0.1 mm below the tip and whose mouth is 2 m higher.
fn in_gap(name: &'static str, points: &[Vec3], force: f32, sides: Vec<(BodyDef, Shape)>) -> Trial {
    let mut def = falling(mesh(points), Vec3::Y * 2.0001, Vec3::X);
    def.force = Vec3::X * force;
    let floor_shape = Shape::cuboid(Vec3::new(4.0, 1.0, 4.0)).expect("a box is possible");
    let floor = BodyDef::fixed(floor_shape.clone()).at(Vec3::Y * -2.0);
    let (mut fixed, mut seen) = (vec![floor], vec![hull(points), floor_shape]);
    for (side, shape) in sides {
        fixed.push(side);
        seen.push(shape);
    }
    Trial { name, falling: def, fixed, seen, seconds: 5.0 }
}

/// Two blocks of triangles with 1 m between them.
fn crack() -> Vec<(BodyDef, Shape)> {
    let half = Vec3::new(1.0, 1.0, 2.5);
    let side = |x: f32| {
        let mesh = mesh_make::cuboid(half).expect("a box is possible");
        (BodyDef::fixed(mesh.into()).at(Vec3::X * x), Shape::cuboid(half).expect("a box is possible"))
    };
    vec![side(-1.5), side(1.5)]
}

/// A frame of triangles with a hole of 1 m x 1 m.
fn hole() -> Vec<(BodyDef, Shape)> {
    let frame = mesh_make::frame(Vec3::new(2.5, 1.0, 2.5), 2.0).expect("a frame is possible");
    let part = |x: f32, z: f32, half: Vec3| {
        (Pose::from_position(Vec3::new(x, 0.0, z)), Shape::cuboid(half).expect("a box is possible"))
    };
    let (wide, narrow) = (Vec3::new(1.0, 1.0, 2.5), Vec3::new(0.5, 1.0, 1.0));
    let parts =
        vec![part(-1.5, 0.0, wide), part(1.5, 0.0, wide), part(0.0, -1.5, narrow), part(0.0, 1.5, narrow)];
    vec![(BodyDef::fixed(frame.into()), Shape::compound(parts).expect("four boxes are possible"))]
}

fn trials() -> Vec<Trial> {
    let (spike, wedge) = (spike(), wedge());
    let as_hull = |points: &'_ [Vec3]| hull(points);
    vec![
        on_tip("spike on spike", (as_hull(&spike), &spike), (as_hull(&spike), &spike), Quat::IDENTITY),
        on_tip("spike on wedge", (as_hull(&spike), &spike), (as_hull(&wedge), &wedge), Quat::IDENTITY),
        on_tip("wedge on wedge", (as_hull(&wedge), &wedge), (as_hull(&wedge), &wedge), Quat::IDENTITY),
        on_tip("wedge across wedge", (as_hull(&wedge), &wedge), (as_hull(&wedge), &wedge), across()),
        on_tip("spike on spike, meshes", (mesh(&spike), &spike), (mesh(&spike), &spike), Quat::IDENTITY),
        in_gap("spike in a hole", &spike, 1.0, hole()),
        in_gap("spike in a crack", &spike, 1.0, crack()),
        in_gap("wedge in a crack", &wedge, 10.0, crack()),
    ]
}

impl Trial {
    fn run(self, figures: &mut Vec<Figure>) {
        let floor = BodyDef::fixed(Shape::cuboid(Vec3::new(50.0, 1.0, 50.0)).expect("a box is possible"))
            .at(Vec3::Y * (FLOOR - 1.0));
        let mut defs = vec![self.falling];
        defs.extend(self.fixed);
        defs.push(floor);
        defs.iter_mut().for_each(|def| def.material = SMOOTH);
        let mut world = world(environment(GRAVITY_98, RATE), &defs);
        let last = defs.last().map(|def| &def.shape);
        let gauge = Gauge::with_shapes(&world, self.seen.iter().chain(last));
        let bodies = world.bodies().to_vec();
        let energy = |states: &[BodyState]| {
            // From the floor: less than nothing cannot be lost.
            let from_floor =
                |state: &BodyState| BodyState { position: state.position - Vec3::Y * FLOOR, ..*state };
            mechanical_energy(&bodies[..1], &[from_floor(&states[0])], 9.8)
        };
        let start = energy(world.states());
        let (mut gain, mut deepest) = (0.0f64, 0.0f64);
        watch(&mut world, self.seconds, |_, states| {
            gain = gain.max(energy(states) / start - 1.0);
            deepest = deepest.max(gauge.deepest(states));
        });
        let name = |what: &str| format!("{}: {what}", self.name);
        figures.extend([
            Figure::at_most(name("gain of energy, part"), gain, ENERGY_GAIN_MAX),
            Figure::at_most(name("deepest overlap, m"), deepest, THROUGH),
            not_finite(&name("bodies whose state is not finite"), &world),
        ]);
    }
}

fn not_finite(name: &str, world: &World) -> Figure {
    let count = world.states().iter().filter(|state| !state.is_finite()).count();
    Figure::at_most(name, count as f64, 0.0)
}

/// A cube falls by 5 cm on a block with the same outline: nothing may push it sideways.
fn flush_edges(figures: &mut Vec<Figure>) {
    let block = |half: Vec3| Shape::from(mesh_make::cuboid(half).expect("a box is possible"));
    let mut cliff = BodyDef::fixed(block(Vec3::new(0.5, 1.0, 0.5))).at(Vec3::Y * -1.5);
    let mut cube = BodyDef::new(block(Vec3::splat(0.5))).at(Vec3::Y * 0.05);
    (cliff.material, cube.material) = (SMOOTH, SMOOTH);
    let mut world = world(environment(GRAVITY_98, RATE), &[cliff, cube]);
    let first = world.states()[1];
    watch(&mut world, 5.0, |_, _| {});
    let last = world.states()[1];
    let sideways = f64::from(last.position.x).hypot(f64::from(last.position.z));
    figures.extend([
        Figure::at_most("cube on a cliff with the same edges: moved sideways, m", sideways, HOP_MAX),
        Figure::at_most(
            "cube on a cliff with the same edges: tilt, degrees",
            turned(&first, &last),
            HEADING_MAX,
        ),
        Figure::at_most(
            "cube on a cliff with the same edges: not at its height, m",
            f64::from(last.position.y).abs(),
            HOP_MAX,
        ),
        not_finite("cube on a cliff with the same edges: bodies whose state is not finite", &world),
    ]);
}

/// A level floor cut into triangles with sides of 0.25 m, 16 m x 8 m.
#[derive(Clone, Copy, Debug)]
enum Floor {
    /// At y = 0, without thickness.
    Sheet,
    /// From y = -1 m to 0, closed.
    Slab,
}

impl Floor {
    const ALL: [Floor; 2] = [Floor::Sheet, Floor::Slab];

    fn name(self) -> &'static str {
        match self {
            Floor::Sheet => "sheet",
            Floor::Slab => "slab",
        }
    }

    fn shape(self) -> Shape {
        const STEPS: [u32; 2] = [64, 32];
        let row = STEPS[1] + 1;
        let count = (STEPS[0] + 1) * row;
        let place =
            |i: u32, y: f32| Vec3::new(0.25 * (i / row) as f32 - 4.0, y, 0.25 * (i % row) as f32 - 4.0);
        let mut corners: Vec<Vec3> = (0..count).map(|i| place(i, 0.0)).collect();
        let mut triangles = Vec::new();
        for i in 0..STEPS[0] {
            for j in 0..STEPS[1] {
                let a = i * row + j;
                let (b, c, d) = (a + row, a + row + 1, a + 1);
                triangles.extend([[a, c, b], [a, d, c]]);
            }
        }
        let mesh = match self {
            Floor::Sheet => Mesh::open(corners, triangles),
            Floor::Slab => {
                corners.extend((0..count).map(|i| place(i, -1.0)));
                let below = |t: &[u32; 3]| [t[0] + count, t[2] + count, t[1] + count];
                let bottom: Vec<[u32; 3]> = triangles.iter().map(below).collect();
                triangles.extend(bottom);
                let mut wall = |a: u32, b: u32| {
                    triangles.extend([[a, b, b + count], [a, b + count, a + count]]);
                };
                for i in 0..STEPS[0] {
                    wall(i * row, (i + 1) * row);
                    wall((i + 1) * row + STEPS[1], i * row + STEPS[1]);
                }
                for j in 0..STEPS[1] {
                    wall(j + 1, j);
                    wall(STEPS[0] * row + j, STEPS[0] * row + j + 1);
                }
                Mesh::new(corners, triangles)
            }
        };
        mesh.expect("a floor of triangles is possible").into()
    }
}

/// A cube slides over the floor, askew to its edges, until friction stops it.
fn internal_edges(floor: Floor, figures: &mut Vec<Figure>) {
    const SPEED: f32 = 5.0;
    const FRICTION: f32 = 0.2;
    let ground = BodyDef::fixed(floor.shape());
    for (kind, shape) in [
        ("box", Shape::cuboid(Vec3::splat(0.5)).expect("a box is possible")),
        ("mesh", mesh_make::cuboid(Vec3::splat(0.5)).expect("a box is possible").into()),
    ] {
        let mut ground = ground.clone();
        let way = Vec3::new(1.0, 0.0, 0.2).normalize();
        let mut cube = BodyDef::new(shape).at(Vec3::new(0.03, 0.5, -0.07));
        cube.velocity = way * SPEED;
        let material = Material::new(FRICTION, 0.0);
        (ground.material, cube.material) = (material, material);
        let mut world = world(environment(GRAVITY_98, RATE), &[ground, cube]);
        let first = world.states()[1];
        let mut hop = 0.0f64;
        watch(&mut world, 4.0, |_, states| hop = hop.max(f64::from(states[1].position.y) - 0.5));
        let last = world.states()[1];
        let travelled = doubled(last.position - first.position);
        let expected = f64::from(SPEED * SPEED / (2.0 * FRICTION)) / 9.8;
        let name = |what: &str| format!("{kind} over the edges of a {}: {what}", floor.name());
        figures.extend([
            Figure::at_most(name("hop, m"), hop, HOP_MAX),
            Figure::at_most(
                name("off its way, degrees"),
                angle_between(travelled, doubled(way)),
                HEADING_MAX,
            ),
            Figure::at_most(name("turned, degrees"), turned(&first, &last), HEADING_MAX),
            Figure::reported(name("way off, part"), moved(&first, &last) / expected - 1.0),
            not_finite(&name("bodies whose state is not finite"), &world),
        ]);
    }
}

/// A spike slides on its tip over the floor at 10 m/s, without gravity, 0.1 mm above it.
fn sliding_spike(floor: Floor, figures: &mut Vec<Figure>) {
    let mut ground = BodyDef::fixed(floor.shape());
    let mut spike = falling(mesh(&spike()), Vec3::new(-3.9, 3.0001, 0.03), Vec3::X * 10.0);
    (ground.material, spike.material) = (SMOOTH, SMOOTH);
    let mut world = world(environment(Vec3::ZERO, RATE), &[ground, spike]);
    let first = world.states()[1];
    watch(&mut world, 1.0, |_, _| {});
    let last = world.states()[1];
    let change = f64::from((last.velocity - first.velocity).length()) / 10.0;
    let name = |what: &str| format!("sliding spike on a {}: {what}", floor.name());
    figures.extend([
        Figure::at_most(name("change of velocity, part"), change, ENERGY_GAIN_MAX),
        Figure::at_most(name("hop, m"), f64::from(last.position.y - first.position.y).abs(), HOP_MAX),
        Figure::at_most(name("turned, degrees"), turned(&first, &last), HEADING_MAX),
        not_finite(&name("bodies whose state is not finite"), &world),
    ]);
}

/// Ten cubes of a pyramid begin a quarter inside each other.
fn overlap_recovery(figures: &mut Vec<Figure>) {
    const PART: f32 = 0.75;
    const ROWS: u32 = 4;
    let mut ground = BodyDef::fixed(Shape::half_space());
    ground.material = Material::new(0.6, 0.0);
    let mut defs = vec![ground];
    for row in 0..ROWS {
        for i in row..ROWS {
            let x = PART * (0.5 * (row as f32 - ROWS as f32) + (i - row) as f32);
            let mut cube = BodyDef::new(Shape::cuboid(Vec3::splat(0.5)).expect("a box is possible"))
                .at(Vec3::new(x, 0.5 + PART * row as f32, 0.0));
            cube.material = Material::new(0.6, 0.0);
            cube.mass = forerun::dynamics::Mass::Density(1.0);
            defs.push(cube);
        }
    }
    let mut world = world(environment(Vec3::new(0.0, -10.0, 0.0), 60), &defs);
    let gauge = Gauge::new(&world);
    let (mut speed, mut after_5s) = (0.0f64, 0.0f64);
    watch(&mut world, 10.0, |time, states| {
        speed = speed.max(fastest(states));
        if time >= 5.0 {
            after_5s = after_5s.max(gauge.deepest(states));
        }
    });
    figures.extend([
        Figure::at_most("overlap recovery: fastest cube ever, m/s", speed, 3.0),
        Figure::at_most("overlap recovery: deepest overlap after 5 s, part of a cube", after_5s, 0.02),
        not_finite("overlap recovery: bodies whose state is not finite", &world),
    ]);
}
