//! Nut: a bolt without friction screws itself into a fixed nut.
//!
//! After rigid-ipc (Ferguson et al., *Intersection-free Rigid Body Dynamics*, 2021), fixture *bolt*: a bolt of 139 mm with a head of 92 mm, density
//! 8050 kg/m³. Its meshes are not ours to use; bolt and nut are made by formula, of the same size, M48 with a pitch of 8 mm and flanks that are 0.2 mm
//! apart. There the step is 0.01 s, too.

use std::f64::consts::{PI, TAU};

use forerun::dynamics::{BodyDef, BodyState, Mass, Material, StepSettings, World};
use forerun::geometry::shape::mesh_make::{Bolt, Grip, Nut, Thread};
use forerun::geometry::shape::{Mesh, MeshDraft, MeshOptions, Shape, TriangleList};
use forerun::geometry::{Pose, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{environment, mechanical_energy, rotated, watch, world};

const G: f32 = 9.81;
const THREAD: Thread = Thread { radius: 0.024, pitch: 0.008 };
const BOLT: Bolt = Bolt {
    thread: THREAD,
    length: 0.104,
    head_radius: 0.04,
    head_height: 0.035,
    head: Grip::Hexagonal,
    segments: 60,
};
const NUT: Nut = Nut {
    thread: THREAD,
    clearance: 0.0004,
    height: 0.032,
    outer_radius: 0.04,
    outside: Grip::Hexagonal,
    segments: 60,
};
/// How far up the bolt begins: three pitches of it are in the nut.
const START: f32 = BOLT.length + 0.5 * NUT.height - 3.0 * THREAD.pitch;
const SECONDS: f64 = 5.0;
/// Turns until the head is on the nut.
const TURNS: f64 = ((START - 0.5 * NUT.height) / THREAD.pitch) as f64;

const PITCH_OFF_MAX: f64 = 0.05;
const OVERLAP_MAX: f64 = 0.1;
const JAM_MAX: f64 = 2.0;
/// Off the screw by a pitch it has gone through the thread.
const OFF_MAX: f64 = 0.1;
const ENERGY_GAIN_MAX: f64 = 1e-4;

/// The fixture's step, and the field that suits the thread as far as memory allows.
pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    let meshes = [BOLT.triangles(), NUT.triangles()].map(|list| baked(list.expect("a thread"), None));
    screw(&meshes, 100, &mut figures);
    figures
}

/// Shorter steps, and coarser fields.
pub(crate) fn run_long() -> Vec<Figure> {
    let mut figures = Vec::new();
    let mut last = 0.0;
    for wished in [0.002, 0.0015, 0.001, 0.0005, 0.000_25, 0.000_12] {
        let meshes =
            [BOLT.triangles(), NUT.triangles()].map(|list| baked(list.expect("a thread"), Some(wished)));
        // Where memory sets the limit, smaller wishes change nothing.
        let cell = cell_of(&meshes[0]);
        if (cell - last).abs() < 1e-6 {
            break;
        }
        last = cell;
        for rate in [60, 100, 240, 1000] {
            screw(&meshes, rate, &mut figures);
        }
    }
    figures
}

fn baked(list: TriangleList, cell: Option<f32>) -> Mesh {
    let options = MeshOptions { cell, ..MeshOptions::default() };
    let draft = MeshDraft::new(list.vertices, list.triangles, options).expect("a thread is closed");
    draft.bake(&|_, _| {}).expect("a thread has an inside")
}

/// Largest distance between the nodes of the field. Metres.
fn cell_of(mesh: &Mesh) -> f64 {
    mesh.collider().field.as_ref().map_or(0.0, |field| f64::from(field.cell()))
}

/// What is seen of the bolt on its way.
#[derive(Default)]
struct Way {
    /// Radians turned, below 0 on the way down.
    turned: f64,
    /// Metres gone, below 0 on the way down.
    gone: f64,
    /// Metres off the true screw, at most.
    off: f64,
    /// When it last had turned by a degree more. Seconds.
    moved_at: f64,
    moved: f64,
    /// Longest time without a degree of turning. Seconds.
    jam: f64,
    /// When the head came to the nut. Seconds.
    arrived: Option<f64>,
    /// Deepest overlap until then, and after. Metres.
    deepest: [f64; 2],
    energy: f64,
}

fn screw([bolt, nut]: &[Mesh; 2], rate: u32, figures: &mut Vec<Figure>) {
    let title = format!("cells of {:.2} mm, 1/{rate}", 1e3 * cell_of(bolt));
    let mut falling = BodyDef::new(Shape::from(bolt.clone())).at(Vec3::Y * START);
    falling.mass = Mass::Density(8050.0);
    let mut fixed = BodyDef::fixed(Shape::from(nut.clone()));
    (falling.material, fixed.material) = (Material::new(0.0, 0.0), Material::new(0.0, 0.0));
    let mut environment = environment(Vec3::Y * -G, rate);
    // Nothing is to stop it but the thread.
    environment.settings = StepSettings { rest_seconds: 0.0, ..environment.settings };
    let mut world = world(environment, &[fixed, falling]);
    let bodies = world.bodies().to_vec();
    let energy = |states: &[BodyState]| mechanical_energy(&bodies, states, f64::from(G));
    let (start, mut last) = (energy(world.states()), world.states()[1]);
    let (mut way, mut frame) = (Way::default(), 0);
    watch(&mut world, SECONDS, |time, states| {
        frame += 1;
        let now = states[1];
        way.turned += turn_about_y(&last, &now);
        last = now;
        let pose = bodies[1].own_pose(&now);
        way.gone = f64::from(pose.position.y) - f64::from(START);
        way.energy = way.energy.max(energy(states) / start - 1.0);
        if frame % 4 == 0 {
            let most = &mut way.deepest[usize::from(way.arrived.is_some())];
            *most = most.max(deepest([bolt, nut], [&pose, &bodies[0].own_pose(&states[0])]));
        }
        way.note(time);
    });
    way.report(&title, free_fall_time(&world), figures);
}

impl Way {
    fn note(&mut self, time: f64) {
        if self.arrived.is_some() {
            return;
        }
        self.off = self.off.max((self.gone - self.turned / TAU * f64::from(THREAD.pitch)).abs());
        if (self.turned - self.moved).abs() > PI / 180.0 {
            (self.moved, self.moved_at) = (self.turned, time);
        }
        self.jam = self.jam.max(time - self.moved_at);
        if -self.turned > TAU * (TURNS - 0.1) {
            self.arrived = Some(time);
        }
    }

    fn report(&self, title: &str, ideal: f64, figures: &mut Vec<Figure>) {
        let name = |what: &str| format!("{title}: {what}");
        let [pitch, depth] = [THREAD.pitch, THREAD.depth()].map(f64::from);
        let [on_the_way, wedged] = self.deepest;
        let per_turn = self.gone / (self.turned / TAU);
        figures.extend([
            Figure::at_least(name("turns in 5 s"), -self.turned / TAU, 1.0),
            Figure::at_most(
                name("pitch off over the whole way, part"),
                (per_turn / pitch - 1.0).abs(),
                PITCH_OFF_MAX,
            ),
            Figure::at_most(name("most off the true screw, pitches"), self.off / pitch, OFF_MAX),
            Figure::at_most(
                name("deepest overlap on the way, depths of the thread"),
                on_the_way / depth,
                OVERLAP_MAX,
            ),
            Figure::at_most(
                name("deepest overlap with the head on the nut, depths of the thread"),
                wedged / depth,
                OVERLAP_MAX,
            ),
            Figure::at_most(name("longest jam, s"), self.jam, JAM_MAX),
            Figure::at_most(name("gain of energy, part"), self.energy, ENERGY_GAIN_MAX),
            Figure::reported(
                name("time to the head, of that of a true screw (0: never there)"),
                self.arrived.map_or(0.0, |time| time / ideal),
            ),
        ]);
    }
}

/// How long a true screw without friction takes to the head: what falls turns, so that its inertia adds to its mass. Seconds
fn free_fall_time(world: &World) -> f64 {
    let (mass, inertia) = {
        let body = &world.bodies()[1];
        // The axis of the bolt is that which its inertia is least about, or most: the one that differs from the other two.
        let own = body.frame.rotation.inverse() * Vec3::Y;
        let inverse = f64::from((body.inverse_inertia * own.abs()).element_sum());
        (1.0 / f64::from(body.inverse_mass), 1.0 / inverse)
    };
    let per_metre = TAU / f64::from(THREAD.pitch);
    let acceleration = f64::from(G) / (1.0 + inertia * per_metre * per_metre / mass);
    (2.0 * TURNS * f64::from(THREAD.pitch) / acceleration).sqrt()
}

/// The turn about +y between two states. Radians, -π to π
fn turn_about_y(from: &BodyState, to: &BodyState) -> f64 {
    let turn = to.rotation * from.rotation.conjugate();
    let angle = 2.0 * f64::from(turn.y).atan2(f64::from(turn.w));
    angle - TAU * (angle / TAU).round()
}

/// The deepest overlap, by vertices and middles of triangles of each mesh in the true thread of the other. As all chords of both are on their own side of
/// their true threads, that of the triangles is no deeper. Metres
fn deepest([bolt, nut]: [&Mesh; 2], [bolt_pose, nut_pose]: [&Pose; 2]) -> f64 {
    // The chamfers of both ends are no thread.
    let (pitch, half) = (f64::from(THREAD.pitch), 0.5 * f64::from(NUT.height));
    let in_nut = |y: f64| y.abs() < half - 0.4 * pitch;
    let on_bolt = |y: f64| y < -0.3 * pitch && y > 1.5 * pitch - f64::from(BOLT.length);
    let clearance = f64::from(NUT.clearance);
    let mut deepest = 0.0f64;
    for p in points(bolt).map(|p| moved_to(p, bolt_pose, nut_pose)).filter(|p| in_nut(p[1])) {
        deepest = deepest.max(depth(p, |surface, r| r - surface - clearance, clearance));
    }
    for p in points(nut).map(|p| moved_to(p, nut_pose, bolt_pose)).filter(|p| on_bolt(p[1])) {
        deepest = deepest.max(depth(p, |surface, r| surface - r, 0.0));
    }
    deepest
}

/// Vertices and middles of triangles. Metres
fn points(mesh: &Mesh) -> impl Iterator<Item = [f64; 3]> + '_ {
    let double = |v: Vec3| v.to_array().map(f64::from);
    let middles = (0..mesh.triangles.len()).map(move |t| {
        let [a, b, c] = mesh.corners(t).map(double);
        [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0)
    });
    mesh.vertices.iter().map(move |v| double(*v)).chain(middles)
}

/// A point of one frame in another.
fn moved_to(p: [f64; 3], from: &Pose, to: &Pose) -> [f64; 3] {
    let q = from.rotation.to_array().map(f64::from);
    let at = rotated(q, p);
    let (a, b) = (from.position.to_array().map(f64::from), to.position.to_array().map(f64::from));
    let t = to.rotation.to_array().map(f64::from);
    rotated([-t[0], -t[1], -t[2], t[3]], [0, 1, 2].map(|k| at[k] + a[k] - b[k]))
}

/// How deep a point is in a thread whose surface is `clearance` (metres) outside of the bolt's, in the plane through it and the axis; 0 outside. `inside`
/// tells by how much, along the radius, from the radius of the bolt's surface and its own.
fn depth(p: [f64; 3], inside: impl Fn(f64, f64) -> f64, clearance: f64) -> f64 {
    let (r, angle) = (p[0].hypot(p[2]), (-p[2]).atan2(p[0]));
    let radius_at = |y: f64| THREAD.radius_at(angle, y);
    let along = inside(radius_at(p[1]), r);
    if along <= 0.0 {
        return 0.0;
    }
    // Straight pieces between heights that are close together: no farther off than a hundredth of a pitch.
    let step = f64::from(THREAD.pitch) / 128.0;
    let reach = (along / step).ceil() as i32;
    let gap = |k: i32| {
        let dy = f64::from(k) * step;
        (radius_at(p[1] + dy) + clearance - r).hypot(dy)
    };
    (-reach..=reach).map(gap).fold(along, f64::min)
}
