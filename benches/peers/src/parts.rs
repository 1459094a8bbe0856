//! Parts: moving meshes cut into convex hulls, for engines that do not take them as they are.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use cpu_time::ProcessTime;
use forerun::geometry::shape::Mesh;
use forerun::{Pose, Shape, Vec3};
use rapier3d::math::Vector;
use rapier3d::parry::transformation::vhacd::{VHACD, VHACDParameters};
use rapier3d::prelude::SharedShape;
use serde::{Deserialize, Serialize};

use crate::engine::{Cutting, Fineness, Kind};
use crate::stage::Stage;

/// The defaults, and the tightest fit that parry's guide to the parameters has, at half of its resolution: at all of it a ring takes minutes.
fn parameters(fineness: Fineness) -> VHACDParameters {
    let defaults = VHACDParameters::default();
    match fineness {
        Fineness::Default => defaults,
        Fineness::Fine => {
            VHACDParameters { resolution: 128, concavity: 0.001, max_convex_hulls: 64, ..defaults }
        }
    }
}

/// A mesh that was cut.
#[derive(Serialize, Deserialize)]
struct Pieces {
    /// Corners of each hull.
    hulls: Vec<Vec<[f32; 3]>>,
    /// CPU time that it took. Milliseconds.
    cpu_ms: f64,
}

/// Puts a compound of hulls in the place of every mesh that an engine does not take; bodies that share a mesh share the compound. Masses stay those of
/// the mesh. Pieces are kept in a folder, if one is given, and found there again.
pub(crate) fn cut_meshes(kind: Kind, stage: &mut Stage, folder: Option<&Path>) -> Result<Cutting, String> {
    let Some(fineness) = kind.fineness() else { return Ok(Cutting::default()) };
    let mut cutting = Cutting::default();
    let mut done: Vec<(Arc<Mesh>, Shape)> = Vec::new();
    for actor in &mut stage.actors {
        let Shape::Mesh(mesh) = &actor.def.shape else { continue };
        // Jolt's C interface has no meshes at all; what has no inside cannot be cut.
        let is_taken = actor.is_fixed() && (kind != Kind::Jolt || !mesh.has_inside());
        if is_taken {
            continue;
        }
        let known = done.iter().find(|(other, _)| Arc::ptr_eq(other, mesh)).map(|(_, parts)| parts.clone());
        let parts = match known {
            Some(parts) => parts,
            None => {
                let pieces = kept_or_cut(mesh, fineness, folder)?;
                cutting.cpu_ms += pieces.cpu_ms;
                cutting.hulls = cutting.hulls.max(pieces.hulls.len());
                let parts = compound(&pieces)?;
                done.push((mesh.clone(), parts.clone()));
                parts
            }
        };
        actor.def.shape = parts;
    }
    Ok(cutting)
}

/// Every engine is to get the same hulls, and cutting finely takes seconds.
fn kept_or_cut(mesh: &Mesh, fineness: Fineness, folder: Option<&Path>) -> Result<Pieces, String> {
    let Some(folder) = folder else { return Ok(cut(mesh, fineness)) };
    let file = folder.join(format!("{fineness:?}-{:016x}.json", fingerprint(mesh)));
    let kept = fs::read_to_string(&file).ok().and_then(|text| serde_json::from_str(&text).ok());
    if let Some(pieces) = kept {
        return Ok(pieces);
    }
    let pieces = cut(mesh, fineness);
    let text = serde_json::to_string(&pieces).map_err(|error| error.to_string())?;
    fs::write(&file, text).map_err(|error| format!("{} cannot be written: {error}", file.display()))?;
    Ok(pieces)
}

/// FNV-1a over all corners of all triangles.
fn fingerprint(mesh: &Mesh) -> u64 {
    let corners = (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t));
    let bytes = corners.flat_map(|corner| corner.to_array()).flat_map(f32::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Hulls of the parts that parry's VHACD finds.
fn cut(mesh: &Mesh, fineness: Fineness) -> Pieces {
    let start = ProcessTime::now();
    let vertices: Vec<Vector> = mesh.vertices.iter().map(|v| vector(*v)).collect();
    let found = VHACD::decompose(&parameters(fineness), &vertices, &mesh.triangles, true);
    let hulls = found.compute_exact_convex_hulls(&vertices, &mesh.triangles);
    let corners = |(points, _): (Vec<Vector>, _)| points.iter().map(|p| [p.x, p.y, p.z]).collect();
    Pieces { hulls: hulls.into_iter().map(corners).collect(), cpu_ms: 1000.0 * start.elapsed().as_secs_f64() }
}

fn compound(pieces: &Pieces) -> Result<Shape, String> {
    let mut parts = Vec::new();
    for corners in &pieces.hulls {
        let points: Vec<Vec3> = corners.iter().copied().map(Vec3::from_array).collect();
        let hull = Shape::hull(&points).map_err(|error| format!("a convex part of a mesh: {error}"))?;
        parts.push((Pose::IDENTITY, hull));
    }
    Shape::compound(parts).map_err(|error| error.to_string())
}

/// Signed distance to the union of hulls, exact outside of it. Metres.
pub(crate) fn distance_to_hulls(shape: &Shape) -> Result<impl Fn(Vec3) -> f32, String> {
    let Shape::Compound(compound) = shape else { return Err("a mesh that was not cut".to_owned()) };
    let of_part = |(_, part): &(Pose, Shape)| match part {
        Shape::Hull(hull) => {
            SharedShape::convex_hull(&hull.vertices.iter().map(|v| vector(*v)).collect::<Vec<_>>())
        }
        _ => None,
    };
    let parts: Option<Vec<SharedShape>> = compound.parts.iter().map(of_part).collect();
    let parts = parts.ok_or("a hull that parry cannot make")?;
    Ok(move |p| {
        let distances = parts.iter().map(|part| part.distance_to_local_point(vector(p), false));
        distances.fold(f32::INFINITY, f32::min)
    })
}

fn vector(v: Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hulls_of_a_ring_keep_its_hole_and_about_its_volume() {
        for kind in [Kind::Rapier, Kind::Box3dFine] {
            let mut stage = Stage::of(&forerun::Scene::open("tori:3").unwrap()).unwrap();
            let whole = stage.actors[1].def.shape.clone();
            let count = cut_meshes(kind, &mut stage, None).unwrap().hulls;
            let parts = &stage.actors[3].def.shape;
            let ratio = parts.mass_properties(1.0).mass / whole.mass_properties(1.0).mass;
            assert!((4..=128).contains(&count), "{count} hulls");
            assert!((0.95..1.3).contains(&ratio), "{ratio} of the volume");
            let distance = distance_to_hulls(parts).unwrap();
            // The hole of radius 0.3 m is there, and so is the tube; where parts meet, its middle is near the ends of hulls.
            assert!((0.2..0.31).contains(&distance(Vec3::ZERO)), "{}", distance(Vec3::ZERO));
            assert!(distance(Vec3::Z * 0.5) < 0.01 && distance(Vec3::Y) > 0.8);
        }
    }
}
