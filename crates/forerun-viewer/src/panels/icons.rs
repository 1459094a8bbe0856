//! Icons of buttons, painted: fonts have them or have not.

use three_d::egui::{
    self, Color32, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, pos2, vec2,
};

use crate::actions::Action;

/// What a button shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Icon {
    /// A triangle.
    Play,
    /// Two bars.
    Pause,
    /// A triangle that points back.
    PlayBack,
    /// A bar and a triangle.
    StepForward,
    /// A triangle back and a bar.
    StepBack,
    /// Two triangles and a bar.
    ToEnd,
    /// A bar and two triangles back.
    ToStart,
    /// A disc.
    Record,
    /// A square.
    Stop,
    /// A camera.
    Camera,
}

/// How large a button with an icon is. Points.
const SIDE: f32 = 24.0;

/// A button with an icon; its tooltip tells what it does and by which keys.
pub(super) fn button(ui: &mut Ui, icon: Icon, action: Action, on: bool, tip: &str) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(SIDE), Sense::click());
    let visuals = ui.style().interact_selectable(&response, on);
    if on || response.hovered() || response.has_focus() {
        ui.painter().rect(
            rect,
            visuals.corner_radius,
            visuals.bg_fill,
            visuals.bg_stroke,
            egui::StrokeKind::Inside,
        );
    }
    paint(ui.painter(), icon, rect.shrink(6.0), visuals.fg_stroke.color);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Button, true, tip));
    response.on_hover_text(tip_of(action, tip))
}

/// A tooltip with the keys behind it.
pub(super) fn tip_of(action: Action, tip: &str) -> String {
    match action.keys() {
        Some(keys) => format!("{tip}  ({keys})"),
        None => tip.to_owned(),
    }
}

/// Paints an icon into a square.
pub(super) fn paint(painter: &Painter, icon: Icon, rect: Rect, colour: Color32) {
    let at = |x: f32, y: f32| pos2(rect.left() + x * rect.width(), rect.top() + y * rect.height());
    let triangle =
        |from: f32, to: f32| solid(painter, vec![at(from, 0.0), at(to, 0.5), at(from, 1.0)], colour);
    let bar = |x: f32| {
        let bar = Rect::from_min_max(at(x - 0.09, 0.0), at(x + 0.09, 1.0));
        painter.rect_filled(bar, 1.0, colour);
    };
    match icon {
        Icon::Play => triangle(0.1, 0.95),
        Icon::PlayBack => triangle(0.9, 0.05),
        Icon::Pause => {
            bar(0.28);
            bar(0.72);
        }
        Icon::StepForward => {
            bar(0.12);
            triangle(0.34, 0.95);
        }
        Icon::StepBack => {
            bar(0.88);
            triangle(0.66, 0.05);
        }
        Icon::ToEnd => {
            triangle(0.0, 0.42);
            triangle(0.42, 0.84);
            bar(0.92);
        }
        Icon::ToStart => {
            triangle(1.0, 0.58);
            triangle(0.58, 0.16);
            bar(0.08);
        }
        Icon::Record => drop(painter.circle_filled(rect.center(), 0.45 * rect.width(), colour)),
        Icon::Stop => drop(painter.rect_filled(rect.shrink(1.0), 1.0, colour)),
        Icon::Camera => {
            let body = Rect::from_min_max(at(0.0, 0.22), at(1.0, 0.95));
            painter.rect_stroke(body, 2.0, Stroke::new(1.4, colour), egui::StrokeKind::Inside);
            painter.rect_filled(Rect::from_min_max(at(0.32, 0.06), at(0.68, 0.24)), 1.0, colour);
            painter.circle_stroke(at(0.5, 0.58), 0.2 * rect.width(), Stroke::new(1.4, colour));
        }
    }
}

fn solid(painter: &Painter, points: Vec<Pos2>, colour: Color32) {
    painter.add(Shape::convex_polygon(points, colour, Stroke::NONE));
}

/// A small triangle that points down to a place: marks and the head of the playhead.
pub(super) fn pointer(painter: &Painter, tip: Pos2, half: f32, colour: Color32) {
    let up = vec2(0.0, -1.5 * half);
    solid(painter, vec![tip + up - vec2(half, 0.0), tip + up + vec2(half, 0.0), tip], colour);
}
