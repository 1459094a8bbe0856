//! Acts: what the user does to a scene. Every one is a command, and what belongs together is one step to be taken back.

use forerun::{BodyDef, BodyId, Change, Command, CommandKey, DriverError, Frame, Mass, Vec3};

use super::Play;
use super::history::Step;
use crate::news::News;

/// How much of its own size a copy stands beside what it is a copy of.
const BESIDE: f32 = 1.1;

/// What an act changed last, so that more of the same takes its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Last {
    key: CommandKey,
}

impl Play {
    /// The frame where a command acts that is given now: the first after the one shown. Not a bit of what is on the screen changes.
    #[must_use]
    pub fn edit_frame(&self) -> Frame {
        self.picture.frame.next()
    }

    /// One step of one command.
    pub fn change(&mut self, change: Change) {
        self.act(label_of(&change), [change]);
    }

    /// One step of these commands. All act at the same frame; in a pause, that is what is shown then.
    pub fn act(&mut self, label: &str, changes: impl IntoIterator<Item = Change>) {
        self.history.begin(label);
        let mut last = None;
        for change in changes {
            last = self.give(change).or(last);
        }
        self.history.end();
        self.show_edit(last);
    }

    /// Begins a step: what is given until its end is taken back as one.
    pub fn begin(&mut self, label: &str) {
        self.history.begin(label);
    }

    /// Ends the step; whether there is one, with something given in it.
    pub fn end(&mut self) -> bool {
        self.history.end()
    }

    /// One more command of the step that has begun. Nothing when it could not be given, which the notice says, or in coupled mode, where it is
    /// done at once.
    pub fn give(&mut self, change: Change) -> Option<Last> {
        if let Some(coupled) = &mut self.coupled {
            if let Err(error) = coupled.change(&change) {
                self.notice.tell(error.to_string());
            }
            return None;
        }
        let given = self.driver.change(change.clone());
        self.given(given, change)
    }

    fn given(&mut self, given: Result<CommandKey, DriverError>, change: Change) -> Option<Last> {
        match given {
            Ok(key) => {
                self.history.give(Command { key, change });
                Some(Last { key })
            }
            Err(error) => {
                self.notice.tell(error.to_string());
                None
            }
        }
    }

    /// One more command of the step, after what was changed last, however far time has gone back since.
    pub fn give_after(&mut self, last: Option<Last>, change: Change) -> Option<Last> {
        let Some(Last { key }) = last.filter(|last| self.is_before(Some(*last))) else {
            return self.give(change);
        };
        let given = self.driver.change_at(key.frame, change.clone());
        self.given(given, change)
    }

    /// In place of what the step changed last, this: one command, however often it is said.
    pub fn give_instead(&mut self, last: Option<Last>, change: Change) -> Option<Last> {
        let Some(Last { key }) = last.filter(|_| self.coupled.is_none()) else { return self.give(change) };
        let told = self.driver.replace(key, change.clone());
        if told.is_ok() {
            self.history.replace(key, &change);
        }
        self.note(told);
        last
    }

    /// Whether time has gone back to before what was changed last.
    #[must_use]
    pub fn is_before(&self, last: Option<Last>) -> bool {
        self.coupled.is_none() && last.is_some_and(|last| self.edit_frame() < last.key.frame)
    }

    /// The same, as long as what was changed last is still ahead of what is shown; another command after that.
    pub fn give_on(&mut self, last: Option<Last>, change: Change) -> Option<Last> {
        let ahead = last.filter(|last| last.key.frame > self.picture.frame);
        self.give_instead(ahead, change)
    }

    /// In a pause, goes on to the frame where an edit acts, so that it is seen.
    pub fn show_edit(&mut self, last: Option<Last>) {
        if let Some(Last { key }) = last.filter(|_| self.paused) {
            self.seek(self.seconds_of(key.frame));
        }
    }

    /// The name that the next body gets.
    #[must_use]
    pub fn coming_body(&self) -> BodyId {
        self.coupled.as_ref().map_or_else(|| self.driver.coming_body(), forerun::Coupled::coming_body)
    }

    /// A name for a body that is added now.
    pub fn new_body(&mut self) -> BodyId {
        match &self.coupled {
            Some(coupled) => coupled.coming_body(),
            None => self.driver.reserve_body(),
        }
    }

    /// Brings bodies in.
    pub fn add_all(&mut self, label: &str, defs: Vec<BodyDef>) -> Vec<BodyId> {
        self.history.begin(label);
        let mut last = None;
        let mut added = Vec::new();
        for def in defs {
            let body = self.new_body();
            last = self.give(Change::Add { body, def: Box::new(def) }).or(last);
            added.push(body);
        }
        self.history.end();
        self.added = added.last().copied();
        self.show_edit(last);
        added
    }

    /// Removes the selected bodies.
    pub fn remove_selected(&mut self) {
        let bodies = self.selection.bodies().to_vec();
        self.act(&counted("remove", bodies.len()), bodies.into_iter().map(|body| Change::Remove { body }));
    }

    /// Another one like each selected body, beside it; those are selected then.
    pub fn duplicate_selected(&mut self) {
        let bodies = self.selection.bodies().to_vec();
        let offset = self.bounds(&bodies).map_or(Vec3::X, |(min, max)| Vec3::X * (BESIDE * (max.x - min.x)));
        let defs: Vec<BodyDef> = bodies
            .iter()
            .filter_map(|body| {
                let mut def = self.def_of(*body)?;
                def.pose.position += offset;
                Some(def)
            })
            .collect();
        let added = self.add_all(&counted("duplicate", defs.len()), defs);
        self.selection.pick_coming(added);
    }

    /// Picks all bodies that move.
    pub fn select_all(&mut self) {
        let moving = |id: &BodyId| self.body(*id).is_some_and(|body| body.is_dynamic());
        let bodies: Vec<BodyId> = self.samples.iter().map(|(id, _)| *id).filter(moving).collect();
        self.selection.pick_all(bodies);
    }

    /// How another body would be made that is as this one is now.
    #[must_use]
    pub fn def_of(&self, body: BodyId) -> Option<BodyDef> {
        let (made, sample) = (self.body(body)?, self.sample(body)?);
        let frame = made.frame.inverse();
        let mass = if made.is_dynamic() {
            Mass::Given {
                mass: 1.0 / made.inverse_mass,
                centre: frame.position,
                inertia: made.inverse_inertia.recip(),
                principal_rotation: frame.rotation,
            }
        } else {
            Mass::Density(1000.0)
        };
        Some(BodyDef {
            pose: sample.pose,
            velocity: sample.velocity,
            angular_velocity: sample.angular_velocity,
            kind: made.kind,
            material: made.material,
            mass,
            gravity_scale: made.gravity_scale,
            force: made.force,
            torque: made.torque,
            ..BodyDef::new(made.shape.clone())
        })
    }

    /// Takes back the last step.
    pub fn undo(&mut self) {
        let Play { history, driver, notice, .. } = self;
        history.undo(|command| told(driver.retract(command.key), notice));
    }

    /// Does again what was taken back.
    pub fn redo(&mut self) {
        let Play { history, driver, notice, .. } = self;
        history.redo(|command| told(driver.submit(command.clone()), notice));
    }

    /// What the next undo takes back, and how many steps there are. None in coupled mode: what was done there is not remembered.
    #[must_use]
    pub fn to_undo(&self) -> (Option<&Step>, usize) {
        self.history.to_undo()
    }

    /// What the next redo does again, and how many steps there are.
    #[must_use]
    pub fn to_redo(&self) -> (Option<&Step>, usize) {
        self.history.to_redo()
    }
}

fn told(result: Result<(), forerun::DriverError>, notice: &mut News<String>) -> bool {
    if let Err(error) = &result {
        notice.tell(error.to_string());
    }
    result.is_ok()
}

fn counted(what: &str, count: usize) -> String {
    if count == 1 { what.to_owned() } else { format!("{what} {count} bodies") }
}

/// As menus say it.
pub(super) fn label_of(change: &Change) -> &'static str {
    match change {
        Change::Add { .. } => "add",
        Change::Remove { .. } => "remove",
        Change::Move { .. } => "move",
        Change::Push { .. } => "push",
        Change::SetVelocity { .. } => "set velocity",
        Change::Hold { .. } => "hold",
        Change::Release { .. } => "release",
        Change::SetMaterial { .. } => "set surface",
        Change::SetForce { .. } => "set force",
        Change::SetGravityScale { .. } => "set gravity scale",
        Change::SetMass { .. } => "set mass",
        Change::SetKind { .. } => "set kind",
        Change::SetGravity { .. } => "set gravity",
    }
}
