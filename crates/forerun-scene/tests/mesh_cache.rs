//! Baked fields kept in a folder: found again, and never in the way.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use forerun_geometry::mesh_file::TriangleList;
use forerun_geometry::shape::{Mesh, MeshOptions, mesh_make};
use forerun_scene::{Format, MeshBaking, MeshCache, MeshWatch, Scene};

/// Counts and writes down.
#[derive(Debug, Default)]
struct Noted {
    baked: AtomicUsize,
    warnings: Mutex<Vec<String>>,
}

impl MeshWatch for Noted {
    fn baking(&self, name: &str, done: usize, total: usize) {
        assert!(done <= total && name == "ring");
        self.baked.fetch_add(1, Ordering::Relaxed);
    }

    fn warning(&self, name: &str, message: &str) {
        self.warnings.lock().unwrap().push(format!("{name} {message}"));
    }
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    let _ = std::fs::remove_file(&folder);
    folder
}

fn ring() -> TriangleList {
    let Mesh { vertices, triangles, .. } = mesh_make::torus(0.4, 0.1, 40, 16).unwrap();
    TriangleList { vertices, triangles }
}

/// Makes the ring with a cache there. Whether it was kept, whether it was baked, and the warnings.
fn make(folder: &Path) -> (bool, bool, Vec<String>) {
    let noted = Arc::new(Noted::default());
    let baking = MeshBaking { cache: Some(MeshCache::in_folder(folder)), watch: Some(noted.clone()) };
    let made = baking.make("ring", ring(), MeshOptions::default()).unwrap();
    let plain = MeshBaking::default().make("ring", ring(), MeshOptions::default()).unwrap();
    assert_eq!(made.mesh, plain.mesh);
    let warnings = noted.warnings.lock().unwrap().clone();
    (made.kept, noted.baked.load(Ordering::Relaxed) > 0, warnings)
}

fn the_file(folder: &Path) -> PathBuf {
    let files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(files.len(), 1, "{files:?}");
    files[0].clone()
}

#[test]
fn a_field_is_baked_once_and_found_again() {
    let folder = folder("cache").join("made/when/needed");
    assert_eq!(make(&folder), (false, true, vec![]));
    assert_eq!(make(&folder), (true, false, vec![]));
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(make(&folder), (false, true, vec![]));
    assert!(the_file(&folder).extension().is_some_and(|extension| extension == "field"));
}

#[test]
fn a_damaged_file_is_a_warning_and_is_replaced() {
    let folder = folder("damaged_cache");
    make(&folder);
    let path = the_file(&folder);
    let good = std::fs::read(&path).unwrap();
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 4;
    let damaged: [&[u8]; 5] = [&[], &good[..good.len() - 1], &good[..20], &flipped, b"something else"];
    for bytes in damaged {
        std::fs::write(&path, bytes).unwrap();
        let (kept, baked, warnings) = make(&folder);
        assert!(!kept && baked && warnings.len() == 1, "{warnings:?}");
        assert!(warnings[0].contains("is of no use") && warnings[0].contains("baked again"), "{warnings:?}");
        assert_eq!(std::fs::read(&path).unwrap(), good);
    }
}

#[test]
fn a_folder_that_cannot_be_used_is_a_warning() {
    let folder = folder("no_folder");
    std::fs::write(&folder, "a file").unwrap();
    for _ in 0..2 {
        let (kept, baked, warnings) = make(&folder);
        assert!(!kept && baked, "{warnings:?}");
        assert!(warnings.iter().any(|w| w.contains("cannot be kept")), "{warnings:?}");
    }
}

#[test]
fn what_was_never_finished_goes_after_a_day() {
    let folder = folder("abandoned_cache");
    make(&folder);
    let field = the_file(&folder);
    let beside = |name: &str, days: u64| {
        let path = folder.join(name);
        std::fs::write(&path, "half a field").unwrap();
        let file = std::fs::File::options().write(true).open(&path).unwrap();
        let now = file.metadata().unwrap().modified().unwrap();
        file.set_modified(now - Duration::from_secs(days * 25 * 3600)).unwrap();
        path
    };
    let (abandoned, in_work) = (beside("0123.77-0.part", 1), beside("0123.78-0.part", 0));
    let not_ours = beside("notes.txt", 400);
    // Found again, nothing is written and nobody looks; kept anew, they do.
    make(&folder);
    assert!(abandoned.exists());
    std::fs::remove_file(&field).unwrap();
    assert_eq!(make(&folder), (false, true, vec![]));
    assert_eq!(
        [&abandoned, &in_work, &not_ours, &field].map(|path| path.exists()),
        [false, true, true, true]
    );
}

#[test]
fn several_at_once_do_not_disturb_each_other() {
    let folder = folder("shared_cache");
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(make(&folder).2, Vec::<String>::new()));
        }
    });
    the_file(&folder);
}

#[test]
fn scenes_use_it_and_tell_what_looks_odd() {
    let folder = folder("scene_cache");
    std::fs::create_dir_all(&folder).unwrap();
    let list = ring();
    let mut obj = String::new();
    list.vertices
        .iter()
        .for_each(|v| obj += &format!("v {} {} {}\n", v.x * 1000.0, v.y * 1000.0, v.z * 1000.0));
    list.triangles.iter().for_each(|t| obj += &format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
    std::fs::write(folder.join("ring.obj"), obj).unwrap();
    let noted = Arc::new(Noted::default());
    let open = |scale: &str| {
        let text = format!(
            "name = 's'\n[meshes.ring]\nfile = 'ring.obj'\nup = 'z'\n{scale}\n[[bodies]]\nshape = {{ mesh = 'ring' }}\n"
        );
        let mut scene =
            Scene::parse(&text, Format::Toml, &folder.join("s.toml").display().to_string()).unwrap();
        scene.baking = MeshBaking {
            cache: Some(MeshCache::in_folder(folder.join("fields"))),
            watch: Some(noted.clone()),
        };
        scene.bodies().unwrap()
    };
    let bodies = open("scale = 0.001");
    let forerun_geometry::Shape::Mesh(mesh) = &bodies[0].shape else { panic!("a mesh") };
    let size = mesh.bounds().max - mesh.bounds().min;
    assert!((size.z - 0.2).abs() < 0.01 && (size.y - 1.0).abs() < 0.01, "turned upright: {size}");
    assert!(noted.warnings.lock().unwrap().is_empty());
    the_file(&folder.join("fields"));
    open("");
    let warnings = noted.warnings.lock().unwrap().clone();
    assert!(warnings.len() == 1 && warnings[0].contains("scale = 0.001"), "{warnings:?}");
}

#[test]
fn only_files_may_have_another_axis_up() {
    let text = "name = 's'\n[meshes.ball]\nup = 'z'\nball = { radius = 1, parts = 2 }\n";
    let error = Scene::parse(text, Format::Toml, "s.toml").unwrap_err().to_string();
    assert!(error.starts_with("s.toml:3:") && error.contains("meshes.ball.up"), "{error}");
    let text = "name = 's'\n[meshes.ring]\nfile = 'ring.stl'\nup = 'z'\n";
    let scene = Scene::parse(text, Format::Toml, "s.toml").unwrap();
    for (format, text) in [(Format::Toml, scene.to_toml()), (Format::Json, scene.to_json())] {
        assert_eq!(Scene::parse(&text, format, "again").unwrap().meshes, scene.meshes);
    }
}
