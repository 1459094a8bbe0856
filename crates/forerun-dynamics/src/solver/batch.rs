//! Batch: islands that are solved together, and the stages that they go through.
//!
//! *Invariant:* the next states of an island do not depend on which other islands share its batch.

use forerun_geometry::{Manifold, Shape, Vec3};

use super::arrange::{Arranger, Order};
use super::blocks::Class;
use super::bodies::Bodies;
use super::classes::{Classes, Evenness, Islanders};
use super::collisions::{Ahead, Moving};
use super::contact_graph::ContactGraph;
use super::descent::{Descent, Sweeps};
use super::energy_guard::{EnergyGuard, Guarded, Guarding};
use super::impulses::{FrictionSums, ImpulseSums, Sums};
use super::islands::Islands;
use super::load::{LoadPass, Loads};
use super::manifolds::Source;
use super::positions::integrate_positions;
use super::prepare::Common;
use super::rest::{Ending, RestScratch, Resting};
use super::rows::Rows;
use super::standing::StandingPass;
use super::substep::{displace, fall, note_pushes};
use super::sweep::Law;
use super::team::Team;
use super::velocities::integrate_velocities;
use crate::lanes::{Row, cells};
use crate::narrow_phase::Contact;
use crate::scratch::{emptied, fill};
use crate::{BodyState, Environment, Member, ShockPropagation, StepSettings};

/// Sweeps that find what the contacts of fast hard islands carry.
const RUSHING_SWEEPS: u32 = 6;
/// Sweeps, each down and up, that find what the contacts of delicate islands carry, and that solve them in each substep. With 24 and 8 an arch that
/// needs nine tenths of its friction sinks by 0.2 m before it rests, with 32 and 8 by 4 mm.
const DELICATE_SWEEPS: u32 = 32;
const DELICATE_SUBSTEP_SWEEPS: u32 = 8;
/// So many more passes push the overlap out of islands that overlap, and of hard ones. A dropped stack of 20 comes to rest after 125 frames instead of
/// 273, a Jenga tower that starts 5 cm in the ground with overlaps of 1.6 mm instead of 5.7.
const MORE_PUSHES: usize = 2;

/// Nobody asks for overlaps that grow by less. Metres.
const SHALLOW_M: f32 = 0.001;

/// Threads that work at one island, at most.
const SHARES_MAX: usize = 16;

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
    /// By contact; see [`Batch::record_friction`].
    pub(crate) frictions: FrictionSums,
    /// By member: the state at the end.
    pub(crate) next: Vec<BodyState>,
    bodies: Bodies,
    /// The least separation of any point after the last substep. Metres.
    least_gap: f32,
    dynamic: Vec<bool>,
    graph: ContactGraph,
    loads: Loads,
    rows: Rows,
    arranger: Arranger,
    guard: EnergyGuard,
    descent: Descent,
    endings: Vec<Ending>,
    rest: RestScratch,
    bounces: bool,
    /// Whether a kinematic body turns.
    carries: bool,
    /// By island: whether a moving kinematic body touches it.
    driven: Vec<bool>,
    classes: Classes,
    /// By evenness and class: the contacts.
    chosen: [[Vec<u32>; Class::COUNT]; 2],
    /// By contact: by how much the solver expects it to lie deeper at the end of the frame, where that may be cut finer. Metres.
    pub(crate) overlap_growth: Vec<f32>,
}

impl<'a> Batch<'a> {
    /// Once members, contacts and islands are there: the start of their frame or slice.
    pub(crate) fn start(&mut self, environment: &Environment, found: &'a [Contact]) {
        self.environment = *environment;
        self.found = found;
        self.least_gap = f32::MAX;
        self.dynamic.clear();
        self.dynamic.extend(self.members.iter().map(|m| m.body.is_dynamic()));
        self.bounces = self.members.iter().any(|m| m.body.material.restitution > 0.0);
        let turns = |m: &Member| m.drives() && m.state.angular_velocity != Vec3::ZERO;
        self.carries = self.members.iter().any(turns);
        self.impulses.clear();
        self.frictions.clear();
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
            frictions: self.frictions,
            next: self.next,
            bodies: self.bodies,
            least_gap: 0.0,
            dynamic: self.dynamic,
            graph: self.graph,
            loads: self.loads,
            rows: self.rows,
            arranger: self.arranger,
            guard: self.guard,
            descent: self.descent,
            endings: self.endings,
            rest: self.rest,
            bounces: false,
            carries: false,
            driven: self.driven,
            classes: self.classes,
            chosen: self.chosen,
            overlap_growth: self.overlap_growth,
        }
    }

    /// Where the members touch.
    pub(crate) fn contacts(&self) -> ContactList<'_> {
        ContactList { ends: &self.ends, found: self.found }
    }

    /// Who rests on whom, once stage 3 is over.
    pub(crate) fn graph(&self) -> &ContactGraph {
        &self.graph
    }

    fn substep_seconds(&self) -> f32 {
        self.environment.settings.frame_seconds / self.environment.settings.substeps as f32
    }

    /// Stage 2: springs, gyroscopic term, accelerations.
    pub(crate) fn integrate_velocities(&mut self) {
        integrate_velocities(&mut self.bodies, &self.members, &self.environment);
    }

    /// Stage 3: levels, load, rows.
    pub(crate) fn build_contact_graph(&mut self) {
        let contacts = ContactList { ends: &self.ends, found: self.found };
        self.graph.build(&self.members, &contacts);
        LoadPass {
            members: &self.members,
            contacts,
            graph: &self.graph,
            centres: &self.bodies.centres,
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
        self.rows.prepare(&self.bodies, &source, &common);
    }

    /// Finds a lane for every contact: flat islands apart from uneven ones, and each class by itself.
    fn arrange(&mut self) {
        self.classes.find(&Islanders {
            members: &self.members,
            contacts: ContactList { ends: &self.ends, found: self.found },
            islands: &self.islands,
            graph: &self.graph,
            strain: &self.loads.strain,
            overlap_allowed_m: self.environment.settings.overlap_allowed_m,
        });
        let mut chosen = std::mem::take(&mut self.chosen);
        chosen.iter_mut().flatten().for_each(Vec::clear);
        for (k, ends) in self.ends.iter().enumerate() {
            let (class, evenness) = self.classes.of(self.islands.of(ends));
            chosen[evenness as usize][class as usize].push(k as u32);
        }
        let order = Order { graph: &self.graph, contacts: &self.ends, yields: &self.dynamic };
        let (arranger, Rows { flat, uneven }) = (&mut self.arranger, &mut self.rows);
        arranger.begin(self.members.len());
        flat.clear();
        for (class, chosen) in chosen[Evenness::Flat as usize].iter().enumerate() {
            arranger.add(chosen, &order, flat);
            flat.ends[class] = flat.count;
        }
        flat.finish();
        uneven.clear();
        for (class, chosen) in chosen[Evenness::Uneven as usize].iter().enumerate() {
            arranger.add(chosen, &order, uneven);
            uneven.ends[class] = uneven.count;
        }
        uneven.finish();
        let threads = rayon::current_num_threads().min(SHARES_MAX);
        flat.share_out(threads, self.members.len());
        uneven.share_out(threads, self.members.len());
        self.bodies.add_unread(self.rows.share_count());
        self.chosen = chosen;
    }

    /// Stage 4: substeps of bounces, gravity, warm start and sweeps.
    pub(crate) fn resolve_contacts(&mut self) {
        let settings = self.environment.settings;
        let h = self.substep_seconds();
        let at = Guarding { islands: &self.islands, driven: &self.driven };
        let (rows, bodies) = (&mut self.rows, &mut self.bodies);
        let (normal, friction) = (&mut self.impulses, &mut self.frictions);
        let least_gap = &mut self.least_gap;
        let (guard, descent) = (&mut self.guard, &mut self.descent);
        let mut standing = StandingPass { guard, descent, at, kicks: &bodies.kicks };
        let hard = settings.first_sweeps_hard;
        rows.stand(Class::Rushing, &mut standing, hard.min(RUSHING_SWEEPS));
        rows.stand(Class::Heap, &mut standing, hard);
        rows.stand(Class::Delicate, &mut standing, DELICATE_SWEEPS);
        let (guard, descent) = (&mut self.guard, &mut self.descent);
        let (bounces, carries) = (self.bounces, self.carries);
        Team::gather(rows.share_count(), |team| {
            for substep in 0..settings.substeps {
                if bounces {
                    let Bodies { velocities, displacements, kicks, .. } = &mut *bodies;
                    let ahead = ahead(displacements, kicks, &settings, (bounces, carries));
                    let velocities = cells(velocities);
                    let bounced = Sums { normal: &mut *normal, friction: &mut *friction };
                    rows.resolve_collisions(&mut Moving { velocities, ahead, bounced });
                }
                if substep == 1 {
                    rows.remove_momentum(&mut bodies.pushes);
                }
                fall(bodies);
                if substep == 0 {
                    rows.apply_impulses(&mut bodies.velocities, team);
                }
                let guess = if substep == 0 { Guarded::FirstGuess } else { Guarded::Guess };
                keep_energy(guard, at, rows, bodies, guess);
                for _ in 0..if substep == 0 { settings.first_sweeps } else { 1 } {
                    rows.sweep(&mut bodies.velocities, team);
                }
                let sweeps = Sweeps { count: DELICATE_SUBSTEP_SWEEPS, law: Law::Coulomb };
                rows.descend(descent, at, &mut bodies.velocities, sweeps);
                keep_energy(guard, at, rows, bodies, Guarded::Result);
                displace(bodies, h);
                let Bodies { velocities, displacements, kicks, .. } = &mut *bodies;
                let ahead = ahead(displacements, kicks, &settings, (bounces, carries));
                *least_gap = rows.relax(velocities, &ahead, team);
                note_pushes(bodies);
                rows.add_impulses(&mut Sums { normal, friction });
                if settings.shock_propagation == ShockPropagation::Classic {
                    rows.propagate_classic(&mut bodies.velocities, &bodies.displacements, h);
                }
            }
        });
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
        if self.least_gap + settings.overlap_allowed_m >= 0.0 {
            // Nobody is pushed, and so nobody comes to overlap.
            return;
        }
        let pushes = self.pushes();
        let (rows, displacements) = (&mut self.rows, &mut self.bodies.displacements);
        Team::gather(rows.share_count(), |team| {
            for _ in 0..pushes {
                rows.propagate_shock(displacements, &settings, team);
            }
        });
        for _ in 0..MORE_PUSHES {
            rows.propagate_more_shock(displacements, &settings);
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
        at.find_endings(&mut self.endings);
        integrate_positions(members, &self.bodies, environment, &mut self.next);
        at.settle(&mut self.next, &self.endings, &mut self.rest);
        if environment.settings.slices_max > 1 {
            self.find_overlap_growth();
        }
    }

    /// For each contact: by how much the solver expects it to lie deeper at the end of the frame, or 0 if all of them by less than [`SHALLOW_M`].
    fn find_overlap_growth(&mut self) {
        fill(&mut self.overlap_growth, self.ends.len(), 0.0);
        let least = self.least_gap;
        if least < -SHALLOW_M || least + self.environment.settings.overlap_allowed_m < 0.0 {
            self.rows.overlap_growth(&self.bodies.displacements, &mut self.overlap_growth);
        }
    }
}

/// Whether contacts with the shape come from a distance field.
pub(crate) fn is_mesh(shape: &Shape) -> bool {
    matches!(shape, Shape::Mesh(_))
}

/// What the kernels that look ahead need.
fn ahead<'a>(
    displacements: &'a [Row],
    kicks: &'a [Row],
    settings: &StepSettings,
    (bounces, carries): (bool, bool),
) -> Ahead<'a> {
    Ahead {
        displacements,
        kicks,
        substep_seconds: settings.frame_seconds / settings.substeps as f32,
        substeps: settings.substeps as f32,
        bounces,
        carries,
    }
}

/// Scales back what impulses have added, where it is energy.
fn keep_energy(guard: &mut EnergyGuard, at: Guarding, rows: &mut Rows, bodies: &mut Bodies, what: Guarded) {
    if guard.gains(at, &bodies.free, &bodies.velocities, what) {
        guard.scale_back(at.islands, &bodies.free, &mut bodies.velocities);
        rows.scale_impulses(guard, at.islands, what);
    }
}
