//! Batch: islands that are solved together, and the stages that they go through.
//!
//! *Invariant:* the next states of an island do not depend on which other islands share its batch.

use forerun_geometry::{Shape, Vec3};

use super::blocks::{Block, arrange};
use super::bodies::Bodies;
use super::collisions::{Moving, resolve_collisions};
use super::contact_graph::ContactGraph;
use super::impulses::{ImpulseSums, add_substep};
use super::islands::Islands;
use super::load::{Load, LoadPass, Strain};
use super::positions::moved;
use super::prepare::{Source, prepare};
use super::rest::{IslandsAt, endings, settle};
use super::shock::{propagate_classic, propagate_shock};
use super::standing::StandingPass;
use super::sweep::{relax, sweep};
use super::velocities::integrate_velocities;
use super::warm_start::{EnergyGuard, Guarded, apply_impulses, remove_momentum};
use crate::lanes::{Portable, Row};
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
    /// First those of easy islands, then those of hard ones.
    blocks: Vec<Block<Portable>>,
    easy_blocks: usize,
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
            blocks: Vec::new(),
            easy_blocks: 0,
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
        let dynamic = &self.dynamic;
        self.graph = ContactGraph::build(&self.members, &self.contacts);
        let (loads, strains) = self.loads();
        let hard = self.hard(&strains);
        let is_hard = |k: &u32| hard[self.island_of(&self.contacts[*k as usize])];
        let (hard, easy): (Vec<u32>, Vec<u32>) = (0..self.contacts.len() as u32).partition(is_hard);
        self.blocks = arrange(&easy, dynamic, &self.graph, &self.contacts);
        self.easy_blocks = self.blocks.len();
        self.blocks.append(&mut arrange(&hard, dynamic, &self.graph, &self.contacts));
        let levels: Vec<u32> = (0..self.members.len()).map(|i| self.graph.level(i)).collect();
        let gravity = self.environment.gravity;
        let source = Source {
            members: &self.members,
            contacts: &self.contacts,
            loads: &loads,
            levels: &levels,
            up: if gravity == Vec3::ZERO { Vec3::ZERO } else { -gravity.normalize() },
            shock_yield: self.environment.settings.shock_yield,
        };
        prepare(&mut self.blocks, &self.bodies, &source);
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
        let h = self.substep_seconds();
        let settings = self.environment.settings;
        let driven = self.driven();
        let guard = EnergyGuard { islands: &self.islands, dynamic: &self.dynamic, driven: &driven };
        let mut kicks: Vec<Row> = self.bodies.accelerations.iter().map(|a| Row(a.0.map(|x| x * h))).collect();
        kicks.push(Row::default());
        let mut before = Vec::new();
        let (blocks, bodies, impulses) = (&mut self.blocks, &mut self.bodies, &mut self.impulses);
        let standing = StandingPass {
            guard: &guard,
            kicks: &kicks,
            displacements: &bodies.displacements,
            substep_seconds: h,
            sweeps: settings.first_sweeps_hard,
        };
        standing.run(&mut blocks[self.easy_blocks..]);
        for substep in 0..settings.substeps {
            if self.bounces {
                resolve_collisions(blocks, &mut moving(bodies, &kicks, &settings, impulses));
            }
            for (velocity, kick) in bodies.velocities.iter_mut().zip(&kicks) {
                for k in 0..6 {
                    velocity.0[k] += kick.0[k];
                }
            }
            if substep == 1 {
                remove_momentum(blocks);
            }
            before.clone_from(&bodies.velocities);
            apply_impulses(blocks, &mut bodies.velocities);
            let guess = if substep == 0 { Guarded::FirstGuess } else { Guarded::Guess };
            guard.check(blocks, &before, &mut bodies.velocities, guess);
            for _ in 0..if substep == 0 { settings.first_sweeps } else { 1 } {
                sweep(blocks, &mut bodies.velocities, &bodies.displacements, h);
            }
            guard.check(blocks, &before, &mut bodies.velocities, Guarded::Result);
            displace(bodies, &before, &kicks, h);
            relax(blocks, &mut moving(bodies, &kicks, &settings, &mut []), self.bounces);
            add_substep(impulses, blocks);
            if settings.shock_propagation == ShockPropagation::Classic {
                propagate_classic(blocks, &mut bodies.velocities, &bodies.displacements, h);
            }
        }
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
        let push_max = settings.recovery_speed_max * settings.frame_seconds;
        for _ in 0..self.pushes() {
            propagate_shock(&mut self.blocks, &mut self.bodies.displacements, &settings, push_max);
        }
        let hard = &mut self.blocks[self.easy_blocks..];
        for _ in 0..HARD_PUSHES {
            propagate_shock(hard, &mut self.bodies.displacements, &settings, push_max);
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
        for block in &self.blocks {
            for (contact, deeper) in block.overlap_growth(&self.bodies.displacements) {
                growth[contact] = deeper;
            }
        }
        growth
    }
}

/// Whether contacts with the shape come from a distance field.
pub(crate) fn is_mesh(shape: &Shape) -> bool {
    matches!(shape, Shape::Mesh(_))
}

/// What the kernels that look ahead need of the bodies.
fn moving<'a>(
    bodies: &'a mut Bodies,
    kicks: &'a [Row],
    settings: &StepSettings,
    bounced: &'a mut [[f32; 4]],
) -> Moving<'a> {
    Moving {
        velocities: &mut bodies.velocities,
        displacements: &bodies.displacements,
        kicks,
        substep_seconds: settings.frame_seconds / settings.substeps as f32,
        substeps: settings.substeps as f32,
        bounced,
    }
}

/// Moves the bodies by their velocities for one substep. A body that no impulse reached flies its parabola; one that was pushed moves as the
/// contacts were solved, with its new velocity.
fn displace(bodies: &mut Bodies, before: &[Row], kicks: &[Row], h: f32) {
    let rows = bodies.displacements.iter_mut().zip(&bodies.velocities).zip(before.iter().zip(kicks));
    for ((displacement, velocity), (free, kick)) in rows {
        let flies = if velocity == free { 0.5 } else { 0.0 };
        for k in 0..6 {
            displacement.0[k] += h * (velocity.0[k] - flies * kick.0[k]);
        }
    }
}
