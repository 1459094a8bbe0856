//! The step of a closed group of bodies: contacts in, next states out.

use forerun_geometry::Vec3;

use crate::close_up::CloseUp;
use crate::narrow_phase::Contact;
use crate::plan::Plan;
use crate::run::Run;
use crate::scratch::StepScratch;
use crate::slices::Slicer;
use crate::solver::fly;
use crate::touch::Ledger;
use crate::{Body, BodyId, BodyKind, BodyState, Environment, Observer, Touches};

/// A body of a group, at the frame that is to be advanced.
#[derive(Clone, Copy, Debug)]
pub struct Member<'a> {
    /// Its name; members are sorted by it.
    pub id: BodyId,
    /// What it is.
    pub body: &'a Body,
    /// How it is.
    pub state: BodyState,
}

impl Member<'_> {
    /// Whether it is a kinematic body in motion: what it touches is pushed, and not at rest.
    pub(crate) fn drives(&self) -> bool {
        let zero = Vec3::ZERO;
        self.body.kind == BodyKind::Kinematic
            && (self.state.velocity != zero || self.state.angular_velocity != zero)
    }
}

/// Bodies that touch nobody outside the group.
///
/// Whoever builds it promises: `members` are sorted by id; `pairs` are all pairs of members with overlapping swept bounds, one of them
/// dynamic, lower index first, sorted; `contacts` are what [`find_contacts`](crate::narrow_phase::find_contacts) gives for these pairs; and every
/// body with a contact to a dynamic member is a member.
#[derive(Clone, Copy, Debug)]
pub struct Group<'a> {
    /// The bodies.
    pub members: &'a [Member<'a>],
    /// Pairs of members that may meet in this frame.
    pub pairs: &'a [(u32, u32)],
    /// Where members touch.
    pub contacts: &'a [Contact],
}

/// What a step did. Degraded results are counted, not hidden.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepReport {
    /// Islands with at least one contact that were solved.
    pub islands: u32,
    /// Contacts (manifolds) found; where bodies are known to stay at rest, none are looked for.
    pub contacts: u32,
    /// Most slices that an island's frame was cut into; 1 when none was.
    pub slices_max: u32,
    /// Bodies whose next state was not finite: they were stopped where they were.
    pub quarantined: u32,
}

impl StepReport {
    /// Of a step in which nobody had to be moved.
    pub(crate) fn of_nothing() -> StepReport {
        StepReport { slices_max: 1, ..StepReport::default() }
    }
}

/// The states of the members one frame later, in the members' order.
///
/// Stage 1, collisions, is what made the group: swept bounds, pairs, contacts. The other five follow for each batch of islands. The states
/// lie in the scratch until it is used again. In an environment that [`Environment::check`] refuses nothing moves.
pub fn advance<'s>(
    group: &Group,
    environment: &Environment,
    observer: &mut dyn Observer,
    scratch: &'s mut StepScratch,
) -> (&'s [BodyState], StepReport) {
    let report = advance_islands(group, environment, observer, Known::default(), scratch);
    (&scratch.next, report)
}

/// As [`advance`], with the same bits, and tells who touched whom. Replaces what `touches` held.
pub fn advance_touching<'s>(
    group: &Group,
    environment: &Environment,
    observer: &mut dyn Observer,
    touches: &mut Touches,
    scratch: &'s mut StepScratch,
) -> (&'s [BodyState], StepReport) {
    let known = Known { touches: Some(touches), ..Known::default() };
    let report = advance_islands(group, environment, observer, known, scratch);
    (&scratch.next, report)
}

/// What a world asks and knows.
#[derive(Default)]
pub(crate) struct Known<'a> {
    /// Where somebody asks who touched whom.
    pub(crate) touches: Option<&'a mut Touches>,
    /// By member, or empty: whether it is known to stay at rest. Then the group has no pairs of it.
    pub(crate) still: &'a [bool],
    /// Where somebody looks into the step.
    pub(crate) close_up: Option<&'a mut CloseUp>,
}

/// As [`advance`]; tells who touched whom where somebody asks. The states are the scratch's.
pub(crate) fn advance_islands(
    group: &Group,
    environment: &Environment,
    observer: &mut dyn Observer,
    Known { touches, still, mut close_up }: Known,
    scratch: &mut StepScratch,
) -> StepReport {
    if environment.check().is_err() {
        scratch.next.clear();
        scratch.next.extend(group.members.iter().map(|member| member.state));
        return StepReport::default();
    }
    let StepScratch { plan, slices, next, slice_counts, chosen, .. } = scratch;
    plan.make(group, environment, still);
    let mut ledger = touches.is_some().then(Ledger::default);
    let dt = environment.settings.frame_seconds;
    next.clear();
    next.extend(group.members.iter().enumerate().map(|(i, member)| {
        let flies = plan.island_of[i] == Plan::NONE && !plan.resting[i];
        if flies { fly(member.body, &member.state, environment, dt) } else { member.state }
    }));
    let mut report = StepReport {
        islands: plan.islands.len() as u32,
        contacts: group.contacts.len() as u32,
        ..StepReport::of_nothing()
    };
    slice_counts.clear();
    slice_counts.extend(plan.islands.iter().map(|island| island.slices));
    let mut count = 1;
    while count <= environment.settings.slices_max.max(1) {
        chosen.clear();
        chosen.extend((0..slice_counts.len() as u32).filter(|&i| slice_counts[i as usize] == count));
        if !chosen.is_empty() {
            report.slices_max = count;
            let notes = ledger.is_some().then(Ledger::default);
            let of_run = close_up.is_some().then(CloseUp::default);
            let mut run =
                Run { observer: &mut *observer, next, notes, close_up: of_run, too_deep: Vec::new() };
            Slicer { group, environment, plan, count }.run(chosen, &mut run, slices);
            if let (Some(ledger), Some(notes)) = (&mut ledger, run.notes) {
                ledger.keep(notes, &run.too_deep);
            }
            if let (Some(close_up), Some(of_run)) = (&mut close_up, run.close_up) {
                close_up.keep(of_run, &run.too_deep);
            }
            // The return in time: the frame of these islands is thrown away and done again in smaller parts.
            for island in run.too_deep {
                slice_counts[island as usize] = count * 2;
            }
        }
        count *= 2;
    }
    report.quarantined = quarantine(group, next);
    if let (Some(touches), Some(ledger)) = (touches, ledger) {
        *touches = Touches { list: ledger.touches(), resting: plan.resting.clone() };
    }
    report
}

/// Stops bodies whose next state is not finite. Returns how many.
fn quarantine(group: &Group, next: &mut [BodyState]) -> u32 {
    let mut count = 0;
    for (state, member) in next.iter_mut().zip(group.members) {
        if !state.is_finite() {
            let zero = Vec3::ZERO;
            *state = BodyState { velocity: zero, angular_velocity: zero, rest: 0, ..member.state };
            count += 1;
        }
    }
    count
}
