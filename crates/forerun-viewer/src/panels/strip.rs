//! The timeline strip: what is kept and what is known, from the oldest frame to the horizon, and display time to be dragged.

mod marks;
mod scale;

use three_d::egui::{
    self, Align2, CursorIcon, FontId, PointerButton, Rect, Response, Sense, Shape, Stroke, Ui, pos2, vec2,
};

use self::marks::Mark;
use self::scale::{Kept, Scale, Zoom};
use super::icons;
use super::palette::Palette;
use crate::report::StripPlace;
use crate::session::Play;

/// Height of the strip. Points.
const HEIGHT: f32 = 50.0;
/// Of it, the ruler.
const RULER: f32 = 16.0;
/// Of it, marks of edits.
const MARKS: f32 = 9.0;
/// How much a step of the wheel zooms, a point.
const WHEEL: f64 = 0.005;

/// The strip between pictures.
#[derive(Debug, Default)]
pub(super) struct Strip {
    zoom: Zoom,
    /// The scene that it belongs to.
    scene: u64,
}

/// Where things are painted.
struct Lanes {
    ruler: Rect,
    marks: Rect,
    track: Rect,
}

impl Strip {
    pub(super) fn show(&mut self, ui: &mut Ui, play: &mut Play, scene: u64, palette: &Palette) -> StripPlace {
        if self.scene != scene {
            *self = Strip { scene, ..Strip::default() };
        }
        let size = vec2(ui.available_width(), HEIGHT);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        let kept = kept(play);
        if !play.paused {
            self.zoom.follow(kept);
        }
        let x = rect.shrink2(vec2(8.0, 0.0)).x_range();
        self.take_wheel(ui, &response, kept, self.zoom.scale(kept, x));
        let scale = self.zoom.scale(kept, x);
        let lanes = Lanes {
            ruler: Rect::from_min_max(rect.min, pos2(rect.right(), rect.top() + RULER)),
            marks: Rect::from_min_max(
                pos2(rect.left(), rect.top() + RULER),
                pos2(rect.right(), rect.top() + RULER + MARKS),
            ),
            track: Rect::from_min_max(pos2(rect.left(), rect.top() + RULER + MARKS), rect.max),
        };
        let marks = marks::marks(play, |time_s| scale.x_of(time_s));
        let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
        paint_ruler(&painter, &lanes, &scale, palette);
        paint_track(&painter, &lanes, play, &scale, palette);
        paint_marks(&painter, &lanes, &marks, palette);
        self.drag(&response, play, &scale);
        let shown_s = play.picture.time_s;
        paint_playhead(&painter, rect, scale.x_of(shown_s), palette);
        explain(ui, response, &marks, &scale, play);
        let [left, top] = [x.min, rect.top()];
        StripPlace { rect: [left, top, x.span(), rect.height()], from_s: scale.start_s, to_s: scale.end_s }
    }

    /// The wheel zooms, the right or middle button moves what is shown, two clicks show all.
    fn take_wheel(&mut self, ui: &Ui, response: &Response, kept: Kept, scale: Scale) {
        if let Some(at) = response.hover_pos() {
            let turned = ui.input(|input| f64::from(input.smooth_scroll_delta.y));
            if turned != 0.0 {
                self.zoom.zoom((turned * WHEEL).exp(), scale.time_of(at.x), kept);
            }
        }
        if response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle) {
            let by_s = scale.time_of(0.0) - scale.time_of(response.drag_delta().x);
            self.zoom.pan(by_s, kept);
        }
        if response.double_clicked_by(PointerButton::Secondary)
            || response.double_clicked_by(PointerButton::Middle)
        {
            self.zoom.reset();
        }
    }

    /// Display time follows the pointer while the left button is down.
    fn drag(&self, response: &Response, play: &mut Play, scale: &Scale) {
        let pressed = response.dragged_by(PointerButton::Primary)
            || response.clicked()
            || (response.is_pointer_button_down_on()
                && response.ctx.input(|input| input.pointer.primary_down()));
        if let Some(at) = response.interact_pointer_pos()
            && pressed
        {
            play.seek(scale.time_of(at.x));
        }
    }
}

fn kept(play: &Play) -> Kept {
    let snapshot = &play.picture.snapshot;
    let seconds = snapshot.frame_seconds();
    Kept {
        oldest_s: snapshot.oldest().seconds(seconds),
        horizon_s: snapshot.horizon().seconds(seconds),
        shown_s: play.picture.time_s,
    }
}

fn paint_ruler(painter: &egui::Painter, lanes: &Lanes, scale: &Scale, palette: &Palette) {
    let (ticks, decimals) = scale.ticks(70.0);
    for time_s in ticks {
        let x = scale.x_of(time_s);
        let foot = pos2(x, lanes.ruler.bottom());
        painter.line_segment([foot - vec2(0.0, 4.0), foot], Stroke::new(1.0, palette.ruler));
        let text = format!("{time_s:.decimals$} s");
        painter.text(
            foot - vec2(0.0, 4.0),
            Align2::CENTER_BOTTOM,
            text,
            FontId::proportional(10.5),
            palette.ruler,
        );
    }
}

fn paint_track(painter: &egui::Painter, lanes: &Lanes, play: &Play, scale: &Scale, palette: &Palette) {
    let snapshot = &play.picture.snapshot;
    let frame_s = play.frame_seconds();
    let shown_s = play.picture.time_s;
    let track = lanes.track.shrink2(vec2(0.0, 1.0));
    painter.rect_filled(track, 3.0, palette.trough);
    let kept = kept(play);
    let bar = |from_s: f64, to_s: f64, part: [f32; 2], colour| {
        let [top, bottom] = part.map(|part| track.top() + part * track.height());
        let [left, right] = [from_s, to_s].map(|time_s| scale.x_of(time_s));
        if right > left {
            painter.rect_filled(Rect::from_min_max(pos2(left, top), pos2(right, bottom)), 0.0, colour);
        }
    };
    bar(kept.oldest_s, shown_s.min(kept.horizon_s), [0.0, 1.0], palette.past);
    let shown_frame_s = play.picture.frame.seconds(snapshot.frame_seconds());
    let ahead = |frames: u64| (shown_frame_s + frames as f64 * frame_s).max(shown_s);
    bar(shown_s, ahead(snapshot.queue_max(shown_s)), [0.0, 0.5], palette.most);
    bar(shown_s, ahead(snapshot.queue_min(shown_s)), [0.5, 1.0], palette.fewest);
    let valid_s = snapshot.valid_to().seconds(snapshot.frame_seconds());
    if valid_s < kept.horizon_s {
        bar(valid_s, kept.horizon_s, [0.5, 1.0], palette.stale.gamma_multiply(0.35));
        let [left, right] = [valid_s, kept.horizon_s].map(|time_s| scale.x_of(time_s));
        let lower = Rect::from_min_max(pos2(left, track.center().y), pos2(right, track.bottom()));
        hatch(painter, lower, palette);
    }
}

/// Slanted lines: seen without seeing colours.
fn hatch(painter: &egui::Painter, rect: Rect, palette: &Palette) {
    let painter = painter.with_clip_rect(rect.intersect(painter.clip_rect()));
    let rect = rect.intersect(painter.clip_rect());
    let count = (rect.width().max(0.0) / 6.0).ceil() as u32 + 3;
    for i in 0..count.min(2000) {
        let x = rect.left() + 6.0 * i as f32 - rect.height();
        let line = [pos2(x, rect.bottom()), pos2(x + rect.height(), rect.top())];
        painter.line_segment(line, Stroke::new(1.5, palette.stale));
    }
}

fn paint_marks(painter: &egui::Painter, lanes: &Lanes, marks: &[Mark], palette: &Palette) {
    for mark in marks {
        icons::pointer(painter, pos2(mark.x, lanes.marks.bottom()), 4.0, palette.mark);
    }
}

fn paint_playhead(painter: &egui::Painter, rect: Rect, x: f32, palette: &Palette) {
    painter.line_segment(
        [pos2(x, rect.top() + RULER), pos2(x, rect.bottom())],
        Stroke::new(2.0, palette.playhead),
    );
    let top = rect.top() + RULER - 3.0;
    let head = vec![
        pos2(x - 5.0, top),
        pos2(x + 5.0, top),
        pos2(x + 5.0, top + 5.0),
        pos2(x, top + 11.0),
        pos2(x - 5.0, top + 5.0),
    ];
    painter.add(Shape::convex_polygon(head, palette.playhead, Stroke::new(1.0, palette.trough)));
}

/// What is under the pointer, in words.
fn explain(ui: &Ui, response: Response, marks: &[Mark], scale: &Scale, play: &Play) {
    let Some(at) = response.hover_pos() else { return };
    ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    if response.dragged() {
        return;
    }
    let time_s = scale.time_of(at.x);
    let near = marks.iter().find(|mark| (mark.x - at.x).abs() < 5.0);
    response.on_hover_ui_at_pointer(|ui| match near {
        Some(mark) => {
            mark.lines.iter().for_each(|line| drop(ui.label(line)));
            if mark.more > 0 {
                ui.weak(format!("and {} more", mark.more));
            }
        }
        None => {
            let snapshot = &play.picture.snapshot;
            let kept = kept(play);
            let valid_s = snapshot.valid_to().seconds(snapshot.frame_seconds());
            let state = match time_s {
                t if t < kept.oldest_s => "not kept any more",
                t if t > kept.horizon_s => "not computed yet",
                t if t > valid_s => "out of date, being computed again",
                t if t > kept.shown_s => "computed ahead",
                _ => "past",
            };
            ui.label(format!("{time_s:.3} s: {state}"));
            let frames = (snapshot.queue_min(kept.shown_s), snapshot.queue_max(kept.shown_s));
            ui.weak(format!(
                "Ahead of the picture: at least {} (red), at most {} frames (blue)",
                frames.0, frames.1
            ));
            ui.weak("Drag: time.  Wheel: zoom.  Right button: move, twice: all");
        }
    });
}
