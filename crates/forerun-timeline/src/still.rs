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
