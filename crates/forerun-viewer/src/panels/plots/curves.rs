//! What each plot draws.

use std::ops::RangeInclusive;

use egui_plot::{Bar, BarChart, Line, Plot, PlotPoint, PlotPoints, PlotUi};
use forerun::Stage;
use three_d::egui::{Color32, FontId, Sense, Ui, Vec2, vec2};

use crate::panels::palette::Palette;
use crate::series::{PictureRow, Series};

/// What a plot shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// States ahead of the picture.
    Queue,
    /// Physics time, display time and real time.
    Clocks,
    /// Time between pictures.
    Interval,
    /// Time of each stage.
    Stages,
    /// Slices and areas.
    Slices,
    /// Body-frames that edits cost.
    Edits,
}

impl Kind {
    /// All, in their order.
    pub(super) const ALL: [Kind; 6] =
        [Kind::Queue, Kind::Clocks, Kind::Interval, Kind::Stages, Kind::Slices, Kind::Edits];

    /// As buttons say it.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Kind::Queue => "queue",
            Kind::Clocks => "clocks",
            Kind::Interval => "pictures",
            Kind::Stages => "stages",
            Kind::Slices => "slices",
            Kind::Edits => "edits",
        }
    }

    /// What is drawn, with its unit.
    pub(super) const fn title(self) -> &'static str {
        match self {
            Kind::Queue => "Queue length (frames)",
            Kind::Clocks => "Physics, display and real time (s)",
            Kind::Interval => "Picture interval (ms)",
            Kind::Stages => "Step time by stage (ms)",
            Kind::Slices => "Slices; active areas",
            Kind::Edits => "Recomputed per edit (body-frames)",
        }
    }

    /// What it means.
    pub(super) const fn meaning(self) -> &'static str {
        match self {
            Kind::Queue => {
                "States that bodies have ahead of the picture: the fewest (red) and the most (blue)."
            }
            Kind::Clocks => {
                "How far physics is computed, what the picture shows, and what it would show if physics had never been late."
            }
            Kind::Interval => {
                "From the start of one picture to the start of the next. Physics never makes it longer."
            }
            Kind::Stages => "How long each computed frame took, stage upon stage.",
            Kind::Slices => {
                "Most slices that an island of the shown frame was cut into, and areas in which a body moved."
            }
            Kind::Edits => {
                "Body-frames that were computed again for each edit, and those of a full computation."
            }
        }
    }

    const fn unit(self) -> &'static str {
        match self {
            Kind::Queue => "frames",
            Kind::Clocks => "s",
            Kind::Interval | Kind::Stages => "ms",
            Kind::Slices => "",
            Kind::Edits => "body-frames",
        }
    }
}

/// Colours of stages, from the first to the last, and of the rest: readable in both themes.
const STAGES: [Color32; 7] = [
    Color32::from_rgb(0x4c, 0x8b, 0xe0),
    Color32::from_rgb(0x3f, 0xb0, 0x8f),
    Color32::from_rgb(0xd8, 0xa0, 0x2a),
    Color32::from_rgb(0xd9, 0x5f, 0x57),
    Color32::from_rgb(0x9a, 0x6f, 0xd0),
    Color32::from_rgb(0x6b, 0x9b, 0x37),
    Color32::from_rgb(0x8a, 0x90, 0x9a),
];

/// Letters of legends. Points.
const SMALL: f32 = 10.5;

/// What the colours of a plot mean, above it: in it they would hide curves.
pub(super) fn legend(ui: &mut Ui, kind: Kind, palette: &Palette) {
    let named: Vec<(&str, Color32)> = match kind {
        Kind::Stages => stage_names().zip(STAGES).collect(),
        Kind::Edits => vec![("full", palette.past), ("recomputed", palette.stale)],
        _ => curves(kind, palette).into_iter().map(|(name, colour, _)| (name, colour)).collect(),
    };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(3.0, 0.0);
        for (name, colour) in named {
            // In one piece, so that no line ends between a colour and its name.
            let text = ui.painter().layout_no_wrap(
                name.to_owned(),
                FontId::proportional(SMALL),
                Color32::PLACEHOLDER,
            );
            let (rect, _) = ui.allocate_exact_size(text.size() + vec2(16.0, 1.0), Sense::hover());
            ui.painter().circle_filled(rect.left_center() + vec2(5.0, 0.0), 3.5, colour);
            ui.painter().galley(rect.min + vec2(11.0, 0.0), text, ui.visuals().text_color());
        }
    });
}

fn stage_names() -> impl Iterator<Item = &'static str> {
    Stage::ALL.iter().map(|stage| stage.name()).chain(["other"])
}

/// Draws one plot over a time of the window's clock (seconds), in a size (points) and in colours.
pub(super) fn show(
    ui: &mut Ui,
    kind: Kind,
    series: &Series,
    time_s: RangeInclusive<f64>,
    look: (Vec2, &Palette),
) {
    let (size, palette) = look;
    let unit = kind.unit();
    let plot = Plot::new(kind.name())
        .width(size.x)
        .height(size.y)
        .allow_drag(false)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_boxed_zoom(false)
        .label_formatter(move |name, at: &PlotPoint| format!("{name}\n{:.3} {unit}\nat {:.2} s", at.y, at.x));
    // Times are far from 0; all else is read against it.
    let plot = if kind == Kind::Clocks { plot } else { plot.include_y(0.0) };
    plot.show(ui, |plot| {
        plot.set_plot_bounds_x(time_s.clone());
        match kind {
            Kind::Stages => stages(plot, series, &time_s),
            Kind::Edits => edits(plot, series, &time_s, palette),
            _ => pictures(plot, kind, series, &time_s, palette),
        }
    });
}

/// A name, a colour, and what of a picture is drawn.
type Curve = (&'static str, Color32, fn(&PictureRow) -> f64);

fn curves(kind: Kind, palette: &Palette) -> Vec<Curve> {
    match kind {
        Kind::Queue => vec![
            ("queue_max", palette.most, |picture| f64::from(picture.row.queue_max)),
            ("queue_min", palette.fewest, |picture| f64::from(picture.row.queue_min)),
        ],
        Kind::Clocks => vec![
            ("physics", palette.most, |picture| picture.row.time_physics_s),
            ("real", palette.ruler, |picture| picture.wished_s),
            ("display", palette.mark, |picture| picture.row.time_display_s),
        ],
        Kind::Interval => vec![("interval_ms", palette.most, |picture| picture.row.interval_ms)],
        _ => vec![
            ("slices_max", palette.fewest, |picture| f64::from(picture.row.slices_max)),
            ("areas_active", palette.most, |picture| f64::from(picture.row.areas_active)),
        ],
    }
}

fn pictures(
    plot: &mut PlotUi<'_>,
    kind: Kind,
    series: &Series,
    time_s: &RangeInclusive<f64>,
    palette: &Palette,
) {
    for (name, colour, value) in curves(kind, palette) {
        // A picture that was put off on purpose, or the first, has no interval.
        let counts = |picture: &&PictureRow| kind != Kind::Interval || picture.row.interval_ms > 0.0;
        let shown = series.pictures.iter().filter(|picture| time_s.contains(&picture.row.time_real_s));
        let shown = shown.filter(counts);
        let points: Vec<[f64; 2]> = shown.map(|picture| [picture.row.time_real_s, value(picture)]).collect();
        plot.line(Line::new(name, PlotPoints::from(points)).color(colour).width(1.6));
    }
}

/// Stage upon stage. Frames that were computed between two pictures lie beside each other.
fn stages(plot: &mut PlotUi<'_>, series: &Series, time_s: &RangeInclusive<f64>) {
    let shown: Vec<_> = series.steps.iter().filter(|row| time_s.contains(&row.time_real_s)).collect();
    let span_s = time_s.end() - time_s.start();
    // More bars than points are not seen: of those that fall together, the mean.
    let slots = 160_usize;
    let mut sums = vec![([0.0_f64; 7], 0_u32); slots];
    for row in shown {
        let slot = ((row.time_real_s - time_s.start()) / span_s * slots as f64) as usize;
        let (sum, count) = &mut sums[slot.min(slots - 1)];
        let parts = row.times.seconds.iter().chain([&row.times.other_s]);
        sum.iter_mut().zip(parts).for_each(|(sum, part)| *sum += f64::from(*part) * 1e3);
        *count += 1;
    }
    let width = span_s / slots as f64;
    let mut charts: Vec<BarChart> = Vec::new();
    for (i, name) in stage_names().enumerate() {
        let bar = |(slot, (sum, count)): (usize, &([f64; 7], u32))| {
            let x = time_s.start() + (slot as f64 + 0.5) * width;
            (*count > 0).then(|| Bar::new(x, sum[i] / f64::from(*count)).width(width))
        };
        let bars: Vec<Bar> = sums.iter().enumerate().filter_map(bar).collect();
        let below: Vec<&BarChart> = charts.iter().collect();
        let chart = BarChart::new(name, bars).color(STAGES[i]).stack_on(&below);
        charts.push(chart);
    }
    charts.into_iter().for_each(|chart| plot.bar_chart(chart));
}

fn edits(plot: &mut PlotUi<'_>, series: &Series, time_s: &RangeInclusive<f64>, palette: &Palette) {
    let width = (time_s.end() - time_s.start()) / 120.0;
    let shown: Vec<_> = series.edits.iter().filter(|row| time_s.contains(&row.time_real_s)).collect();
    let full =
        shown.iter().map(|row| Bar::new(row.time_real_s, row.edit.full as f64).width(2.0 * width)).collect();
    let done =
        shown.iter().map(|row| Bar::new(row.time_real_s, row.edit.recomputed as f64).width(width)).collect();
    plot.bar_chart(BarChart::new("full", full).color(palette.past));
    plot.bar_chart(BarChart::new("recomputed", done).color(palette.stale));
}
