//! Programs: what runs on the graphics card, in the GLSL that desktops and WebGL2 share.

use three_d::{Blend, Context, Cull, DepthTest, Program, RenderStates, WriteMask};

const LIGHT: &str = include_str!("shaders/light.glsl");

/// All of them.
pub(super) struct Programs {
    pub(super) body: Program,
    pub(super) ghost: Program,
    /// Where bodies are and nothing else.
    pub(super) shape: Program,
    pub(super) sky: Program,
    pub(super) ground: Program,
    pub(super) line: Program,
    pub(super) outline: Program,
    pub(super) slice: Program,
}

impl Programs {
    /// Has the driver compile them; or what it says against it.
    pub(super) fn new(context: &Context) -> Result<Programs, String> {
        let plain = |vertex: &str, fragment: &str| {
            Program::from_source(context, vertex, fragment).map_err(|error| error.to_string())
        };
        let lit = |vertex: &str, fragment: &str| plain(vertex, &format!("{LIGHT}\n{fragment}"));
        let body = include_str!("shaders/body.vert");
        let screen = include_str!("shaders/screen.vert");
        Ok(Programs {
            body: lit(body, include_str!("shaders/body.frag"))?,
            ghost: plain(body, include_str!("shaders/ghost.frag"))?,
            shape: plain(include_str!("shaders/shape.vert"), include_str!("shaders/shape.frag"))?,
            sky: lit(screen, include_str!("shaders/sky.frag"))?,
            ground: lit(include_str!("shaders/ground.vert"), include_str!("shaders/ground.frag"))?,
            line: plain(include_str!("shaders/line.vert"), include_str!("shaders/line.frag"))?,
            outline: plain(screen, include_str!("shaders/outline.frag"))?,
            slice: plain(include_str!("shaders/slice.vert"), include_str!("shaders/slice.frag"))?,
        })
    }
}

/// What is drawn as it is.
pub(super) const SOLID: RenderStates = RenderStates {
    write_mask: WriteMask::COLOR_AND_DEPTH,
    depth_test: DepthTest::Less,
    blend: Blend::Disabled,
    cull: Cull::None,
};

/// What is seen through, and hides nothing.
pub(super) const CLEAR: RenderStates = RenderStates {
    write_mask: WriteMask::COLOR,
    depth_test: DepthTest::LessOrEqual,
    blend: Blend::TRANSPARENCY,
    cull: Cull::None,
};
