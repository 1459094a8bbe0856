//! Histories: what bodies and gravity are over the frames, as what differs from another snapshot.

use std::sync::Arc;

use forerun_dynamics::{Body, BodyId, Environment};

use super::{BodyTraits, DeltaError, HistoryDelta, SnapshotDelta, wrong};
use crate::Frame;
use crate::definitions::{Definitions, History, share_equal};
use crate::shared_list::SharedList;

/// So many names may be reserved between two deltas and not be used: who applies one is not to run out of memory for one number in it.
const RESERVED_MAX: usize = 65_536;

/// What a body is from a frame on.
type Entry = (Frame, Option<Arc<Body>>);

/// How many names there are, and which bodies are something else than `before`.
pub(super) fn delta(before: Option<&Definitions>, after: &Definitions) -> (u32, Vec<HistoryDelta>) {
    let names = after.names() as u32;
    if before.is_some_and(|before| std::ptr::eq(before, after)) {
        return (names, Vec::new());
    }
    let nothing = SharedList::default();
    let mut histories = Vec::new();
    for (first, now, old) in after.bodies.unshared(before.map_or(&nothing, |before| &before.bodies)) {
        for (index, history) in now.iter().enumerate() {
            let old = old.get(index);
            let is_new_name = old.is_none() && history.def.is_none() && history.entries.is_empty();
            let same_def = same_memory(history.def.as_ref(), old.and_then(|old| old.def.as_ref()));
            if is_new_name || (same_def && old.is_some_and(|old| same_entries(history, old))) {
                continue;
            }
            let traits = |body: &Option<Arc<Body>>| body.as_ref().map(|body| BodyTraits::of(body));
            histories.push(HistoryDelta {
                body: BodyId((first + index) as u32),
                made: (!same_def).then(|| history.def.clone()),
                entries: history.entries.iter().map(|(frame, body)| (*frame, traits(body))).collect(),
            });
        }
    }
    (names, histories)
}

fn same_memory<T>(a: Option<&Arc<T>>, b: Option<&Arc<T>>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (a, b) => a.is_none() && b.is_none(),
    }
}

fn same_entries(a: &History, b: &History) -> bool {
    let same = |(a, b): (&Entry, &Entry)| a.0 == b.0 && same_memory(a.1.as_ref(), b.1.as_ref());
    a.entries.len() == b.entries.len() && a.entries.iter().zip(&b.entries).all(same)
}

/// The definitions that a delta leads to.
pub(super) fn apply(
    before: Option<&Arc<Definitions>>,
    delta: &SnapshotDelta,
) -> Result<Arc<Definitions>, DeltaError> {
    let names = delta.names as usize;
    let known = before.map_or(0, |before| before.names());
    if names < known || names > known + delta.histories.len() + RESERVED_MAX {
        return Err(wrong("names", format!("are {names}, after {known}")));
    }
    if let Some(environments) = &delta.environments {
        check_environments(environments)?;
    }
    let mut definitions = match (before, &delta.environments) {
        (Some(before), None) if names == known && delta.histories.is_empty() => {
            return Ok(Arc::clone(before));
        }
        (Some(before), None) => Definitions::clone(before),
        (Some(before), Some(environments)) => {
            Definitions { environments: environments.clone(), ..Definitions::clone(before) }
        }
        (None, Some(environments)) => {
            Definitions { bodies: SharedList::default(), environments: environments.clone() }
        }
        (None, None) => return Err(wrong("environments", "are missing")),
    };
    definitions.reserve(names);
    for changed in &delta.histories {
        let Some(slot) = definitions.bodies.get_mut(changed.body.0 as usize) else {
            return Err(wrong("histories", format!("body {} has no name", changed.body.0)));
        };
        *slot = Arc::new(history(slot, changed)?);
    }
    Ok(Arc::new(definitions))
}

fn check_environments(environments: &[(Frame, Environment)]) -> Result<(), DeltaError> {
    // Two commands of one frame leave two entries: the later one holds.
    if environments.is_empty() || !environments.is_sorted_by_key(|(from, _)| *from) {
        return Err(wrong("environments", "are none, or not in their order"));
    }
    for (_, environment) in environments {
        environment.check().map_err(|error| wrong("environments", error))?;
    }
    Ok(())
}

/// The history of a body after a change. What comes out as it was keeps its memory.
fn history(old: &History, changed: &HistoryDelta) -> Result<History, DeltaError> {
    let fault = |message: String| wrong("histories", format!("body {}: {message}", changed.body.0));
    let def = changed.made.clone().unwrap_or_else(|| old.def.clone());
    if !changed.entries.is_sorted_by(|(a, _), (b, _)| a < b) {
        return Err(fault("is not in the order of frames".to_owned()));
    }
    let mut entries: Vec<Entry> = Vec::with_capacity(changed.entries.len());
    for (frame, traits) in &changed.entries {
        let body = match (traits, &def) {
            (None, _) => None,
            (Some(_), None) => return Err(fault("was never made".to_owned())),
            (Some(traits), Some(def)) => Some(Arc::new(traits.body(def).map_err(fault)?)),
        };
        entries.push((*frame, body));
    }
    share_equal(&mut entries, &old.entries);
    Ok(History { def, entries })
}
