//! Lines: strokes, dots, arrows and boxes, as wide as so many pixels wherever they are.

use forerun::{Aabb, Vec3};
use three_d::{Context, DepthTest, InstanceBuffer, RenderStates, VertexBuffer};

use super::convert::vector;
use super::eye::Eye;
use super::programs::{CLEAR, Programs};

/// Along the stroke from 0 to 1, and across it from -1 to 1.
const CORNERS: [[f32; 2]; 6] = [[0.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.0, -1.0], [1.0, 1.0], [0.0, 1.0]];
/// How much is seen of a stroke that is behind something.
const BEHIND: f32 = 0.35;
/// The head of an arrow, as part of its length.
const HEAD: f32 = 0.3;

/// Red, green, blue, opacity.
pub(super) type Ink = [u8; 4];

/// Strokes to be drawn. Keeps its memory from picture to picture.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// Where each begins and ends, and its widths there in points.
    starts: Vec<[f32; 4]>,
    ends: Vec<[f32; 4]>,
    inks: Vec<Ink>,
}

impl Lines {
    pub(super) fn clear(&mut self) {
        self.starts.clear();
        self.ends.clear();
        self.inks.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.inks.is_empty()
    }

    /// From one point to another.
    pub(super) fn line(&mut self, [from, to]: [Vec3; 2], width: f32, ink: Ink) {
        self.stroke([from, to], [width, width], ink);
    }

    /// As wide at its ends as said.
    fn stroke(&mut self, [from, to]: [Vec3; 2], [first, last]: [f32; 2], ink: Ink) {
        if from.is_finite() && to.is_finite() {
            self.starts.push([from.x, from.y, from.z, first]);
            self.ends.push([to.x, to.y, to.z, last]);
            self.inks.push(ink);
        }
    }

    /// A round dot.
    pub(super) fn dot(&mut self, at: Vec3, width: f32, ink: Ink) {
        self.line([at, at], width, ink);
    }

    /// With a head at its end.
    pub(super) fn arrow(&mut self, [from, to]: [Vec3; 2], width: f32, ink: Ink) {
        let neck = to.lerp(from, HEAD);
        self.line([from, neck], width, ink);
        self.stroke([neck, to], [4.0 * width, 0.0], ink);
    }

    /// Through points; `ink` says the colour of each part, from 0 at the first point to 1 at the last.
    pub(super) fn path(&mut self, points: &[Vec3], width: f32, ink: impl Fn(f32) -> Ink) {
        let parts = points.len().saturating_sub(1).max(1) as f32;
        for (i, pair) in points.windows(2).enumerate() {
            self.line([pair[0], pair[1]], width, ink(i as f32 / parts));
        }
    }

    /// The edges of a box.
    pub(super) fn boxed(&mut self, bounds: &Aabb, width: f32, ink: Ink) {
        let corner = |k: usize| {
            let pick = |axis: usize| if k >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        };
        for k in 0..8 {
            for axis in [1, 2, 4] {
                if k & axis == 0 {
                    self.line([corner(k), corner(k | axis)], width, ink);
                }
            }
        }
    }
}

/// What draws them.
pub(super) struct LineDrawer {
    corners: VertexBuffer<[f32; 2]>,
    starts: InstanceBuffer<[f32; 4]>,
    ends: InstanceBuffer<[f32; 4]>,
    inks: InstanceBuffer<Ink>,
}

impl LineDrawer {
    pub(super) fn new(context: &Context) -> LineDrawer {
        LineDrawer {
            corners: VertexBuffer::new_with_data(context, &CORNERS),
            starts: InstanceBuffer::new(context),
            ends: InstanceBuffer::new(context),
            inks: InstanceBuffer::new(context),
        }
    }

    /// Draws all strokes, faintly where they are behind something.
    pub(super) fn draw(&mut self, programs: &Programs, eye: &Eye, lines: &mut Lines) {
        if lines.is_empty() {
            return;
        }
        let scale = eye.pixels_per_point();
        for end in lines.starts.iter_mut().chain(&mut lines.ends) {
            end[3] *= scale;
        }
        self.starts.fill(&lines.starts);
        self.ends.fill(&lines.ends);
        self.inks.fill(&lines.inks);
        let program = &programs.line;
        let size = eye.viewport;
        program.use_uniform("viewProjection", eye.view_projection);
        program.use_uniform("viewport", three_d::vec2(size.width as f32, size.height as f32));
        program.use_uniform("near", eye.near);
        for (depth_test, opacity) in [(DepthTest::Greater, BEHIND), (DepthTest::LessOrEqual, 1.0)] {
            program.use_uniform("opacity", opacity);
            program.use_vertex_attribute("corner", &self.corners);
            program.use_instance_attribute("start", &self.starts);
            program.use_instance_attribute("end", &self.ends);
            program.use_instance_attribute("ink", &self.inks);
            let states = RenderStates { depth_test, ..CLEAR };
            program.draw_arrays_instanced(states, size, CORNERS.len() as u32, lines.inks.len() as u32);
        }
    }
}

/// A rectangle with a picture on it.
pub(super) struct Leaf {
    pub(super) middle: Vec3,
    /// To the middles of its right and its upper edge.
    pub(super) along: Vec3,
    pub(super) beside: Vec3,
}

impl Leaf {
    /// Draws it. `corners` from (-1, -1) to (1, 1).
    pub(super) fn draw(
        &self,
        programs: &Programs,
        eye: &Eye,
        corners: &VertexBuffer<[f32; 2]>,
        image: &three_d::Texture2D,
    ) {
        let program = &programs.slice;
        program.use_uniform("viewProjection", eye.view_projection);
        program.use_uniform("middle", vector(self.middle));
        program.use_uniform("along", vector(self.along));
        program.use_uniform("beside", vector(self.beside));
        program.use_texture("image", image);
        program.use_vertex_attribute("corner", corners);
        program.draw_arrays(CLEAR, eye.viewport, 6);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_twelve_edges_and_a_path_one_part_less_than_points() {
        let mut lines = Lines::default();
        let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 3.0) };
        lines.boxed(&bounds, 1.0, [255; 4]);
        let lengths: f32 = lines
            .starts
            .iter()
            .zip(&lines.ends)
            .map(|(a, b)| (0..3).map(|k| (b[k] - a[k]).abs()).sum::<f32>())
            .sum();
        assert!(lines.inks.len() == 12 && (lengths - 24.0).abs() < 1e-6, "{lengths}");
        lines.clear();
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(f32::NAN)];
        lines.path(&points, 1.0, |part| [0, 0, 0, (255.0 * part) as u8]);
        assert_eq!(lines.inks, [[0, 0, 0, 0], [0, 0, 0, 85]], "what is no number is not drawn");
    }
}
