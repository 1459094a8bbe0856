//! Slice: a distance field in three planes through the middle of its mesh, beside the true section of the triangles.

use forerun::Vec3;
use forerun::geometry::sdf::Field;
use forerun::geometry::shape::Mesh;
use plotters::prelude::{BitMapBackend, IntoDrawingArea, IntoFont, Text};
use plotters::style::Color;

use super::canvas::Canvas;
use super::round::round_above;
use crate::charts::{AXIS_TEXT, FONT, embed_font};

/// Pixels along the longest side of the mesh.
const LONGEST: f32 = 520.0;
/// Room around the mesh in its panel. Pixels.
const ROOM: u32 = 40;
/// Height of the text above a panel and below all of them. Pixels.
const CAPTION: u32 = 34;
const LEGEND: u32 = 44;
/// Lines of equal distance between the surface and the farthest point.
const LINES: f32 = 8.0;

const ZERO_LINE: [u8; 3] = [10, 10, 10];
const SECTION: [u8; 3] = [255, 225, 40];
const NO_FIELD: [u8; 3] = [236, 236, 236];
const SURFACE: [f32; 3] = [245.0, 245.0, 245.0];
const INSIDE: [f32; 3] = [20.0, 90.0, 170.0];
const OUTSIDE: [f32; 3] = [205.0, 105.0, 20.0];

/// A plane through a point, and which axes of space go to the right and up in its picture.
struct Plane {
    normal: usize,
    right: usize,
    up: usize,
    at: f32,
}

impl Plane {
    const NAMES: [char; 3] = ['x', 'y', 'z'];

    fn through(point: Vec3) -> [Plane; 3] {
        [(0, 2, 1), (1, 0, 2), (2, 0, 1)].map(|(normal, right, up)| Plane {
            normal,
            right,
            up,
            at: point[normal],
        })
    }

    fn caption(&self) -> String {
        let [normal, right, up] = [self.normal, self.right, self.up].map(|axis| Plane::NAMES[axis]);
        format!("{normal} = {:.4} m   ({right} to the right, {up} up)", self.at)
    }
}

/// What all panels share.
struct Scale {
    metres_per_pixel: f32,
    /// The largest distance in the picture. Metres.
    farthest: f32,
    /// From one line of equal distance to the next. Metres.
    step: f64,
}

/// Draws the slices through `centre`.
pub(crate) fn draw_slices(mesh: &Mesh, centre: Vec3) -> Result<Canvas, String> {
    let bounds = mesh.bounds();
    let extent = bounds.max - bounds.min;
    let metres_per_pixel = extent.max_element() / LONGEST;
    let field = mesh.collider().field.as_ref();
    let deepest = field.map_or(0.0, |field| deepest_of(field, mesh));
    let farthest = deepest.max(metres_per_pixel * ROOM as f32);
    let scale = Scale { metres_per_pixel, farthest, step: round_above(farthest / LINES) };
    let planes = Plane::through(centre);
    let panels: Vec<Canvas> = planes.iter().map(|plane| draw_panel(mesh, plane, &scale)).collect();
    let width = panels.iter().map(|panel| panel.width).sum::<u32>();
    let height = panels.iter().map(|panel| panel.height).max().unwrap_or(0) + CAPTION + LEGEND;
    let mut canvas = Canvas::new(width.max(900), height);
    let mut texts = Vec::new();
    let mut left = 0;
    for (panel, plane) in panels.iter().zip(&planes) {
        canvas.paste(panel, left, CAPTION);
        texts.push((plane.caption(), left + 8, 8));
        left += panel.width;
    }
    let legend = match field {
        Some(field) => format!(
            "blue: inside, orange: outside; a line every {} m; black: zero of the field, yellow: the triangles; cells of {:.4e} m",
            scale.step,
            field.cell()
        ),
        None => "no field: the mesh has no inside; yellow: the triangles".to_owned(),
    };
    texts.push((legend, 8, height - LEGEND + 12));
    write_texts(&mut canvas, &texts)?;
    Ok(canvas)
}

/// The largest distance inside, at the nodes of a coarse grid. Metres.
fn deepest_of(field: &Field, mesh: &Mesh) -> f32 {
    let bounds = mesh.bounds();
    let side = |k: i32| Vec3::splat((k as f32 + 0.5) / 24.0);
    let mut deepest = 0.0_f32;
    for (x, y, z) in (0..24 * 24 * 24).map(|k| (k % 24, k / 24 % 24, k / 576)) {
        let part = Vec3::new(side(x).x, side(y).x, side(z).x);
        let (distance, _) = field.distance_and_gradient(bounds.min + (bounds.max - bounds.min) * part);
        deepest = deepest.max(-distance);
    }
    deepest
}

fn draw_panel(mesh: &Mesh, plane: &Plane, scale: &Scale) -> Canvas {
    let bounds = mesh.bounds();
    let pixels = |axis: usize| {
        ((bounds.max[axis] - bounds.min[axis]) / scale.metres_per_pixel).ceil() as u32 + 2 * ROOM
    };
    let (width, height) = (pixels(plane.right), pixels(plane.up));
    let mut canvas = Canvas::new(width, height);
    canvas.bytes.as_chunks_mut::<3>().0.fill(NO_FIELD);
    let to_pixel = |point: Vec3| {
        let right = (point[plane.right] - bounds.min[plane.right]) / scale.metres_per_pixel + ROOM as f32;
        let up = (point[plane.up] - bounds.min[plane.up]) / scale.metres_per_pixel + ROOM as f32;
        [right, height as f32 - up]
    };
    if let Some(field) = &mesh.collider().field {
        let distance = |x: u32, y: u32| {
            let mut point = Vec3::ZERO;
            point[plane.normal] = plane.at;
            let along = |pixel: f32| (pixel - ROOM as f32) * scale.metres_per_pixel;
            point[plane.right] = bounds.min[plane.right] + along(x as f32 + 0.5);
            point[plane.up] = bounds.min[plane.up] + along(height as f32 - y as f32 - 0.5);
            field.distance_and_gradient(point).0
        };
        draw_field(&mut canvas, scale, distance);
    }
    for t in 0..mesh.triangles.len() {
        if let Some([from, to]) = cut(mesh.corners(t), plane) {
            draw_line(&mut canvas, to_pixel(from), to_pixel(to));
        }
    }
    canvas
}

fn draw_field(canvas: &mut Canvas, scale: &Scale, distance: impl Fn(u32, u32) -> f32) {
    let (width, height) = (canvas.width, canvas.height);
    let rows: Vec<Vec<f32>> = (0..height).map(|y| (0..width).map(|x| distance(x, y)).collect()).collect();
    let lines_below = |distance: f32| (f64::from(distance) / scale.step).floor();
    for y in 0..height {
        for x in 0..width {
            let here = rows[y as usize][x as usize];
            let around = [(1, 0), (0, 1), (-1, 0), (0, -1)].iter().filter_map(|(dx, dy)| {
                rows.get(y.checked_add_signed(*dy)? as usize)?.get(x.checked_add_signed(*dx)? as usize)
            });
            let (mut zero, mut line) = (false, false);
            for other in around {
                zero |= (*other < 0.0) != (here < 0.0);
                line |= lines_below(*other) < lines_below(here);
            }
            let full = if here < 0.0 { INSIDE } else { OUTSIDE };
            let part = (here.abs() / scale.farthest).clamp(0.0, 1.0).sqrt();
            let shade = if line { 0.8 } else { 1.0 };
            let mixed = [0, 1, 2].map(|k| (shade * (SURFACE[k] + (full[k] - SURFACE[k]) * part)) as u8);
            canvas.set(x, y, if zero { ZERO_LINE } else { mixed });
        }
    }
}

/// Where a triangle meets the plane.
fn cut(corners: [Vec3; 3], plane: &Plane) -> Option<[Vec3; 2]> {
    let heights = corners.map(|corner| corner[plane.normal] - plane.at);
    let crossings: Vec<Vec3> = (0..3)
        .filter_map(|i| {
            let (a, b) = (heights[i], heights[(i + 1) % 3]);
            ((a < 0.0) != (b < 0.0)).then(|| corners[i].lerp(corners[(i + 1) % 3], a / (a - b)))
        })
        .collect();
    crossings.try_into().ok()
}

fn draw_line(canvas: &mut Canvas, from: [f32; 2], to: [f32; 2]) {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let steps = (dx.abs().max(dy.abs()).ceil().max(1.0)) as u32;
    for i in 0..=steps {
        let part = i as f32 / steps as f32;
        canvas.set((from[0] + dx * part) as u32, (from[1] + dy * part) as u32, SECTION);
    }
}

fn write_texts(canvas: &mut Canvas, texts: &[(String, u32, u32)]) -> Result<(), String> {
    embed_font();
    let size = (canvas.width, canvas.height);
    let area = BitMapBackend::with_buffer(&mut canvas.bytes, size).into_drawing_area();
    for (text, x, y) in texts {
        let style = (FONT, 17).into_font().color(&AXIS_TEXT.to_rgba());
        area.draw(&Text::new(text.as_str(), (*x as i32, *y as i32), style)).map_err(|e| e.to_string())?;
    }
    area.present().map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun::geometry::shape::mesh_make;

    #[test]
    fn the_slice_of_a_ball_is_a_circle_blue_inside() {
        let ball = mesh_make::ball(0.5, 8).unwrap();
        let canvas = draw_slices(&ball, Vec3::ZERO).unwrap();
        let pixel = |x: u32, y: u32| {
            let at = (y as usize * canvas.width as usize + x as usize) * 3;
            [canvas.bytes[at], canvas.bytes[at + 1], canvas.bytes[at + 2]]
        };
        let panel = canvas.width / 3;
        let middle_y = CAPTION + (canvas.height - CAPTION - LEGEND) / 2;
        for k in 0..3 {
            let middle = k * panel + panel / 2;
            let [red, _, blue] = pixel(middle, middle_y);
            assert!(blue > red, "the middle is inside");
            let [red, _, blue] = pixel(k * panel + 2, middle_y);
            assert!(red > blue, "the edge of the picture is outside");
            // From the middle to the right: the section after the radius.
            let section = (middle..(k + 1) * panel).find(|x| pixel(*x, middle_y) == SECTION).unwrap();
            assert!((section - middle).abs_diff(LONGEST as u32 / 2) <= 3, "{}", section - middle);
        }
    }
}
