//! Colours of what panels paint themselves, for light and for dark.

use three_d::egui::{self, Color32};

use crate::view::Theme;

/// Colours that mean something.
#[derive(Clone, Copy, Debug)]
pub(super) struct Palette {
    /// Behind the strip.
    pub(super) trough: Color32,
    /// What was and is still kept.
    pub(super) past: Color32,
    /// The most states that a body has ahead: the dissertation's blue bar.
    pub(super) most: Color32,
    /// The fewest: its red bar.
    pub(super) fewest: Color32,
    /// What is out of date.
    pub(super) stale: Color32,
    /// Where display time is.
    pub(super) playhead: Color32,
    /// Edits.
    pub(super) mark: Color32,
    /// Lines and numbers of rulers.
    pub(super) ruler: Color32,
    /// All is well.
    pub(super) good: Color32,
}

impl Palette {
    pub(super) const fn of(theme: Theme) -> Palette {
        match theme {
            Theme::Dark => Palette {
                trough: Color32::from_rgb(0x16, 0x18, 0x1c),
                past: Color32::from_rgb(0x4a, 0x50, 0x5a),
                most: Color32::from_rgb(0x3d, 0x7d, 0xd8),
                fewest: Color32::from_rgb(0xe0, 0x5a, 0x50),
                stale: Color32::from_rgb(0xf2, 0xb1, 0x34),
                playhead: Color32::from_rgb(0xf5, 0xf6, 0xf8),
                mark: Color32::from_rgb(0x5f, 0xd3, 0xa2),
                ruler: Color32::from_rgb(0x9a, 0xa2, 0xae),
                good: Color32::from_rgb(0x5f, 0xd3, 0xa2),
            },
            Theme::Light => Palette {
                trough: Color32::from_rgb(0xe3, 0xe6, 0xea),
                past: Color32::from_rgb(0xa9, 0xb1, 0xbc),
                most: Color32::from_rgb(0x4a, 0x8a, 0xe0),
                fewest: Color32::from_rgb(0xc9, 0x35, 0x2c),
                stale: Color32::from_rgb(0xe0, 0x93, 0x00),
                playhead: Color32::from_rgb(0x14, 0x18, 0x1e),
                mark: Color32::from_rgb(0x0c, 0x7d, 0x52),
                ruler: Color32::from_rgb(0x55, 0x5e, 0x6a),
                good: Color32::from_rgb(0x0c, 0x7d, 0x52),
            },
        }
    }
}

/// Panels in the colours of both themes; once.
pub(super) fn dress(ctx: &egui::Context) {
    ctx.style_mut_of(egui::Theme::Dark, |style| {
        arrange(style);
        // Grey on grey is hard to read over a bright picture.
        style.visuals.override_text_color = Some(Color32::from_rgb(0xdc, 0xdf, 0xe4));
        style.visuals.selection.bg_fill = Color32::from_rgb(0x2d, 0x5c, 0x9e);
    });
    ctx.style_mut_of(egui::Theme::Light, |style| {
        arrange(style);
        style.visuals.override_text_color = Some(Color32::from_rgb(0x20, 0x25, 0x2c));
        style.visuals.selection.bg_fill = Color32::from_rgb(0xa9, 0xcc, 0xf7);
    });
}

fn arrange(style: &mut egui::Style) {
    style.spacing.item_spacing = egui::vec2(6.0, 5.0);
    style.spacing.button_padding = egui::vec2(7.0, 3.0);
    style.interaction.tooltip_delay = 0.35;
    style.visuals.window_shadow.blur = 12;
}

/// Light or dark from now on.
pub(super) fn choose(ctx: &egui::Context, theme: Theme) {
    let wanted = match theme {
        Theme::Dark => egui::Theme::Dark,
        Theme::Light => egui::Theme::Light,
    };
    if ctx.theme() != wanted {
        ctx.set_theme(wanted);
    }
}
