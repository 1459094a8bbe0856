//! Shade: bodies on a ground in the sun, seen by a camera.
//!
//! Every picture is taken four times, moved by parts of a pixel, and averaged.

use std::sync::Arc;

use forerun::{Aabb, Pose, Vec3};

use super::canvas::Canvas;
use super::raster::{Corner, clip, cover};
use super::round::round_below;
use super::shadow::Shadow;
use super::{Camera, Facet, TO_SUN};

/// Where in a pixel the four pictures are taken (a turned grid, so that edges near the axes get four steps too).
const OFFSETS: [[f32; 2]; 4] = [[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]];
const SUN: Vec3 = Vec3::new(0.92, 0.88, 0.80);
const FROM_SKY: Vec3 = Vec3::new(0.34, 0.37, 0.42);
const FROM_GROUND: Vec3 = Vec3::new(0.16, 0.15, 0.14);
const ZENITH: Vec3 = Vec3::new(0.36, 0.52, 0.72);
const HORIZON: Vec3 = Vec3::new(0.80, 0.86, 0.92);
const LIGHT_SQUARE: Vec3 = Vec3::new(0.62, 0.62, 0.60);
const DARK_SQUARE: Vec3 = Vec3::new(0.46, 0.47, 0.46);

/// A thing in the picture.
#[derive(Clone)]
pub(crate) struct Item {
    /// In the frame of the thing; equal things share them.
    pub(crate) facets: Arc<[Facet]>,
    pub(crate) pose: Pose,
    /// As it is in the sun.
    pub(crate) colour: Vec3,
}

/// A plane without end: all points below its y axis.
#[derive(Clone, Copy)]
pub(crate) struct Ground {
    pub(crate) pose: Pose,
    /// Edge of a square of its pattern. Metres.
    pub(crate) square: f32,
}

/// What is in a picture.
pub(crate) struct View<'a> {
    pub(crate) camera: Camera,
    pub(crate) items: &'a [Item],
    pub(crate) grounds: &'a [Ground],
    /// What matters; shadows are drawn in and around it.
    pub(crate) seen: Aabb,
}

/// What is nearest in a pixel.
#[derive(Clone, Copy)]
struct Nearest {
    depth: f32,
    normal: Vec3,
    item: u32,
}

/// Takes the picture.
pub(crate) fn draw(view: &View<'_>, width: u32, height: u32) -> Canvas {
    let size = [width as usize, height as usize];
    let shadow = Shadow::of(view.items, &view.seen, TO_SUN);
    let mut sums = vec![Vec3::ZERO; size[0] * size[1]];
    let nothing = Nearest { depth: f32::INFINITY, normal: Vec3::ZERO, item: 0 };
    let mut nearest = vec![nothing; size[0] * size[1]];
    for offset in OFFSETS {
        nearest.fill(nothing);
        fill(view, size, offset, &mut nearest);
        for (i, (sum, nearest)) in sums.iter_mut().zip(&nearest).enumerate() {
            let x = ((i % size[0]) as f32 + offset[0]) / size[0] as f32 * 2.0 - 1.0;
            let y = 1.0 - ((i / size[0]) as f32 + offset[1]) / size[1] as f32 * 2.0;
            *sum += colour_along(view, &shadow, view.camera.ray(x, y), nearest);
        }
    }
    let mut canvas = Canvas::new(width, height);
    for (pixel, sum) in canvas.bytes.as_chunks_mut::<3>().0.iter_mut().zip(&sums) {
        // The square root is nearly what screens expect of light.
        *pixel = (*sum / OFFSETS.len() as f32)
            .to_array()
            .map(|x| (x.clamp(0.0, 1.0).sqrt() * 255.0).round() as u8);
    }
    canvas
}

fn fill(view: &View<'_>, size: [usize; 2], offset: [f32; 2], nearest: &mut [Nearest]) {
    // Pixels are asked for at their middles.
    let shift = [0.5 - offset[0], 0.5 - offset[1]];
    let half = size.map(|n| 0.5 * n as f32);
    for (number, item) in view.items.iter().enumerate() {
        for facet in item.facets.iter() {
            let corner = |i: usize| Corner {
                at: view.camera.project(item.pose.transform_point(facet.corners[i])),
                normal: item.pose.rotation * facet.normals[i],
            };
            clip([corner(0), corner(1), corner(2)], view.camera.near, |triangle| {
                // Straight lines stay straight in 1 / depth.
                let pixels = triangle.map(|Corner { at, .. }| {
                    Vec3::new(
                        half[0] * (1.0 + at.x / at.z) + shift[0],
                        half[1] * (1.0 - at.y / at.z) + shift[1],
                        1.0 / at.z,
                    )
                });
                cover(pixels, size, |index, parts| {
                    let parts = [0, 1, 2].map(|k| parts[k] * pixels[k].z);
                    let sum = parts[0] + parts[1] + parts[2];
                    if 1.0 / sum < nearest[index].depth {
                        let normal = (0..3).map(|k| triangle[k].normal * parts[k]).sum::<Vec3>();
                        nearest[index] = Nearest { depth: 1.0 / sum, normal, item: number as u32 };
                    }
                });
            });
        }
    }
}

/// The light that comes back along a ray, 1 deep.
fn colour_along(view: &View<'_>, shadow: &Shadow, ray: Vec3, nearest: &Nearest) -> Vec3 {
    let eye = view.camera.eye;
    let (mut depth, mut found) = (nearest.depth, None);
    for ground in view.grounds {
        let normal = ground.pose.rotation * Vec3::Y;
        let at = (ground.pose.position - eye).dot(normal) / ray.dot(normal);
        if ray.dot(normal) < 0.0 && at > view.camera.near && at < depth {
            (depth, found) = (at, Some((ground, normal)));
        }
    }
    let point = eye + ray * depth;
    if let Some((ground, normal)) = found {
        let lit = light(normal, shadow.light_at(point, normal)) * squares(view, ground, (point, ray), depth);
        // Into the haze, beyond what matters.
        let far = 6.0 * (view.seen.max - view.seen.min).length() + (eye - view.seen.min).length();
        let haze = depth * depth / (depth * depth + far * far);
        return lit.lerp(HORIZON, haze);
    }
    if depth.is_finite() {
        let normal = nearest.normal.normalize_or(Vec3::Y);
        // Both sides are drawn: open meshes have no other.
        let normal = if normal.dot(ray) > 0.0 { -normal } else { normal };
        let colour = view.items[nearest.item as usize].colour;
        return colour * colour * light(normal, shadow.light_at(point, normal));
    }
    let height = ray.normalize().y.clamp(0.0, 1.0);
    HORIZON.lerp(ZENITH, height.sqrt())
}

/// Light on a surface, of which so much sees the sun.
fn light(normal: Vec3, sunlit: f32) -> Vec3 {
    let sun = SUN * (normal.dot(TO_SUN.normalize()).max(0.0) * sunlit);
    sun + FROM_GROUND.lerp(FROM_SKY, 0.5 + 0.5 * normal.y)
}

/// The colour of the ground's squares, even where they are smaller than a pixel.
fn squares(view: &View<'_>, ground: &Ground, (point, ray): (Vec3, Vec3), depth: f32) -> Vec3 {
    let local = ground.pose.inverse_transform_point(point) / ground.square;
    let odd = (local.x.floor() + local.z.floor()).rem_euclid(2.0) > 0.5;
    let steepness = (ground.pose.rotation * Vec3::Y).dot(ray.normalize()).abs().max(1e-4);
    // A pixel is about a thousandth of the depth.
    let contrast =
        (1.5 - depth * view.camera.half_size[1] * 0.012 / (steepness * ground.square)).clamp(0.0, 1.0);
    let middle = 0.5 * (LIGHT_SQUARE + DARK_SQUARE);
    middle.lerp(if odd { DARK_SQUARE } else { LIGHT_SQUARE }, contrast)
}

/// An edge for squares that suits things of a size: 1, 2 or 5 times a power of ten, about an eighth.
pub(crate) fn square_for(size: f32) -> f32 {
    round_below(size.min(1e6) / 8.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::facets;
    use forerun::Shape;

    #[test]
    fn a_ball_on_a_ground_is_drawn_with_its_shadow() {
        let seen = Aabb { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::new(1.0, 2.0, 1.0) };
        let ball = Item {
            facets: facets(&Shape::sphere(1.0).unwrap()).into(),
            pose: Pose::from_position(Vec3::Y),
            colour: Vec3::new(0.9, 0.1, 0.1),
        };
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let points = corners.iter().flat_map(|[x, z]| [0.0, 2.0].map(|y| Vec3::new(*x, y, *z)));
        let camera = Camera::fitting(points, Vec3::new(0.2, 0.5, 1.0), 1.0);
        let view =
            View { camera, items: &[ball], grounds: &[Ground { pose: Pose::IDENTITY, square: 1.0 }], seen };
        let canvas = draw(&view, 100, 100);
        let pixel_of = |point: Vec3| {
            let at = camera.project(point);
            let (x, y) = (50.0 * (1.0 + at.x / at.z), 50.0 * (1.0 - at.y / at.z));
            let at = (y as usize * 100 + x as usize) * 3;
            [0, 1, 2].map(|k| i32::from(canvas.bytes[at + k]))
        };
        let [red, green, _] = pixel_of(Vec3::Y + Vec3::new(0.2, 0.7, 0.7).normalize());
        assert!(red > 180 && green < 100, "the ball: {red} {green}");
        // Where a ray from the sun through the ball's middle meets the ground, and a place beside it.
        let shaded = Vec3::Y - TO_SUN / TO_SUN.y;
        let brightness = |point| pixel_of(point).iter().sum::<i32>();
        assert!(brightness(Vec3::new(0.9, 0.0, 0.95)) > brightness(shaded) + 60, "the shadow");
        assert!(brightness(Vec3::new(-0.2, 0.0, 1.0)) > 200, "the ground");
    }

    #[test]
    fn squares_are_round_numbers() {
        for (size, expected) in [(8.1, 1.0), (20.0, 2.0), (0.05, 0.005), (1e9, 1e5)] {
            let square = square_for(size);
            assert!((square / expected - 1.0).abs() < 1e-3, "{size}: {square}");
        }
    }
}
