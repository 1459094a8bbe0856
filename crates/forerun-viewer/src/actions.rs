//! Actions: all that a key, a menu or a button does, in one table. The help panel is this table.

use three_d::{Key, Modifiers};

/// What the user may ask for by a key, a menu or a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Let display time go on, or hold it.
    PlayPause,
    /// One frame on.
    StepForward,
    /// One frame back.
    StepBack,
    /// A second on.
    JumpForward,
    /// A second back.
    JumpBack,
    /// To the oldest frame that is kept.
    GoToStart,
    /// To the horizon.
    GoToHorizon,
    /// Half as fast.
    Slower,
    /// Twice as fast.
    Faster,
    /// Let display time run backwards.
    Rewind,
    /// Look at the selection.
    Focus,
    /// Look at everything.
    FrameAll,
    /// Remove the selected bodies.
    Delete,
    /// Another body, where the camera looks.
    Add,
    /// Another body like the selected one, beside it.
    Duplicate,
    /// Select nothing.
    Deselect,
    /// Select all bodies that move.
    SelectAll,
    /// Take back the last command.
    Undo,
    /// Do again what was taken back.
    Redo,
    /// Read the scene again, from its start.
    Reload,
    /// Open a scene file.
    Open,
    /// Keep a picture of the window.
    Screenshot,
    /// Keep a picture without the panels.
    BareScreenshot,
    /// Start or end a film.
    Film,
    /// Between the decoupled and the coupled driver.
    Coupled,
    /// Show or hide the plots.
    Plots,
    /// Let the plots go on, or hold them.
    HoldPlots,
    /// Show or hide the panel of the selection.
    Inspector,
    /// Show or hide ghosts of the future.
    Ghosts,
    /// Show or hide contacts.
    Contacts,
    /// The next way to colour bodies.
    NextColour,
    /// Select with the mouse.
    SelectTool,
    /// Throw with the mouse.
    ThrowTool,
    /// Push with the mouse.
    PushTool,
    /// Between light and dark panels.
    Theme,
    /// Larger text and buttons.
    Larger,
    /// Smaller text and buttons.
    Smaller,
    /// Show or hide the list of built-in scenes.
    Scenes,
    /// Show or hide this list.
    Help,
}

/// Which modifier keys go with a key. On a Mac, the command key stands for Ctrl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum With {
    /// None.
    Nothing,
    /// Ctrl.
    Ctrl,
    /// Shift.
    Shift,
    /// Ctrl and Shift.
    CtrlShift,
}

/// A key and what it does.
#[derive(Clone, Copy, Debug)]
pub struct Shortcut {
    /// The key.
    pub key: Key,
    /// The modifiers that go with it.
    pub with: With,
    /// What it does.
    pub action: Action,
    /// As the help panel says it.
    pub help: &'static str,
}

const fn on(key: Key, with: With, action: Action, help: &'static str) -> Shortcut {
    Shortcut { key, with, action, help }
}

/// All shortcuts, in the order of the help panel. Those of Blender, Unity and web players where these agree.
pub const SHORTCUTS: &[Shortcut] = &[
    on(Key::Space, With::Nothing, Action::PlayPause, "play, pause"),
    on(Key::ArrowRight, With::Nothing, Action::StepForward, "one frame on"),
    on(Key::ArrowLeft, With::Nothing, Action::StepBack, "one frame back"),
    on(Key::ArrowRight, With::Shift, Action::JumpForward, "a second on"),
    on(Key::ArrowLeft, With::Shift, Action::JumpBack, "a second back"),
    on(Key::Home, With::Nothing, Action::GoToStart, "to the oldest frame"),
    on(Key::End, With::Nothing, Action::GoToHorizon, "to the horizon"),
    on(Key::ArrowDown, With::Nothing, Action::Slower, "half as fast"),
    on(Key::ArrowUp, With::Nothing, Action::Faster, "twice as fast"),
    on(Key::R, With::Nothing, Action::Rewind, "rewind"),
    on(Key::F, With::Nothing, Action::Focus, "look at the selection"),
    on(Key::A, With::Shift, Action::FrameAll, "look at everything"),
    on(Key::Q, With::Nothing, Action::SelectTool, "select and drag"),
    on(Key::T, With::Nothing, Action::ThrowTool, "throw"),
    on(Key::P, With::Nothing, Action::PushTool, "push"),
    on(Key::Delete, With::Nothing, Action::Delete, "remove the selection"),
    on(Key::Insert, With::Nothing, Action::Add, "a body where the camera looks, as it would be thrown"),
    on(Key::D, With::Ctrl, Action::Duplicate, "another one like the selection"),
    on(Key::A, With::Ctrl, Action::SelectAll, "select all that moves"),
    on(Key::Escape, With::Nothing, Action::Deselect, "select nothing"),
    on(Key::Z, With::Ctrl, Action::Undo, "undo"),
    on(Key::Z, With::CtrlShift, Action::Redo, "redo"),
    on(Key::Y, With::Ctrl, Action::Redo, "redo"),
    on(Key::O, With::Ctrl, Action::Open, "open a scene file"),
    on(Key::R, With::Ctrl, Action::Reload, "read the scene again"),
    on(Key::G, With::Nothing, Action::Ghosts, "ghosts of the future"),
    on(Key::C, With::Nothing, Action::NextColour, "colour by the next property"),
    on(Key::X, With::Nothing, Action::Contacts, "contacts"),
    on(Key::L, With::Nothing, Action::Plots, "plots"),
    on(Key::N, With::Nothing, Action::Inspector, "panel of the selection"),
    on(Key::K, With::Nothing, Action::Coupled, "coupled or decoupled driver"),
    on(Key::B, With::Nothing, Action::Scenes, "built-in scenes"),
    on(Key::L, With::Shift, Action::HoldPlots, "hold the plots, let them go on"),
    on(Key::F12, With::Nothing, Action::Screenshot, "screenshot"),
    on(Key::F12, With::Shift, Action::BareScreenshot, "screenshot without panels"),
    on(Key::F12, With::Ctrl, Action::Film, "start, end a film"),
    on(Key::F10, With::Nothing, Action::Theme, "light or dark"),
    on(Key::Equals, With::Ctrl, Action::Larger, "larger text and buttons"),
    on(Key::Plus, With::Ctrl, Action::Larger, "larger text and buttons"),
    on(Key::Minus, With::Ctrl, Action::Smaller, "smaller text and buttons"),
    on(Key::F1, With::Nothing, Action::Help, "this list"),
    on(Key::H, With::Nothing, Action::Help, "this list"),
];

impl With {
    /// What the modifiers are.
    #[must_use]
    pub const fn of(modifiers: Modifiers) -> Option<With> {
        match (modifiers.command || modifiers.ctrl, modifiers.shift, modifiers.alt) {
            (false, false, false) => Some(With::Nothing),
            (true, false, false) => Some(With::Ctrl),
            (false, true, false) => Some(With::Shift),
            (true, true, false) => Some(With::CtrlShift),
            _ => None,
        }
    }
}

impl Shortcut {
    /// How the key is written: `Ctrl+Z`.
    #[must_use]
    pub fn keys(&self) -> String {
        let key = match self.key {
            Key::ArrowRight => "→".to_owned(),
            Key::ArrowLeft => "←".to_owned(),
            Key::ArrowUp => "↑".to_owned(),
            Key::ArrowDown => "↓".to_owned(),
            Key::Escape => "Esc".to_owned(),
            Key::Equals => "=".to_owned(),
            Key::Plus => "+".to_owned(),
            Key::Minus => "-".to_owned(),
            key => format!("{key:?}"),
        };
        match self.with {
            With::Nothing => key,
            With::Ctrl => format!("Ctrl+{key}"),
            With::Shift => format!("Shift+{key}"),
            With::CtrlShift => format!("Ctrl+Shift+{key}"),
        }
    }
}

impl Action {
    /// The keys that ask for it, for tooltips and menus: the first there are.
    #[must_use]
    pub fn keys(self) -> Option<String> {
        SHORTCUTS.iter().find(|shortcut| shortcut.action == self).map(Shortcut::keys)
    }
}

/// What a key does.
#[must_use]
pub fn action_of(key: Key, modifiers: Modifiers) -> Option<Action> {
    let with = With::of(modifiers)?;
    SHORTCUTS
        .iter()
        .find(|shortcut| shortcut.key == key && shortcut.with == with)
        .map(|shortcut| shortcut.action)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_means_two_things() {
        for (i, a) in SHORTCUTS.iter().enumerate() {
            assert!(SHORTCUTS[..i].iter().all(|b| a.key != b.key || a.with != b.with), "{}", a.keys());
        }
    }

    #[test]
    fn undo_is_where_everybody_looks_for_it() {
        let ctrl = Modifiers { ctrl: true, command: true, ..Modifiers::default() };
        assert_eq!(action_of(Key::Z, ctrl), Some(Action::Undo));
        assert_eq!(action_of(Key::Z, Modifiers::default()), None);
    }
}
