//! Batch: islands that are solved together, and the stages that they go through.
//!
//! *Invariant:* the next states of an island do not depend on which other islands share its batch.

use forerun_geometry::{Shape, Vec3};

use super::arrange::{Arranger, Order};
use super::bodies::Bodies;
use super::collisions::Moving;
use super::contact_graph::ContactGraph;
use super::energy_guard::{EnergyGuard, Guarded};
use super::impulses::ImpulseSums;
use super::islands::Islands;
use super::load::{Load, LoadPass, Strain};
use super::manifolds::Source;
use super::positions::moved;
use super::prepare::{Common, prepare};
use super::rest::{IslandsAt, endings, settle};
use super::rows::{OnlyHard, Rows};
use super::standing::StandingPass;
use super::substep::{displace, fall, note_pushes};
use super::velocities::integrate_velocities;
use crate::narrow_phase::Contact;
use crate::{BodyState, Environment, Member, ShockPropagation, StepSettings};

/// An island is hard when the load pass leaves more than this part of its weight to the sweeps: stacks and pyramids leave none, a heap most of it.
const HARD_PART: f64 = 0.1;

/// So many more passes push the overlap out of hard islands. Of 1000 bodies poured into a pit the worst two overlapped by 103 mm without them
/// and by 10 mm with them, at a cost of 4 %.
const HARD_PUSHES: usize = 2;

/// Some islands, with the bodies that do not yield but that they touch.
pub(crate) struct Batch<'a> {
    /// Sorted by id.
    pub(crate) members: Vec<Member<'a>>,
    /// In canonical order; indices into `members`.
    pub(crate) contacts: Vec<Contact>,
    /// `settings.frame_seconds` is the length of the slice.
    pub(crate) environment: Environment,
    /// By contact; see [`Batch::record_impulses`].
    pub(crate) impulses: ImpulseSums,
    bodies: Bodies,
    dynamic: Vec<bool>,
    islands: Islands,
    graph: ContactGraph,
    rows: Rows,
    guard: EnergyGuard,
    spins: Vec<Vec3>,
    bounces: bool,
}

impl<'a> Batch<'a> {
    /// A batch at the start of its frame or slice.
    pub(crate) fn new(
        members: Vec<Member<'a>>,
        contacts: Vec<Contact>,
        environment: Environment,
    ) -> Batch<'a> {
        let dynamic: Vec<bool> = members.iter().map(|m| m.body.is_dynamic()).collect();
        let ends = contacts.iter().map(|c| (c.first, c.second));
        let islands = Islands::find(members.len(), |i| dynamic[i], ends);
        let bounces = members.iter().any(|m| m.body.material.restitution > 0.0);
        Batch {
            members,
            contacts,
            environment,
            impulses: Vec::new(),
            bodies: Bodies::default(),
            dynamic,
            islands,
            graph: ContactGraph::default(),
            rows: Rows::default(),
            guard: EnergyGuard::default(),
            spins: Vec::new(),
            bounces,
        }
    }

    /// Has what contacts push with added up. The classic shock propagation's impulses, which act on velocities, are not among it.
    pub(crate) fn record_impulses(&mut self) {
        self.impulses = vec![[0.0; 4]; self.contacts.len()];
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
        self.graph = ContactGraph::build(&self.members, &self.contacts);
        let (loads, strains) = self.loads();
        let hard = self.hard(&strains);
        self.arrange(&hard);
        let levels: Vec<u32> = (0..self.members.len()).map(|i| self.graph.level(i)).collect();
        let gravity = self.environment.gravity;
        let source = Source { contacts: &self.contacts, loads: &loads, levels: &levels };
        let common = Common {
            up: if gravity == Vec3::ZERO { Vec3::ZERO } else { -gravity.normalize() },
            shock_yield: self.environment.settings.shock_yield,
            substep_seconds: self.substep_seconds(),
        };
        let Rows { flat, uneven } = &mut self.rows;
        prepare(&mut flat.blocks, &mut flat.details, &self.bodies, &source, &common);
        prepare(&mut uneven.blocks, &mut uneven.details, &self.bodies, &source, &common);
    }

    /// Finds a lane for every contact: flat islands apart from uneven ones, easy ones before hard ones.
    fn arrange(&mut self, hard: &[bool]) {
        let uneven = self.uneven();
        let mut chosen: [Vec<u32>; 4] = Default::default();
        for (k, contact) in self.contacts.iter().enumerate() {
            let root = self.island_of(contact);
            chosen[2 * usize::from(uneven[root]) + usize::from(hard[root])].push(k as u32);
        }
        let order = Order { graph: &self.graph, contacts: &self.contacts, yields: &self.dynamic };
        let mut arranger = Arranger::default();
        arranger.begin(self.members.len());
        let Rows { flat, uneven } = &mut self.rows;
        let [flat_easy, flat_hard, uneven_easy, uneven_hard] = &chosen;
        flat.clear();
        arranger.add(flat_easy, &order, flat);
        flat.easy = flat.count;
        arranger.add(flat_hard, &order, flat);
        flat.finish();
        uneven.clear();
        arranger.add(uneven_easy, &order, uneven);
        uneven.easy = uneven.count;
        arranger.add(uneven_hard, &order, uneven);
        uneven.finish();
    }

    /// Per island root: whether some manifold has points that push different ways. Only those of meshes do.
    fn uneven(&self) -> Vec<bool> {
        let mut uneven = vec![false; self.members.len()];
        if self.members.iter().any(|m| is_mesh(&m.body.shape)) {
            for contact in &self.contacts {
                let points = &contact.manifold.points[..contact.manifold.count as usize];
                uneven[self.island_of(contact)] |= points.iter().any(|p| p.normal != points[0].normal);
            }
        }
        uneven
    }

    /// The root of the island that a contact belongs to.
    fn island_of(&self, contact: &Contact) -> usize {
        let (first, second) = (contact.first as usize, contact.second as usize);
        self.islands.root(if self.dynamic[first] { first } else { second })
    }

    /// Per island root: whether the load pass fails to place its weight (heaps, arches, wedged bodies), so that it needs more sweeps.
    fn hard(&self, strains: &[Strain]) -> Vec<bool> {
        let mut sums = vec![(0.0f64, 0.0f64); strains.len()];
        for (i, strain) in strains.iter().enumerate() {
            let sum = &mut sums[self.islands.root(i)];
            sum.0 += f64::from(strain.weight);
            sum.1 += f64::from(strain.lost);
        }
        sums.into_iter().map(|(weight, lost)| lost > HARD_PART * weight).collect()
    }

    fn loads(&self) -> (Vec<Load>, Vec<Strain>) {
        LoadPass {
            members: &self.members,
            contacts: &self.contacts,
            graph: &self.graph,
            environment: &self.environment,
            substep_seconds: self.substep_seconds(),
        }
        .run()
    }

    /// Stage 4: substeps of bounces, gravity, warm start and sweeps.
    pub(crate) fn resolve_contacts(&mut self) {
        let settings = self.environment.settings;
        let h = self.substep_seconds();
        let driven = self.driven();
        self.guard.begin(&self.islands, &self.dynamic, &driven);
        self.stand();
        let (rows, bodies, impulses) = (&mut self.rows, &mut self.bodies, &mut self.impulses);
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
            keep_energy(&mut self.guard, rows, bodies, guess);
            for _ in 0..if substep == 0 { settings.first_sweeps } else { 1 } {
                rows.sweep(&mut bodies.velocities);
            }
            keep_energy(&mut self.guard, rows, bodies, Guarded::Result);
            displace(bodies, h);
            rows.relax(&mut moving(bodies, &settings, &mut []), self.bounces);
            note_pushes(bodies);
            rows.add_impulses(impulses);
            if settings.shock_propagation == ShockPropagation::Classic {
                rows.propagate_classic(&mut bodies.velocities, &bodies.displacements, h);
            }
        }
    }

    /// Betters the first guess of hard islands.
    fn stand(&mut self) {
        let mut standing = StandingPass {
            guard: &mut self.guard,
            kicks: &self.bodies.kicks,
            sweeps: self.environment.settings.first_sweeps_hard,
        };
        let Rows { flat, uneven } = &mut self.rows;
        standing.run(&mut flat.blocks[flat.easy..], &mut flat.details[flat.easy..]);
        standing.run(&mut uneven.blocks[uneven.easy..], &mut uneven.details[uneven.easy..]);
    }

    /// Islands that a moving kinematic body touches.
    fn driven(&self) -> Vec<bool> {
        let mut driven = vec![false; self.members.len()];
        let drives = |i: u32| self.members[i as usize].drives();
        for c in &self.contacts {
            if drives(c.first) {
                driven[self.islands.root(c.second as usize)] = true;
            }
            if drives(c.second) {
                driven[self.islands.root(c.first as usize)] = true;
            }
        }
        driven
    }

    /// Stage 5: remaining overlap is pushed out, level by level.
    pub(crate) fn propagate_shock(&mut self) {
        let settings = self.environment.settings;
        for _ in 0..self.pushes() {
            self.rows.propagate_shock(OnlyHard::No, &mut self.bodies.displacements, &settings);
        }
        for _ in 0..HARD_PUSHES {
            self.rows.propagate_shock(OnlyHard::Yes, &mut self.bodies.displacements, &settings);
        }
    }

    /// Meshes overlap in many points at once and need a second pass. Mesh islands have batches of their own.
    fn pushes(&self) -> usize {
        if self.members.iter().any(|m| m.body.is_dynamic() && is_mesh(&m.body.shape)) { 2 } else { 1 }
    }

    /// Stage 6: new states, in the order of the members.
    pub(crate) fn integrate_positions(&self) -> Vec<BodyState> {
        let endings = endings(&self.members, &self.contacts, &self.spins, &self.environment.settings);
        let mut next: Vec<BodyState> = (self.members.iter().enumerate())
            .map(|(i, m)| moved(m, &self.bodies, i, &endings[i], &self.environment))
            .collect();
        let islands = IslandsAt { islands: &self.islands, driven: &self.driven(), contacts: &self.contacts };
        settle(&self.members, &mut next, &endings, &islands, &self.environment);
        next
    }

    /// For each contact: by how much the solver expects it to lie deeper at the end of the frame. Metres.
    pub(crate) fn overlap_growth(&self) -> Vec<f32> {
        let mut growth = vec![0.0; self.contacts.len()];
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
fn keep_energy(guard: &mut EnergyGuard, rows: &mut Rows, bodies: &mut Bodies, what: Guarded) {
    if guard.gains(&bodies.free, &bodies.velocities, what) {
        guard.scale_back(&bodies.free, &mut bodies.velocities);
        rows.scale_impulses(guard, what);
    }
}
