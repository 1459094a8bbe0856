//! Figures: the dissertation's two kinds of chart, states in the queue and time against time.

use forerun::QueueRow;
use plotters::style::RGBColor;

use crate::charts::{
    BLUE_LINE, GREEN_LINE, GREY_LINE, Legend, Line, ORANGE_LINE, PURPLE_LINE, Panel, Stroke,
};

/// Length of a close look. Seconds.
const ZOOM_S: f64 = 0.5;
/// Width of a line that others may lie on. Pixels.
const WIDE: u32 = 4;

/// A recorded playback and what the legend calls it.
#[derive(Clone, Copy)]
pub(crate) struct Recorded<'a> {
    pub(crate) label: &'a str,
    pub(crate) rows: &'a [QueueRow],
}

/// States in the queue at every picture (figures 5.2, 5.5, 5.8, 5.12).
pub(crate) fn queue(title: &str, decoupled: &[QueueRow]) -> Panel {
    let apart = decoupled.iter().any(|row| row.queue_low != row.queue_max);
    let most = line("most states of a body", BLUE_LINE, decoupled, |row| f64::from(row.queue_max));
    let mut lines = vec![most];
    if apart {
        lines[0].width = WIDE;
        let fewest = line("fewest states of a body", ORANGE_LINE, decoupled, |row| f64::from(row.queue_low));
        lines.push(Line { width: 2, ..fewest });
    } else {
        "states of every body".clone_into(&mut lines[0].name);
    }
    Panel {
        title: title.to_owned(),
        y_label: "states ahead of the display",
        legend: Legend::LowerRight,
        window: None,
        lines,
    }
}

/// The half second around the picture with the fewest states, the start left out.
pub(crate) fn queue_at_lowest(title: &str, decoupled: &[QueueRow]) -> Panel {
    let later = decoupled.iter().filter(|row| row.time_real_s > ZOOM_S);
    let lowest = later.min_by_key(|row| row.queue_low).map_or(ZOOM_S, |row| row.time_real_s);
    Panel { window: Some((lowest - 0.5 * ZOOM_S, lowest + 0.5 * ZOOM_S)), ..queue(title, decoupled) }
}

/// Display time and physics time against real time (figures 5.3, 5.6, 5.9, 5.13).
pub(crate) fn times(title: &str, decoupled: Recorded, coupled: Option<Recorded>) -> Panel {
    let rows = decoupled.rows;
    let display = format!("display, {}", decoupled.label);
    let mut lines = vec![
        line(&format!("physics, {}", decoupled.label), BLUE_LINE, rows, |row| row.time_physics_low_s),
        Line { width: WIDE, ..line(&display, GREEN_LINE, rows, |row| row.time_display_s) },
    ];
    if let Some(coupled) = coupled {
        let name = format!("physics = display, {}", coupled.label);
        lines.push(line(&name, ORANGE_LINE, coupled.rows, |row| row.time_display_s));
    }
    let real = line("real time", GREY_LINE, rows, |row| row.time_real_s);
    lines.push(Line { stroke: Stroke::Dashed, ..real });
    Panel {
        title: title.to_owned(),
        y_label: "simulated time (s)",
        legend: Legend::UpperLeft,
        window: None,
        lines,
    }
}

/// The time step of the displayed frame (figure 5.13).
pub(crate) fn time_steps(title: &str, recorded: &[Recorded]) -> Panel {
    const COLOURS: [RGBColor; 3] = [BLUE_LINE, PURPLE_LINE, ORANGE_LINE];
    let lines = recorded.iter().zip(COLOURS.into_iter().cycle()).map(|(one, colour)| {
        // The first picture shows the initial states, which no step has made.
        let rows = one.rows.get(1..).unwrap_or_default();
        Line { width: WIDE, ..line(one.label, colour, rows, |row| 1000.0 * row.time_step_s) }
    });
    let mut lines: Vec<Line> = lines.collect();
    // Only the first lies under others.
    lines.iter_mut().skip(1).for_each(|line| line.width = 2);
    Panel {
        title: title.to_owned(),
        y_label: "time step (ms)",
        legend: Legend::LowerRight,
        window: None,
        lines,
    }
}

fn line(name: &str, colour: RGBColor, rows: &[QueueRow], value: impl Fn(&QueueRow) -> f64) -> Line {
    let points = rows.iter().map(|row| (row.time_real_s, value(row))).collect();
    Line { name: name.to_owned(), colour, stroke: Stroke::Solid, width: 2, points }
}
