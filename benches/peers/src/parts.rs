//! Parts: moving meshes cut into convex hulls, for engines that do not take them as they are.

use std::sync::Arc;

use cpu_time::ProcessTime;
use forerun::geometry::shape::Mesh;
use forerun::{Pose, Shape, Vec3};
use rapier3d::math::Vector;
use rapier3d::parry::transformation::vhacd::{VHACD, VHACDParameters};
use rapier3d::prelude::SharedShape;

use crate::engine::{Cutting, Fineness};
use crate::stage::Stage;

/// The defaults, and what parry's guide to the parameters recommends for high quality.
fn parameters(fineness: Fineness) -> VHACDParameters {
    match fineness {
        Fineness::Default => VHACDParameters::default(),
        Fineness::Fine => VHACDParameters {
            resolution: 256,
            concavity: 0.001,
            max_convex_hulls: 64,
            plane_downsampling: 2,
            convex_hull_downsampling: 2,
            convex_hull_approximation: false,
            ..VHACDParameters::default()
        },
    }
}

/// Puts a compound of hulls in the place of every moving mesh; bodies that share a mesh share the compound. Masses stay those of the mesh.
pub(crate) fn cut_moving_meshes(stage: &mut Stage, fineness: Fineness) -> Result<Cutting, String> {
    let mut cutting = Cutting::default();
    let mut done: Vec<(Arc<Mesh>, Shape)> = Vec::new();
    for actor in stage.actors.iter_mut().filter(|actor| !actor.is_fixed()) {
        let Shape::Mesh(mesh) = &actor.def.shape else { continue };
        let known = done.iter().find(|(other, _)| Arc::ptr_eq(other, mesh)).map(|(_, parts)| parts.clone());
        let parts = match known {
            Some(parts) => parts,
            None => {
                let (parts, cpu_ms) = cut(mesh, fineness)?;
                cutting.cpu_ms += cpu_ms;
                done.push((mesh.clone(), parts.clone()));
                parts
            }
        };
        if let Shape::Compound(compound) = &parts {
            cutting.hulls = cutting.hulls.max(compound.parts.len());
        }
        actor.def.shape = parts;
    }
    Ok(cutting)
}

/// Hulls of the parts that parry's VHACD finds, and what CPU time it took to find them. Milliseconds.
fn cut(mesh: &Mesh, fineness: Fineness) -> Result<(Shape, f64), String> {
    let start = ProcessTime::now();
    let vertices: Vec<Vector> = mesh.vertices.iter().map(|v| vector(*v)).collect();
    let found = VHACD::decompose(&parameters(fineness), &vertices, &mesh.triangles, true);
    let hulls = found.compute_exact_convex_hulls(&vertices, &mesh.triangles);
    let cpu_ms = 1000.0 * start.elapsed().as_secs_f64();
    let mut parts = Vec::new();
    for (points, _) in hulls {
        let points: Vec<Vec3> = points.iter().map(|p| Vec3::new(p.x, p.y, p.z)).collect();
        let hull = Shape::hull(&points).map_err(|error| format!("a convex part of a mesh: {error}"))?;
        parts.push((Pose::IDENTITY, hull));
    }
    Ok((Shape::compound(parts).map_err(|error| error.to_string())?, cpu_ms))
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
        for fineness in [Fineness::Default, Fineness::Fine] {
            let mut stage = Stage::of(&forerun::Scene::open("tori:3").unwrap()).unwrap();
            let whole = stage.actors[1].def.shape.clone();
            let count = cut_moving_meshes(&mut stage, fineness).unwrap().hulls;
            let parts = &stage.actors[3].def.shape;
            let ratio = parts.mass_properties(1.0).mass / whole.mass_properties(1.0).mass;
            assert!((4..=128).contains(&count), "{count} hulls");
            assert!((0.95..1.3).contains(&ratio), "{ratio} of the volume");
            let distance = distance_to_hulls(parts).unwrap();
            // The hole of radius 0.3 m is there, and so is the tube.
            assert!((0.2..0.31).contains(&distance(Vec3::ZERO)), "{}", distance(Vec3::ZERO));
            assert!(distance(Vec3::Z * 0.5) < -0.1 && distance(Vec3::Y) > 0.8);
        }
    }
}
