//! Plan: what each experiment runs and which figures it draws.

use forerun::{DriverKind, Scene};

/// One run of an experiment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Variant {
    /// Folder, column and legend entry.
    pub(crate) label: &'static str,
    pub(crate) driver: DriverKind,
    /// Most slices of a frame; none for the scene's own setting. 1 switches the return in time off.
    pub(crate) slices_max: Option<u32>,
}

/// One chart of an experiment: file name and title, which begins with the number of the dissertation's figure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Figure {
    pub(crate) file: &'static str,
    pub(crate) title: &'static str,
    pub(crate) kind: FigureKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FigureKind {
    Queue,
    /// Above, all of the queue; below, its lowest moment.
    QueueAndLowest,
    Times,
    TimesAndSteps,
}

/// One experiment.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    /// Folder and heading.
    pub(crate) name: &'static str,
    /// What the experiment is to show, in a sentence or two.
    pub(crate) question: &'static str,
    pub(crate) scene: Scene,
    /// Real seconds, unless the user says otherwise.
    pub(crate) seconds: f64,
    pub(crate) variants: Vec<Variant>,
    pub(crate) figures: [Figure; 2],
}

const DECOUPLED: Variant = Variant { label: "decoupled", driver: DriverKind::Decoupled, slices_max: None };
const COUPLED: Variant = Variant { label: "coupled", driver: DriverKind::Coupled, slices_max: None };

pub(crate) fn dominoes(scene: Scene) -> Plan {
    Plan {
        name: "dominoes",
        question: "A simple scene: does physics stay ahead of the display, with a full queue, and is the display in real time? \
                   Here the traditional model is in real time too.",
        scene,
        seconds: 30.0,
        variants: vec![DECOUPLED, COUPLED],
        figures: [
            figure("figure_5_2", "Figure 5.2: dominoes, states in the queue", FigureKind::Queue),
            figure(
                "figure_5_3",
                "Figure 5.3: dominoes, display and physics against real time",
                FigureKind::Times,
            ),
        ],
    }
}

pub(crate) fn meshes(scene: Scene) -> Plan {
    Plan {
        name: "meshes",
        question: "Complex meshes that are cheap while they fall and expensive when they meet: does the queue that was filled \
                   before carry the display over the burst, where the traditional model falls behind?",
        scene,
        seconds: 10.0,
        variants: vec![DECOUPLED, COUPLED],
        figures: [
            figure("figure_5_5", "Figure 5.5: meshes, states in the queue", FigureKind::Queue),
            figure(
                "figure_5_6",
                "Figure 5.6: meshes, display and physics against real time",
                FigureKind::Times,
            ),
        ],
    }
}

pub(crate) fn interaction(scene: Scene) -> Plan {
    Plan {
        name: "interaction",
        question: "A body is added at 10 s: do only the states that it can reach go out of date (the fewest states of a body drop, the \
                   most do not), and is the queue filled again?",
        scene,
        seconds: 30.0,
        variants: vec![DECOUPLED, COUPLED],
        figures: [
            figure(
                "figure_5_8",
                "Figure 5.8: interaction, fewest and most states in the queue",
                FigureKind::QueueAndLowest,
            ),
            figure(
                "figure_5_9",
                "Figure 5.9: interaction, display and physics against real time",
                FigureKind::Times,
            ),
        ],
    }
}

/// A frame of 30 ms that lets one of the boxes sink 2.5 mm deeper counts as not plausible.
const STACK_DEEP_PART: f32 = 0.005;

pub(crate) fn stack(mut scene: Scene) -> Plan {
    scene.settings.deep_overlap_part = Some(STACK_DEEP_PART);
    let without =
        Variant { label: "without return in time", driver: DriverKind::Decoupled, slices_max: Some(1) };
    Plan {
        name: "stack",
        question: "A dropped stack of 20: is the time step made shorter where the result was not plausible, and does the queue fill \
                   all the same? The second column has the return in time switched off.",
        scene,
        seconds: 10.0,
        variants: vec![DECOUPLED, without, COUPLED],
        figures: [
            figure("figure_5_12", "Figure 5.12: stack, states in the queue", FigureKind::Queue),
            figure(
                "figure_5_13",
                "Figure 5.13: stack, display and physics against real time",
                FigureKind::TimesAndSteps,
            ),
        ],
    }
}

const fn figure(file: &'static str, title: &'static str, kind: FigureKind) -> Figure {
    Figure { file, title, kind }
}
