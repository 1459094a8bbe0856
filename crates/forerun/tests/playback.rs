//! Playback against a hand-turned clock: what is recorded does not depend on how fast this machine is.

use std::time::Duration;

use forerun::scene::Format;

use forerun::{
    Clock, DriverKind, Playback, PlaybackError, PlaybackSettings, Scene, Threads, TimelineSettings, play,
    timeline_of,
};

const FPS: f64 = 30.0;

/// Plays one second; every picture takes as long as `picture` says.
fn played(scene: &str, driver: DriverKind, picture: impl Fn(usize) -> Duration) -> Playback {
    let scene = Scene::open(scene).expect("a built-in scene");
    let clock = Clock::by_hand();
    let turned = clock.clone();
    let settings = PlaybackSettings { driver, seconds: 1.0, fps: FPS, ..PlaybackSettings::default() };
    let mut shown = 0;
    let playback = play(&scene, &settings, &clock, &mut |_| {
        turned.turn(picture(shown));
        shown += 1;
    });
    playback.expect("the scene plays")
}

fn interval(_: usize) -> Duration {
    Duration::from_secs_f64(1.0 / FPS)
}

#[test]
fn pictures_come_at_equal_intervals_when_nothing_is_late() {
    let playback = played("stack:3", DriverKind::Decoupled, interval);
    assert_eq!((playback.report.pictures, playback.report.late_pictures), (30, 0));
    for (i, row) in playback.rows.iter().enumerate() {
        assert!((row.time_real_s - i as f64 / FPS).abs() < 1e-6, "picture {i} at {}", row.time_real_s);
        assert!(row.queue_min <= row.queue_max && row.queue_max <= 100, "{row:?}");
        assert!(row.time_display_s <= row.time_real_s, "{row:?}");
    }
    assert_eq!(playback.last_poses.len(), 4);
}

#[test]
fn impossible_lengths_and_rates_are_refused() {
    let scene = Scene::open("stack:1").expect("a built-in scene");
    let refused = |seconds: f64, fps: f64, at_fault: &str| {
        let settings = PlaybackSettings { seconds, fps, ..PlaybackSettings::default() };
        let error = play(&scene, &settings, &Clock::by_hand(), &mut |_| {}).err();
        assert!(
            matches!(&error, Some(PlaybackError::Setting { field, .. }) if *field == at_fault),
            "{error:?}"
        );
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
        refused(bad, FPS, "seconds");
        refused(1.0, bad, "fps");
    }
    refused(1.0, 1e-300, "fps");
}

#[test]
fn degraded_results_are_in_the_report() {
    let text = "name = 'odd'\n\
                [[bodies]]\nshape = { sphere = { radius = 1 } }\n\
                [[bodies]]\nshape = { sphere = { radius = 1 } }\nposition = [9, 0, 0]\nmass = 0.001\nforce = [3e38, 0, 0]\n\
                [[commands]]\nframe = 2\nremove = 0\n\
                [[commands]]\nframe = 4\npush = { body = 0, impulse = [1, 0, 0] }\n";
    let mut scene = Scene::parse(text, Format::Toml, "odd").expect("a possible scene");
    let report = |scene: &Scene, driver| {
        let clock = Clock::by_hand();
        let turned = clock.clone();
        let settings = PlaybackSettings { driver, seconds: 1.0, fps: FPS, ..PlaybackSettings::default() };
        let played = play(scene, &settings, &clock, &mut |_| {
            turned.turn(interval(0));
            // Physics has a thread of its own, and time to hear of what this picture brought.
            std::thread::sleep(Duration::from_millis(2));
        });
        played.expect("it plays").report
    };
    let decoupled = report(&scene, DriverKind::Decoupled);
    assert!(decoupled.quarantined > 0 && decoupled.ignored == 1, "{decoupled:?}");
    // The traditional model removes nobody.
    scene.commands.clear();
    let coupled = report(&scene, DriverKind::Coupled);
    assert!(coupled.quarantined > 0 && coupled.ignored == 0, "{coupled:?}");
}

#[test]
fn a_slow_cycle_makes_the_traditional_model_late_for_good() {
    let stall = |picture| if picture == 10 { Duration::from_millis(500) } else { interval(picture) };
    let playback = played("stack:3", DriverKind::Coupled, stall);
    assert_eq!(playback.report.late_pictures, 1);
    // 500 ms passed and the longest step is 42 ms.
    assert!((playback.report.delay_max_s - 0.458).abs() < 1e-6, "{:?}", playback.report);
    let last = playback.rows.last().expect("pictures");
    assert!((last.time_real_s - last.time_display_s - 0.458).abs() < 1e-6, "{last:?}");
}

#[test]
fn the_traditional_model_ends_up_where_the_timeline_does() {
    let coupled = played("stack:2", DriverKind::Coupled, interval);
    let scene = Scene::open("stack:2").expect("a built-in scene");
    let mut timeline = timeline_of(&scene, TimelineSettings::default()).expect("the scene is possible");
    while timeline.advance() != forerun::timeline::Progress::Idle {}
    let snapshot = timeline.snapshot();
    for (body, pose) in coupled.last_poses {
        let expected = snapshot.sample(body, 29.0 / FPS).expect("the body is there").pose;
        assert!(pose.position.distance(expected.position) < 0.02, "body {}: {pose:?}, {expected:?}", body.0);
    }
}

#[test]
fn a_scene_gives_the_same_states_under_any_number_of_threads() {
    let run = |count: u16| {
        let threads = Threads::exactly(count.try_into().expect("not 0")).expect("few threads");
        let scene = Scene::open("dominoes:12").expect("a built-in scene");
        let settings = TimelineSettings { lookahead: 60, ..TimelineSettings::default() };
        let mut timeline = timeline_of(&scene, settings).expect("the scene is possible");
        threads.install(|| while timeline.advance() != forerun::timeline::Progress::Idle {});
        timeline
    };
    let (one, four) = (run(1), run(4));
    assert_eq!(forerun::timeline::check::mismatches(&one, &four).0, 0);
}
