//! Recording and replaying as scripts see them: exit codes, JSON, and what is said of damaged files.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn forerun(arguments: &[&str]) -> Output {
    let command = Command::new(env!("CARGO_BIN_EXE_forerun")).args(arguments).output();
    command.expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("output is UTF-8")
}

/// A folder of its own for each test, made new.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the target folder is ours");
    folder
}

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().expect("our names are UTF-8").to_owned()
}

/// A recorded second and a half of a scene with a command at its end.
fn recorded(folder: &Path) -> String {
    let scene = path(folder, "scene.toml");
    let text_of = "name = 'pushed'\n[[bodies]]\nshape = 'half_space'\nkind = 'fixed'\n\
                   [[bodies]]\nshape = { box = { half_extents = [0.5, 0.5, 0.5] } }\nposition = [0, 0.5, 0]\n\
                   [[commands]]\nframe = 40\npush = { body = 1, impulse = [3000, 0, 0] }\n";
    std::fs::write(&scene, text_of).expect("the folder is ours");
    let file = path(folder, "a.forerun");
    let output = forerun(&["run", &scene, "--seconds", "1.5", "--record", &file]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains(&format!("wrote {file}")));
    file
}

#[test]
fn a_recorded_run_is_replayed_with_the_same_hashes() {
    let folder = folder("replayed");
    let file = recorded(&folder);
    let mut hashes = Vec::new();
    for threads in ["1", "2", "4"] {
        let output = forerun(&["replay", &file, "--threads", threads, "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let verdict: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
        assert_eq!((&verdict["bodies"], &verdict["orders"]), (&2.into(), &1.into()));
        assert_eq!((&verdict["refused"], &verdict["differences"]), (&0.into(), &0.into()));
        assert!(verdict["hashes"].as_u64() >= Some(2) && verdict["frames"].as_u64() > Some(60), "{verdict}");
        hashes.push(verdict["state_hash"].clone());
    }
    assert!(hashes[0].is_string() && hashes[0] == hashes[1] && hashes[1] == hashes[2], "{hashes:?}");
    let output = forerun(&["replay", &file]);
    assert!(
        text(&output.stdout).contains("hashes that are different           0"),
        "{}",
        text(&output.stdout)
    );
}

#[test]
fn a_damaged_recording_is_refused_and_recovered() {
    let folder = folder("damaged");
    let file = recorded(&folder);
    let bytes = std::fs::read(&file).expect("it was written");
    let cut = path(&folder, "cut.forerun");
    std::fs::write(&cut, &bytes[..bytes.len() - 30]).expect("the folder is ours");
    let output = forerun(&["replay", &cut]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains(&format!("{cut}: is cut at byte ")), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("--recover OUT"), "{}", text(&output.stderr));
    let saved = path(&folder, "saved.forerun");
    let output = forerun(&["replay", &cut, "--recover", &saved]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains(&format!("wrote {saved}: 1 orders")), "{}", text(&output.stdout));
    assert_eq!(forerun(&["replay", &saved]).status.code(), Some(0));

    let mut flipped = bytes;
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    std::fs::write(&cut, &flipped).expect("the folder is ours");
    let output = forerun(&["replay", &cut]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("the checksum is wrong"), "{}", text(&output.stderr));
}

#[test]
fn what_cannot_be_recorded_or_replayed_ends_with_2() {
    let folder = folder("refused");
    let file = path(&folder, "a.forerun");
    let nowhere = path(&folder, "no/such/folder/a.forerun");
    let cases: [(&[&str], &str); 4] = [
        (
            &["run", "dominoes:3", "--driver", "coupled", "--record", &file],
            "record: needs the decoupled driver",
        ),
        (&["run", "dominoes:3", "--seconds", "1", "--record", &nowhere], "choose another file"),
        (&["replay", "Cargo.toml"], "Cargo.toml: is no recording"),
        (&["replay", "nosuch.forerun"], "nosuch.forerun: "),
    ];
    for (arguments, message) in cases {
        let output = forerun(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output.stdout));
        assert!(text(&output.stderr).contains(message), "{arguments:?}: {}", text(&output.stderr));
    }
}
