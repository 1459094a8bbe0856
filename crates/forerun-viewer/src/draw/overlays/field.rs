//! Field slice: the distance field of a mesh in a horizontal plane of its own frame, as colours, and the mesh cut open there.

use std::sync::Arc;

use forerun::geometry::sdf::Field;
use forerun::geometry::shape::Mesh;
use forerun::{BodyId, Pose, Shape, Vec3};
use three_d::{Context, CpuTexture, Interpolation, Texture2D, TextureData, VertexBuffer, Wrapping};

use super::super::Scenery;
use super::super::eye::Eye;
use super::super::lines::Leaf;
use super::super::programs::Programs;

/// Pixels along an edge of the slice.
const PIXELS: u32 = 192;
/// Room around the mesh, as part of its size.
const ROOM: f32 = 0.18;
/// Lines of equal distance between the surface and the deepest point, about.
const LINES: f32 = 7.0;

const INSIDE: [f32; 3] = [24.0, 96.0, 176.0];
const OUTSIDE: [f32; 3] = [214.0, 112.0, 28.0];
const SURFACE: [f32; 3] = [244.0, 244.0, 240.0];

/// What was drawn last, and of what.
struct Drawn {
    mesh: Arc<Mesh>,
    height: f32,
    image: Texture2D,
}

/// The slice of the selected mesh.
#[derive(Default)]
pub(in super::super) struct FieldSlice {
    body: Option<(BodyId, Pose)>,
    drawn: Option<Drawn>,
}

impl FieldSlice {
    /// Makes the picture of the slice, when it is asked for and the selected body has a field. Who is cut open.
    pub(in super::super) fn prepare(&mut self, context: &Context, scenery: &Scenery<'_>) -> Option<BodyId> {
        self.body = None;
        let overlays = &scenery.view.overlays;
        if !overlays.field {
            self.drawn = None;
            return None;
        }
        let id = scenery.play.selection.active()?;
        let (body, sample) = scenery.play.body(id).zip(scenery.play.sample(id))?;
        let Shape::Mesh(mesh) = &body.shape else { return None };
        let field = mesh.collider().field.as_ref()?;
        let height = overlays.field_height.clamp(0.0, 1.0);
        let same =
            |drawn: &Drawn| Arc::ptr_eq(&drawn.mesh, mesh) && drawn.height.to_bits() == height.to_bits();
        if !self.drawn.as_ref().is_some_and(same) {
            let image = image_of(context, field, mesh, height);
            self.drawn = Some(Drawn { mesh: Arc::clone(mesh), height, image });
        }
        self.body = Some((id, sample.pose));
        Some(id)
    }

    /// The plane above which the mesh is cut off: its normal and its distance from the origin.
    pub(in super::super) fn plane(&self) -> Option<(Vec3, f32)> {
        let ((_, pose), drawn) = self.body.as_ref().zip(self.drawn.as_ref())?;
        let normal = pose.rotation * Vec3::Y;
        let at = pose.transform_point(Vec3::Y * level_of(&drawn.mesh, drawn.height));
        Some((normal, normal.dot(at)))
    }

    /// Draws the slice.
    pub(in super::super) fn draw(&self, programs: &Programs, eye: &Eye, corners: &VertexBuffer<[f32; 2]>) {
        let Some(((_, pose), drawn)) = self.body.as_ref().zip(self.drawn.as_ref()) else { return };
        let (centre, half) = extent_of(&drawn.mesh);
        let middle = Vec3::new(centre.x, level_of(&drawn.mesh, drawn.height), centre.z);
        let leaf = Leaf {
            middle: pose.transform_point(middle),
            along: pose.rotation * (Vec3::X * half),
            beside: pose.rotation * (Vec3::Z * half),
        };
        leaf.draw(programs, eye, corners, &drawn.image);
    }
}

/// The middle of a mesh, and half an edge of a square around it with some room.
fn extent_of(mesh: &Mesh) -> (Vec3, f32) {
    let bounds = mesh.bounds();
    let half = bounds.half_extents();
    (bounds.centre(), (1.0 + ROOM) * half.x.max(half.z))
}

/// Where the slice is in the mesh's own frame. Metres.
fn level_of(mesh: &Mesh, height: f32) -> f32 {
    let bounds = mesh.bounds();
    bounds.min.y + (bounds.max.y - bounds.min.y) * height
}

fn image_of(context: &Context, field: &Field, mesh: &Mesh, height: f32) -> Texture2D {
    let texture = CpuTexture {
        data: TextureData::RgbaU8(pixels_of(field, mesh, height)),
        width: PIXELS,
        height: PIXELS,
        min_filter: Interpolation::Linear,
        mag_filter: Interpolation::Linear,
        wrap_s: Wrapping::ClampToEdge,
        wrap_t: Wrapping::ClampToEdge,
        ..CpuTexture::default()
    };
    Texture2D::new(context, &texture)
}

/// Row by row: x to the right, z up.
fn pixels_of(field: &Field, mesh: &Mesh, height: f32) -> Vec<[u8; 4]> {
    let (centre, half) = extent_of(mesh);
    let level = level_of(mesh, height);
    let side = |k: u32| ((k as f32 + 0.5) / PIXELS as f32 * 2.0 - 1.0) * half;
    let point = |k: u32| Vec3::new(centre.x + side(k % PIXELS), level, centre.z + side(k / PIXELS));
    let distances: Vec<f32> = (0..PIXELS * PIXELS).map(|k| field.distance_and_gradient(point(k)).0).collect();
    let deepest = distances.iter().fold(0.0_f32, |deepest, distance| deepest.max(-distance));
    let scale = deepest.max(0.05 * half);
    distances.iter().map(|distance| colour_of(*distance, scale, 2.0 * half / PIXELS as f32)).collect()
}

/// Blue inside, orange outside, light at the surface, with lines of equal distance; transparent far out. `pixel`: metres.
fn colour_of(distance: f32, scale: f32, pixel: f32) -> [u8; 4] {
    let part = (distance.abs() / scale).clamp(0.0, 1.0).sqrt();
    let full = if distance < 0.0 { INSIDE } else { OUTSIDE };
    let step = scale / LINES;
    let from_line = (distance / step - (distance / step).round()).abs() * step;
    let shade = if from_line < 0.6 * pixel { 0.78 } else { 1.0 };
    let [red, green, blue] = if distance.abs() < 0.9 * pixel {
        [12.0; 3]
    } else {
        [0, 1, 2].map(|k| shade * (SURFACE[k] + (full[k] - SURFACE[k]) * part))
    };
    let opacity = if distance < 0.0 { 1.0 } else { (0.85 - 0.6 * distance / scale).clamp(0.0, 0.85) };
    [red as u8, green as u8, blue as u8, (255.0 * opacity) as u8]
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun::geometry::shape::mesh_make;

    #[test]
    fn the_slice_of_a_ball_is_blue_in_the_middle_and_ends_at_its_radius() {
        let ball = mesh_make::ball(0.5, 12).unwrap();
        let field = ball.collider().field.as_ref().unwrap();
        let pixels = pixels_of(field, &ball, 0.5);
        let at = |x: u32, y: u32| pixels[(y * PIXELS + x) as usize];
        let middle = at(PIXELS / 2, PIXELS / 2);
        assert!(middle[2] > middle[0] && middle[3] == 255, "{middle:?}");
        let corner = at(0, 0);
        assert!(corner[0] > corner[2] && corner[3] < 128, "{corner:?}");
        // The black line of the surface, to the right of the middle.
        let black = (PIXELS / 2..PIXELS).find(|x| at(*x, PIXELS / 2)[..3] == [12; 3]).unwrap();
        let radius = (black as f32 + 0.5 - 0.5 * PIXELS as f32) * 2.0 * extent_of(&ball).1 / PIXELS as f32;
        assert!((radius - 0.5).abs() < 0.02, "{radius}");
    }
}
