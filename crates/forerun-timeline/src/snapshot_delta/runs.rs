//! Runs: the states of a snapshot's frames, as what differs from another snapshot.

use std::sync::Arc;

use forerun_dynamics::Environment;

use super::{DeltaBase, DeltaError, RunDelta, SnapshotDelta, wrong};
use crate::Frame;
use crate::definitions::Definitions;
use crate::frame_table::{Entry, FrameTable};
use crate::parts::check_state;
use crate::tables::Tables;

/// With so few states that differ from the frame as it was, nobody asks how many differ from the frame before.
const FEW: usize = 16;

/// The snapshot before, as far as there is something to keep of it.
fn kept_of(before: Option<&Tables>, oldest: Frame) -> Option<&Tables> {
    before.filter(|before| before.oldest() <= oldest && oldest <= before.horizon())
}

/// The runs of `after` that `before` does not have.
pub(super) fn delta(before: Option<&Tables>, after: &Tables) -> Vec<RunDelta> {
    let before = kept_of(before, after.oldest());
    let mut starts: Vec<Frame> = after.runs().map(|(from, _)| from).collect();
    if let Some(before) = before {
        starts.extend(before.runs().map(|(from, _)| from));
        starts.push(before.horizon().next());
        starts.retain(|from| (after.oldest()..=after.horizon()).contains(from));
        starts.sort_unstable();
        starts.dedup();
    }
    let mut runs = Vec::new();
    for (index, from) in starts.iter().enumerate() {
        let to = starts.get(index + 1).map_or(after.horizon(), |next| next.minus(1));
        let table = after.at(*from);
        let old = before.and_then(|before| before.get(*from));
        if old.is_some_and(|old| Arc::ptr_eq(old, table)) {
            continue;
        }
        let last = (*from > after.oldest()).then(|| after.at(from.minus(1)));
        let (base, entries) = smallest(table, old, last);
        runs.push(RunDelta { from: *from, to, base, entries });
    }
    runs
}

/// What differs from the base that least differs from.
fn smallest(
    table: &FrameTable,
    old: Option<&Arc<FrameTable>>,
    last: Option<&Arc<FrameTable>>,
) -> (DeltaBase, Vec<Entry>) {
    let nothing = FrameTable::default();
    let from = |base: &FrameTable| -> Vec<Entry> {
        let differing = table.differences(base).into_iter();
        differing.map(|body| (body, table.get(body).copied())).collect()
    };
    let since_old = old.map(|old| (DeltaBase::SameFrame, from(old)));
    match (since_old, last) {
        (Some(since_old), _) if since_old.1.len() <= FEW => since_old,
        (since_old, Some(last)) => {
            let since_last = (DeltaBase::FrameBefore, from(last));
            let fewer = |old: &(DeltaBase, Vec<Entry>)| old.1.len() <= since_last.1.len();
            since_old.filter(fewer).unwrap_or(since_last)
        }
        (Some(since_old), None) => since_old,
        (None, None) => (DeltaBase::Nothing, from(&nothing)),
    }
}

/// The tables that a delta leads to.
pub(super) fn apply(
    before: Option<&Tables>,
    delta: &SnapshotDelta,
    definitions: &Definitions,
) -> Result<Tables, DeltaError> {
    let before = kept_of(before, delta.oldest);
    let mut tables = before.cloned();
    if let Some(tables) = &mut tables {
        tables.forget_before(delta.oldest);
        tables.forget_after(delta.horizon.min(tables.horizon()));
    }
    for run in &delta.runs {
        let fits = |last: Frame| run.to <= last || run.from == last.next();
        let begins = tables.as_ref().map_or(run.from == delta.oldest, |tables| fits(tables.horizon()));
        if run.from < delta.oldest || run.to < run.from || run.to > delta.horizon || !begins {
            return Err(wrong("runs", format!("{} to {} are out of place", run.from, run.to)));
        }
        check_entries(&run.entries, definitions, &definitions.environment(run.from))?;
        let last = (run.from > delta.oldest).then(|| tables.as_ref()?.get(run.from.minus(1))).flatten();
        let base = match run.base {
            DeltaBase::Nothing => Some(Arc::default()),
            DeltaBase::SameFrame => before.and_then(|before| before.get(run.from)).cloned(),
            DeltaBase::FrameBefore => last.cloned(),
        };
        let base = base.ok_or_else(|| wrong("runs", format!("{} has no base", run.from)))?;
        let (table, _) = base.with_entries(&run.entries, last.unwrap_or(&base));
        match &mut tables {
            Some(tables) if run.from > tables.horizon() => {
                tables.push(table);
                tables.extend_to(run.to);
            }
            Some(tables) => tables.set_run(run.from, run.to, table),
            None => tables.insert(Tables::new(run.from, table)).extend_to(run.to),
        }
    }
    match tables {
        Some(tables) if tables.horizon() == delta.horizon => Ok(tables),
        _ => Err(wrong("runs", format!("do not reach {}", delta.horizon))),
    }
}

fn check_entries(
    entries: &[Entry],
    definitions: &Definitions,
    environment: &Environment,
) -> Result<(), DeltaError> {
    if !entries.is_sorted_by(|(a, _), (b, _)| a < b) {
        return Err(wrong("runs", "are not in the order of the bodies' names"));
    }
    for (body, state) in entries {
        if body.0 as usize >= definitions.names() {
            return Err(wrong("runs", format!("body {} has no name", body.0)));
        }
        if let Some(state) = state {
            let fault = |message| wrong("runs", format!("body {}: {message}", body.0));
            check_state(state, environment).map_err(fault)?;
        }
    }
    Ok(())
}
