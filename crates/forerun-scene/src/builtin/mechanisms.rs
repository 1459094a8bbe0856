//! Mechanisms of meshes: what keeps them together is their form alone.

use std::f32::consts::{FRAC_PI_2, PI};

use forerun_geometry::Vec3;

use super::parts::{ground, mesh, turn};
use crate::mesh::{BoltEntry, GripEntry, LinkEntry, NutEntry, ThreadEntry};
use crate::{BodyEntry, Scene};

/// A chain of links hangs from a fixed one; at first it leans a little.
pub(super) fn chain(links: u32) -> Scene {
    const LINK: LinkEntry =
        LinkEntry { radius: 0.06, straight: 0.08, tube_radius: 0.02, bend_parts: 16, sides: 16 };
    // From one link to the next where their tubes touch, less half a millimetre of play.
    const PITCH: f32 = LINK.straight + 2.0 * (LINK.radius - LINK.tube_radius) - 0.0005;
    const LEAN: f32 = 0.15;
    let mut scene = Scene::new("chain", "A chain of interlocked steel links hangs from a fixed one.");
    scene.seconds = 60.0;
    scene.meshes.insert("link".to_owned(), LINK.into());
    scene.put(ground());
    let hook = Vec3::Y * (0.5 + PITCH * links as f32);
    let (sin, cos) = libm::sincosf(LEAN);
    for i in 0..=links {
        // The long axis of a link is x: turned down, then every other one by a quarter about it.
        let quarter = if i % 2 == 0 { 0.0 } else { FRAC_PI_2 };
        let rotation = turn(Vec3::Z, LEAN - FRAC_PI_2) * turn(Vec3::X, quarter);
        let link = mesh("link").turned(rotation).at(hook + Vec3::new(sin, -cos, 0.0) * (PITCH * i as f32));
        scene.put(if i == 0 { link.named("hook").fixed() } else { steel(link).surface(0.3, 0.0) });
    }
    scene
}

/// A nut without friction falls down the thread of a bolt that stands on its head.
pub(super) fn nut(_: u32) -> Scene {
    const THREAD: ThreadEntry = ThreadEntry { radius: 0.024, pitch: 0.012 };
    const PITCHES: f32 = 13.0;
    const BOLT: BoltEntry = BoltEntry {
        thread: THREAD,
        length: PITCHES * THREAD.pitch,
        head_radius: 0.032,
        head_height: 0.02,
        head: GripEntry::Round,
        segments: 60,
    };
    const NUT: NutEntry = NutEntry {
        thread: THREAD,
        clearance: 0.0004,
        height: 0.03,
        outer_radius: 0.036,
        outside: GripEntry::Hexagonal,
        segments: 60,
    };
    let mut scene =
        Scene::new("nut", "A nut without friction falls down the thread of a bolt, turning all the way.");
    scene.seconds = 5.0;
    scene.meshes.insert("bolt".to_owned(), BOLT.into());
    scene.meshes.insert("nut".to_owned(), NUT.into());
    scene.put(ground());
    let foot = Vec3::Y * BOLT.head_height;
    let bolt = mesh("bolt").named("bolt").fixed().surface(0.0, 0.0);
    scene.put(bolt.at(foot).turned(turn(Vec3::X, PI)));
    // A whole number of pitches up, the two threads fit without a turn.
    let start = foot + Vec3::Y * ((PITCHES - 2.0) * THREAD.pitch);
    scene.put(steel(mesh("nut").named("nut")).surface(0.0, 0.0).at(start));
    scene
}

fn steel(mut body: BodyEntry) -> BodyEntry {
    body.density = Some(7850.0);
    body
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(body: &BodyEntry) -> Vec3 {
        Vec3::from_array(body.position)
    }

    #[test]
    fn neighbouring_links_are_interlocked_and_apart() {
        let scene = chain(12);
        assert_eq!(scene.bodies.len(), 1 + 1 + 12);
        for pair in scene.bodies[1..].windows(2) {
            let distance = place(&pair[0]).distance(place(&pair[1]));
            // Tube on tube it would be 0.16 m; where the one left the other, 0.24 m.
            assert!(distance < 0.16 && distance > 0.159, "{distance}");
        }
    }

    #[test]
    fn the_nut_begins_on_the_thread() {
        let scene = nut(1);
        let (bolt, nut) = (place(&scene.bodies[1]), place(&scene.bodies[2]));
        let pitches = (nut - bolt).y / 0.012;
        assert!((pitches - 11.0).abs() < 1e-4, "{pitches}");
    }
}
