//! Stages: the six verbs of the step, and who may watch them.

/// The stages of one step, in order. The same words name the files, the profile rows and the CSV columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Find the pairs that touch or will touch, and where.
    Collisions,
    /// Gravity, forces, torques, gyroscopic term.
    Velocities,
    /// Who rests on whom: levels, islands, and the load that each contact carries.
    ContactGraph,
    /// Impulses with friction, bounces included, in level order.
    Contacts,
    /// Remaining overlap is pushed out level by level; what is below moves less.
    ShockPropagation,
    /// New poses; rest.
    Positions,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Stage; 6] = [
        Stage::Collisions,
        Stage::Velocities,
        Stage::ContactGraph,
        Stage::Contacts,
        Stage::ShockPropagation,
        Stage::Positions,
    ];

    /// The name used in files: `collisions`, `velocities`, `contact_graph`, `contacts`, `shock_propagation`, `positions`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Stage::Collisions => "collisions",
            Stage::Velocities => "velocities",
            Stage::ContactGraph => "contact_graph",
            Stage::Contacts => "contacts",
            Stage::ShockPropagation => "shock_propagation",
            Stage::Positions => "positions",
        }
    }
}

/// Called after each stage of a step: profilers, viewers and tests hang here.
pub trait Observer {
    /// `stage` has just ended.
    fn after(&mut self, stage: Stage);
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn after(&mut self, _stage: Stage) {}
}
