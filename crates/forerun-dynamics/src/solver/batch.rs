//! Batch: islands that are solved together, and the stages that they go through.
//!
//! *Invariant:* the next states of an island do not depend on which other islands share its batch.

use forerun_geometry::{Manifold, Shape, Vec3};

use super::arrange::{Arranger, Order};
use super::blocks::{Arranged, Class};
use super::bodies::Bodies;
use super::collisions::Moving;
use super::contact_graph::ContactGraph;
use super::descent::{Descent, Sweeps};
use super::energy_guard::{EnergyGuard, Guarded, Guarding};
use super::impulses::ImpulseSums;
use super::islands::Islands;
use super::load::{LoadPass, Loads, Strain};
use super::manifolds::Source;
use super::positions::moved;
use super::prepare::{Common, prepare};
use super::rest::{Ending, Resting};
use super::rows::Rows;
use super::standing::StandingPass;
use super::substep::{displace, fall, note_pushes};
use super::sweep::Law;
use super::velocities::integrate_velocities;
use crate::narrow_phase::Contact;
use crate::scratch::{emptied, fill};
use crate::{BodyState, Environment, Member, ShockPropagation, StepSettings};

/// An island is hard when the load pass leaves more than this part of its weight to the sweeps: stacks and pyramids leave none, a heap most of it.
const HARD_PART: f64 = 0.1;

/// Root mean square of the speeds in an island; what moves faster does not stand. m/s
const SLOW: f64 = 0.5;
/// Sweeps that find what the contacts of fast hard islands carry.
const RUSHING_SWEEPS: u32 = 4;
/// Hard islands that are so high and have so few contacts are delicate: arches, card houses. It takes many sweeps to find what keeps them up, and
/// as they are small that costs little: 0.1 ms for an arch of 17 stones.
const DELICATE_LEVELS: u32 = 4;
const DELICATE_CONTACTS: u32 = 192;
/// Sweeps, each down and up, that find what the contacts of delicate islands carry, and that solve them in each substep. With 24 and 8 an arch that
/// needs nine tenths of its friction sinks by 0.2 m before it rests, with 32 and 8 by 4 mm.
const DELICATE_SWEEPS: u32 = 32;
const DELICATE_SUBSTEP_SWEEPS: u32 = 8;
/// An island overlaps when some contact does by so many times what is allowed.
const OVERLAPPING: f32 = 2.0;
/// So many more passes push the overlap out of islands that overlap, and of hard ones. A dropped stack of 20 comes to rest after 125 frames instead of
/// 273, a Jenga tower that starts 5 cm in the ground with overlaps of 1.6 mm instead of 5.7.
const MORE_PUSHES: usize = 2;

/// A contact of a batch: who touches, and where that is written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ends {
    /// Index of the body with the lower id.
    pub(crate) first: u32,
    /// Index of the other.
    pub(crate) second: u32,
    /// Index among the contacts that were found.
    pub(crate) contact: u32,
}

/// The contacts of a batch, in canonical order within an island.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactList<'a> {
    pub(crate) ends: &'a [Ends],
    /// What was found, for this batch or for more: who touches is said in other numbers here.
    pub(crate) found: &'a [Contact],
}

impl<'a> ContactList<'a> {
    /// Where contact `k` of the batch touches.
    pub(crate) fn manifold(&self, k: usize) -> &'a Manifold {
        &self.found[self.ends[k].contact as usize].manifold
    }
}

/// What the classes of islands follow from.
#[derive(Clone, Copy, Debug, Default)]
struct IslandSums {
    weight: f64,
    /// The part of the weight that the load pass does not place.
    lost: f64,
    mass: f64,
    /// Twice the energy of the centres of mass.
    motion: f64,
}

impl IslandSums {
    fn add(&mut self, strain: &Strain, member: &Member) {
        let mass = 1.0 / f64::from(member.body.inverse_mass);
        self.weight += f64::from(strain.weight);
        self.lost += f64::from(strain.lost);
        self.mass += mass;
        self.motion += mass * f64::from(member.state.velocity.length_squared());
    }

    fn is_hard(&self) -> bool {
        self.lost > HARD_PART * self.weight
    }

    fn is_slow(&self) -> bool {
        self.motion < SLOW * SLOW * self.mass
    }
}

/// Some islands, with the bodies that do not yield but that they touch. Kept from step to step for its memory.
#[derive(Debug, Default)]
pub(crate) struct Batch<'a> {
    /// Those that yield, by id within an island; then the others.
    pub(crate) members: Vec<Member<'a>>,
    /// By member: its index in the group.
    pub(crate) sources: Vec<u32>,
    /// See [`ContactList`].
    pub(crate) ends: Vec<Ends>,
    pub(crate) found: &'a [Contact],
    pub(crate) islands: Islands,
    /// `settings.frame_seconds` is the length of the slice.
    pub(crate) environment: Environment,
    /// By contact; see [`Batch::record_impulses`].
    pub(crate) impulses: ImpulseSums,
    /// By member: the state at the end.
    pub(crate) next: Vec<BodyState>,
    bodies: Bodies,
    dynamic: Vec<bool>,
    graph: ContactGraph,
    loads: Loads,
    rows: Rows,
    arranger: Arranger,
    guard: EnergyGuard,
    descent: Descent,
    spins: Vec<Vec3>,
    endings: Vec<Ending>,
    bounces: bool,
    /// By island: whether a moving kinematic body touches it.
    driven: Vec<bool>,
}

impl<'a> Batch<'a> {
    /// Once members, contacts and islands are there: the start of their frame or slice.
    pub(crate) fn start(&mut self, environment: &Environment, found: &'a [Contact]) {
        self.environment = *environment;
        self.found = found;
        self.dynamic.clear();
        self.dynamic.extend(self.members.iter().map(|m| m.body.is_dynamic()));
        self.bounces = self.members.iter().any(|m| m.body.material.restitution > 0.0);
        self.impulses.clear();
        self.find_driven();
    }

    /// The memory alone.
    pub(crate) fn emptied<'b>(self) -> Batch<'b> {
        Batch {
            members: emptied(self.members),
            sources: self.sources,
            ends: self.ends,
            found: &[],
            islands: self.islands,
            environment: self.environment,
            impulses: self.impulses,
            next: self.next,
            bodies: self.bodies,
            dynamic: self.dynamic,
            graph: self.graph,
            loads: self.loads,
            rows: self.rows,
            arranger: self.arranger,
            guard: self.guard,
            descent: self.descent,
            spins: self.spins,
            endings: self.endings,
            bounces: false,
            driven: self.driven,
        }
    }

    /// Where the members touch.
    pub(crate) fn contacts(&self) -> ContactList<'_> {
        ContactList { ends: &self.ends, found: self.found }
    }

    /// Has what contacts push with added up. The classic shock propagation's impulses, which act on velocities, are not among it.
    pub(crate) fn record_impulses(&mut self) {
        fill(&mut self.impulses, self.ends.len(), [0.0; 4]);
    }

    fn substep_seconds(&self) -> f32 {
        self.environment.settings.frame_seconds / self.environment.settings.substeps as f32
    }

    /// Stage 2: springs, gyroscopic term, accelerations.
    pub(crate) fn integrate_velocities(&mut self) {
        self.bodies = Bodies::gather(&self.members, &self.environment);
        self.spins =
            integrate_velocities(&self.members, &mut self.bodies, self.environment.settings.frame_seconds);
    }

    /// Stage 3: levels, load, rows.
    pub(crate) fn build_contact_graph(&mut self) {
        let contacts = ContactList { ends: &self.ends, found: self.found };
        self.graph.build(&self.members, &contacts);
        LoadPass {
            members: &self.members,
            contacts,
            graph: &self.graph,
            environment: &self.environment,
            substep_seconds: self.substep_seconds(),
        }
        .run(&mut self.loads);
        self.arrange();
        let gravity = self.environment.gravity;
        let contacts = ContactList { ends: &self.ends, found: self.found };
        let source = Source { contacts, loads: &self.loads.of_contact, levels: self.graph.levels() };
        let common = Common {
            up: if gravity == Vec3::ZERO { Vec3::ZERO } else { -gravity.normalize() },
            shock_yield: self.environment.settings.shock_yield,
            substep_seconds: self.substep_seconds(),
        };
        let Rows { flat, uneven } = &mut self.rows;
        prepare(&mut flat.blocks, &mut flat.details, &self.bodies, &source, &common);
        prepare(&mut uneven.blocks, &mut uneven.details, &self.bodies, &source, &common);
    }

    /// Finds a lane for every contact: flat islands apart from uneven ones, and each class by itself.
    fn arrange(&mut self) {
        let kinds = self.kinds();
        let mut chosen: [Vec<u32>; 2 * Class::COUNT] = Default::default();
        for (k, ends) in self.ends.iter().enumerate() {
            let (class, uneven) = kinds[self.island_of(ends)];
            chosen[class as usize + if uneven { Class::COUNT } else { 0 }].push(k as u32);
        }
        let order = Order { graph: &self.graph, contacts: &self.ends, yields: &self.dynamic };
        let (arranger, Rows { flat, uneven }) = (&mut self.arranger, &mut self.rows);
        let (of_flat, of_uneven) = chosen.split_at(Class::COUNT);
        arranger.begin(self.members.len());
        flat.clear();
        for (chosen, class) in of_flat.iter().zip(0..) {
            arranger.add(chosen, &order, flat);
            flat.ends[class] = flat.count;
        }
        flat.finish();
        uneven.clear();
        for (chosen, class) in of_uneven.iter().zip(0..) {
            arranger.add(chosen, &order, uneven);
            uneven.ends[class] = uneven.count;
        }
        uneven.finish();
    }

    /// By island: what it needs, and whether some manifold has points that push different ways, which only those of meshes do.
    fn kinds(&self) -> Vec<(Class, bool)> {
        let mut sums = vec![IslandSums::default(); self.islands.count() + 1];
        for (i, (strain, member)) in self.loads.strain.iter().zip(&self.members).enumerate() {
            if member.body.is_dynamic() {
                sums[self.islands.root(i)].add(strain, member);
            }
        }
        // How high the island is.
        let mut top = vec![0; self.islands.count() + 1];
        for &i in &self.graph.order {
            let island = self.islands.root(i as usize);
            top[island] = top[island].max(self.graph.levels()[i as usize]);
        }
        // How many contacts, and the deepest overlap.
        let mut size = vec![(0u32, 0.0f32); self.islands.count() + 1];
        for (ends, separation) in self.ends.iter().zip(self.graph.deepest()) {
            let size = &mut size[self.island_of(ends)];
            *size = (size.0 + 1, size.1.max(-separation));
        }
        let deep = OVERLAPPING * self.environment.settings.overlap_allowed_m;
        let class = |((sums, (contacts, overlap)), top): ((IslandSums, _), _)| match sums.is_hard() {
            true if !sums.is_slow() => Class::Rushing,
            true if contacts <= DELICATE_CONTACTS && top >= DELICATE_LEVELS => Class::Delicate,
            true => Class::Heap,
            false if overlap > deep => Class::Overlapping,
            false => Class::Easy,
        };
        let mut kinds: Vec<(Class, bool)> =
            sums.into_iter().zip(size).zip(top).map(|of| (class(of), false)).collect();
        if self.members.iter().any(|m| is_mesh(&m.body.shape)) {
            for (k, ends) in self.ends.iter().enumerate() {
                let manifold = self.contacts().manifold(k);
                let points = &manifold.points[..manifold.count as usize];
                if points.iter().any(|p| p.normal != points[0].normal) {
                    kinds[self.island_of(ends)].1 = true;
                }
            }
        }
        kinds
    }

    /// The number of the island that a contact belongs to.
    fn island_of(&self, ends: &Ends) -> usize {
        // Bodies that do not yield have the highest number.
        self.islands.root(ends.first as usize).min(self.islands.root(ends.second as usize))
    }

    /// Stage 4: substeps of bounces, gravity, warm start and sweeps.
    pub(crate) fn resolve_contacts(&mut self) {
        let settings = self.environment.settings;
        let h = self.substep_seconds();
        let at = Guarding { islands: &self.islands, driven: &self.driven };
        let (rows, bodies, impulses) = (&mut self.rows, &mut self.bodies, &mut self.impulses);
        let mut standing =
            StandingPass { guard: &mut self.guard, descent: &mut self.descent, at, kicks: &bodies.kicks };
        let efforts = [
            (Class::Rushing, RUSHING_SWEEPS.min(settings.first_sweeps_hard)),
            (Class::Heap, settings.first_sweeps_hard),
            (Class::Delicate, DELICATE_SWEEPS),
        ];
        for (class, sweeps) in efforts {
            let chosen = rows.flat.of(class);
            let Arranged { blocks, details, .. } = &mut rows.flat;
            standing.run(&mut blocks[chosen.clone()], &mut details[chosen], sweeps);
            let chosen = rows.uneven.of(class);
            let Arranged { blocks, details, .. } = &mut rows.uneven;
            standing.run(&mut blocks[chosen.clone()], &mut details[chosen], sweeps);
        }
        for substep in 0..settings.substeps {
            if self.bounces {
                rows.resolve_collisions(&mut moving(bodies, &settings, impulses));
            }
            if substep == 1 {
                rows.remove_momentum(&mut bodies.pushes);
            }
            fall(bodies);
            if substep == 0 {
                rows.apply_impulses(&mut bodies.velocities);
            }
            let guess = if substep == 0 { Guarded::FirstGuess } else { Guarded::Guess };
            keep_energy(&mut self.guard, at, rows, bodies, guess);
            for _ in 0..if substep == 0 { settings.first_sweeps } else { 1 } {
                rows.sweep(&mut bodies.velocities);
            }
            let sweeps = Sweeps { count: DELICATE_SUBSTEP_SWEEPS, law: Law::Coulomb };
            rows.descend(&mut self.descent, at, &mut bodies.velocities, sweeps);
            keep_energy(&mut self.guard, at, rows, bodies, Guarded::Result);
            displace(bodies, h);
            rows.relax(&mut moving(bodies, &settings, &mut []), self.bounces);
            note_pushes(bodies);
            rows.add_impulses(impulses);
            if settings.shock_propagation == ShockPropagation::Classic {
                rows.propagate_classic(&mut bodies.velocities, &bodies.displacements, h);
            }
        }
    }

    /// Finds the islands that a moving kinematic body touches.
    fn find_driven(&mut self) {
        fill(&mut self.driven, self.members.len() + 1, false);
        let drives = |i: u32| self.members[i as usize].drives();
        if !self.members.iter().any(Member::drives) {
            return;
        }
        for Ends { first, second, .. } in &self.ends {
            for (driver, driven) in [(*first, *second), (*second, *first)] {
                if drives(driver) {
                    self.driven[self.islands.root(driven as usize)] = true;
                }
            }
        }
    }

    /// Stage 5: remaining overlap is pushed out, level by level.
    pub(crate) fn propagate_shock(&mut self) {
        let settings = self.environment.settings;
        let push_max = settings.recovery_speed_max * settings.frame_seconds;
        let displacements = &mut self.bodies.displacements;
        // Meshes overlap in many points at once and need a second pass. Mesh islands have batches of their own.
        let meshes = self.members.iter().any(|m| m.body.is_dynamic() && is_mesh(&m.body.shape));
        let passes = if meshes { 2 } else { 1 };
        for _ in 0..passes {
            self.rows.propagate_shock(Class::Easy..=Class::Easy, displacements, &settings, push_max);
        }
        for _ in 0..passes + MORE_PUSHES {
            self.rows.propagate_shock(
                Class::Overlapping..=Class::Delicate,
                displacements,
                &settings,
                push_max,
            );
        }
    }

    /// Stage 6: new states.
    pub(crate) fn integrate_positions(&mut self) {
        let (members, environment) = (&self.members, &self.environment);
        let at = Resting {
            members,
            contacts: ContactList { ends: &self.ends, found: self.found },
            deepest: self.graph.deepest(),
            islands: &self.islands,
            driven: &self.driven,
            environment,
        };
        at.find_endings(&self.spins, &mut self.endings);
        let bodies = &self.bodies;
        let moves = |(i, m): (usize, &Member)| moved(m, bodies, i, &self.endings[i], environment);
        self.next.clear();
        self.next.extend(members.iter().enumerate().map(moves));
        at.settle(&mut self.next, &self.endings);
    }

    /// For each contact: by how much the solver expects it to lie deeper at the end of the frame. Metres.
    pub(crate) fn overlap_growth(&self) -> Vec<f32> {
        let mut growth = vec![0.0; self.ends.len()];
        self.rows.overlap_growth(&self.bodies.displacements, &mut growth);
        growth
    }
}

/// Whether contacts with the shape come from a distance field.
pub(crate) fn is_mesh(shape: &Shape) -> bool {
    matches!(shape, Shape::Mesh(_))
}

/// What the kernels that look ahead need of the bodies.
fn moving<'a>(bodies: &'a mut Bodies, settings: &StepSettings, bounced: &'a mut [[f32; 4]]) -> Moving<'a> {
    Moving {
        velocities: &mut bodies.velocities,
        displacements: &bodies.displacements,
        kicks: &bodies.kicks,
        substep_seconds: settings.frame_seconds / settings.substeps as f32,
        substeps: settings.substeps as f32,
        bounced,
    }
}

/// Scales back what impulses have added, where it is energy.
fn keep_energy(guard: &mut EnergyGuard, at: Guarding, rows: &mut Rows, bodies: &mut Bodies, what: Guarded) {
    if guard.gains(at, &bodies.free, &bodies.velocities, what) {
        guard.scale_back(at.islands, &bodies.free, &mut bodies.velocities);
        rows.scale_impulses(guard, at.islands, what);
    }
}
