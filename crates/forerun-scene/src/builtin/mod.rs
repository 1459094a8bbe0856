//! Built-in scenes, by name and size: `dominoes`, `dominoes:10000`.
//!
//! Sizes, distances and speeds are those of the published cases that each scene names, so that figures can be put side by side.

mod balls;
mod dissertation;
mod flying;
mod groups;
mod mechanisms;
mod noise;
mod parts;
mod piles;
mod sliding;
mod structures;
mod towers;
mod toys;

use crate::error::{Fault, SceneError};
use crate::scene::Scene;
use crate::source::Source;

/// A scene that needs no file.
#[derive(Clone, Copy, Debug)]
pub struct BuiltIn {
    /// Its name, as on the command line.
    pub name: &'static str,
    /// The size it has when none is given. None: it has only one size.
    pub default_size: Option<u32>,
    /// What the size counts. Empty if it has only one.
    pub size_counts: &'static str,
    /// What it shows, in a sentence.
    pub description: &'static str,
    size_max: u32,
    make: fn(u32) -> Scene,
}

const fn sized(
    name: &'static str,
    (default_size, size_max, size_counts): (u32, u32, &'static str),
    description: &'static str,
    make: fn(u32) -> Scene,
) -> BuiltIn {
    BuiltIn { name, default_size: Some(default_size), size_counts, description, size_max, make }
}

const fn single(name: &'static str, description: &'static str, make: fn(u32) -> Scene) -> BuiltIn {
    BuiltIn { name, default_size: None, size_counts: "", description, size_max: 1, make }
}

const TILT: (u32, u32, &str) = (4, 10, "tilts of 4.5 degrees");

static BUILT_INS: &[BuiltIn] = &[
    sized("dominoes", (255, 100_000, "dominoes"), "Dominoes in a spiral", dissertation::dominoes),
    sized(
        "meshes",
        (60, 10_000, "meshes"),
        "Rings and knotted tubes of about 5000 triangles",
        dissertation::meshes,
    ),
    sized(
        "interaction",
        (255, 100_000, "dominoes"),
        "Dominoes, and a ball at 10 s",
        dissertation::interaction,
    ),
    sized("stack", (20, 10_000, "boxes"), "A stack of boxes, dropped from 0.1 m", dissertation::stack),
    sized("pyramid", (30, 500, "boxes in the lowest row"), "A pyramid of boxes", piles::pyramid),
    sized(
        "large_pyramid",
        (100, 500, "boxes in the lowest row"),
        "The same, one island of 5050",
        piles::large_pyramid,
    ),
    sized(
        "many_pyramids",
        (196, 10_000, "pyramids"),
        "Pyramids of 55 boxes that never meet",
        piles::many_pyramids,
    ),
    sized("islands", (100, 10_000, "piles"), "Piles of 100 boxes that never meet", piles::islands),
    sized("rain", (1000, 100_000, "bodies"), "Balls, boxes and capsules fall into a pit", piles::rain),
    sized("rings", (500, 5000, "rings"), "Rings fall over 25 poles", piles::rings),
    sized("tori", (50, 10_000, "rings"), "Rings of 1536 triangles fall on a heap", piles::tori),
    sized("convex_pile", (5120, 100_000, "rocks"), "A column of rocks collapses", piles::convex_pile),
    sized("domino_lines", (40, 1000, "lines"), "Lines of 25 dominoes that never meet", groups::domino_lines),
    sized("walls", (20, 1000, "piles"), "Piles with thin walls between them", groups::walls),
    sized("break", (4, 50, "rows of balls"), "A break on a billiard table", groups::billiard_break),
    single("meeting", "Two groups that meet after 5 s, and a third that never does", groups::meeting),
    sized("chain", (12, 100, "links"), "A chain of interlocked links hangs", mechanisms::chain),
    single("nut", "A nut falls down the thread of a bolt", mechanisms::nut),
    sized("swing", (8, 100, "links"), "A chain of rings swings into a heap", groups::swing),
    sized("mugs", (40, 1000, "mugs"), "Mugs on hooks, and as many that fall on them", toys::mugs),
    sized("bowl", (60, 1000, "things"), "Gears, jacks, knots, letters and more fall into a bowl", toys::bowl),
    sized("chairs", (50, 1000, "chairs"), "Chairs fall on a heap", toys::chairs),
    sized("letters", (42, 1000, "letters"), "Letters fall and lie", toys::letters),
    sized("gears", (8, 100, "gears"), "Gears in mesh round pegs; the first is turned", toys::gears),
    sized("hills", (60, 10_000, "things"), "All sorts of things fall on hills, an open mesh", toys::hills),
    sized("pile", (1000, 100_000, "boxes"), "Boxes in a pit, one heap that comes to rest", groups::pile),
    sized("hail", (500, 10_000, "balls"), "Elastic balls at 50 m/s between thin walls", groups::hail),
    sized("cradle", (5, 1000, "balls"), "A row of elastic balls between two walls", structures::cradle),
    single("slope", "Blocks of different friction on a ramp", structures::slope),
    sized(
        "capstone",
        (300, 100_000, "masses of a cube"),
        "Heavy cubes fall on pyramids of light ones",
        structures::capstone,
    ),
    single("arch", "An arch of 17 wedges that carries 4 boxes", structures::arch),
    single("plank", "A plank over an edge becomes a catapult", structures::plank),
    sized("kapla", (6, 100, "floors"), "A tower of loose blocks, 17 a floor", structures::kapla),
    sized("tower", (40, 1000, "cubes"), "A tower of cubes that touch", towers::tower),
    sized(
        "falling_tower",
        (40, 1000, "cubes"),
        "A tower of cubes that falls together",
        towers::falling_tower,
    ),
    sized("jenga", (30, 1000, "layers"), "A tower of planks laid crosswise", towers::jenga),
    sized(
        "tiny_pyramid",
        (30, 500, "cubes in the lowest row"),
        "A pyramid of 5 cm cubes",
        towers::tiny_pyramid,
    ),
    sized("card_house", (5, 50, "levels"), "A house of cards", towers::card_house),
    sized("ball_cube", (6, 40, "balls along an edge"), "A cube of balls falls apart", balls::cube_collapses),
    sized(
        "elastic_ball_cube",
        (6, 40, "balls along an edge"),
        "A cube of elastic balls falls apart",
        balls::cube_bounces,
    ),
    single("a01a", "Slope: a block slides 0.624 m and stops", sliding::a01a),
    single("a01b", "Slope: a block slides faster and faster", sliding::a01b),
    single("a01c", "Level: three blocks slide equally far", sliding::a01c),
    sized("a04a", TILT, "A ball rolls down", sliding::a04a),
    sized("a04b", TILT, "A cylinder rolls down", sliding::a04b),
    sized("a04c", TILT, "A hoop rolls down", sliding::a04c),
    sized("a04d", TILT, "A ball slips down", sliding::a04d),
    sized("a04e", TILT, "A ball of triangles rolls down", sliding::a04e),
    single("a06a", "32 blocks slide equally far in all directions", sliding::a06a),
    single("a06b", "A spinning block is braked", sliding::a06b),
    single("a07", "49 elastic balls keep their energy", flying::a07),
    single("a09a", "Free rotation about the intermediate axis flips", flying::a09a),
    single("a09b", "Free rotation about the largest axis does not", flying::a09b),
    single("a09c", "Free rotation about the smallest axis does not", flying::a09c),
    single("a09d", "Free rotation of a cylinder for 300 s", flying::a09d),
    single("a11a", "A ball hits a rod off its centre", flying::a11a),
    single("a11b", "A ball hits an L of two boxes off its centre", flying::a11b),
    single("a12a", "A spinning ball falls and sticks", flying::a12a),
    single("a12b", "A spinning ball falls and slides", flying::a12b),
    sized("a16a", (20, 80, "degrees of tilt"), "A tilted disc rolls round on its rim", flying::a16a),
    single("a16b", "A disc rolls upright at 0.8 m/s", flying::a16b),
    single("a16c", "A disc at 0.3 m/s falls over", flying::a16c),
    single("a18a", "Turntable, friction 0.1", sliding::a18a),
    single("a18b", "Turntable, friction 0.5", sliding::a18b),
    single("a18c", "Turntable, friction 1", sliding::a18c),
    single("a18d", "Turntable, friction 0.5, constant spin", sliding::a18d),
    single("a19a", "Five balls, gaps, restitution 1", flying::a19a),
    single("a19b", "Five balls, gaps, restitution 0.9", flying::a19b),
    single("a19c", "Five balls that touch", flying::a19c),
    single("a19d", "Five balls on the ground with friction", flying::a19d),
];

/// All built-in scenes, the main ones first.
#[must_use]
pub fn list() -> &'static [BuiltIn] {
    BUILT_INS
}

/// A built-in scene by its name, with a size behind a colon if another than the usual one is wanted.
///
/// # Errors
/// When there is no such scene, or not of this size; the message lists what there is.
pub fn scene(name_and_size: &str) -> Result<Scene, SceneError> {
    let fault =
        |message: String, remedy: String| Source::named(name_and_size).error(Fault::new(message, remedy));
    let (name, size) = match name_and_size.split_once(':') {
        Some((name, size)) => (name, Some(size)),
        None => (name_and_size, None),
    };
    let Some(built_in) = BUILT_INS.iter().find(|built_in| built_in.name == name) else {
        let names: Vec<&str> = BUILT_INS.iter().map(|built_in| built_in.name).collect();
        return Err(fault(
            format!("there is no built-in scene \"{name}\"; there are {}", names.join(", ")),
            "take one of these, or a file that ends in .toml or .json".to_owned(),
        ));
    };
    let size = match (size, built_in.default_size) {
        (None, default) => default.unwrap_or(1),
        (Some(_), None) => {
            return Err(fault(format!("{name} has only one size"), format!("write {name} alone")));
        }
        (Some(text), Some(default)) => {
            let size = text.parse().ok().filter(|size| (1..=built_in.size_max).contains(size));
            size.ok_or_else(|| {
                let (most, counts) = (built_in.size_max, built_in.size_counts);
                let message = format!(
                    "the size of {name} is a whole number from 1 to {most} ({counts}), is \"{text}\""
                );
                fault(message, format!("for example {name}:{default}"))
            })?
        }
    };
    Ok((built_in.make)(size))
}
