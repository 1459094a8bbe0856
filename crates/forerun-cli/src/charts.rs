//! Charts: lines over time, drawn the same as SVG and as PNG.
//!
//! Promise: every axis has a name with its unit, every line an entry in the legend, and no colour alone carries a meaning
//! that readers with a colour-vision deficiency would lose (palette of Okabe and Ito).

use std::path::{Path, PathBuf};
use std::sync::Once;

use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use crate::failure::Failure;

/// Size of a chart in pixels; two panels share the height.
pub(crate) const SIZE: (u32, u32) = (1200, 720);
pub(crate) const FONT: &str = "sans-serif";
pub(crate) const AXIS_TEXT: RGBColor = RGBColor(40, 40, 40);
pub(crate) const GRID: RGBColor = RGBColor(222, 222, 222);

pub(crate) const BLUE_LINE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const ORANGE_LINE: RGBColor = RGBColor(213, 94, 0);
pub(crate) const GREEN_LINE: RGBColor = RGBColor(0, 158, 115);
pub(crate) const PURPLE_LINE: RGBColor = RGBColor(170, 68, 153);
pub(crate) const GREY_LINE: RGBColor = RGBColor(140, 140, 140);

/// How a line is drawn.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Stroke {
    Solid,
    Dashed,
}

/// One line of a chart.
pub(crate) struct Line {
    pub(crate) name: String,
    pub(crate) colour: RGBColor,
    pub(crate) stroke: Stroke,
    /// Pixels.
    pub(crate) width: u32,
    pub(crate) points: Vec<(f64, f64)>,
}

/// Where the legend leaves the lines alone.
#[derive(Clone, Copy)]
pub(crate) enum Legend {
    UpperLeft,
    LowerRight,
}

/// One pair of axes and what is drawn in it.
pub(crate) struct Panel {
    pub(crate) title: String,
    pub(crate) y_label: &'static str,
    pub(crate) legend: Legend,
    /// Where the time axis begins and ends (seconds); the whole of the lines when none.
    pub(crate) window: Option<(f64, f64)>,
    pub(crate) lines: Vec<Line>,
}

const X_LABEL: &str = "real time (s)";

/// Draws the panels one above the other to `stem`.svg and `stem`.png.
pub(crate) fn draw(panels: &[Panel], stem: &Path) -> Result<[PathBuf; 2], Failure> {
    embed_font();
    let (svg, png) = (stem.with_extension("svg"), stem.with_extension("png"));
    let failed = |path: &Path, error: String| Failure::chart(path, &error);
    draw_panels(&SVGBackend::new(&svg, SIZE).into_drawing_area(), panels).map_err(|e| failed(&svg, e))?;
    draw_panels(&BitMapBackend::new(&png, SIZE).into_drawing_area(), panels).map_err(|e| failed(&png, e))?;
    Ok([svg, png])
}

/// Makes [`FONT`] known; before anything is drawn.
pub(crate) fn embed_font() {
    static FONT_REGISTERED: Once = Once::new();
    FONT_REGISTERED.call_once(|| {
        // The font is embedded and valid; were it not, drawing would fail and say so.
        let _ = register_font(FONT, FontStyle::Normal, dejavu::sans::regular());
    });
}

fn draw_panels<DB: DrawingBackend>(root: &DrawingArea<DB, Shift>, panels: &[Panel]) -> Result<(), String> {
    root.fill(&WHITE).map_err(|e| e.to_string())?;
    let areas = root.split_evenly((panels.len(), 1));
    for (area, panel) in areas.iter().zip(panels) {
        draw_panel(area, panel).map_err(|e| e.to_string())?;
    }
    root.present().map_err(|e| e.to_string())
}

fn draw_panel<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    panel: &Panel,
) -> Result<(), DrawingAreaErrorKind<DB::ErrorType>> {
    let (x_max, y_max) = extent(&panel.lines);
    let (from, to) = panel.window.unwrap_or((0.0, x_max));
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, (FONT, 24).into_font().color(&BLACK))
        .margin(14)
        .margin_right(30)
        .x_label_area_size(54)
        .y_label_area_size(78)
        .build_cartesian_2d(from..to, 0.0..y_max)?;
    chart
        .configure_mesh()
        .x_desc(X_LABEL)
        .y_desc(panel.y_label)
        .x_labels(13)
        .y_labels(9)
        .x_label_formatter(&|v| tick(*v))
        .y_label_formatter(&|v| tick(*v))
        .label_style((FONT, 17).into_font().color(&AXIS_TEXT))
        .axis_desc_style((FONT, 19).into_font().color(&AXIS_TEXT))
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .axis_style(AXIS_TEXT)
        .draw()?;
    for line in &panel.lines {
        let style = line.colour.stroke_width(line.width);
        let points = line.points.iter().copied().filter(|(x, _)| (from..=to).contains(x));
        match line.stroke {
            Stroke::Solid => chart
                .draw_series(LineSeries::new(points, style))?
                .label(&line.name)
                .legend(move |at| PathElement::new(legend_ends(at), style)),
            Stroke::Dashed => chart
                .draw_series(DashedLineSeries::new(points, 7, 5, style))?
                .label(&line.name)
                .legend(move |at| DashedPathElement::new(legend_ends(at), 7, 5, style)),
        };
    }
    let position = match panel.legend {
        Legend::UpperLeft => SeriesLabelPosition::UpperLeft,
        Legend::LowerRight => SeriesLabelPosition::LowerRight,
    };
    chart
        .configure_series_labels()
        .position(position)
        .margin(12)
        .legend_area_size(40)
        .label_font((FONT, 17).into_font().color(&AXIS_TEXT))
        .background_style(WHITE.mix(0.85))
        .border_style(GRID)
        .draw()
}

/// A short piece of a line for the legend, from where plotters wants it.
fn legend_ends((x, y): (i32, i32)) -> [(i32, i32); 2] {
    [(x, y), (x + 31, y)]
}

/// The axes' ends: the largest values, rounded up so that the last tick has a number; time to a tenth of a second.
fn extent(lines: &[Line]) -> (f64, f64) {
    let points = || lines.iter().flat_map(|line| &line.points);
    let x_max = points().map(|p| p.0).fold(0.0, f64::max);
    let y_max = points().map(|p| p.1).fold(0.0, f64::max);
    (if x_max > 0.0 { (10.0 * x_max).ceil() / 10.0 } else { 1.0 }, round_up(y_max * 1.04))
}

/// The next number up of the form 1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten.
pub(crate) fn round_up(value: f64) -> f64 {
    if value <= 0.0 {
        return 1.0;
    }
    let power = 10_f64.powf(value.log10().floor());
    let steps = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    // Rounding of the logarithm may put `value` a hair above 10 powers: then 10 is near enough.
    let step = steps.into_iter().find(|step| step * power >= value).unwrap_or(10.0);
    step * power
}

/// A number with no more digits than it needs.
pub(crate) fn tick(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_end_at_round_numbers_not_below_the_data() {
        for (value, end) in
            [(0.0, 1.0), (0.031, 0.04), (1.0, 1.0), (33.2, 40.0), (99.0, 100.0), (104.0, 120.0)]
        {
            assert!((round_up(value) - end).abs() < 1e-9, "{value} -> {}", round_up(value));
        }
    }

    #[test]
    fn ticks_carry_no_empty_digits() {
        assert_eq!([tick(0.0), tick(0.5), tick(30.0), tick(0.125)], ["0", "0.5", "30", "0.125"]);
    }
}
