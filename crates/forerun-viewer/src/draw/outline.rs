//! Outline: a line around what is selected, wherever it is seen or hidden.

use forerun::Vec3;
use three_d::{
    ClearState, Context, CoreError, DepthTest, Interpolation, RenderStates, Texture2D, VertexBuffer,
    Viewport, Wrapping, WriteMask,
};

use super::convert::vector;
use super::crowd::Crowd;
use super::eye::Eye;
use super::programs::{CLEAR, Programs};
use super::surface::Surfaces;

/// Where the selected bodies are, in the picture.
#[derive(Default)]
pub(super) struct Outline {
    mask: Option<Texture2D>,
}

impl Outline {
    /// Draws the selected bodies into the mask: before anything is drawn on the screen.
    pub(super) fn prepare(
        &mut self,
        context: &Context,
        programs: &Programs,
        eye: &Eye,
        (chosen, surfaces): (&Crowd, &Surfaces),
    ) {
        let Viewport { width, height, .. } = eye.viewport;
        if chosen.is_empty() || width == 0 || height == 0 {
            return;
        }
        let fits = |mask: &Texture2D| mask.width() == width && mask.height() == height;
        let mask = self.mask.take().filter(fits).unwrap_or_else(|| {
            let (near, edge) = (Interpolation::Nearest, Wrapping::ClampToEdge);
            Texture2D::new_empty::<[u8; 4]>(context, width, height, near, near, None, edge, edge)
        });
        let states = RenderStates {
            write_mask: WriteMask::COLOR,
            depth_test: DepthTest::Always,
            ..RenderStates::default()
        };
        let program = &programs.shape;
        program.use_uniform("viewProjection", eye.view_projection);
        let target = mask.as_color_target(None);
        let drawn = target.clear(ClearState::color(0.0, 0.0, 0.0, 0.0)).write::<CoreError>(|| {
            chosen.draw(program, states, Viewport::new_at_origo(width, height), surfaces);
            Ok(())
        });
        // What draws cannot fail.
        drop(drawn);
        self.mask = Some(mask);
    }

    /// Draws the line.
    pub(super) fn draw(
        &self,
        programs: &Programs,
        eye: &Eye,
        corners: &VertexBuffer<[f32; 2]>,
        colour: Vec3,
    ) {
        let Some(mask) = &self.mask else { return };
        let program = &programs.outline;
        program.use_texture("mask", mask);
        program.use_uniform("lineColour", vector(colour));
        program.use_uniform("width", (2.5 * eye.pixels_per_point()).round() as i32);
        program.use_vertex_attribute("corner", corners);
        let states = RenderStates { depth_test: DepthTest::Always, ..CLEAR };
        program.draw_arrays(states, eye.viewport, 6);
    }
}
