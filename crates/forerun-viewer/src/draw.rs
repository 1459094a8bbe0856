//! Drawing: bodies, ground and sky, what is still to come and what is inside a frame, by the graphics card.
//!
//! The shaders are our own ([`three_d`] lends windows, buffers and textures): bodies of one look go to the card as one call, and
//! only what changed is sent. What is written here is the order of a picture: shadows, the mask of the selection, sky, ground, bodies,
//! ghosts, lines, outline.

mod bodies;
mod colours;
mod convert;
mod crowd;
mod extras;
mod eye;
mod ghosts;
mod glass;
mod ground;
mod labels;
mod light;
mod lines;
mod outline;
mod overlays;
mod programs;
mod shadow;
mod surface;

pub use colours::{Rgb, legend};
pub use extras::{Extras, PreviewTrack};
pub use labels::{write_failure, write_labels};

use forerun::{FrameInspection, Vec3};
use three_d::{ClearState, Context, CoreError, RenderTarget, Viewport};

use crate::camera::Camera;
use crate::session::Play;
use crate::view::View;
use bodies::Bodies;
use convert::vector;
use eye::Eye;
use ghosts::Ghosts;
use ground::Ground;
use light::Light;
use lines::{LineDrawer, Lines};
use outline::Outline;
use overlays::FieldSlice;
use programs::{Programs, SOLID};
use shadow::Shadows;

/// What is this many times as far as all that there is, is half haze.
const HAZE: f32 = 5.0;

/// What there is to draw.
#[derive(Clone, Copy, Debug)]
pub struct Scenery<'a> {
    /// The scene that plays.
    pub play: &'a Play,
    /// Who keeps something of a scene keeps this number with it.
    pub scene_number: u64,
    /// Where it is seen from.
    pub camera: &'a Camera,
    /// How it is shown.
    pub view: &'a View,
    /// What the hands show.
    pub extras: &'a Extras,
    /// What is inside the frame that is shown, or one shortly before, when that is known.
    pub inside: Option<&'a FrameInspection>,
}

/// Whether the view shows anything that is only known from inside a frame.
#[must_use]
pub fn needs_inspection(view: &View) -> bool {
    use crate::view::ColourBy::{Area, Island, Slices};
    let overlays = &view.overlays;
    overlays.contacts
        || overlays.impulses
        || overlays.levels
        || overlays.bounds
        || overlays.areas
        || matches!(view.colour_by, Area | Island | Slices)
}

/// What draws the scene. Keeps what it sent to the graphics card between pictures.
pub struct Painter {
    context: Context,
    programs: Result<Programs, String>,
    bodies: Bodies,
    ghosts: Ghosts,
    ground: Ground,
    shadows: Shadows,
    outline: Outline,
    slice: FieldSlice,
    lines: Lines,
    line_drawer: LineDrawer,
    opened: (u64, bool),
}

impl Painter {
    /// Draws into windows of this context.
    #[must_use]
    pub fn new(context: &Context) -> Painter {
        Painter {
            context: context.clone(),
            programs: Programs::new(context),
            bodies: Bodies::default(),
            ghosts: Ghosts::default(),
            ground: Ground::new(context),
            shadows: Shadows::default(),
            outline: Outline::default(),
            slice: FieldSlice::default(),
            lines: Lines::default(),
            line_drawer: LineDrawer::new(context),
            opened: (0, false),
        }
    }

    /// Why nothing can be drawn: what the driver has against the shaders.
    #[must_use]
    pub fn failure(&self) -> Option<&str> {
        self.programs.as_ref().err().map(String::as_str)
    }

    /// Draws the picture that the session shows.
    pub fn draw(&mut self, target: &RenderTarget<'_>, viewport: Viewport, scenery: &Scenery<'_>) {
        // Another driver may have shapes of its own.
        let opened = (scenery.scene_number, scenery.play.is_coupled());
        if self.opened != opened {
            self.bodies.forget();
            self.ghosts.forget();
            self.opened = opened;
        }
        self.place(scenery);
        let eye = Eye::new(scenery.camera, viewport, self.bodies.reach);
        self.prepare(&eye, scenery);
        target.clear(ClearState::depth(1.0));
        let drawn = target.write::<CoreError>(|| {
            self.fill(&eye, scenery);
            Ok(())
        });
        // What draws cannot fail.
        drop(drawn);
    }

    /// Where everything is, without the graphics card but for what it is sent.
    fn place(&mut self, scenery: &Scenery<'_>) {
        let cut = self.slice.prepare(&self.context, scenery);
        self.bodies.place(&self.context, scenery, cut);
        self.ghosts.place(&self.context, &mut self.bodies.surfaces, scenery);
        self.lines.clear();
        overlays::draw(&mut self.lines, scenery);
        ghosts::draw_trails(&mut self.lines, scenery.play, scenery.view, scenery.extras);
    }

    /// What is drawn elsewhere than on the screen.
    fn prepare(&mut self, eye: &Eye, scenery: &Scenery<'_>) {
        let Ok(programs) = &self.programs else { return };
        let Bodies { crowd, chosen, surfaces, casters, moved, .. } = &self.bodies;
        if scenery.view.shadows {
            let camera = scenery.camera;
            let seen = (casters, camera.target, camera.distance);
            self.shadows.cast(&self.context, programs, (crowd, surfaces, *moved), seen);
        } else {
            self.shadows.clear();
        }
        self.outline.prepare(&self.context, programs, eye, (chosen, surfaces));
    }

    /// What is drawn on the screen.
    fn fill(&mut self, eye: &Eye, scenery: &Scenery<'_>) {
        let Ok(programs) = &self.programs else { return };
        let light = Light::of(scenery.view.theme);
        let Bodies { crowd, chosen, glass, surfaces, planes, reach, .. } = &self.bodies;
        let haze_distance = HAZE * (reach + scenery.camera.distance);
        self.ground.draw_sky(programs, eye, light);
        let lit = (light, &self.shadows, haze_distance);
        self.ground.draw_planes(programs, eye, lit, (scenery.view, planes));
        let program = &programs.body;
        light.tell(program, eye, &self.shadows, haze_distance);
        program.use_uniform("viewProjection", eye.view_projection);
        let (normal, distance) = self.slice.plane().unwrap_or((Vec3::Y, f32::MAX));
        program.use_uniform("cut", vector(normal).extend(distance));
        crowd.draw(program, SOLID, eye.viewport, surfaces);
        let corners = &self.ground.corners;
        self.slice.draw(programs, eye, corners);
        self.ghosts.draw(programs, eye, (glass, surfaces));
        self.line_drawer.draw(programs, eye, &mut self.lines);
        if !chosen.is_empty() {
            self.outline.draw(programs, eye, corners, light.outline);
        }
    }
}
