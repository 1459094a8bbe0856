//! Sets: scenes that stand for all, each with how many frames it takes to tell engines apart, and what we want to reach.

/// The word for the scenes that we compare by.
const ALL: &str = "all";
/// The word for the scenes where meshes move.
pub(crate) const MESHES: &str = "meshes";

/// A scene of a set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) scene: &'static str,
    /// Few enough that all nine take about ten minutes on two threads with three rounds.
    pub(crate) frames: u32,
    /// The part of the best other engine's time that we want to need on one thread; none where we have set none.
    pub(crate) goal: Option<f64>,
}

const fn entry(scene: &'static str, frames: u32, goal: Option<f64>) -> Entry {
    Entry { scene, frames, goal }
}

/// Small and large, one island and many, boxes and mixed shapes, touching at the start and falling.
const SCENES: [Entry; 9] = [
    entry("dominoes", 300, Some(0.6)),
    entry("dominoes:10000", 40, Some(0.5)),
    entry("pyramid", 200, Some(0.8)),
    entry("large_pyramid", 60, Some(0.5)),
    entry("many_pyramids", 40, None),
    entry("islands", 60, Some(0.5)),
    entry("rain", 200, Some(0.7)),
    entry("rain:5000", 100, Some(0.7)),
    entry("convex_pile", 200, None),
];

/// What meshes that move are used for.
const MESH_SCENES: [Entry; 7] = [
    entry("tori", 300, Some(0.6)),
    entry("rings:100", 600, None),
    entry("chain", 300, None),
    entry("nut", 300, None),
    entry("mugs", 300, None),
    entry("bowl", 300, None),
    entry("chairs", 300, None),
];

/// The set of a name.
pub(crate) fn named(name: &str) -> Option<&'static [Entry]> {
    match name {
        ALL => Some(&SCENES),
        MESHES => Some(&MESH_SCENES),
        _ => None,
    }
}

/// What we want to reach on a scene.
pub(crate) fn goal(scene: &str) -> Option<f64> {
    SCENES.iter().chain(&MESH_SCENES).find(|entry| entry.scene == scene)?.goal
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nut::Nut;
    use crate::stage::Stage;

    #[test]
    fn every_scene_of_the_set_exists() {
        for entry in SCENES.iter().chain(&MESH_SCENES) {
            assert!(forerun::Scene::open(entry.scene).is_ok(), "{}", entry.scene);
        }
        assert_eq!((goal("islands"), goal("stack")), (Some(0.5), None));
    }

    #[test]
    fn the_nut_is_followed_on_its_bolt() {
        let entry = MESH_SCENES.iter().find(|entry| entry.scene == "nut").unwrap();
        let scene = forerun::Scene::open(entry.scene).unwrap();
        assert!(Nut::of(&scene, &Stage::of(&scene).unwrap()).is_some());
    }
}
