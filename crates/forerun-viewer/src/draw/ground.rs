//! Ground and sky: half-spaces as planes with a grid, and what is behind everything.

use forerun::{Pose, Vec3};
use three_d::{Context, Cull, DepthTest, RenderStates, VertexBuffer, WriteMask};

use super::convert::vector;
use super::eye::Eye;
use super::light::Light;
use super::programs::{Programs, SOLID};
use super::shadow::Shadows;
use crate::view::View;

/// Lines of the grid start again after so many metres, so that numbers stay small far out.
const GRID_TURN: f32 = 1000.0;

/// A rectangle from (-1, -1) to (1, 1) as two triangles, counter-clockwise.
const CORNERS: [[f32; 2]; 6] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// What draws ground and sky.
pub(super) struct Ground {
    pub(super) corners: VertexBuffer<[f32; 2]>,
}

impl Ground {
    pub(super) fn new(context: &Context) -> Ground {
        Ground { corners: VertexBuffer::new_with_data(context, &CORNERS) }
    }

    /// Behind everything.
    pub(super) fn draw_sky(&self, programs: &Programs, eye: &Eye, light: &Light) {
        let states = RenderStates {
            write_mask: WriteMask::COLOR,
            depth_test: DepthTest::Always,
            ..RenderStates::default()
        };
        let program = &programs.sky;
        light.tell(program, eye, &Shadows::default(), 1.0);
        program.use_uniform("forward", vector(eye.forward));
        program.use_uniform("across", vector(eye.across));
        program.use_uniform("upwards", vector(eye.upwards));
        program.use_uniform("zenith", vector(light.zenith));
        program.use_uniform("nadir", vector(light.nadir));
        program.use_vertex_attribute("corner", &self.corners);
        program.draw_arrays(states, eye.viewport, CORNERS.len() as u32);
    }

    /// The planes of half-spaces; each is seen from outside only.
    pub(super) fn draw_planes(
        &self,
        programs: &Programs,
        eye: &Eye,
        (light, shadows, haze_distance): (&Light, &Shadows, f32),
        (view, planes): (&View, &[Pose]),
    ) {
        if planes.is_empty() {
            return;
        }
        let program = &programs.ground;
        light.tell(program, eye, shadows, haze_distance);
        program.use_uniform("viewProjection", eye.view_projection);
        program.use_uniform("earth", vector(light.earth));
        program.use_uniform("lineColour", vector(light.lines));
        program.use_uniform("lineStrength", if view.grid { 1.0 } else { 0.0 });
        // The corners of the square are farther away than its edges.
        program.use_uniform("reach", 0.7 * eye.far);
        for plane in planes {
            let (along, up, beside) =
                (plane.rotation * Vec3::X, plane.rotation * Vec3::Y, plane.rotation * -Vec3::Z);
            let below = eye.position - up * (eye.position - plane.position).dot(up);
            let shift = [along, beside]
                .map(|axis| (below - plane.position).dot(axis))
                .map(|at| at - (at / GRID_TURN).floor() * GRID_TURN);
            program.use_uniform("middle", vector(below));
            program.use_uniform("along", vector(along));
            program.use_uniform("beside", vector(beside));
            program.use_uniform("up", vector(up));
            program.use_uniform("shift", three_d::vec2(shift[0], shift[1]));
            program.use_vertex_attribute("corner", &self.corners);
            let states = RenderStates { cull: Cull::Back, ..SOLID };
            program.draw_arrays(states, eye.viewport, CORNERS.len() as u32);
        }
    }
}
