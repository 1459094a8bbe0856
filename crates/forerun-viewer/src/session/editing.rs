//! Editing: values of a body that are dragged in a panel. However often a value changes while it is dragged, it is one command, at the frame where
//! the drag began; each change of the value takes the place of the one before.

use std::mem::discriminant;

use forerun::{BodyDef, BodyId, Change, Mass};

use super::Play;
use super::acts::{Last, label_of};

/// A value that is being changed.
#[derive(Clone, Debug)]
pub(super) struct Editing {
    /// What was said last.
    change: Change,
    last: Option<Last>,
    /// Of a body that another takes the place of, because no command changes its mass: its name.
    replaced: Option<BodyId>,
}

impl Play {
    /// Sets a value. As long as the same one is set again, and the edit has not ended, it stays one command.
    pub fn edit(&mut self, change: Change) {
        let same = |editing: &Editing| {
            editing.change.body() == change.body() && discriminant(&editing.change) == discriminant(&change)
        };
        if !self.editing.as_ref().is_some_and(same) {
            self.end_edit();
            self.begin(label_of(&change));
        }
        let last = self.editing.take().and_then(|editing| editing.last);
        let now = self.give_instead(last, change.clone());
        if last.is_none() {
            self.show_edit(now);
        }
        self.editing = Some(Editing { change, last: now, replaced: None });
    }

    /// Gives a body another mass (kg, above 0) spread in the same way. No command changes a mass: another body takes the place of this one, with
    /// another name.
    pub fn edit_mass(&mut self, body: BodyId, mass: f32) {
        let replacing =
            |editing: &Editing| editing.replaced == Some(body) || editing.change.body() == Some(body);
        let before = self.editing.take_if(|editing| editing.replaced.is_some() && replacing(editing));
        let Some(Editing { change: Change::Add { body: new, mut def }, last, replaced }) = before else {
            return self.replace_by(body, mass);
        };
        set_mass(&mut def, mass);
        let change = Change::Add { body: new, def };
        let last = self.give_instead(last, change.clone());
        self.editing = Some(Editing { change, last, replaced });
    }

    fn replace_by(&mut self, body: BodyId, mass: f32) {
        let Some(mut def) = self.def_of(body) else { return };
        set_mass(&mut def, mass);
        self.end_edit();
        self.begin("set mass");
        self.give(Change::Remove { body });
        let new = self.new_body();
        let change = Change::Add { body: new, def: Box::new(def) };
        let last = self.give(change.clone());
        self.selection.pick_coming(vec![new]);
        self.show_edit(last);
        // In coupled mode there is nothing to be said instead: each change is another body.
        self.editing = last.map(|last| Editing { change, last: Some(last), replaced: Some(body) });
    }

    /// What is being set, and was said last: what a panel shows until the scene does.
    #[must_use]
    pub fn edited(&self) -> Option<&Change> {
        self.editing.as_ref().map(|editing| &editing.change)
    }

    /// Nobody changes the value any more: the next change is another step.
    pub fn end_edit(&mut self) {
        if self.editing.take().is_some() {
            self.end();
        }
    }
}

/// The same body, heavier or lighter throughout.
fn set_mass(def: &mut BodyDef, heavier: f32) {
    if let Mass::Given { mass, inertia, .. } = &mut def.mass {
        *inertia *= heavier / *mass;
        *mass = heavier;
    }
}
