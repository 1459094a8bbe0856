//! The command line as scripts see it: exit codes, JSON on standard output, files.

mod common;

use common::{code, folder, forerun, json, text};
use serde_json::Value;

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().expect("an object").keys().map(String::as_str).collect()
}

#[test]
fn wrong_usage_and_bad_input_end_with_2_and_a_message_on_standard_error() {
    let cases: [(&[&str], &str); 9] = [
        (&["fly"], "unrecognized subcommand"),
        (&["run"], "SCENE"),
        (&["run", "nosuch"], "there is no built-in scene \"nosuch\""),
        (&["run", "pyramid:x"], "whole number"),
        (&["run", "no/such/file.toml"], "no/such/file.toml: cannot be read"),
        (&["run", "stack", "--seconds", "-3"], "--seconds"),
        (&["validate", "nosuch"], "there is no case \"nosuch\""),
        (&["view"], "no window can be opened"),
        (&["bake", "stack", "-o", "x.glb"], "not there yet"),
    ];
    for (arguments, message) in cases {
        let output = forerun(arguments);
        assert_eq!(code(&output), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(message), "{arguments:?}: {}", text(&output.stderr));
        assert!(output.stdout.is_empty(), "{arguments:?}: {}", text(&output.stdout));
    }
}

#[test]
fn a_mistake_in_a_file_is_named_with_its_line() {
    let file = folder("bad_file").join("bad.toml");
    std::fs::write(&file, "name = \"bad\"\n[[bodies]]\nshape = { sphere = { radius = -1 } }\n")
        .expect("writes");
    let output = forerun(&["run", file.to_str().expect("a plain path")]);
    assert_eq!(code(&output), Some(2));
    let message = text(&output.stderr);
    assert!(message.contains("bad.toml:3:") && message.contains("radius"), "{message}");
}

#[test]
fn run_writes_a_row_per_picture_a_report_and_charts() {
    let out = folder("run");
    let folder_name = out.to_str().expect("a plain path");
    let arguments = ["run", "stack:3", "--seconds", "0.5", "--fps", "20", "--threads", "1", "--json"];
    let report = json(&forerun(&[&arguments[..], &["--out", folder_name]].concat()));
    let fields = [
        "scene",
        "driver",
        "seconds",
        "pictures",
        "late_pictures",
        "starved_pictures",
        "longest_stall_ms",
        "delay_max_s",
        "queue_min",
        "queue_low",
        "queue_max",
        "slices_max",
        "recomputed",
        "quarantined",
        "ignored",
    ];
    let mut expected = fields.to_vec();
    let mut found = keys(&report);
    expected.sort_unstable();
    found.sort_unstable();
    assert_eq!(found, expected);
    assert_eq!((&report["scene"], &report["driver"]), (&Value::from("stack"), &Value::from("decoupled")));
    let written: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("report.json")).expect("report.json"))
            .expect("JSON");
    assert_eq!(written, report);
    let csv = std::fs::read_to_string(out.join("queue.csv")).expect("queue.csv");
    assert!(csv.starts_with(
        "time_real_s,time_display_s,time_physics_s,queue_min,queue_max,slices_max,areas_active,recomputed,"
    ));
    assert_eq!(csv.lines().count() as u64, 1 + report["pictures"].as_u64().expect("a number"));
    for chart in ["queue.svg", "queue.png", "time.svg", "time.png"] {
        let bytes = std::fs::metadata(out.join(chart)).map_or(0, |file| file.len());
        assert!(bytes > 2000, "{chart} has {bytes} bytes");
    }
}

#[test]
fn degraded_results_are_printed_where_there_are_any() {
    let file = folder("degraded").join("odd.toml");
    let scene = "name = \"odd\"\n[[bodies]]\nshape = { sphere = { radius = 1 } }\nmass = 0.001\nforce = [3e38, 0, 0]\n";
    std::fs::write(&file, scene).expect("writes");
    let output = forerun(&["run", file.to_str().expect("a plain path"), "--seconds", "0.2"]);
    assert_eq!(code(&output), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    assert!(printed.contains("states that were not finite"), "{printed}");
    assert!(!printed.contains("commands that did nothing"), "{printed}");
}

#[test]
fn the_coupled_driver_has_no_queue() {
    let report = json(&forerun(&["run", "stack:3", "--seconds", "0.3", "--driver", "coupled", "--json"]));
    assert_eq!((&report["queue_max"], &report["recomputed"]), (&Value::from(0), &Value::from(0)));
}

#[test]
fn check_finds_no_difference_and_says_what_it_compared() {
    let arguments = ["check", "stack:3", "--edits", "4", "--frames", "40", "--threads", "1,2", "--json"];
    let verdict = json(&forerun(&arguments));
    assert_eq!(verdict["mismatches"], 0);
    assert_eq!(verdict["threads"], serde_json::json!([1, 2]));
    for field in ["scene", "edits", "seed", "frames", "affected", "recomputed", "full"] {
        assert!(!verdict[field].is_null(), "{field}");
    }
    for (times, part) in [("edit_ms", "mean"), ("edit_ms", "median"), ("full_ms", "max")] {
        assert!(verdict[times][part].is_f64(), "{times}.{part}");
    }
    assert!(verdict["recomputed"].as_u64() <= verdict["full"].as_u64());
}

#[test]
fn check_says_in_words_what_it_found_and_how_to_do_it_again() {
    let options = ["--settle", "20", "--display-step", "2", "--compare-every", "3"];
    let usual = ["check", "stack:3", "--edits", "7", "--frames", "30", "--threads", "1"];
    let words = text(&forerun(&[&usual[..], &options[..]].concat()).stdout);
    assert!(words.contains("--settle 20 --display-step 2 --compare-every 3"), "{words}");
    assert!(words.contains("every state of every body has the bits of a full run"), "{words}");
    assert!(words.contains("than a full re-simulation of the same frames"), "{words}");
}

#[test]
fn bench_measures_each_scene_and_gives_the_same_hash_for_any_thread_count() {
    let one = json(&forerun(&["bench", "stack:3", "dominoes:10", "--frames", "30", "--json"]));
    let two =
        json(&forerun(&["bench", "stack:3", "dominoes:10", "--frames", "30", "--threads", "2", "--json"]));
    for place in 0..2 {
        let (one, two) = (&one["scenes"][place], &two["scenes"][place]);
        assert_eq!(one["state_hash"], two["state_hash"]);
        for field in [
            "scene",
            "bodies",
            "frames",
            "threads",
            "first_step_ms",
            "step_ms",
            "stage_ms",
            "body_steps_per_s",
            "overlap_max_m",
            "overlap_end_m",
            "energy_max_over_initial",
            "speed_end_mean",
            "bytes_per_body_frame",
        ] {
            assert!(!one[field].is_null(), "{field}");
        }
        let stages =
            ["collisions", "velocities", "contact_graph", "contacts", "shock_propagation", "positions"];
        assert!(stages.iter().all(|stage| one["stage_ms"][stage].is_f64()));
        let energy = one["energy_max_over_initial"].as_f64().expect("a number");
        assert!((1.0..1.01).contains(&energy), "{energy}");
    }
}

#[test]
fn scenes_are_listed_and_printed_as_files_that_can_be_run() {
    let list = forerun(&["scenes"]);
    assert!(text(&list.stdout).contains("dominoes"));
    let file = folder("scenes").join("small.toml");
    std::fs::write(&file, forerun(&["scenes", "stack:2"]).stdout).expect("writes");
    let name = file.to_str().expect("a plain path");
    let report = json(&forerun(&["bench", name, "--frames", "5", "--json"]));
    let built_in = json(&forerun(&["bench", "stack:2", "--frames", "5", "--json"]));
    assert_eq!(report["scenes"][0]["state_hash"], built_in["scenes"][0]["state_hash"]);
}

/// Heaps of all kinds of shapes, so that every kernel has its part. The hashes of this build and of all others are those of the test `golden`
/// of forerun-dynamics; here every way in which one program can run is compared.
#[test]
fn no_instruction_set_and_no_thread_count_changes_a_bit() {
    let hashes = |instructions: &str, threads: &str| -> Option<Vec<String>> {
        let scenes = ["pyramid:9", "rain:48", "convex_pile:90"];
        let options =
            ["--frames", "40", "--awake", "--json", "--instructions", instructions, "--threads", threads];
        let output = forerun(&[&["bench"], &scenes[..], &options[..]].concat());
        if code(&output) == Some(2) && text(&output.stderr).contains("this processor has no") {
            return None;
        }
        let report = json(&output);
        let hash = |scene: &Value| scene["state_hash"].as_str().expect("a hash").to_owned();
        Some(report["scenes"].as_array().expect("scenes").iter().map(hash).collect())
    };
    let reference = hashes("portable", "1").expect("any processor has it");
    assert_eq!(reference.len(), 3);
    for instructions in ["portable", "sse2", "avx2", "avx512"] {
        for threads in ["1", "2", "4"] {
            let Some(found) = hashes(instructions, threads) else { continue };
            assert_eq!(found, reference, "{instructions}, {threads} threads");
        }
    }
}

#[test]
fn bench_lets_a_scene_come_to_rest_and_draws_its_stages() {
    let chart = folder("bench").join("stages.any");
    let args = ["bench", "islands:1", "--frames", "10", "--settle", "200", "--json", "--chart"];
    let report = json(&forerun(&[&args[..], &[chart.to_str().expect("plain")]].concat()));
    let scene = &report["scenes"][0];
    assert_eq!(scene["settle"], 200);
    // Asleep: nothing is stored, and the world stands still. In the air at first: 52 bytes and more a body and frame.
    assert_eq!(scene["bytes_per_body_frame"].as_f64(), Some(0.0));
    assert_eq!(scene["speed_end_mean"].as_f64(), Some(0.0));
    let falling = json(&forerun(&["bench", "islands:1", "--frames", "10", "--json"]));
    assert!(falling["scenes"][0]["bytes_per_body_frame"].as_f64() > Some(50.0));
    assert!(scene["timeline_frame_ms"].as_f64() < falling["scenes"][0]["timeline_frame_ms"].as_f64());
    let svg = std::fs::read_to_string(chart.with_extension("svg")).expect("stages.svg");
    assert!(svg.contains("shock propagation") && svg.contains("islands:1, "), "{svg}");
    assert!(chart.with_extension("png").exists());
}

#[test]
fn validate_prints_a_table_and_ends_well() {
    let output = forerun(&["validate", "free_fall"]);
    assert_eq!(code(&output), Some(0));
    assert!(text(&output.stdout).starts_with("| case | figure | value | limit | |\n|---|"));
}

#[test]
fn validate_prints_one_json_object() {
    let report = json(&forerun(&["validate", "free_fall", "arch", "--json"]));
    let figures = report["figures"].as_array().expect("a list");
    let count = |verdict: &str| figures.iter().filter(|figure| figure["verdict"] == verdict).count();
    assert!(figures.iter().all(|figure| figure["value"].is_number() && figure["limit"].is_string()));
    assert_eq!(figures[0]["case"], "free_fall");
    assert_eq!(report["passed"], count("pass"));
    assert_eq!(report["judged"], count("pass") + count("miss"));
    assert_eq!(report["not_run"].as_array().map(Vec::len), Some(0));
    // Every miss of these two is known, and nothing else has a cause.
    assert!(figures.iter().all(|figure| figure["cause"].is_string() == (figure["verdict"] == "miss")));
    assert!(count("miss") > 0 && figures.iter().any(|f| f["cause"].to_string().contains("linear program")));
}

#[test]
fn an_experiment_puts_the_drivers_beside_each_other() {
    let out = folder("experiment");
    let output = forerun(&["experiment", "stack", "--seconds", "0.3", "--out", out.to_str().expect("plain")]);
    assert_eq!(code(&output), Some(0), "{}", text(&output.stderr));
    let page = std::fs::read_to_string(out.join("stack/report.md")).expect("report.md");
    assert!(page.contains("| decoupled | without return in time | coupled |"), "{page}");
    for file in
        ["decoupled/queue.csv", "without_return_in_time/queue.csv", "coupled/queue.csv", "figure_5_13.png"]
    {
        assert!(out.join("stack").join(file).exists(), "{file}");
    }
}
