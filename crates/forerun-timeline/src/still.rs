//! Still: a snapshot of a single frame, for who steps without a timeline and wants to be looked at all the same.

use std::sync::Arc;

use forerun_dynamics::{Body, BodyDef, BodyId, BodyState, Environment};

use crate::areas::Areas;
use crate::definitions::Definitions;
use crate::frame_table::{Entry, FrameTable};
use crate::marks::Marks;
use crate::tables::Tables;
use crate::timeline::area_edge;
use crate::{Frame, Snapshot};

/// A body of a snapshot of a single frame.
#[derive(Clone, Debug)]
pub struct StillBody {
    /// Its name.
    pub body: BodyId,
    /// How it was made, if that is known.
    pub def: Option<Arc<BodyDef>>,
    /// What it is now.
    pub made: Arc<Body>,
    /// How it is now.
    pub state: BodyState,
}

impl Snapshot {
    /// The bodies as they are shown at a time (seconds), in the order of their ids: to go on from there without a timeline. None where the time is no
    /// number.
    #[must_use]
    pub fn still_at(&self, seconds: f64) -> Vec<StillBody> {
        if seconds.is_nan() {
            return Vec::new();
        }
        let look = self.look_at(seconds);
        let mut bodies = Vec::new();
        self.for_each_shown(look.moment, |body| {
            let shown = self.shown(body, &look).map(|(_, state, _)| state.canonical());
            let made = self.definitions.body(body, look.moment.frame.min(self.known_to(body)));
            bodies.extend(shown.zip(made).map(|(state, made)| StillBody {
                body,
                def: self.definitions.def(body).cloned(),
                made: Arc::clone(made),
                state,
            }));
        });
        bodies
    }

    /// Gravity and settings as they are from this frame to the next.
    #[must_use]
    pub fn environment_at(&self, frame: Frame) -> Environment {
        self.definitions.environment(frame)
    }

    /// How many names of bodies are in use; ids are below it.
    #[must_use]
    pub fn names(&self) -> usize {
        self.definitions.names()
    }

    /// A snapshot of some bodies (sorted by id) at one frame.
    #[must_use]
    pub fn still(frame: Frame, bodies: &[StillBody], environment: Environment) -> Snapshot {
        let names = bodies.last().map_or(0, |last| last.body.0 as usize + 1);
        let mut made = vec![(None, None); names];
        for StillBody { body, def, made: is, .. } in bodies {
            if let Some(place) = made.get_mut(body.0 as usize) {
                *place = (def.clone(), Some(Arc::clone(is)));
            }
        }
        let edge_m = area_edge(bodies.iter().map(|body| &*body.made));
        let empty = Snapshot {
            valid_to: frame,
            tables: Tables::new(frame, Arc::default()),
            definitions: Arc::new(Definitions::at(Frame(0), made, environment)),
            doubtful: Vec::new(),
            effects: Arc::default(),
            marks: Marks::default(),
            grid: Areas::new(edge_m).grid(),
        };
        let entries: Vec<(BodyId, BodyState)> = bodies.iter().map(|body| (body.body, body.state)).collect();
        empty.moved(frame, &entries)
    }

    /// The same bodies in other states (sorted by id), at another single frame. What stays where it was is shared.
    #[must_use]
    pub fn moved(&self, frame: Frame, states: &[(BodyId, BodyState)]) -> Snapshot {
        let entries: Vec<Entry> = states.iter().map(|(body, state)| (*body, Some(*state))).collect();
        let table: &Arc<FrameTable> = self.tables.at(self.horizon());
        let (table, _) = table.with_entries(&entries, table);
        Snapshot {
            valid_to: frame,
            tables: Tables::new(frame, table),
            definitions: Arc::clone(&self.definitions),
            doubtful: Vec::new(),
            effects: Arc::default(),
            marks: Marks::default(),
            grid: self.grid,
        }
    }
}
