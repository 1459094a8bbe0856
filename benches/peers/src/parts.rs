//! Parts: moving meshes cut into convex hulls, for engines that do not take them as they are.

use std::sync::Arc;

use forerun::geometry::shape::Mesh;
use forerun::{Pose, Shape, Vec3};
use rapier3d::math::Vector;
use rapier3d::parry::transformation::vhacd::{VHACD, VHACDParameters};

use crate::stage::Stage;

/// Puts a compound of hulls in the place of every moving mesh; bodies that share a mesh share the compound. Masses stay those of the mesh.
/// Returns the most hulls that a mesh was cut into, 0 when there was none to cut.
pub(crate) fn cut_moving_meshes(stage: &mut Stage) -> Result<usize, String> {
    let mut most = 0;
    let mut done: Vec<(Arc<Mesh>, Shape)> = Vec::new();
    for actor in stage.actors.iter_mut().filter(|actor| !actor.is_fixed()) {
        let Shape::Mesh(mesh) = &actor.def.shape else { continue };
        let known = done.iter().find(|(other, _)| Arc::ptr_eq(other, mesh)).map(|(_, parts)| parts.clone());
        let parts = match known {
            Some(parts) => parts,
            None => {
                let parts = cut(mesh)?;
                done.push((mesh.clone(), parts.clone()));
                parts
            }
        };
        if let Shape::Compound(compound) = &parts {
            most = most.max(compound.parts.len());
        }
        actor.def.shape = parts;
    }
    Ok(most)
}

/// Hulls of the parts that parry's VHACD finds at its defaults.
fn cut(mesh: &Mesh) -> Result<Shape, String> {
    let vertices: Vec<Vector> = mesh.vertices.iter().map(|v| Vector::new(v.x, v.y, v.z)).collect();
    let found = VHACD::decompose(&VHACDParameters::default(), &vertices, &mesh.triangles, true);
    let hulls = found.compute_exact_convex_hulls(&vertices, &mesh.triangles);
    let mut parts = Vec::new();
    for (points, _) in hulls {
        let points: Vec<Vec3> = points.iter().map(|p| Vec3::new(p.x, p.y, p.z)).collect();
        let hull = Shape::hull(&points).map_err(|error| format!("a convex part of a mesh: {error}"))?;
        parts.push((Pose::IDENTITY, hull));
    }
    Shape::compound(parts).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hulls_of_a_ring_keep_its_hole_and_about_its_volume() {
        let mut stage = Stage::of(&forerun::Scene::open("tori:3").unwrap()).unwrap();
        let whole = stage.actors[1].def.shape.clone();
        let count = cut_moving_meshes(&mut stage).unwrap();
        let parts = &stage.actors[3].def.shape;
        let ratio = parts.mass_properties(1.0).mass / whole.mass_properties(1.0).mass;
        assert!((4..64).contains(&count), "{count} hulls");
        assert!((0.95..1.3).contains(&ratio), "{ratio} of the volume");
    }
}
