//! Batch: islands that are solved together, and the stages that they go through.
//!
//! *Invariant:* the next states of an island do not depend on which other islands share its batch.

use forerun_geometry::{Manifold, Shape, Vec3};

use super::arrange::{Arranger, Order};
use super::bodies::Bodies;
use super::collisions::{Ahead, Moving};
use super::contact_graph::ContactGraph;
use super::energy_guard::{EnergyGuard, Guarded, Guarding};
use super::impulses::ImpulseSums;
use super::islands::Islands;
use super::load::{LoadPass, Loads};
use super::manifolds::Source;
use super::positions::integrate_positions;
use super::prepare::Common;
use super::rest::{Ending, RestScratch, Resting};
use super::rows::Rows;
use super::standing::StandingPass;
use super::substep::{displace, fall, note_pushes};
use super::team::Team;
use super::velocities::integrate_velocities;
use crate::lanes::{Row, cells};
use crate::narrow_phase::Contact;
use crate::scratch::{emptied, fill};
use crate::{BodyState, Environment, Member, ShockPropagation, StepSettings};

/// An island is hard when the load pass leaves more than this part of its weight to the sweeps: stacks and pyramids leave none, a heap most of it.
const HARD_PART: f64 = 0.1;

/// So many more passes push the overlap out of hard islands. Of 1000 bodies poured into a pit the worst two overlapped by 103 mm without them
/// and by 10 mm with them, at a cost of 4 %.
const HARD_PUSHES: usize = 2;

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
    endings: Vec<Ending>,
    rest: RestScratch,
    bounces: bool,
    /// By island: whether a moving kinematic body touches it.
    driven: Vec<bool>,
    /// By island: the weight, and what of it the load pass fails to place.
    weights: Vec<[f64; 2]>,
    /// By island: see [`Batch::classify`].
    classes: Vec<u8>,
    /// By class: the contacts.
    chosen: [Vec<u32>; 4],
    /// By contact: by how much the solver expects it to lie deeper at the end of the frame, where that may be cut finer. Metres.
    pub(crate) overlap_growth: Vec<f32>,
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
            least_gap: 0.0,
            dynamic: self.dynamic,
            graph: self.graph,
            loads: self.loads,
            rows: self.rows,
            arranger: self.arranger,
            guard: self.guard,
            endings: self.endings,
            rest: self.rest,
            bounces: false,
            driven: self.driven,
            weights: self.weights,
            classes: self.classes,
            chosen: self.chosen,
            overlap_growth: self.overlap_growth,
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

    /// Finds a lane for every contact: flat islands apart from uneven ones, easy ones before hard ones.
    fn arrange(&mut self) {
        self.classify();
        let mut chosen = std::mem::take(&mut self.chosen);
        chosen.iter_mut().for_each(Vec::clear);
        for (k, ends) in self.ends.iter().enumerate() {
            chosen[usize::from(self.classes[self.island_of(ends)])].push(k as u32);
        }
        let order = Order { graph: &self.graph, contacts: &self.ends, yields: &self.dynamic };
        let (arranger, Rows { flat, uneven }) = (&mut self.arranger, &mut self.rows);
        let [flat_easy, flat_hard, uneven_easy, uneven_hard] = &chosen;
        arranger.begin(self.members.len());
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
        let threads = rayon::current_num_threads().min(SHARES_MAX);
        flat.share_out(threads, self.members.len());
        uneven.share_out(threads, self.members.len());
        self.bodies.add_unread(self.rows.share_count());
        self.chosen = chosen;
    }

    /// Finds the class of each island: 1 more where the load pass fails to place the weight (heaps, arches, wedged bodies), so that it needs more sweeps;
    /// 2 more where points of a mesh's manifold push different ways. (So may those of two capsules that lie alongside each other, by a few degrees: their
    /// mean serves.)
    fn classify(&mut self) {
        fill(&mut self.weights, self.islands.count() + 1, [0.0; 2]);
        for (i, strain) in self.loads.strain.iter().enumerate() {
            let [weight, lost] = &mut self.weights[self.islands.root(i)];
            *weight += f64::from(strain.weight);
            *lost += f64::from(strain.lost);
        }
        self.classes.clear();
        self.classes.extend(self.weights.iter().map(|[weight, lost]| u8::from(*lost > HARD_PART * weight)));
        if !self.members.iter().any(|m| is_mesh(&m.body.shape)) {
            return;
        }
        for (k, ends) in self.ends.iter().enumerate() {
            let points = self.contacts().manifold(k).points();
            let of_mesh = |i: u32| is_mesh(&self.members[i as usize].body.shape);
            let differ = points.iter().any(|p| p.normal != points[0].normal);
            if differ && (of_mesh(ends.first) || of_mesh(ends.second)) {
                let island = self.island_of(ends);
                self.classes[island] |= 2;
            }
        }
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
        let least_gap = &mut self.least_gap;
        let mut standing = StandingPass {
            guard: &mut self.guard,
            at,
            kicks: &bodies.kicks,
            sweeps: settings.first_sweeps_hard,
        };
        let Rows { flat, uneven } = rows;
        standing.run(&mut flat.blocks[flat.easy..], &mut flat.details[flat.easy..]);
        standing.run(&mut uneven.blocks[uneven.easy..], &mut uneven.details[uneven.easy..]);
        let (guard, bounces) = (&mut self.guard, self.bounces);
        Team::gather(rows.share_count(), |team| {
            for substep in 0..settings.substeps {
                if bounces {
                    let Bodies { velocities, displacements, kicks, .. } = &mut *bodies;
                    let ahead = ahead(displacements, kicks, &settings, bounces);
                    let velocities = cells(velocities);
                    rows.resolve_collisions(&mut Moving { velocities, ahead, bounced: &mut *impulses });
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
                keep_energy(guard, at, rows, bodies, Guarded::Result);
                displace(bodies, h);
                let Bodies { velocities, displacements, kicks, .. } = &mut *bodies;
                let ahead = ahead(displacements, kicks, &settings, bounces);
                *least_gap = rows.relax(velocities, &ahead, team);
                note_pushes(bodies);
                rows.add_impulses(impulses);
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
        for _ in 0..HARD_PUSHES {
            rows.propagate_hard_shock(displacements, &settings);
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
    bounces: bool,
) -> Ahead<'a> {
    Ahead {
        displacements,
        kicks,
        substep_seconds: settings.frame_seconds / settings.substeps as f32,
        substeps: settings.substeps as f32,
        bounces,
    }
}

/// Scales back what impulses have added, where it is energy.
fn keep_energy(guard: &mut EnergyGuard, at: Guarding, rows: &mut Rows, bodies: &mut Bodies, what: Guarded) {
    if guard.gains(at, &bodies.free, &bodies.velocities, what) {
        guard.scale_back(at.islands, &bodies.free, &mut bodies.velocities);
        rows.scale_impulses(guard, at.islands, what);
    }
}
