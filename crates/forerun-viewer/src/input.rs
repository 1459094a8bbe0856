//! Input: what the mouse and the keys did since the last picture, as the window tells it.

use three_d::{Event, FrameInput, Viewport};

/// What happened since the last picture. Events that somebody took are marked as handled.
pub struct Input {
    /// In the order in which they came.
    pub events: Vec<Event>,
    /// The whole window, in pixels.
    pub viewport: Viewport,
    /// Pixels per point of the system's unit.
    pub pixels_per_point: f32,
    /// The clock of the window. Seconds.
    pub real_s: f64,
    /// Since the last picture. Seconds.
    pub elapsed_s: f64,
}

impl Input {
    /// Takes what the window collected.
    #[must_use]
    pub fn of(frame: &mut FrameInput) -> Input {
        Input {
            events: std::mem::take(&mut frame.events),
            viewport: frame.viewport,
            pixels_per_point: frame.device_pixel_ratio,
            real_s: frame.accumulated_time * 1e-3,
            elapsed_s: frame.elapsed_time * 1e-3,
        }
    }
}
