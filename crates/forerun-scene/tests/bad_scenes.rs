//! Every mistake in a scene is reported with its line, its field and what to do.

use forerun_scene::{Format, Scene, SceneError};

/// A scene with one mistake: its text, the line, the field, and words that message and remedy must have.
struct Bad {
    what: &'static str,
    text: &'static str,
    line: usize,
    field: &'static str,
    says: &'static [&'static str],
}

const HEAD: &str = "name = \"bad\"\n";

fn error_of(text: &str, format: Format) -> SceneError {
    let name = if format == Format::Toml { "bad.toml" } else { "bad.json" };
    // Mesh files and shapes are looked at only when the bodies are made.
    match Scene::parse(text, format, name) {
        Err(error) => error,
        Ok(scene) => match scene.bodies().err().or(scene.commands().err()) {
            Some(error) => error,
            None => panic!("this was accepted:\n{text}"),
        },
    }
}

fn assert_reports(bad: &Bad, text: &str, format: Format) {
    let error = error_of(text, format);
    let printed = error.to_string();
    let place = error.place.unwrap_or_else(|| panic!("{}: no place in {printed}", bad.what));
    assert_eq!(place.line, bad.line, "{}: {printed}", bad.what);
    assert_eq!(error.field, bad.field, "{}: {printed}", bad.what);
    assert!(!error.remedy.is_empty(), "{}: no remedy in {printed}", bad.what);
    for word in bad.says {
        assert!(printed.contains(word), "{}: \"{word}\" is not in {printed}", bad.what);
    }
}

const TOML: &[Bad] = &[
    Bad { what: "syntax", text: "[[bodies]]\nshape = = 3\n", line: 3, field: "", says: &["bad.toml:3:9"] },
    Bad { what: "unclosed table", text: "[settings\n", line: 2, field: "", says: &["]"] },
    Bad {
        what: "key given twice",
        text: "seconds = 1\nseconds = 2\n",
        line: 3,
        field: "",
        says: &["duplicate"],
    },
    Bad {
        what: "unknown field of the scene",
        text: "gravty = [0, -9.81, 0]\n",
        line: 2,
        field: "gravty",
        says: &["did you mean `gravity`"],
    },
    Bad {
        what: "unknown field of a body",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\nmas = 3\n",
        line: 4,
        field: "bodies[0].mas",
        says: &["`restitution`", "did you mean `mass`"],
    },
    Bad {
        what: "unknown field of a shape",
        text: "[[bodies]]\nshape = { sphere = { radius = 1,\n  height = 2 } }\n",
        line: 4,
        field: "bodies[0].shape.sphere.height",
        says: &["expected `radius`"],
    },
    Bad {
        what: "unknown shape",
        text: "[[bodies]]\n\nshape = { spere = { radius = 1 } }\n",
        line: 4,
        field: "bodies[0].shape",
        says: &["`half_space`", "did you mean `sphere`"],
    },
    Bad {
        what: "unknown kind",
        text: "[[bodies]]\nshape = \"half_space\"\nkind = \"static\"\n",
        line: 4,
        field: "bodies[0].kind",
        says: &["`fixed`", "`kinematic`"],
    },
    Bad {
        what: "missing shape",
        text: "[[bodies]]\nshape = \"half_space\"\nkind = \"fixed\"\n[[bodies]]\nmass = 1\n",
        line: 5,
        field: "bodies[1]",
        says: &["missing field `shape`"],
    },
    Bad {
        what: "text for a number",
        text: "[[bodies]]\nshape = { sphere = { radius = \"big\" } }\n",
        line: 3,
        field: "bodies[0].shape.sphere.radius",
        says: &["string \"big\"", "expected f32"],
    },
    Bad {
        what: "two numbers for three",
        text: "gravity = [0, -9.81]\n",
        line: 2,
        field: "gravity",
        says: &["length 2", "array of length 3"],
    },
    Bad {
        what: "radius below 0",
        text: "[[bodies]]\nshape = { sphere = { radius = -1 } }\n",
        line: 3,
        field: "bodies[0].shape.sphere.radius",
        says: &["must be above 0, is -1"],
    },
    Bad {
        what: "half extent 0 in a list over lines",
        text: "[[bodies]]\nshape = { box = { half_extents = [\n 1,\n 0,\n 1] } }\n",
        line: 5,
        field: "bodies[0].shape.box.half_extents[1]",
        says: &["must be above 0, is 0"],
    },
    Bad {
        what: "capsule with a negative height",
        text: "[[bodies]]\nshape.capsule.radius = 1\nshape.capsule.half_height = -0.5\n",
        line: 4,
        field: "bodies[0].shape.capsule.half_height",
        says: &["0 or more"],
    },
    Bad {
        what: "hull of three points",
        text: "[[bodies]]\nshape = { hull = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]] } }\n",
        line: 3,
        field: "bodies[0].shape.hull.points",
        says: &["4 points or more, this has 3"],
    },
    Bad {
        what: "hull in a plane",
        text: "[[bodies]]\nshape = { hull = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]] } }\n",
        line: 3,
        field: "bodies[0].shape.hull",
        says: &["plane"],
    },
    Bad {
        what: "body too heavy for a float",
        text: "[[bodies]]\n\nshape = { sphere = { radius = 1e13 } }\n",
        line: 4,
        field: "bodies[0].shape",
        says: &["mass", "inf"],
    },
    Bad {
        what: "open mesh that moves",
        text: "[meshes.m]\nopen = true\nfile = 'm.obj'\n[[bodies]]\nshape = { mesh = 'm' }\n",
        line: 6,
        field: "bodies[0].shape",
        says: &["open mesh", "kind = \"fixed\""],
    },
    Bad {
        what: "compound of a mesh",
        text: "[[bodies]]\nshape = { compound = [\n  { shape = { sphere = { radius = 1 } } },\n  { shape = { mesh = \"m\" } },\n] }\n",
        line: 5,
        field: "bodies[0].shape.compound[1].shape",
        says: &["sphere, box, capsule, cylinder or hull"],
    },
    Bad {
        what: "position not a number",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\nposition = [0, nan, 0]\n",
        line: 4,
        field: "bodies[0].position[1]",
        says: &["finite", "NaN"],
    },
    Bad {
        what: "infinite velocity",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\nvelocity = [inf, 0, 0]\n",
        line: 4,
        field: "bodies[0].velocity[0]",
        says: &["finite"],
    },
    Bad {
        what: "quaternion of length 2",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\nrotation = [0, 2, 0, 0]\n",
        line: 4,
        field: "bodies[0].rotation",
        says: &["unit quaternion", "of length 1 it is [0, 1, 0, 0]"],
    },
    Bad {
        what: "rotation with an axis and a yaw",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\nrotation = { axis = [0, 1, 0], yaw_degrees = 3 }\n",
        line: 4,
        field: "bodies[0].rotation",
        says: &["either `axis` and `angle_degrees`, or `yaw_degrees` alone"],
    },
    Bad {
        what: "axis without a direction",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\n[bodies.rotation]\nangle_degrees = 3\naxis = [0, 0, 0]\n",
        line: 6,
        field: "bodies[0].rotation.axis",
        says: &["has no length"],
    },
    Bad {
        what: "restitution above 1",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\nrestitution = 1.5\n",
        line: 4,
        field: "bodies[0].restitution",
        says: &["from 0 to 1, is 1.5"],
    },
    Bad {
        what: "negative friction",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\nfriction = -0.1\n",
        line: 4,
        field: "bodies[0].friction",
        says: &["0 or more, is -0.1"],
    },
    Bad {
        what: "static friction below kinetic",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\nstatic_friction = 0.2\n",
        line: 4,
        field: "bodies[0].static_friction",
        says: &["at least friction (0.5), is 0.2"],
    },
    Bad {
        what: "density and mass",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\ndensity = 500\nmass = 2\n",
        line: 5,
        field: "bodies[0].mass",
        says: &["density or a mass"],
    },
    Bad {
        what: "mass 0",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\nmass = 0\n",
        line: 4,
        field: "bodies[0].mass",
        says: &["above 0"],
    },
    Bad {
        what: "inertia without mass",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\ninertia = [1, 1, 1]\n",
        line: 4,
        field: "bodies[0].inertia",
        says: &["needs `mass`"],
    },
    Bad {
        what: "dynamic half-space",
        text: "[[bodies]]\nshape = \"half_space\"\n",
        line: 3,
        field: "bodies[0].shape",
        says: &["never dynamic", "kind = \"fixed\""],
    },
    Bad {
        what: "mesh that is not there",
        text: "[meshes.ring]\ntorus = { radius = 1, tube_radius = 0.2, segments = 9, sides = 9 }\n[[bodies]]\nshape = { mesh = \"rng\" }\n",
        line: 5,
        field: "bodies[0].shape.mesh",
        says: &["no mesh \"rng\"", "ring"],
    },
    Bad {
        what: "mesh file that is not there",
        text: "[meshes.mug]\nfile = \"no/such/mug.obj\"\n",
        line: 3,
        field: "meshes.mug.file",
        says: &["cannot be read", "mug.obj", "relative to the folder"],
    },
    Bad {
        what: "mesh file of another kind",
        text: "[meshes.mug]\nfile = \"mug.fbx\"\n",
        line: 3,
        field: "meshes.mug.file",
        says: &[".gltf or .glb"],
    },
    Bad {
        what: "mesh of two formulas",
        text: "[meshes.mug]\nfile = \"mug.obj\"\nball = { radius = 1, parts = 3 }\n",
        line: 2,
        field: "meshes.mug",
        says: &["exactly one"],
    },
    Bad {
        what: "torus thicker than its ring",
        text: "[meshes.ring.torus]\nradius = 0.5\ntube_radius = 0.6\nsegments = 20\nsides = 10\n",
        line: 3,
        field: "meshes.ring.torus.radius",
        says: &["above tube_radius (0.6), is 0.5"],
    },
    Bad {
        what: "knot that falls apart",
        text: "[meshes.k]\ntorus_knot = { p = 2, q = 4, radius = 1, winding_radius = 0.4, tube_radius = 0.1, segments = 99, sides = 9 }\n",
        line: 3,
        field: "meshes.k.torus_knot.q",
        says: &["no common factor"],
    },
    Bad {
        what: "frame of 0 seconds",
        text: "frame_seconds = 0\n",
        line: 2,
        field: "frame_seconds",
        says: &["from 0.00001 to 1"],
    },
    Bad {
        what: "too many substeps",
        text: "[settings]\nsubsteps = 100\n",
        line: 3,
        field: "settings.substeps",
        says: &["from 1 to 64, is 100"],
    },
    Bad {
        what: "slices not a power of two",
        text: "[settings]\nslices_max = 3\n",
        line: 3,
        field: "settings.slices_max",
        says: &["1, 2, 4, 8"],
    },
    Bad {
        what: "two bodies of one name",
        text: "[[bodies]]\nname = \"a\"\nshape = { sphere = { radius = 1 } }\n[[bodies]]\nname = \"a\"\nshape = { sphere = { radius = 1 } }\n",
        line: 6,
        field: "bodies[1].name",
        says: &["number 0 and number 1"],
    },
    Bad {
        what: "command without a time",
        text: "[[commands]]\nset_gravity = [0, 0, 0]\n",
        line: 2,
        field: "commands[0]",
        says: &["`frame` or a time in `seconds`"],
    },
    Bad {
        what: "command without an action",
        text: "[[commands]]\nframe = 1\n",
        line: 2,
        field: "commands[0]",
        says: &["set_velocity", "push"],
    },
    Bad {
        what: "command with two actions",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\n[[commands]]\nframe = 1\nremove = 0\nrelease = 0\n",
        line: 7,
        field: "commands[0].release",
        says: &["remove and release"],
    },
    Bad {
        what: "command before the start",
        text: "[[commands]]\nset_gravity = [0, 0, 0]\nframe = -1\n",
        line: 4,
        field: "commands[0].frame",
        says: &["-1"],
    },
    Bad {
        what: "command at the start",
        text: "[[commands]]\nset_gravity = [0, 0, 0]\nframe = 0\n",
        line: 4,
        field: "commands[0].frame",
        says: &["1 or more, is 0"],
    },
    Bad {
        what: "command to nobody",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\n[[commands]]\nframe = 1\npush = { impulse = [1, 0, 0], body = \"b\" }\n",
        line: 6,
        field: "commands[0].push.body",
        says: &["no body called \"b\"", "1 bodies"],
    },
    Bad {
        what: "command to a body that comes later",
        text: "[[commands]]\nframe = 5\nadd = { name = \"b\", shape = { sphere = { radius = 1 } } }\n[[commands]]\nframe = 4\nremove = \"b\"\n",
        line: 7,
        field: "commands[1].remove",
        says: &["added at frame 5, this is frame 4"],
    },
    Bad {
        what: "mistake in an added body",
        text: "[[commands]]\nseconds = 5\nadd = { name = \"b\", shape = { sphere = { radius = 0 } } }\n",
        line: 4,
        field: "commands[0].add.shape.sphere.radius",
        says: &["above 0"],
    },
    Bad {
        what: "hold stiffer than a step can follow",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\n[[commands]]\nframe = 1\n[commands.hold]\nbody = 0\ntarget = [0, 0, 0]\nfrequency_hz = 1e20\n",
        line: 9,
        field: "commands[0].hold.frequency_hz",
        says: &["above 0 and at most 10000"],
    },
    Bad {
        what: "hold damped beyond measure",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\n[[commands]]\nframe = 1\n[commands.hold]\nbody = 0\ntarget = [0, 0, 0]\ndamping_ratio = 1e20\n",
        line: 9,
        field: "commands[0].hold.damping_ratio",
        says: &["from 0 to 10000"],
    },
    Bad {
        what: "factor on gravity that is no number",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\n[[commands]]\nframe = 1\nset_gravity_scale = { body = 0, scale = inf }\n",
        line: 6,
        field: "commands[0].set_gravity_scale.scale",
        says: &["a finite number, is inf"],
    },
    Bad {
        what: "mass that is none",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\n[[commands]]\nframe = 1\nset_mass = { body = 0, mass = 0 }\n",
        line: 6,
        field: "commands[0].set_mass.mass",
        says: &["from 0.000000000001 to 1000000000000, is 0"],
    },
    Bad {
        what: "hold without stiffness",
        text: "[[bodies]]\nshape = { sphere = { radius = 1 } }\n[[commands]]\nframe = 1\n[commands.hold]\nbody = 0\ntarget = [0, 0, 0]\nfrequency_hz = 0\n",
        line: 9,
        field: "commands[0].hold.frequency_hz",
        says: &["above 0"],
    },
];

#[test]
fn mistakes_in_toml() {
    for bad in TOML {
        assert_reports(bad, &format!("{HEAD}{}", bad.text), Format::Toml);
    }
}

const JSON: &[Bad] = &[
    Bad { what: "syntax", text: "\"seconds\": 3,,\n}", line: 2, field: "", says: &["bad.json:2:"] },
    Bad { what: "cut off", text: "\"seconds\": 3\n", line: 3, field: "", says: &["EOF"] },
    Bad { what: "text after the end", text: "\"seconds\": 3\n}\n}", line: 4, field: "", says: &["trailing"] },
    Bad {
        what: "unknown field",
        text: "\"bodies\": [\n{ \"shape\": { \"sphere\": { \"radius\": 1 } },\n\"positon\": [0, 0, 0] } ] }",
        line: 4,
        field: "bodies[0].positon",
        says: &["did you mean `position`"],
    },
    Bad {
        what: "wrong type",
        text: "\"bodies\": [\n{ \"shape\": { \"sphere\": {\n\"radius\": true } } } ] }",
        line: 4,
        field: "bodies[0].shape.sphere.radius",
        says: &["boolean"],
    },
    Bad {
        what: "radius below 0",
        text: "\"bodies\": [\n{ \"shape\": \"half_space\", \"kind\": \"fixed\" },\n{ \"shape\": { \"sphere\": {\n\"radius\": -2 } } } ] }",
        line: 5,
        field: "bodies[1].shape.sphere.radius",
        says: &["above 0, is -2"],
    },
    Bad {
        what: "number too large for f32",
        text: "\"bodies\": [ { \"shape\": { \"sphere\": { \"radius\": 1 } },\n\"position\": [0,\n1e300, 0] } ] }",
        line: 4,
        field: "bodies[0].position[1]",
        says: &["out of range"],
    },
    Bad {
        what: "mesh file that is not there",
        text: "\"meshes\": {\n\"m\": { \"scale\": 2,\n\"file\": \"none.stl\" } } }",
        line: 4,
        field: "meshes.m.file",
        says: &["cannot be read"],
    },
    Bad {
        what: "command to a body that is not there",
        text: "\"commands\": [\n{ \"frame\": 1, \"remove\": 7 } ] }",
        line: 3,
        field: "commands[0].remove",
        says: &["number 7"],
    },
];

#[test]
fn mistakes_in_json() {
    for bad in JSON {
        assert_reports(bad, &format!("{{ \"name\": \"bad\",\n{}", bad.text), Format::Json);
    }
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let error = Scene::load("no/such/scene.toml").unwrap_err();
    assert!(error.to_string().starts_with("no/such/scene.toml: cannot be read"), "{error}");
    let error = Scene::load("scene.xml").unwrap_err();
    assert!(error.to_string().contains(".toml or .json"), "{error}");
}

#[test]
fn mistakes_in_mesh_files_are_named_by_their_own_line_too() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    std::fs::write(folder.join("bent.obj"), "v 0 0 0\nv 1 0 0\nf 1 2 3\n").unwrap();
    std::fs::write(folder.join("open.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let error = |file: &str| {
        let path = folder.join("bad_mesh.toml");
        std::fs::write(&path, format!("name = 'bad'\n[meshes.m]\nfile = '{file}'\n")).unwrap();
        Scene::load(&path).unwrap().bodies().unwrap_err().to_string()
    };
    let bent = error("bent.obj");
    for words in
        ["bad_mesh.toml:3:8: meshes.m.file: ", "bent.obj: line 3: vertex 3 does not", "(export the mesh"]
    {
        assert!(bent.contains(words), "\"{words}\" is not in {bent}");
    }
    let open = error("open.obj");
    assert!(open.contains("is not closed") && open.contains("open = true"), "{open}");
}

#[test]
fn built_in_scenes_that_do_not_exist_are_answered_with_a_list() {
    let error = Scene::open("dominos").unwrap_err().to_string();
    assert!(error.contains("dominoes, meshes, interaction, stack"), "{error}");
    for name in ["dominoes:0", "dominoes:x", "dominoes:", "dominoes:-5", "dominoes:99999999"] {
        let error = Scene::open(name).unwrap_err().to_string();
        assert!(error.contains("1 to 100000") && error.contains("dominoes:255"), "{error}");
    }
    assert!(Scene::open("slope:3").unwrap_err().to_string().contains("only one size"));
}

/// No text, however mangled, makes the reader panic.
#[test]
fn mangled_text_is_refused_or_read_but_never_panics() {
    let good = Scene::open("slope").unwrap();
    for (format, text) in [(Format::Toml, good.to_toml()), (Format::Json, good.to_json())] {
        let mut state = 1_u64;
        for _ in 0..2000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let mut bytes = text.clone().into_bytes();
            let at = (state >> 33) as usize % bytes.len();
            match state >> 24 & 3 {
                0 => bytes.truncate(at),
                1 => drop(bytes.remove(at)),
                2 => bytes[at] = b"[]{}=,\"-9e.\n"[(state >> 40) as usize % 12],
                _ => bytes.insert(at, b"[]{}=,\"-9e.\n"[(state >> 40) as usize % 12]),
            }
            if let Ok(scene) = Scene::parse(&String::from_utf8_lossy(&bytes), format, "mangled") {
                let _ = scene.bodies();
                let _ = scene.commands();
            }
        }
    }
}
