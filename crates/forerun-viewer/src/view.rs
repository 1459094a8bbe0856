//! View: what is shown and how. Plain settings: they survive restarts, and panels edit them in place.

use serde::{Deserialize, Serialize};

/// What the colour of a body tells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColourBy {
    /// Which one it is.
    #[default]
    Body,
    /// With whom it is solved together.
    Island,
    /// Which area it is in.
    Area,
    /// How many of its states are known beyond the one shown.
    Lookahead,
    /// Whether it rests.
    Rest,
    /// Into how many slices its frame was cut.
    Slices,
    /// How fast it is.
    Speed,
}

impl ColourBy {
    /// All, in the order of menus.
    pub const ALL: [ColourBy; 7] = [
        ColourBy::Body,
        ColourBy::Island,
        ColourBy::Area,
        ColourBy::Lookahead,
        ColourBy::Rest,
        ColourBy::Slices,
        ColourBy::Speed,
    ];

    /// As menus say it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            ColourBy::Body => "body",
            ColourBy::Island => "island",
            ColourBy::Area => "area",
            ColourBy::Lookahead => "lookahead",
            ColourBy::Rest => "rest",
            ColourBy::Slices => "slices",
            ColourBy::Speed => "speed",
        }
    }

    /// The one after it, and after the last the first.
    #[must_use]
    pub fn next(self) -> ColourBy {
        let at = Self::ALL.iter().position(|by| *by == self).unwrap_or(0);
        Self::ALL[(at + 1) % Self::ALL.len()]
    }
}

/// Light or dark panels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Theme {
    /// Dark panels, dusk outside.
    #[default]
    Dark,
    /// Light panels, day outside.
    Light,
}

impl Theme {
    /// The other one.
    #[must_use]
    pub const fn other(self) -> Theme {
        match self {
            Theme::Dark => Theme::Light,
            Theme::Light => Theme::Dark,
        }
    }
}

/// Transparent pictures of what is still to come (the dissertation's figure 5.7).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Ghosts {
    /// Whether they are shown.
    pub shown: bool,
    /// How many, 1 to 20. The last one is at the horizon, the others at equal distances before it.
    pub count: u32,
    /// How opaque the nearest is, 0 to 1.
    pub opacity: f32,
    /// Whether the selection leaves a trail into the future.
    pub trails: bool,
    /// How far trails and the preview of a throw look ahead. Seconds.
    pub trail_seconds: f32,
    /// Whether a throw is shown while it is aimed.
    pub preview: bool,
}

impl Default for Ghosts {
    fn default() -> Self {
        Ghosts { shown: false, count: 1, opacity: 0.35, trails: true, trail_seconds: 1.5, preview: true }
    }
}

/// What is drawn over the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Overlays {
    /// Contact points with their normals.
    pub contacts: bool,
    /// How hard contacts push.
    pub impulses: bool,
    /// Levels in the contact graph, as numbers.
    pub levels: bool,
    /// Boxes that bodies are found by.
    pub bounds: bool,
    /// Areas and their clocks.
    pub areas: bool,
    /// A slice of the distance field of the selection.
    pub field: bool,
    /// Where the slice is, 0 to 1 of the body's height.
    pub field_height: f32,
}

/// What a press of the left button does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tool {
    /// Picks a body, and drags it by a spring.
    #[default]
    Select,
    /// Throws something.
    Throw,
    /// Pushes a body.
    Push,
}

impl Tool {
    /// As menus and scripts say it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Tool::Select => "select",
            Tool::Throw => "throw",
            Tool::Push => "push",
        }
    }
}

/// What is thrown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Missile {
    /// A ball.
    #[default]
    Ball,
    /// A box.
    Box,
    /// A torus.
    Torus,
    /// One like the selected body.
    Selected,
}

/// How things are thrown and dragged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Grip {
    /// What a press of the left button does.
    pub tool: Tool,
    /// What is thrown.
    pub missile: Missile,
    /// How large: the radius of a ball. Metres.
    pub size: f32,
    /// How fast it leaves. m/s.
    pub speed: f32,
    /// How heavy it is. kg/m³.
    pub density: f32,
    /// The spring that drags. Hz.
    pub frequency: f32,
    /// By how much a push changes the velocity. m/s.
    pub push: f32,
}

impl Default for Grip {
    fn default() -> Self {
        Grip {
            tool: Tool::Select,
            missile: Missile::Ball,
            size: 0.3,
            speed: 15.0,
            density: 1000.0,
            frequency: 3.0,
            push: 3.0,
        }
    }
}

/// Which panels are open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Open {
    /// The panel of tools.
    pub tools: bool,
    /// The panel of the selection.
    pub inspector: bool,
    /// The plots.
    pub plots: bool,
    /// The list of keys.
    pub help: bool,
}

impl Default for Open {
    fn default() -> Self {
        Open { tools: true, inspector: true, plots: false, help: false }
    }
}

/// What is shown and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct View {
    /// What colours tell.
    pub colour_by: ColourBy,
    /// Light or dark.
    pub theme: Theme,
    /// Whether bodies cast shadows.
    pub shadows: bool,
    /// Whether the ground has a grid.
    pub grid: bool,
    /// Size of text and buttons, against the system's. 0.5 to 3.
    pub scale: f32,
    /// What is still to come.
    pub ghosts: Ghosts,
    /// What is drawn over the bodies.
    pub overlays: Overlays,
    /// How things are thrown and dragged.
    pub grip: Grip,
    /// Which panels are open.
    pub open: Open,
}

impl Default for View {
    fn default() -> Self {
        View {
            colour_by: ColourBy::default(),
            theme: Theme::default(),
            shadows: true,
            grid: true,
            scale: 1.0,
            ghosts: Ghosts::default(),
            overlays: Overlays::default(),
            grip: Grip::default(),
            open: Open::default(),
        }
    }
}
