//! Shapes: what each engine makes of a mesh that moves: how long that takes, and how far it is from the mesh.

use std::path::Path;
use std::sync::Arc;

use cpu_time::ProcessTime;
use forerun::Shape;
use forerun::Vec3;
use forerun::geometry::shape::{Mesh, MeshDraft};
use serde::{Deserialize, Serialize};

use crate::engine::{self, Kind};
use crate::stage::Stage;
use crate::surface;
use crate::true_mesh::TrueMesh;

/// An engine's shapes against the meshes that they stand for; of several meshes the worst of each.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Fit {
    /// Most hulls of a mesh; 0: it was not cut.
    pub(crate) hulls: usize,
    /// Their corners, all together.
    pub(crate) corners: usize,
    /// Farthest that the mesh's surface is from that of the engine's shape, outside or buried in it. Metres.
    pub(crate) off_m: f32,
    /// How far the engine's shape is open around the origin of its frame, as a part of how far the mesh is; none where the origin is within the mesh.
    pub(crate) opening: Option<f32>,
}

/// The different meshes that move, each with the first body that has it.
pub(crate) fn moving(stage: &Stage) -> Vec<(usize, Arc<Mesh>)> {
    let mut meshes: Vec<(usize, Arc<Mesh>)> = Vec::new();
    for (i, actor) in stage.actors.iter().enumerate().filter(|(_, actor)| !actor.is_fixed()) {
        if let Shape::Mesh(mesh) = &actor.def.shape
            && !meshes.iter().any(|(_, known)| Arc::ptr_eq(known, mesh))
        {
            meshes.push((i, mesh.clone()));
        }
    }
    meshes
}

/// How many different meshes there are, fixed ones too.
pub(crate) fn different(stage: &Stage) -> usize {
    let mut meshes: Vec<*const Mesh> = (stage.actors.iter())
        .filter_map(
            |actor| if let Shape::Mesh(mesh) = &actor.def.shape { Some(Arc::as_ptr(mesh)) } else { None },
        )
        .collect();
    meshes.sort_unstable();
    meshes.dedup();
    meshes.len()
}

/// Makes the stage what the engine takes, and says how long making the shapes from triangles took: of ours the fields once more, of others the cutting.
/// Pieces are kept in a folder, if one is given. CPU milliseconds.
pub(crate) fn prepare(
    kind: Kind,
    stage: &mut Stage,
    meshes: &[(usize, Arc<Mesh>)],
    folder: Option<&Path>,
) -> Result<f64, String> {
    if kind != Kind::Forerun {
        return Ok(engine::prepare(kind, stage, folder)?.cpu_ms);
    }
    let start = ProcessTime::now();
    for (_, mesh) in meshes {
        let draft = MeshDraft::new(mesh.vertices.clone(), mesh.triangles.clone(), mesh.options());
        draft.and_then(|draft| draft.bake(&|_, _| {})).map_err(|error| error.to_string())?;
    }
    Ok(1000.0 * start.elapsed().as_secs_f64())
}

/// Compares the shapes of a prepared stage with the meshes.
pub(crate) fn fit(kind: Kind, stage: &Stage, meshes: &[(usize, Arc<Mesh>)]) -> Result<Fit, String> {
    let mut worst = Fit::default();
    for (body, mesh) in meshes {
        let fit = match &stage.actors[*body].def.shape {
            Shape::Mesh(_) if kind == Kind::Forerun => {
                let field = mesh.collider().field.as_ref().ok_or("a mesh that moves and has no field")?;
                compare(mesh, |p| field.distance_and_gradient(p).0)
            }
            Shape::Mesh(_) => Fit { opening: Some(1.0), ..Fit::default() },
            cut => of_hulls(cut, mesh)?,
        };
        let least = |a: Option<f32>, b: Option<f32>| a.into_iter().chain(b).reduce(f32::min);
        worst = Fit {
            hulls: worst.hulls.max(fit.hulls),
            corners: worst.corners.max(fit.corners),
            off_m: worst.off_m.max(fit.off_m),
            opening: least(worst.opening, fit.opening),
        };
    }
    Ok(worst)
}

#[cfg(feature = "engines")]
fn of_hulls(cut: &Shape, mesh: &Arc<Mesh>) -> Result<Fit, String> {
    let Shape::Compound(compound) = cut else { return Err("a mesh that was not cut".to_owned()) };
    let corners =
        |part: &(forerun::Pose, Shape)| if let Shape::Hull(hull) = &part.1 { hull.vertices.len() } else { 0 };
    let distance = crate::parts::distance_to_hulls(cut)?;
    Ok(Fit {
        hulls: compound.parts.len(),
        corners: compound.parts.iter().map(corners).sum(),
        ..compare(mesh, distance)
    })
}

#[cfg(not(feature = "engines"))]
fn of_hulls(_: &Shape, _: &Arc<Mesh>) -> Result<Fit, String> {
    Err(engine::WITHOUT_ENGINES.to_owned())
}

/// Compares the distances of a shape with the mesh that it stands for.
fn compare(mesh: &Arc<Mesh>, distance: impl Fn(Vec3) -> f32) -> Fit {
    let points = surface::points(&Shape::Mesh(mesh.clone()));
    let off_m = points.iter().map(|p| distance(*p).abs()).fold(0.0, f32::max);
    let is_hollow = TrueMesh::new(mesh.clone()).signed_distance(Vec3::ZERO) > 0.0;
    Fit { off_m, opening: is_hollow.then(|| opening(&points, distance)), ..Fit::default() }
}

/// How far one gets from the origin to the nearest points of a surface before the shape is in the way, as a part of how far these are. Only the sides that
/// distances tell count: in the middle of a hole fields are coarse.
fn opening(points: &[Vec3], distance: impl Fn(Vec3) -> f32) -> f32 {
    const STEPS: u8 = 250;
    /// Points that are farther by this factor are looked at too.
    const NEAR: f32 = 1.2;
    let nearest = points.iter().map(|p| p.length()).fold(f32::INFINITY, f32::min);
    let free = |point: &Vec3| {
        let way = *point * (nearest / point.length());
        let at = |k: &u8| f32::from(*k) / 200.0;
        (0..STEPS).find(|k| distance(way * at(k)) <= 0.0).map_or(NEAR, |k| at(&k))
    };
    points.iter().filter(|p| p.length() < NEAR * nearest).map(free).fold(NEAR, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring() -> Arc<Mesh> {
        let stage = Stage::of(&forerun::Scene::open("tori:2").unwrap()).unwrap();
        let meshes = moving(&stage);
        assert_eq!((meshes.len(), meshes[0].0), (1, 1));
        meshes[0].1.clone()
    }

    #[test]
    fn a_ring_one_centimetre_thicker_is_off_by_that() {
        let mesh = ring();
        let exact = TrueMesh::new(mesh.clone());
        let thicker = compare(&mesh, |p| exact.signed_distance(p) - 0.01);
        assert!((thicker.off_m - 0.01).abs() < 1e-4, "{}", thicker.off_m);
        // Its hole is 0.3 m wide to every side.
        assert!((thicker.opening.unwrap() - 0.29 / 0.3).abs() < 0.006, "{:?}", thicker.opening);
    }

    #[test]
    fn our_field_is_near_the_ring() {
        let stage = Stage::of(&forerun::Scene::open("tori:2").unwrap()).unwrap();
        let fit = fit(Kind::Forerun, &stage, &moving(&stage)).unwrap();
        assert!(fit.off_m > 0.0 && fit.off_m < 0.02, "{}", fit.off_m);
        assert!((fit.opening.unwrap() - 1.0).abs() < 0.03, "{:?}", fit.opening);
    }
}
