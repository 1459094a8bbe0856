//! Chart: where a step's time goes: a bar a scene, a piece of it a stage.
//!
//! Lengths are nanoseconds for a body and a step, so that scenes of all sizes can be compared; the whole step's milliseconds stand beside the name.

use std::path::{Path, PathBuf};

use forerun::dynamics::Stage;
use plotters::coord::Shift;
use plotters::prelude::*;

use crate::bench::Measurement;
use crate::charts::{
    AXIS_TEXT, BLUE_LINE, FONT, GREEN_LINE, GREY_LINE, GRID, ORANGE_LINE, PURPLE_LINE, SIZE, embed_font,
    round_up, tick,
};
use crate::failure::Failure;

/// How much longer than the longest bar the axis is, so that the legend hides none.
const LEGEND_ROOM: f64 = 1.3;
const YELLOW: RGBColor = RGBColor(230, 190, 40);

/// Colour and name of each stage, in the order of the stages.
const PIECES: [(RGBColor, &str); Stage::ALL.len()] = [
    (BLUE_LINE, "collisions"),
    (YELLOW, "velocities"),
    (GREEN_LINE, "contact graph"),
    (ORANGE_LINE, "contacts"),
    (GREY_LINE, "shock propagation"),
    (PURPLE_LINE, "positions"),
];

/// Draws the bars to `file` with the endings svg and png.
pub(crate) fn draw_stages(measured: &[Measurement], file: &Path) -> Result<[PathBuf; 2], Failure> {
    embed_font();
    let (svg, png) = (file.with_extension("svg"), file.with_extension("png"));
    let bars: Vec<Bar> = measured.iter().map(Bar::of).collect();
    let failed = |path: &Path, error: String| Failure::chart(path, &error);
    draw_bars(&SVGBackend::new(&svg, SIZE).into_drawing_area(), &bars)
        .map_err(|error| failed(&svg, error.to_string()))?;
    draw_bars(&BitMapBackend::new(&png, SIZE).into_drawing_area(), &bars)
        .map_err(|error| failed(&png, error.to_string()))?;
    Ok([svg, png])
}

struct Bar {
    name: String,
    /// Nanoseconds for a body and a step, in the order of the stages.
    pieces: [f64; Stage::ALL.len()],
}

impl Bar {
    fn of(measurement: &Measurement) -> Self {
        let Measurement { scene, step_ms, bodies, .. } = measurement;
        let bodies = (*bodies).max(1) as f64;
        Bar {
            name: format!("{scene}, {:.3} ms", step_ms.mean),
            pieces: measurement.stage_ms.in_order().map(|ms| 1e6 * ms / bodies),
        }
    }

    fn length(&self) -> f64 {
        self.pieces.iter().sum()
    }
}

fn draw_bars<DB: DrawingBackend>(
    root: &DrawingArea<DB, Shift>,
    bars: &[Bar],
) -> Result<(), DrawingAreaErrorKind<DB::ErrorType>> {
    root.fill(&WHITE)?;
    let longest = bars.iter().map(Bar::length).fold(0.0, f64::max);
    let mut chart = ChartBuilder::on(root)
        .caption("Where the time of a step goes", (FONT, 24).into_font().color(&BLACK))
        .margin(14)
        .margin_right(30)
        .x_label_area_size(54)
        .y_label_area_size(220)
        .build_cartesian_2d(0.0..round_up(LEGEND_ROOM * longest), (0..bars.len()).into_segmented())?;
    let name = |place: &SegmentValue<usize>| match place {
        // The first scene on top.
        SegmentValue::CenterOf(i) => {
            bars.iter().rev().nth(*i).map_or_else(String::new, |bar| bar.name.clone())
        }
        _ => String::new(),
    };
    chart
        .configure_mesh()
        .disable_y_mesh()
        .x_desc("CPU time for a body and a step (ns)")
        .x_label_formatter(&|x| tick(*x))
        .y_labels(bars.len())
        .y_label_formatter(&name)
        .label_style((FONT, 17).into_font().color(&AXIS_TEXT))
        .axis_desc_style((FONT, 19).into_font().color(&AXIS_TEXT))
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .axis_style(AXIS_TEXT)
        .draw()?;
    for (stage, (colour, name)) in PIECES.iter().enumerate() {
        let piece = |(i, bar): (usize, &Bar)| {
            let from: f64 = bar.pieces[..stage].iter().sum();
            let ends =
                [(from, SegmentValue::Exact(i)), (from + bar.pieces[stage], SegmentValue::Exact(i + 1))];
            let mut rectangle = Rectangle::new(ends, colour.filled());
            rectangle.set_margin(8, 8, 0, 0);
            rectangle
        };
        chart
            .draw_series(bars.iter().rev().enumerate().map(piece))?
            .label(*name)
            .legend(move |(x, y)| Rectangle::new([(x, y - 7), (x + 31, y + 7)], colour.filled()));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::MiddleRight)
        .margin(12)
        .legend_area_size(40)
        .label_font((FONT, 17).into_font().color(&AXIS_TEXT))
        .background_style(WHITE.mix(0.85))
        .border_style(GRID)
        .draw()?;
    root.present()
}
