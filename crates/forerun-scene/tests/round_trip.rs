//! Every scene that is written comes back the same, bit for bit; the committed files are the built-in scenes.

use std::path::{Path, PathBuf};

use forerun_dynamics::{BodyDef, Mass};
use forerun_scene::{BuiltIn, Format, Scene, SceneCommand, builtin};

/// Sizes that keep the test short; everything else is made at its usual size.
fn name_and_size(built_in: &BuiltIn) -> String {
    match built_in.name {
        "many_pyramids" | "islands" => format!("{}:9", built_in.name),
        "large_pyramid" => "large_pyramid:40".to_owned(),
        "rings" | "rain" | "convex_pile" => format!("{}:100", built_in.name),
        name => name.to_owned(),
    }
}

fn bits(def: &BodyDef) -> Vec<u32> {
    let (p, q) = (def.pose.position, def.pose.rotation);
    let mass = match def.mass {
        Mass::Density(x) | Mass::Total(x) => vec![x],
        Mass::Given { mass, centre, inertia, principal_rotation: r } => {
            let (c, i) = (centre, inertia);
            vec![mass, c.x, c.y, c.z, i.x, i.y, i.z, r.x, r.y, r.z, r.w]
        }
    };
    let mut numbers = mass;
    for v in [p, def.velocity, def.angular_velocity, def.force, def.torque] {
        numbers.extend([v.x, v.y, v.z]);
    }
    let m = def.material;
    numbers.extend([q.x, q.y, q.z, q.w, m.friction, m.static_friction, m.restitution, def.gravity_scale]);
    numbers.iter().map(|x| x.to_bits()).collect()
}

fn assert_same(a: &Scene, b: &Scene) {
    assert_eq!(a.to_toml(), b.to_toml());
    assert_eq!((&a.name, &a.description), (&b.name, &b.description));
    assert_eq!((a.seconds.to_bits(), a.environment()), (b.seconds.to_bits(), b.environment()));
    let (x, y) = (a.bodies().unwrap(), b.bodies().unwrap());
    assert_eq!(x.len(), y.len());
    for (x, y) in x.iter().zip(&y) {
        assert_eq!(bits(x), bits(y));
        assert_eq!(x, y);
    }
    assert_eq!(a.commands().unwrap(), b.commands().unwrap());
}

#[test]
fn every_built_in_scene_comes_back_from_toml_and_json() {
    for built_in in builtin::list() {
        let scene = Scene::open(&name_and_size(built_in)).unwrap();
        assert_eq!(scene.name, built_in.name);
        assert_same(&scene, &Scene::parse(&scene.to_toml(), Format::Toml, "again.toml").unwrap());
        assert_same(&scene, &Scene::parse(&scene.to_json(), Format::Json, "again.json").unwrap());
    }
}

const EVERYTHING: &str = r#"
name = "everything"
description = "Each field once, with a value that is not its default."
seconds = 3.5
frame_seconds = 0.03
gravity = [0.1, -1.62, -0.0]

[settings]
substeps = 8
first_sweeps = 5
contact_margin_m = 0.03
overlap_allowed_m = 0.001
overlap_recovery = 0.25
recovery_speed_max = 1.5
shock_yield = 0.75
rest_speed = 0.01
rest_seconds = 0.0
slices_max = 16

[meshes."a ring"]
torus = { radius = 0.5, tube_radius = 0.2, segments = 12, sides = 6 }
scale = 2.0
[meshes.knot]
torus_knot = { p = 2, q = 3, radius = 0.5, winding_radius = 0.2, tube_radius = 0.1, segments = 64, sides = 6 }
[meshes.ball]
ball = { radius = 1.0, parts = 2 }
open = true
[meshes.bowl]
bowl = { radius = 1.0, foot_radius = 0.5, height = 0.6, thickness = 0.1, segments = 16 }
cell = 0.05
[meshes.mug]
mug = { radius = 0.4, height = 0.9, thickness = 0.05, handle_radius = 0.06, handle_reach = 0.28, segments = 32 }
[meshes.gear]
gear = { teeth = 12, module = 0.1, half_width = 0.1, bore = 0.2 }
[meshes.letter]
letter = { letter = "R", height = 1.0, depth = 0.25 }
[meshes.chair]
chair = { width = 0.5, depth = 0.45, seat_height = 0.46, height = 0.95, bar = 0.04 }
[meshes.jack]
jack = { reach = 0.5, arm_radius = 0.1, knob_radius = 0.11, cells = 18 }
[meshes.link]
link = { radius = 0.3, straight = 0.2, tube_radius = 0.08, bend_parts = 6, sides = 6 }
[meshes.bolt]
bolt = { thread = { radius = 0.2, pitch = 0.1 }, length = 0.5, head_radius = 0.35, head_height = 0.2, head = "hexagonal", segments = 24 }
[meshes.nut]
nut = { thread = { radius = 0.2, pitch = 0.1 }, clearance = 0.01, height = 0.3, outer_radius = 0.36, outside = "round", segments = 24 }
[meshes.terrain]
terrain = { half_width = 5.0, height = 1.0, hill = 4.0, cells = 10, seed = 7 }
open = true

[[bodies]]
name = "ground"
shape = "half_space"
kind = "fixed"

[[bodies]]
shape = { capsule = { half_height = 0.0, radius = 0.001 } }
position = [0.1, 0.30000004, -0.0]
rotation = { axis = [1.0, 1.0, 0.0], angle_degrees = -30.0 }
velocity = [0.00000000000000000001, 0.2, 0.3]
angular_velocity = [1.0, 2.0, 3.0]
kind = "kinematic"
friction = 0.1
static_friction = 0.7
restitution = 0.9
density = 7800.0
gravity_scale = -0.5
force = [1.0, 0.0, 0.0]
torque = [0.0, 0.1, 0.0]

[[bodies]]
shape = { compound = [{ shape = { box = { half_extents = [1.0, 2.0, 3.0] } }, position = [1.0, 0.0, 0.0], rotation = { yaw_degrees = 45.0 } }, { shape = { cylinder = { half_height = 0.5, radius = 0.25 } } }] }
mass = 3.0
centre_of_mass = [0.1, 0.0, 0.0]
inertia = [1.0, 2.0, 2.5]
inertia_rotation = [0.0, 0.0, 0.0, 1.0]

[[bodies]]
name = "hull"
shape = { hull = { points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] } }

[[bodies]]
shape = { mesh = "a ring" }

[[commands]]
frame = 3
add = { name = "late", shape = { sphere = { radius = 0.5 } }, position = [0.0, 5.0, 0.0] }

[[commands]]
frame = 2
remove = 4

[[commands]]
seconds = 0.31
move = { body = "late", position = [1.0, 2.0, 3.0], rotation = [0.0, 1.0, 0.0, 0.0] }

[[commands]]
frame = 12
push = { body = 2, impulse = [1.0, 0.0, 0.0], point = [0.0, 1.0, 0.0] }

[[commands]]
frame = 13
set_velocity = { body = "hull", velocity = [1.0, 0.0, 0.0], angular_velocity = [0.0, 0.0, 1.0] }

[[commands]]
frame = 14
set_force = { body = "hull", force = [1.0, 0.0, 0.0], torque = [0.0, 0.0, 1.0] }

[[commands]]
frame = 15
set_material = { body = "hull", friction = 0.2, static_friction = 0.3, restitution = 0.4 }

[[commands]]
frame = 16
set_kind = { body = "hull", kind = "fixed" }

[[commands]]
frame = 17
hold = { body = 2, anchor = [0.1, 0.0, 0.0], target = [0.0, 2.0, 0.0], frequency_hz = 3.0, damping_ratio = 0.5 }

[[commands]]
frame = 18
release = 2

[[commands]]
frame = 19
set_gravity = [0.0, 0.0, 0.0]

[[commands]]
frame = 20
set_gravity_scale = { body = "hull", scale = -0.5 }

[[commands]]
frame = 21
set_mass = { body = "hull", mass = 12.5 }
"#;

/// Line by line: a field that the writer forgets is missing here.
#[test]
fn a_scene_with_every_field_is_written_as_it_was_read() {
    let scene = Scene::parse(EVERYTHING, Format::Toml, "everything.toml").unwrap();
    let lines = |text: &str| -> Vec<String> {
        let mut lines: Vec<String> =
            text.lines().filter(|line| !line.is_empty()).map(str::to_owned).collect();
        // Meshes come out by name, commands as written.
        lines.sort();
        lines
    };
    assert_eq!(lines(&scene.to_toml()), lines(EVERYTHING));
    assert_same(&scene, &Scene::parse(&scene.to_json(), Format::Json, "everything.json").unwrap());
}

#[test]
fn commands_come_in_the_order_of_their_frames_with_the_bodies_numbers() {
    let scene = Scene::parse(EVERYTHING, Format::Toml, "everything.toml").unwrap();
    let commands = scene.commands().unwrap();
    let frames: Vec<u64> = commands.iter().map(|c| c.frame).collect();
    assert_eq!(frames, [2, 3, 10, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21]);
    assert_eq!(commands[0].command, SceneCommand::Remove { body: 4 });
    assert!(matches!(&commands[1].command, SceneCommand::Add { body: 5, .. }));
    assert!(matches!(&commands[2].command, SceneCommand::Move { body: 5, .. }));
    assert_eq!(commands[11].command, SceneCommand::SetGravityScale { body: 3, scale: -0.5 });
    assert_eq!(commands[12].command, SceneCommand::SetMass { body: 3, mass: 12.5 });
    assert!(matches!(&commands[4].command, SceneCommand::SetVelocity { body: 3, .. }));
}

fn scenes_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

/// To write them anew: `forerun scenes slope > scenes/slope.toml`.
#[test]
fn committed_scene_files_are_the_built_in_scenes() {
    let mut found = 0;
    for entry in std::fs::read_dir(scenes_folder()).unwrap() {
        let path = entry.unwrap().path();
        if Format::of(&path).is_none() {
            continue;
        }
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let built_in = Scene::open(&name).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), built_in.to_toml(), "{}", path.display());
        assert_same(&built_in, &Scene::load(&path).unwrap());
        found += 1;
    }
    assert!(found >= 3, "slope, cradle and stack are committed");
}

/// The page on the format must stay true: each of its whole scenes is read.
#[test]
fn the_scenes_of_the_documentation_are_right() {
    let page = std::fs::read_to_string(scenes_folder().join("../docs/scene-format.md")).unwrap();
    let mut read = 0;
    for (fence, format) in [("```toml\nname", Format::Toml), ("```json\n{", Format::Json)] {
        for part in page.split(fence).skip(1) {
            let text = format!("{}{}", fence.split_once('\n').unwrap().1, part.split("```").next().unwrap());
            let scene = Scene::parse(&text, format, "docs/scene-format.md").unwrap();
            assert!(!scene.bodies().unwrap().is_empty());
            scene.commands().unwrap();
            read += 1;
        }
    }
    assert!(read >= 2, "a TOML and a JSON scene");
}

#[test]
fn the_options_of_a_mesh_file_are_written() {
    let text =
        "name = \"z up\"\n[meshes.part]\nfile = \"part.stl\"\nscale = 0.001\nup = \"z\"\ncell = 0.002\n";
    let scene = Scene::parse(text, Format::Toml, "z_up.toml").unwrap();
    let written = scene.to_toml();
    for line in text.lines() {
        assert!(written.lines().any(|other| other == line), "{line} is not in\n{written}");
    }
    let json = Scene::parse(&scene.to_json(), Format::Json, "z_up.json").unwrap();
    assert_eq!(json.meshes, scene.meshes);
}

#[test]
fn mesh_files_are_found_beside_the_scene_in_obj_and_stl() {
    let folder = std::env::temp_dir().join(format!("forerun-scene-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    std::fs::write(folder.join("tetra.obj"), obj).unwrap();
    let v = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let mut stl = "solid t\n".to_owned();
    for face in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
        stl += "facet normal 0 0 0\nouter loop\n";
        for corner in face {
            let [x, y, z] = v[corner];
            stl += &format!("vertex {x} {y} {z}\n");
        }
        stl += "endloop\nendfacet\n";
    }
    std::fs::write(folder.join("tetra.stl"), stl + "endsolid t\n").unwrap();
    let scene = "name = 'files'\n[meshes.a]\nfile = 'tetra.obj'\n[meshes.b]\nfile = 'tetra.stl'\n\
                 [[bodies]]\nshape = { mesh = 'a' }\n[[bodies]]\nshape = { mesh = 'b' }\n";
    std::fs::write(folder.join("files.toml"), scene).unwrap();
    let bodies = Scene::load(folder.join("files.toml")).unwrap().bodies().unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    for body in &bodies {
        let forerun_geometry::Shape::Mesh(mesh) = &body.shape else { panic!("a mesh") };
        assert_eq!((mesh.vertices.len(), mesh.triangles.len(), mesh.has_inside()), (4, 4, true));
    }
}
