//! Recording and replaying as scripts see them: exit codes, JSON, and what is said of damaged files.

mod common;

use std::path::Path;

use common::{code, folder, forerun, json, text};

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
    assert_eq!(code(&output), Some(0), "{}", text(&output.stderr));
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
        let verdict = json(&output);
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
    assert_eq!(code(&output), Some(2));
    assert!(text(&output.stderr).contains(&format!("{cut}: is cut at byte ")), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("--recover OUT"), "{}", text(&output.stderr));
    let saved = path(&folder, "saved.forerun");
    let output = forerun(&["replay", &cut, "--recover", &saved]);
    assert_eq!(code(&output), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains(&format!("wrote {saved}: 1 orders")), "{}", text(&output.stdout));
    assert_eq!(code(&forerun(&["replay", &saved])), Some(0));

    let mut flipped = bytes;
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    std::fs::write(&cut, &flipped).expect("the folder is ours");
    let output = forerun(&["replay", &cut]);
    assert_eq!(code(&output), Some(2));
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
        assert_eq!(code(&output), Some(2), "{arguments:?}: {}", text(&output.stdout));
        assert!(text(&output.stderr).contains(message), "{arguments:?}: {}", text(&output.stderr));
    }
}
