//! Drawing: bodies, ground and sky, by the graphics card.

mod convert;
mod extras;
mod surface;

pub use extras::{Extras, PreviewTrack};

use std::collections::BTreeMap;

use forerun::BodyId;
use three_d::{
    AmbientLight, ClearState, Context, DirectionalLight, Gm, InstancedMesh, Instances, Light, Mat4, Object,
    PhysicalMaterial, RenderTarget, Srgba, Viewport,
};

use crate::camera::Camera;
use crate::session::Play;
use crate::view::View;
use convert::{matrix_of, vector};
use surface::Look;

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
}

/// Bodies of one shape.
struct Batch {
    model: Gm<InstancedMesh, PhysicalMaterial>,
}

/// What draws the scene. Keeps the surfaces of shapes between pictures.
pub struct Painter {
    context: Context,
    batches: BTreeMap<Look, Batch>,
    sun: DirectionalLight,
    sky: AmbientLight,
    opened: u64,
}

impl Painter {
    /// Draws into windows of this context.
    #[must_use]
    pub fn new(context: &Context) -> Painter {
        Painter {
            context: context.clone(),
            batches: BTreeMap::new(),
            sun: DirectionalLight::new(context, 2.2, Srgba::WHITE, three_d::vec3(-0.45, -1.0, -0.35)),
            sky: AmbientLight::new(context, 0.45, Srgba::WHITE),
            opened: 0,
        }
    }

    /// Draws the picture that the session shows.
    pub fn draw(&mut self, target: &RenderTarget<'_>, viewport: Viewport, scenery: &Scenery<'_>) {
        let Scenery { play, scene_number, camera, view, .. } = *scenery;
        if self.opened != scene_number {
            self.batches.clear();
            self.opened = scene_number;
        }
        self.place(play);
        let eye = three_d::Camera::new_perspective(
            viewport,
            vector(camera.eye()),
            vector(camera.target),
            vector(camera.up()),
            three_d::radians(camera.angle()),
            0.01 * camera.distance,
            1000.0 * camera.distance,
        );
        let models = || self.batches.values().map(|batch| &batch.model);
        if view.shadows {
            // Without memory for a shadow map there are no shadows.
            let _ = self.sun.generate_shadow_map(2048, models().map(|model| &model.geometry));
        } else {
            self.sun.clear_shadow_map();
        }
        let objects: Vec<&dyn Object> = models().map(|model| model as &dyn Object).collect();
        let lights: [&dyn Light; 2] = [&self.sun, &self.sky];
        target.clear(ClearState::color_and_depth(0.55, 0.65, 0.78, 1.0, 1.0)).render(&eye, objects, &lights);
    }

    fn place(&mut self, play: &Play) {
        let mut placed: BTreeMap<Look, (BodyId, Vec<Mat4>, Vec<Srgba>)> = BTreeMap::new();
        for (id, sample) in &play.samples {
            let Some(body) = play.body(*id) else { continue };
            let Some(key) = surface::look_of(&body.shape) else { continue };
            let (_, matrices, colours) = placed.entry(key).or_insert_with(|| (*id, Vec::new(), Vec::new()));
            matrices.push(matrix_of(&sample.pose) * surface::scale_of(&body.shape));
            let hue = id.0.wrapping_mul(2_654_435_761) >> 8;
            colours.push(Srgba::new_opaque(
                90 + (hue & 127) as u8,
                90 + (hue >> 7 & 127) as u8,
                90 + (hue >> 14 & 127) as u8,
            ));
        }
        self.batches.retain(|key, _| placed.contains_key(key));
        for (key, (id, transformations, colours)) in placed {
            let instances = Instances { transformations, colors: Some(colours), ..Instances::default() };
            match self.batches.get_mut(&key) {
                Some(batch) => batch.model.geometry.set_instances(&instances),
                None => {
                    let Some(body) = play.body(id) else { continue };
                    let mesh = InstancedMesh::new(&self.context, &instances, &surface::mesh_of(&body.shape));
                    let material =
                        PhysicalMaterial { roughness: 0.7, metallic: 0.0, ..PhysicalMaterial::default() };
                    self.batches.insert(key, Batch { model: Gm::new(mesh, material) });
                }
            }
        }
    }
}
