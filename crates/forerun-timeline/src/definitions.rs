//! Definitions: what the bodies and gravity are from which frame on.
//!
//! Promise: a function of the commands alone, never of the states, so that it is known for all frames as soon as a command is
//! accepted.

use std::sync::Arc;

use forerun_dynamics::{Body, BodyDef, BodyId, Environment};
use forerun_geometry::Vec3;
use forerun_geometry::shape::{Shape, Sphere};

use crate::Frame;
use crate::command::{Change, CommandKey};
use crate::effect::body_after;
use crate::shared_list::SharedList;
use crate::stale::same_body;

/// What one body is from which frame on.
#[derive(Clone, Debug, Default)]
pub(crate) struct History {
    /// How it was made; `None` while it only has a name.
    pub(crate) def: Option<Arc<BodyDef>>,
    /// Sorted by frame; each holds until the next. `None` where the body does not exist.
    pub(crate) entries: Vec<(Frame, Option<Arc<Body>>)>,
}

impl History {
    /// The body as it is from this frame to the next.
    pub(crate) fn body(&self, frame: Frame) -> Option<&Arc<Body>> {
        in_force(&self.entries, frame)?.as_ref()
    }
}

/// What every body and gravity are, over frames.
#[derive(Clone, Debug)]
pub(crate) struct Definitions {
    pub(crate) bodies: SharedList<Arc<History>>,
    /// Sorted by frame; each holds until the next; the first holds from the beginning. Never empty.
    pub(crate) environments: Vec<(Frame, Environment)>,
}

impl Definitions {
    /// Bodies 0, 1, 2, ... that exist from frame 0 on.
    pub(crate) fn new(bodies: Vec<(Arc<BodyDef>, Arc<Body>)>, environment: Environment) -> Definitions {
        let bodies = bodies.into_iter().map(|(def, body)| (Some(def), Some(body)));
        Definitions::at(Frame(0), bodies, environment)
    }

    /// For the names 0, 1, 2, ...: how each was made, if it was, and what it is from a frame on, if it is there.
    pub(crate) fn at(
        from: Frame,
        bodies: impl IntoIterator<Item = (Option<Arc<BodyDef>>, Option<Arc<Body>>)>,
        environment: Environment,
    ) -> Definitions {
        let bodies = bodies.into_iter().map(|(def, body)| {
            let entries = body.map(|body| (from, Some(body)));
            Arc::new(History { def, entries: entries.into_iter().collect() })
        });
        Definitions { bodies: bodies.collect(), environments: vec![(from, environment)] }
    }

    /// How many names are in use.
    pub(crate) fn names(&self) -> usize {
        self.bodies.len()
    }

    /// Makes names up to `count` known.
    pub(crate) fn reserve(&mut self, count: usize) {
        if count > self.bodies.len() {
            self.bodies.grow(count, &Arc::default());
        }
    }

    /// How a body was made, if it was.
    pub(crate) fn def(&self, body: BodyId) -> Option<&Arc<BodyDef>> {
        self.bodies.get(body.0 as usize)?.def.as_ref()
    }

    /// Says how a body is made, before the history is rebuilt with the command that adds it; `None` when that was taken back.
    pub(crate) fn set_def(&mut self, body: BodyId, def: Option<Arc<BodyDef>>) {
        if let Some(history) = self.history_mut(body) {
            history.def = def;
        }
    }

    /// The body as it is from this frame to the next.
    pub(crate) fn body(&self, body: BodyId, frame: Frame) -> Option<&Arc<Body>> {
        self.bodies.get(body.0 as usize)?.body(frame)
    }

    /// All that a body is over the frames; it stays as it is when the definitions change.
    pub(crate) fn history(&self, body: BodyId) -> Arc<History> {
        self.bodies.get(body.0 as usize).cloned().unwrap_or_default()
    }

    fn history_mut(&mut self, body: BodyId) -> Option<&mut History> {
        self.bodies.get_mut(body.0 as usize).map(Arc::make_mut)
    }

    /// Gravity and settings as they are from this frame to the next.
    pub(crate) fn environment(&self, frame: Frame) -> Environment {
        // There is always an entry at or before the oldest frame; what lies before is as that.
        in_force(&self.environments, frame).copied().unwrap_or(self.environments[0].1)
    }

    /// Works out a body's history anew from `from` on. `commands` are all commands to it at `from` or later, sorted.
    pub(crate) fn rebuild_body<'a>(
        &mut self,
        body: BodyId,
        from: Frame,
        commands: impl Iterator<Item = (CommandKey, &'a Change)>,
    ) {
        let Some(history) = self.history_mut(body) else { return };
        let kept = history.entries.partition_point(|(frame, _)| *frame < from);
        let old = history.entries.split_off(kept);
        let mut current = history.entries.last().and_then(|(_, body)| body.clone());
        for (key, change) in commands {
            let Ok(next) = body_after(current.as_ref(), change, history.def.as_deref()) else { continue };
            if same_body(next.as_ref(), current.as_ref()) {
                continue;
            }
            current = next;
            if history.entries.last().is_some_and(|(frame, _)| *frame == key.frame) {
                history.entries.pop();
            }
            history.entries.push((key.frame, current.clone()));
        }
        share_equal(&mut history.entries[kept..], &old);
    }

    /// Works out gravity anew from `from` on. `gravities` are all commands to it at `from` or later, sorted.
    pub(crate) fn rebuild_environment(
        &mut self,
        from: Frame,
        gravities: impl Iterator<Item = (Frame, Vec3)>,
    ) {
        let kept = self.environments.partition_point(|(frame, _)| *frame < from).max(1);
        self.environments.truncate(kept);
        for (frame, gravity) in gravities {
            let environment = Environment { gravity, ..self.environments[0].1 };
            self.environments.push((frame, environment));
        }
    }

    /// Whether another gravity held only before `oldest`.
    pub(crate) fn has_gravity_before(&self, oldest: Frame) -> bool {
        self.environments.get(1).is_some_and(|(from, _)| *from <= oldest)
    }

    /// Forgets what held only before `oldest`.
    pub(crate) fn forget_before(&mut self, oldest: Frame, bodies: impl Iterator<Item = BodyId>) {
        drop_before(&mut self.environments, oldest);
        for body in bodies {
            if let Some(history) = self.history_mut(body) {
                drop_before(&mut history.entries, oldest);
                // Gone for good: its name is used up, but what it was made of need not be kept.
                if matches!(history.entries[..], [(_, None)]) && history.def.is_some() {
                    history.def = Some(gone());
                }
            }
        }
    }
}

/// What stands for how a body was made that is gone for good.
fn gone() -> Arc<BodyDef> {
    Arc::new(BodyDef::new(Shape::Sphere(Sphere { radius: 1.0 })))
}

/// What holds at a frame: the last entry at or before it.
fn in_force<T>(entries: &[(Frame, T)], frame: Frame) -> Option<&T> {
    let after = entries.partition_point(|(from, _)| *from <= frame);
    entries.get(after.checked_sub(1)?).map(|(_, value)| value)
}

fn drop_before<T>(entries: &mut Vec<(Frame, T)>, oldest: Frame) {
    let after = entries.partition_point(|(from, _)| *from <= oldest);
    entries.drain(..after.saturating_sub(1));
}

/// Keeps the old memory of bodies that come out as they were, so that a look at the pointer tells.
pub(crate) fn share_equal(entries: &mut [(Frame, Option<Arc<Body>>)], old: &[(Frame, Option<Arc<Body>>)]) {
    for (frame, body) in entries {
        if let Some(before) = in_force(old, *frame)
            && same_body(before.as_ref(), body.as_ref())
        {
            body.clone_from(before);
        }
    }
}
