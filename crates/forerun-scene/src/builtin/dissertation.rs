//! The four scenes of the dissertation's experiments (its chapter 5): dominoes, meshes, interaction, stack.

use forerun_geometry::Vec3;

use super::noise::Noise;
use super::parts::{cube, cuboid, ground, mesh, sphere, turn, walls};
use crate::mesh::{TorusEntry, TorusKnotEntry};
use crate::{BodyEntry, CommandEntry, MeshEntry, Scene};

/// Half extents of a domino: its thin side looks along the row.
const DOMINO: Vec3 = Vec3::new(0.05, 0.25, 0.125);
/// From one domino to the next along the row. Metres.
pub(super) const DOMINO_STEP: f32 = 0.2;
/// The innermost domino turns about its leading bottom edge. rad/s; at 3 rad/s some engines' wave never starts.
const TIP_SPEED: f32 = 6.0;

/// A row of dominoes along a spiral from the inside out; the first one topples.
pub(super) fn dominoes(count: u32) -> Scene {
    let mut scene = Scene::new(
        "dominoes",
        "Dominoes in a spiral; the innermost is tipped over and the wave runs outwards.",
    );
    scene.seconds = 30.0;
    scene.put(ground());
    let mut spiral = Spiral::new();
    for i in 0..count {
        let (foot, along) = (spiral.point(), spiral.tangent());
        let body = domino(foot, along);
        scene.put(if i == 0 { tipped(body, along) } else { body });
        spiral.advance(DOMINO_STEP);
    }
    scene
}

/// A domino that stands on `foot` and faces `along`, a level unit vector.
pub(super) fn domino(foot: Vec3, along: Vec3) -> BodyEntry {
    let yaw = libm::atan2f(-along.z, along.x);
    cuboid(DOMINO.x, DOMINO.y, DOMINO.z).at(foot + Vec3::Y * DOMINO.y).turned(turn(Vec3::Y, yaw))
}

/// The domino turns about its leading bottom edge, as if it had been tipped.
pub(super) fn tipped(domino: BodyEntry, along: Vec3) -> BodyEntry {
    let spin = Vec3::Y.cross(along) * TIP_SPEED;
    let from_edge = Vec3::Y * DOMINO.y - along * DOMINO.x;
    domino.moving(spin.cross(from_edge)).spinning(spin)
}

/// An Archimedean spiral about the y axis: arms 0.8 m apart, from a radius of 2 m outwards.
struct Spiral {
    angle: f64,
}

impl Spiral {
    /// Radius gained per radian.
    const PITCH: f64 = 0.8 / std::f64::consts::TAU;

    fn new() -> Spiral {
        Spiral { angle: 2.0 / Spiral::PITCH }
    }

    /// Goes on by a length along the curve. In f64: the error of 10 000 steps stays below a micrometre.
    fn advance(&mut self, length: f32) {
        // ds/dangle = pitch sqrt(1 + angle²); the midpoint rule in 16 parts.
        let part = f64::from(length) / 16.0;
        let slope = |angle: f64| 1.0 / (Spiral::PITCH * (1.0 + angle * angle).sqrt());
        for _ in 0..16 {
            let middle = self.angle + 0.5 * part * slope(self.angle);
            self.angle += part * slope(middle);
        }
    }

    fn point(&self) -> Vec3 {
        let (sin, cos) = libm::sincos(self.angle);
        let radius = Spiral::PITCH * self.angle;
        Vec3::new((radius * cos) as f32, 0.0, (radius * sin) as f32)
    }

    /// Unit vector along the curve, outwards.
    fn tangent(&self) -> Vec3 {
        let (sin, cos) = libm::sincos(self.angle);
        Vec3::new((cos - self.angle * sin) as f32, 0.0, (sin + self.angle * cos) as f32).normalize()
    }
}

/// The dominoes, and a ball that comes in after 10 s and starts a second wave.
pub(super) fn interaction(count: u32) -> Scene {
    let mut scene = dominoes(count);
    scene.name = "interaction".to_owned();
    scene.description =
        "Dominoes in a spiral; after 10 s a ball is added, falls on those still standing and starts a second wave."
            .to_owned();
    // Three quarters along the row: the wave has not come so far at 10 s, with the 255 dominoes of the experiment.
    let below = &scene.bodies[1 + (count as usize * 3) / 4];
    let ball = sphere(0.25).named("ball").at(Vec3::from_array(below.position) + Vec3::Y * 2.0);
    scene.commands.push(CommandEntry {
        seconds: Some(10.0),
        add: Some(Box::new(ball)),
        ..CommandEntry::default()
    });
    scene
}

/// Rings and knots of some 5000 triangles each fall into a pit.
pub(super) fn meshes(count: u32) -> Scene {
    let mut scene = Scene::new(
        "meshes",
        "Rings and knotted tubes of about 5000 triangles each fall into a pit, as they are.",
    );
    let knot = |p, q, segments| {
        MeshEntry::from(TorusKnotEntry {
            p,
            q,
            radius: 0.5,
            winding_radius: 0.22,
            tube_radius: 0.1,
            segments,
            sides: 12,
        })
    };
    let ring = TorusEntry { radius: 0.6, tube_radius: 0.15, segments: 96, sides: 24 };
    scene.meshes.insert("ring".to_owned(), MeshEntry::from(ring));
    scene.meshes.insert("trefoil".to_owned(), knot(2, 3, 192));
    scene.meshes.insert("loop".to_owned(), knot(1, 2, 192));
    scene.put(ground());
    walls(&mut scene, 3.0, 6.0);
    let mut noise = Noise::new(60);
    for i in 0..count {
        let (layer, cell) = (i / 9, i % 9);
        let name = ["ring", "trefoil", "loop"][(i % 3) as usize];
        let x = (cell % 3) as f32 - 1.0;
        let z = (cell / 3) as f32 - 1.0;
        let place = Vec3::new(
            1.8 * x + noise.about_zero(0.05),
            1.2 + 1.8 * layer as f32,
            1.8 * z + noise.about_zero(0.05),
        );
        scene.put(mesh(name).at(place).turned(noise.rotation()));
    }
    scene
}

/// Boxes of 1 m above each other, 0.1 m apart, the lowest 0.1 m above the ground.
pub(super) fn stack(count: u32) -> Scene {
    let mut scene =
        Scene::new("stack", "Boxes of 1 m fall on each other from 0.1 m and have to stand as a stack.");
    scene.put(ground());
    for i in 0..count {
        scene.put(cube(0.5).at(Vec3::Y * (0.6 + 1.1 * i as f32)));
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dominoes_stand_at_equal_steps_along_arms_of_equal_distance() {
        let scene = dominoes(255);
        let at = |i: usize| Vec3::from_array(scene.bodies[i + 1].position);
        for i in 0..254 {
            let chord = at(i).distance(at(i + 1));
            assert!((chord - 0.2).abs() < 1e-3, "{i}: {chord}");
        }
        // The curve's length from a to b, by its closed form, is 254 steps.
        let length = |a: f64| 0.5 * Spiral::PITCH * (a * (1.0 + a * a).sqrt() + a.asinh());
        let mut spiral = Spiral::new();
        let start = spiral.angle;
        for _ in 0..254 {
            spiral.advance(DOMINO_STEP);
        }
        assert!((length(spiral.angle) - length(start) - 254.0 * f64::from(DOMINO_STEP)).abs() < 1e-6);
    }

    #[test]
    fn the_first_domino_turns_about_its_leading_bottom_edge() {
        let scene = dominoes(2);
        let (first, second) = (&scene.bodies[1], &scene.bodies[2]);
        let along = (Vec3::from_array(second.position) - Vec3::from_array(first.position)).normalize();
        let edge = along * 0.05 - Vec3::Y * 0.25;
        let v = Vec3::from_array(first.velocity);
        let w = Vec3::from_array(first.angular_velocity);
        assert!((v + w.cross(edge)).length() < 0.05, "the edge stays");
        let top = v + w.cross(Vec3::Y * 0.25);
        assert!(top.dot(along) > 2.9, "the top goes forward: {top}");
    }
}
