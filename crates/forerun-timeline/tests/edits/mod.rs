//! Edits: what a fuzzed session may do to a timeline, as plain values that shrink.

use std::sync::{Arc, OnceLock};

use forerun_dynamics::{BodyDef, BodyId, BodyKind, Mass, Material, Spring};
use forerun_geometry::shape::{Capsule, Compound, Cuboid, Cylinder, Hull, Mesh, Shape, Sphere};
use forerun_geometry::{Pose, Quat, Vec3};
use forerun_timeline::Change;
use proptest::prelude::*;

/// A session: the bodies at first, how far the timeline looks back and ahead, and what is done.
#[derive(Clone, Debug)]
pub(crate) struct Session {
    pub(crate) bodies: Vec<Spec>,
    pub(crate) past: u32,
    pub(crate) lookahead: u32,
    /// Most memory for states.
    pub(crate) bytes_max: Option<usize>,
    pub(crate) record_contacts: bool,
    /// Bodies come to rest soon.
    pub(crate) restful: bool,
    pub(crate) edits: Vec<Edit>,
}

/// One thing that is done.
#[derive(Clone, Debug)]
pub(crate) enum Edit {
    /// A command is submitted.
    Submit { at: At, source: u32, change: What },
    /// A command is sent once more under the same key.
    Again(u8),
    /// A command is taken back.
    Retract(u8),
    /// Another change takes the place of that of a command.
    Replace(u8, What),
    /// The local user takes back the last order.
    Undo,
    /// The local user does again what was taken back.
    Redo,
    /// Some frames of work.
    Advance(u8),
    /// All the work there is.
    Finish,
    /// The display goes on, or back.
    Display(i8),
    /// The timeline is put away as values and made anew from them, with its states or without.
    SaveAndLoad(bool),
    /// A fork is put aside.
    Fork,
    /// The session goes on with a fork.
    Swap(u8),
    /// A fork becomes the timeline.
    Adopt(u8),
    /// Everything known to be true is compared with a full run.
    Compare,
}

/// The frame of a command.
#[derive(Clone, Copy, Debug)]
pub(crate) enum At {
    /// The oldest frame or before: refused.
    TooOld,
    /// So many after the oldest that commands may have.
    Past(u8),
    /// Before (or after) the frame after the display's.
    Display(i8),
    /// Before or after the horizon.
    Horizon(i8),
    /// As late as can be, or nearly.
    Never(u8),
}

/// A number that is small, or not.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Size {
    One,
    Zero,
    NegativeZero,
    Denormal,
    Huge(u8),
    NotANumber,
    Infinite,
}

impl Size {
    pub(crate) fn is_plain(self) -> bool {
        matches!(self, Size::One | Size::Zero)
    }

    pub(crate) fn is_finite(self) -> bool {
        !matches!(self, Size::NotANumber | Size::Infinite)
    }

    fn factor(self) -> f32 {
        match self {
            Size::One => 1.0,
            Size::Zero => 0.0,
            Size::NegativeZero => -0.0,
            Size::Denormal => 1e-42,
            Size::Huge(index) => [1e3, 1e6, 1e10, 1e18, 1e27, 1e36][usize::from(index) % 6],
            Size::NotANumber => f32::NAN,
            Size::Infinite => f32::INFINITY,
        }
    }
}

/// A direction on a coarse grid, and a size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrow(i8, i8, i8, pub(crate) Size);

impl Arrow {
    fn times(self, length: f32) -> Vec3 {
        Vec3::new(f32::from(self.0), f32::from(self.1), f32::from(self.2)) * (length / 64.0) * self.3.factor()
    }
}

/// What a command does, and to the how-manieth name.
#[derive(Clone, Debug)]
pub(crate) enum What {
    Add(Spec),
    /// With a name in use: refused where a body is or was made by it.
    AddAgain(u8, Spec),
    Remove(u8),
    Move(u8, Arrow),
    Push(u8, Arrow, Option<Arrow>),
    SetVelocity(u8, Arrow, Arrow),
    Hold(u8, Arrow, Size),
    Release(u8),
    SetMaterial(u8, Size),
    SetForce(u8, Arrow, Arrow),
    SetGravityScale(u8, Size),
    SetMass(u8, Size),
    SetKind(u8, u8),
    SetGravity(Arrow),
}

impl What {
    /// Whether all its numbers are of ordinary size, so that nobody may refuse them.
    pub(crate) fn is_plain(&self) -> bool {
        let possible = match self {
            What::Add(spec) | What::AddAgain(_, spec) => !matches!(spec.density, Size::Zero),
            _ => true,
        };
        possible && self.sizes().into_iter().all(Size::is_plain)
    }

    /// Whether all its numbers are finite: if not, it has to be refused.
    pub(crate) fn is_finite(&self) -> bool {
        self.sizes().into_iter().all(Size::is_finite)
    }

    fn sizes(&self) -> Vec<Size> {
        match self {
            What::Add(spec) | What::AddAgain(_, spec) => vec![spec.velocity.3, spec.density],
            What::Move(_, arrow) | What::SetGravity(arrow) => vec![arrow.3],
            What::Push(_, arrow, point) => point.iter().map(|point| point.3).chain([arrow.3]).collect(),
            What::SetVelocity(_, a, b) | What::SetForce(_, a, b) => vec![a.3, b.3],
            What::Hold(_, arrow, size) => vec![arrow.3, *size],
            What::SetMaterial(_, size) | What::SetGravityScale(_, size) | What::SetMass(_, size) => {
                vec![*size]
            }
            What::Remove(_) | What::Release(_) | What::SetKind(..) => Vec::new(),
        }
    }

    /// The change, where `names` names are in use.
    pub(crate) fn change(&self, names: usize) -> Change {
        let name = |index: u8| BodyId(u32::from(index) % (names as u32).max(1));
        match self.clone() {
            What::Add(spec) => Change::Add { body: BodyId(names as u32), def: Box::new(spec.def()) },
            What::AddAgain(body, spec) => Change::Add { body: name(body), def: Box::new(spec.def()) },
            What::Remove(body) => Change::Remove { body: name(body) },
            What::Move(body, arrow) => {
                let position = arrow.times(6.0) + Vec3::Y;
                let turned = Quat::from_xyzw(f32::from(arrow.0), f32::from(arrow.1), 0.0, 80.0).normalize();
                Change::Move { body: name(body), pose: Pose { position, rotation: turned } }
            }
            What::Push(body, arrow, point) => {
                let at_point = point.map(|point| point.times(3.0));
                Change::Push { body: name(body), impulse: arrow.times(2000.0), at_point }
            }
            What::SetVelocity(body, velocity, spin) => Change::SetVelocity {
                body: name(body),
                velocity: velocity.times(8.0),
                angular_velocity: spin.times(8.0),
            },
            What::Hold(body, arrow, size) => {
                let spring = Spring {
                    anchor: Vec3::ZERO,
                    target: arrow.times(4.0),
                    frequency_hz: 5.0 + size.factor(),
                    damping_ratio: size.factor(),
                };
                Change::Hold { body: name(body), spring }
            }
            What::Release(body) => Change::Release { body: name(body) },
            What::SetMaterial(body, size) => {
                let friction = 0.4 * size.factor();
                let restitution = if size.is_plain() { 0.5 } else { 0.0 };
                let material = Material { friction, static_friction: 1.5 * friction, restitution };
                Change::SetMaterial { body: name(body), material }
            }
            What::SetForce(body, force, torque) => {
                Change::SetForce { body: name(body), force: force.times(9000.0), torque: torque.times(900.0) }
            }
            What::SetGravityScale(body, size) => {
                Change::SetGravityScale { body: name(body), scale: -0.5 * size.factor() }
            }
            What::SetMass(body, size) => Change::SetMass { body: name(body), mass: 70.0 * size.factor() },
            What::SetKind(body, kind) => {
                let kinds = [BodyKind::Dynamic, BodyKind::Fixed, BodyKind::Kinematic];
                Change::SetKind { body: name(body), kind: kinds[usize::from(kind) % 3] }
            }
            What::SetGravity(arrow) => Change::SetGravity { gravity: arrow.times(10.0) },
        }
    }
}

/// How a body is made.
#[derive(Clone, Debug)]
pub(crate) struct Spec {
    shape: u8,
    /// On a coarse grid, so that bodies overlap, touch and stack.
    place: (i8, u8, i8),
    velocity: Arrow,
    density: Size,
    kind: u8,
}

impl Spec {
    pub(crate) fn def(&self) -> BodyDef {
        let (x, y, z) = self.place;
        let place = Vec3::new(0.3 * f32::from(x), 0.3 + 0.3 * f32::from(y), 0.3 * f32::from(z));
        let kind = match self.kind {
            0..6 => BodyKind::Dynamic,
            6 => BodyKind::Fixed,
            _ => BodyKind::Kinematic,
        };
        BodyDef {
            kind,
            velocity: self.velocity.times(6.0),
            mass: Mass::Density(800.0 * self.density.factor()),
            ..BodyDef::new(shape(usize::from(self.shape))).at(place)
        }
    }
}

/// Boxes are the commonest. Made once: a distance field takes a while.
fn shape(index: usize) -> Shape {
    static SHAPES: OnceLock<[Shape; 7]> = OnceLock::new();
    let shapes = SHAPES.get_or_init(|| {
        let r = 0.35;
        let corners = [Vec3::X * r, -Vec3::X * r, Vec3::Y * r, -Vec3::Y * r, Vec3::Z * r, -Vec3::Z * r];
        let triangles =
            [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let bars = [Vec3::new(0.3, 0.15, 0.1), Vec3::new(0.1, 0.15, 0.3)]
            .map(|half_extents| (Pose::IDENTITY, Shape::Cuboid(Cuboid { half_extents })));
        [
            Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.3, 0.15, 0.3) }),
            Shape::Sphere(Sphere { radius: 0.3 }),
            Shape::Capsule(Capsule { half_height: 0.2, radius: 0.15 }),
            Shape::Cylinder(Cylinder { half_height: 0.15, radius: 0.3 }),
            Shape::Hull(Arc::new(Hull::new(&corners).expect("an octahedron is convex"))),
            Shape::Compound(Arc::new(Compound::new(bars.to_vec()).expect("two boxes"))),
            Mesh::new(corners.to_vec(), triangles.to_vec()).expect("an octahedron is closed").into(),
        ]
    });
    shapes[index.saturating_sub(2) % shapes.len()].clone()
}

pub(crate) fn session() -> impl Strategy<Value = Session> {
    // One body that is not possible would be the end of the session.
    let few = || prop::collection::vec(spec(Just(Size::One)), 0..10);
    let many = prop::collection::vec(spec(Just(Size::One)), 0..40);
    let pasts = prop_oneof![Just(3_u32), Just(15), Just(1000)];
    let memory = prop_oneof![5 => Just(None), 1 => (10_000_usize..200_000).prop_map(Some)];
    let settings = (pasts, 2_u32..25, memory, any::<bool>(), any::<bool>());
    (prop_oneof![few(), few(), many], settings, prop::collection::vec(edit(), 1..50)).prop_map(
        |(bodies, (past, lookahead, bytes_max, record_contacts, restful), edits)| Session {
            bodies,
            past,
            lookahead,
            bytes_max,
            record_contacts,
            restful,
            edits,
        },
    )
}

fn edit() -> impl Strategy<Value = Edit> {
    prop_oneof![
        20 => (at(), 0_u32..3, what()).prop_map(|(at, source, change)| Edit::Submit { at, source, change }),
        1 => any::<u8>().prop_map(Edit::Again),
        3 => any::<u8>().prop_map(Edit::Retract),
        3 => (any::<u8>(), what()).prop_map(|(index, change)| Edit::Replace(index, change)),
        3 => Just(Edit::Undo),
        2 => Just(Edit::Redo),
        8 => (1_u8..12).prop_map(Edit::Advance),
        2 => Just(Edit::Finish),
        4 => (-6_i8..10).prop_map(Edit::Display),
        2 => any::<bool>().prop_map(Edit::SaveAndLoad),
        1 => Just(Edit::Fork),
        1 => any::<u8>().prop_map(Edit::Swap),
        1 => any::<u8>().prop_map(Edit::Adopt),
        1 => Just(Edit::Compare),
    ]
}

fn at() -> impl Strategy<Value = At> {
    prop_oneof![
        1 => Just(At::TooOld),
        4 => (0_u8..30).prop_map(At::Past),
        5 => (-5_i8..6).prop_map(At::Display),
        4 => (-6_i8..6).prop_map(At::Horizon),
        1 => (0_u8..3).prop_map(At::Never),
    ]
}

fn what() -> impl Strategy<Value = What> {
    let name = any::<u8>;
    prop_oneof![
        6 => spec(size()).prop_map(What::Add),
        1 => (name(), spec(size())).prop_map(|(body, spec)| What::AddAgain(body, spec)),
        5 => name().prop_map(What::Remove),
        5 => (name(), arrow()).prop_map(|(body, arrow)| What::Move(body, arrow)),
        6 => (name(), arrow(), prop::option::of(arrow())).prop_map(|(body, a, p)| What::Push(body, a, p)),
        4 => (name(), arrow(), arrow()).prop_map(|(body, v, w)| What::SetVelocity(body, v, w)),
        3 => (name(), arrow(), size()).prop_map(|(body, arrow, size)| What::Hold(body, arrow, size)),
        2 => name().prop_map(What::Release),
        2 => (name(), size()).prop_map(|(body, size)| What::SetMaterial(body, size)),
        3 => (name(), arrow(), arrow()).prop_map(|(body, f, t)| What::SetForce(body, f, t)),
        3 => (name(), size()).prop_map(|(body, size)| What::SetGravityScale(body, size)),
        3 => (name(), size()).prop_map(|(body, size)| What::SetMass(body, size)),
        4 => (name(), 0_u8..3).prop_map(|(body, kind)| What::SetKind(body, kind)),
        1 => arrow().prop_map(What::SetGravity),
    ]
}

fn size() -> impl Strategy<Value = Size> + Clone {
    prop_oneof![
        40 => Just(Size::One),
        4 => Just(Size::Zero),
        1 => Just(Size::NegativeZero),
        1 => Just(Size::Denormal),
        2 => (0_u8..6).prop_map(Size::Huge),
        1 => Just(Size::NotANumber),
        1 => Just(Size::Infinite),
    ]
}

fn arrow() -> impl Strategy<Value = Arrow> {
    sized_arrow(size())
}

fn sized_arrow(size: impl Strategy<Value = Size>) -> impl Strategy<Value = Arrow> {
    (-64_i8..=64, -64_i8..=64, -64_i8..=64, size).prop_map(|(x, y, z, size)| Arrow(x, y, z, size))
}

fn spec(size: impl Strategy<Value = Size> + Clone) -> impl Strategy<Value = Spec> {
    let place = (-5_i8..6, 0_u8..8, -4_i8..5);
    (0_u8..9, place, sized_arrow(size.clone()), size, 0_u8..8)
        .prop_map(|(shape, place, velocity, density, kind)| Spec { shape, place, velocity, density, kind })
}
