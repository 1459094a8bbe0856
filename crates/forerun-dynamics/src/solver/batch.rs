//! Batch: islands that are solved together, and the stages that they go through.
//!
//! *Invariant:* the next states of an island do not depend on which other islands share its batch.

use forerun_geometry::{Manifold, Shape, Vec3};

use super::blocks::{Block, arrange};
use super::bodies::Bodies;
use super::collisions::{Moving, resolve_collisions};
use super::contact_graph::ContactGraph;
use super::impulses::{ImpulseSums, add_substep};
use super::islands::Islands;
use super::load::{LoadPass, Loads};
use super::positions::moved;
use super::prepare::{Source, prepare};
use super::rest::{Ending, Resting};
use super::shock::{propagate_classic, propagate_shock};
use super::standing::StandingPass;
use super::sweep::{relax, sweep};
use super::velocities::integrate_velocities;
use super::warm_start::{EnergyGuard, Guarded, apply_impulses, remove_momentum};
use crate::lanes::{Portable, Row};
use crate::narrow_phase::Contact;
use crate::scratch::{emptied, fill};
use crate::{BodyState, Environment, Member, ShockPropagation, StepSettings};

/// An island is hard when the load pass leaves more than this part of its weight to the sweeps: stacks and pyramids leave none, a heap most of it.
const HARD_PART: f64 = 0.1;

/// So many more passes push the overlap out of hard islands. Of 1000 bodies poured into a pit the worst two overlapped by 103 mm without them
/// and by 10 mm with them, at a cost of 4 %.
const HARD_PUSHES: usize = 2;

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
    /// First those of easy islands, then those of hard ones.
    blocks: Vec<Block<Portable>>,
    easy_blocks: usize,
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
            blocks: self.blocks,
            easy_blocks: 0,
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
        let (easy, hard) = self.easy_and_hard();
        self.blocks = arrange(&easy, &self.dynamic, &self.graph, &self.ends);
        self.easy_blocks = self.blocks.len();
        if !hard.is_empty() {
            self.blocks.append(&mut arrange(&hard, &self.dynamic, &self.graph, &self.ends));
        }
        let gravity = self.environment.gravity;
        let source = Source {
            members: &self.members,
            contacts,
            loads: &self.loads.of_contact,
            levels: self.graph.levels(),
            up: if gravity == Vec3::ZERO { Vec3::ZERO } else { -gravity.normalize() },
            shock_yield: self.environment.settings.shock_yield,
        };
        prepare(&mut self.blocks, &self.bodies, &source);
    }

    /// Contacts of islands whose weight the load pass places, and of those where it fails (heaps, arches, wedged bodies), so that they need more
    /// sweeps.
    fn easy_and_hard(&self) -> (Vec<u32>, Vec<u32>) {
        let mut sums = vec![(0.0f64, 0.0f64); self.islands.count() + 1];
        for (i, strain) in self.loads.strain.iter().enumerate() {
            let sum = &mut sums[self.islands.root(i)];
            sum.0 += f64::from(strain.weight);
            sum.1 += f64::from(strain.lost);
        }
        let hard = |&k: &u32| {
            let Ends { first, second, .. } = self.ends[k as usize];
            let dynamic = if self.dynamic[first as usize] { first } else { second };
            let (weight, lost) = sums[self.islands.root(dynamic as usize)];
            lost > HARD_PART * weight
        };
        (0..self.ends.len() as u32).partition(|k| !hard(k))
    }

    /// Stage 4: substeps of bounces, gravity, warm start and sweeps.
    pub(crate) fn resolve_contacts(&mut self) {
        let h = self.substep_seconds();
        let settings = self.environment.settings;
        let guard = EnergyGuard { islands: &self.islands, dynamic: &self.dynamic, driven: &self.driven };
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
