//! `forerun mesh` and `forerun render` as scripts see them.

mod common;

use std::path::Path;
use std::process::Output;

use common::{code, command, folder, json, run, text};
use serde_json::Value;

/// Runs it in a folder, with a cache in that folder.
fn forerun(folder: &Path, arguments: &[&str]) -> Output {
    run(command(arguments).current_dir(folder).env("FORERUN_CACHE_DIR", folder.join("cache")))
}

/// A brick with a square hole along z, of 32 triangles, as OBJ: `outer` and `inner` are half its width and that of the hole.
fn write_frame(path: &Path, outer: f32, inner: f32, half_depth: f32) {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut obj = String::new();
    for z in [-half_depth, half_depth] {
        for size in [outer, inner] {
            corners.iter().for_each(|[x, y]| obj += &format!("v {} {} {z}\n", x * size, y * size));
        }
    }
    for k in 0..4 {
        let next = (k + 1) % 4;
        let mut face = |ids: [usize; 4]| {
            obj += &format!("f {} {} {} {}\n", ids[0] + 1, ids[1] + 1, ids[2] + 1, ids[3] + 1)
        };
        // Outer side, hole, front (12 to 15 are the front of the hole) and back.
        face([k, next, next + 8, k + 8]);
        face([k + 12, next + 12, next + 4, k + 4]);
        face([k + 8, next + 8, next + 12, k + 12]);
        face([k + 4, next + 4, next, k]);
    }
    std::fs::write(path, obj).expect("writes");
}

fn close(value: &Value, expected: f64) -> bool {
    (value.as_f64().expect("a number") / expected - 1.0).abs() < 1e-4
}

/// Width, height and the bytes of the picture.
fn picture(path: &Path) -> (u32, u32, Vec<u8>) {
    let file = std::fs::File::open(path).expect("the picture is there");
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG file");
    let mut bytes = vec![0; reader.output_buffer_size()];
    let info = reader.next_frame(&mut bytes).expect("a whole picture");
    (info.width, info.height, bytes)
}

#[test]
fn mesh_tells_what_formulas_tell_and_keeps_the_field() {
    let folder = folder("mesh_report");
    // In millimetres and z up: 200 x 200 x 60 with a hole of 120 x 120.
    write_frame(&folder.join("frame.obj"), 100.0, 60.0, 30.0);
    let arguments = ["mesh", "frame.obj", "--scale", "0.001", "--up", "z", "--density", "500", "--json"];
    let report = json(&forerun(&folder, &arguments));
    let volume = 0.06 * (0.04 - 0.0144);
    assert_eq!((&report["triangles"], &report["vertices"]), (&Value::from(32), &Value::from(16)));
    assert_eq!((&report["enclosure"], &report["shells"]), (&Value::from("closed"), &Value::from(1)));
    assert!(
        close(&report["solid"]["volume_m3"], volume) && close(&report["solid"]["mass_kg"], 500.0 * volume)
    );
    // About the axis of the hole, which points up: m/12 (2 a²) of the whole less that of the hole.
    let inertia = 500.0 * 0.06 * (0.04 * 0.08 - 0.0144 * 0.0288) / 12.0;
    let moments = report["solid"]["principal_inertia_kg_m2"].as_array().expect("three");
    assert!(close(&moments[1], inertia), "{moments:?}");
    assert!(
        close(&report["max_m"][1], 0.03) && report["warnings"].as_array().is_some_and(Vec::is_empty),
        "{report:#}"
    );
    assert!(report["field"]["bytes"].as_u64() > Some(0) && report["cached"] == false);
    // Nodes lie on the faces of the frame but for the hole's, whose edges are sharp.
    let (error, cell) = (report["field"]["error_mean_m"].as_f64(), report["field"]["cell_m"].as_f64());
    assert!(error.expect("a number") < 0.2 * cell.expect("a number"), "{report:#}");

    // A field that is large enough to be kept, then kept, then damaged, then refused by --no-cache.
    let fine = [&arguments[..], &["--cell", "0.002"]].concat();
    let cached = |arguments: &[&str]| json(&forerun(&folder, arguments))["cached"] == true;
    assert!(!cached(&fine) && cached(&fine));
    for file in std::fs::read_dir(folder.join("cache/meshes")).expect("a cache").flatten() {
        std::fs::write(file.path(), "damaged").expect("writes");
    }
    let mended = json(&forerun(&folder, &fine));
    assert!(
        mended["cached"] == false && text(mended["warnings"].to_string().as_bytes()).contains("baked again")
    );
    assert!(cached(&fine) && !cached(&[&fine[..], &["--no-cache"]].concat()));
}

#[test]
fn mesh_warns_of_millimetres_and_of_holes() {
    let folder = folder("mesh_warnings");
    write_frame(&folder.join("frame.obj"), 100.0, 60.0, 30.0);
    let output = forerun(&folder, &["mesh", "frame.obj"]);
    assert_eq!(code(&output), Some(0), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    assert!(
        said.contains("--scale 0.001") && said.contains("watertight") && said.contains("kg m²"),
        "{said}"
    );
    std::fs::write(folder.join("sheet.obj"), "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n").expect("writes");
    let sheet = json(&forerun(&folder, &["mesh", "sheet.obj", "--json", "--slice", "sheet.png"]));
    assert!(sheet["enclosure"] == "open" && sheet["solid"].is_null() && sheet["field"].is_null());
    assert!(sheet["warnings"].to_string().contains("open = true"), "{sheet:#}");
    picture(&folder.join("sheet.png"));
}

#[test]
fn mesh_refuses_with_file_place_and_remedy() {
    let folder = folder("mesh_refusals");
    std::fs::write(
        folder.join("bent.ply"),
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n",
    )
    .expect("writes");
    std::fs::write(folder.join("cut.glb"), "glTF\u{2}\0\0\0").expect("writes");
    std::fs::write(folder.join("line.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").expect("writes");
    let cases: [(&[&str], &str); 9] = [
        (&["mesh", "none.obj"], "none.obj: cannot be read"),
        (&["mesh", "bent.ply"], "bent.ply: header: vertices have no number y"),
        (&["mesh", "cut.glb"], "cut.glb: header: the file is shorter"),
        (&["mesh", "line.obj"], "line.obj: the mesh has no triangles but 1 degenerate"),
        (&["mesh", "cut.blend"], "use a file that ends in .obj, .stl, .ply, .gltf or .glb"),
        (&["mesh", "line.obj", "--scale", "0"], "--scale"),
        (&["mesh", "line.obj", "--up", "w"], "--up"),
        (&["render", "stack:2"], "give -o FILE.png"),
        (
            &["render", "stack:2", "-o", "no/folder/x.png", "--time", "0"],
            "no/folder/x.png: the picture cannot be written",
        ),
    ];
    for (arguments, message) in cases {
        let output = forerun(&folder, arguments);
        assert_eq!(code(&output), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(message), "{arguments:?}: {}", text(&output.stderr));
        assert!(output.stdout.is_empty(), "{arguments:?}: {}", text(&output.stdout));
    }
}

#[test]
fn mesh_draws_views_and_slices() {
    let folder = folder("mesh_pictures");
    write_frame(&folder.join("frame.obj"), 0.1, 0.06, 0.03);
    let arguments = ["mesh", "frame.obj", "--picture", "views.png", "--slice", "slices.png"];
    let output = forerun(&folder, &arguments);
    assert!(text(&output.stdout).contains("wrote views.png"), "{}", text(&output.stderr));
    let (width, height, bytes) = picture(&folder.join("views.png"));
    assert_eq!((width, height), (1440, 720));
    let blue = |pixel: &&[u8]| i32::from(pixel[2]) > i32::from(pixel[0]) + 60;
    let part = bytes.chunks_exact(3).filter(blue).count() as f32 / (width * height) as f32;
    assert!((0.1..0.8).contains(&part), "{part} of the views is the mesh");
    let (_, _, bytes) = picture(&folder.join("slices.png"));
    // The true section in yellow, and next to it the zero line in black.
    let count = |colour: [u8; 3]| bytes.chunks_exact(3).filter(|pixel| **pixel == colour).count();
    assert!(count([255, 225, 40]) > 500 && count([10, 10, 10]) > 500);
}

#[test]
fn render_draws_a_time_and_a_film() {
    let folder = folder("render");
    let arguments = [
        "render", "stack:3", "--time", "0.4", "--size", "160x90", "--film", "film", "--fps", "5", "-o",
        "end.png",
    ];
    let output = forerun(&folder, &arguments);
    assert_eq!(code(&output), Some(0), "{}", text(&output.stderr));
    assert_eq!(picture(&folder.join("end.png")).0, 160);
    let mut names: Vec<_> = std::fs::read_dir(folder.join("film"))
        .expect("a film")
        .flatten()
        .map(|entry| entry.file_name())
        .collect();
    names.sort();
    assert_eq!(names, ["00000.png", "00001.png", "00002.png"]);
    // The same bits again, on another number of threads.
    forerun(
        &folder,
        &["render", "stack:3", "--time", "0.4", "--size", "160x90", "-o", "again.png", "--threads", "2"],
    );
    let bytes = |name| std::fs::read(folder.join(name)).expect("a file");
    assert!(bytes("end.png") == bytes("again.png"), "pictures of equal states are equal");
}
