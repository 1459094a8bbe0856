//! Recordings: what is saved comes back and goes on bit for bit; what is cut or changed is noticed, and what comes before it is not lost.

use std::num::NonZeroU16;
use std::path::PathBuf;
use std::time::Duration;

use forerun::recording::{Event, Mark, Recording, RecordingFault};
use forerun::timeline::Progress;
use forerun::timeline::check::{Random, random_change};
use forerun::{
    BodyDef, BodyId, Change, Clock, Command, CommandError, CommandKey, Decoupled, DecoupledSettings, Frame,
    Keep, Order, Recorder, Scene, Threads, Timeline, TimelineSettings, Vec3, load_timeline, save_timeline,
    timeline_of,
};

/// A file of its own for each test, gone when the test ends.
struct Temporary(PathBuf);

impl Temporary {
    fn new(name: &str) -> Temporary {
        let folder = std::env::temp_dir().join(format!("forerun-recording-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder for temporary files");
        Temporary(folder)
    }

    fn file(&self) -> PathBuf {
        self.0.join("a.forerun")
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Boxes, hulls, compounds, meshes and things that come to rest soon.
fn scenes() -> Vec<Timeline> {
    let settings = TimelineSettings { lookahead: 25, past: 20, ..TimelineSettings::default() };
    ["dominoes:12", "meshes:2", "rain:20", "interaction"]
        .into_iter()
        .map(|name| {
            timeline_of(&Scene::open(name).expect("a built-in scene"), settings).expect("it is possible")
        })
        .collect()
}

/// A random order of the local user, or of another.
fn random_order(timeline: &mut Timeline, random: &mut Random) -> Order {
    let last = timeline.commands().last().map(|(key, _)| *key);
    let from = timeline.oldest().0 + 1;
    let frame = Frame(from + random.below(timeline.horizon().0 + 5 - from));
    let change = random_change(timeline, frame, random);
    match (random.below(10), last) {
        (0, _) => Order::Undo,
        (1, _) => Order::Redo,
        (2, Some(key)) => Order::Retract(key),
        (3, Some(key)) => Order::Replace(Command { key, change }),
        (other, _) => {
            let key =
                CommandKey { frame, source: (other % 2) as u32, sequence: 1_000_000 + random.bits() % 1000 };
            Order::Submit(Command { key, change })
        }
    }
}

fn finish(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

fn go_on(timeline: &mut Timeline, random: &mut Random) -> Vec<Option<u64>> {
    let mut hashes = Vec::new();
    for display in 0..30 {
        if random.below(4) == 0 {
            let order = random_order(timeline, random);
            let _ = timeline.obey(order);
        }
        timeline.set_display(Frame(timeline.display().0 + u64::from(display % 3 == 0)));
        for _ in 0..4 {
            timeline.advance();
        }
        hashes.push(timeline.state_hash(timeline.oldest()));
    }
    finish(timeline);
    hashes
        .extend((timeline.oldest().0..=timeline.horizon().0).map(|frame| timeline.state_hash(Frame(frame))));
    hashes
}

#[test]
fn what_is_loaded_goes_on_as_if_it_had_not_been_saved() {
    let temporary = Temporary::new("goes-on");
    let path = temporary.file();
    for (index, mut timeline) in scenes().into_iter().enumerate() {
        let mut random = Random::new(index as u64 + 1);
        for round in 0..4 {
            go_on(&mut timeline, &mut random);
            for _ in 0..random.below(8) {
                timeline.advance();
            }
            let mut hashes = Vec::new();
            for keep in [Keep::Commands, Keep::States] {
                save_timeline(&timeline, &path, keep).expect("a place to write");
                let mut loaded = load_timeline(&path).expect("it was just written");
                assert_eq!(loaded.names(), timeline.names());
                if keep == Keep::States {
                    assert_eq!(loaded.valid_to(), timeline.valid_to());
                    let first = std::fs::read(&path).expect("it is there");
                    save_timeline(&loaded, &path, keep).expect("a place to write");
                    assert!(first == std::fs::read(&path).expect("it is there"), "saved, loaded, saved");
                } else {
                    // What was known is worked off again first.
                    while loaded.valid_to() < timeline.valid_to() {
                        assert_ne!(loaded.advance(), Progress::Idle);
                    }
                }
                assert_eq!(loaded.diff(&timeline), None);
                finish(&mut loaded);
                hashes.push(go_on(&mut loaded, &mut random.clone()));
            }
            finish(&mut timeline);
            hashes.push(go_on(&mut timeline, &mut random));
            assert!(hashes[0] == hashes[2], "scene {index}, round {round}: without states");
            assert!(hashes[1] == hashes[2], "scene {index}, round {round}: with states");
        }
    }
}

/// Obeys an order and records it; whether it was possible.
fn tell(timeline: &mut Timeline, recorder: &Recorder, order: &Order) -> bool {
    let error = timeline.obey(order.clone()).err();
    let tried = matches!(order, Order::Undo | Order::Redo)
        && !matches!(error, Some(CommandError::NothingToUndo | CommandError::NothingToRedo));
    if error.is_none() || tried {
        recorder.order(order, timeline);
    }
    error.is_none()
}

/// A recorded session, with orders of all kinds and a fork that is adopted; its bytes.
fn session(mut timeline: Timeline, seed: u64, name: &str) -> Vec<u8> {
    let temporary = Temporary::new(name);
    let path = temporary.file();
    let (mut random, mut forks) = (Random::new(seed), Vec::new());
    let recorder = Recorder::create(&path, &timeline).expect("a place to write");
    for picture in 0..60 {
        for _ in 0..random.below(3) {
            let order = random_order(&mut timeline, &mut random);
            tell(&mut timeline, &recorder, &order);
        }
        match picture {
            20 => forks.push(timeline.fork()),
            30 => {
                timeline.adopt(forks.remove(0));
                recorder.restart(&timeline);
            }
            _ => {}
        }
        timeline.set_display(Frame(picture));
        // Physics is sometimes late.
        for _ in 0..random.below(5) {
            timeline.advance();
        }
        if picture % 5 == 0 {
            recorder.mark(&timeline);
        }
    }
    recorder.finish().expect("a place to write");
    std::fs::read(&path).expect("it was written")
}

#[test]
fn a_replay_has_the_same_hashes_on_any_number_of_threads() {
    for (index, timeline) in scenes().into_iter().enumerate() {
        let bytes = session(timeline, 7 + index as u64, "replay");
        let recording = Recording::decode(&bytes).expect("it was just written");
        assert!(recording.encode().expect("it was one") == bytes, "read and written");
        let mut last = None;
        for count in [1, 2, 4] {
            let threads = Threads::exactly(NonZeroU16::new(count).expect("above 0")).expect("a few threads");
            let replay = threads.install(|| recording.replay(&mut |_| {})).expect("it was recorded");
            assert!(replay.is_same(), "scene {index}, {count} threads: {replay:?}");
            assert!(replay.marks >= 13 && replay.orders > 5, "{replay:?}");
            assert!(last.is_none_or(|last| last == replay.hash));
            last = Some(replay.hash);
        }
    }
}

/// Parts that no timeline has are refused by name, and settings at the end of their range do no harm.
#[test]
fn impossible_states_are_refused() {
    let timeline = scenes().remove(0);
    let parts = timeline.parts(Keep::Commands);
    let body = parts.names.iter().position(|name| name.body.is_some()).expect("there are bodies");
    let refusal = |turned: fn(forerun::Quat) -> forerun::Quat| {
        let mut parts = parts.clone();
        let state = &mut parts.names[body].body.as_mut().expect("it is one").state;
        state.rotation = turned(state.rotation);
        Timeline::from_parts(parts).map(drop).map_err(|error| error.to_string())
    };
    assert_eq!(refusal(|q| q), Ok(()));
    assert_eq!(refusal(|q| q * 1.0001), Ok(()));
    for wrong in [|q| q * 1.001, |q| q * 0.0, |q| q * 1e30] as [fn(forerun::Quat) -> forerun::Quat; 3] {
        let message = refusal(wrong).expect_err("it is no rotation");
        assert!(message.starts_with(&format!("names[{body}].body.state: has a rotation")), "{message}");
    }
    let mut long = parts.clone();
    long.environment.settings.rest_seconds = f32::MAX;
    // No rest is that long, or it is: neither is an overflow.
    drop(Timeline::from_parts(long));
}

#[test]
fn a_mark_that_no_session_gets_to_is_refused() {
    let timeline = scenes().remove(0);
    let start = Recording::of(&timeline, Keep::Commands).start;
    let told = |display, oldest, frame| {
        let mark = Mark { display: Frame(display), oldest: Frame(oldest), frame: Frame(frame), hash: 1 };
        let recording = Recording { start: start.clone(), events: vec![Event::Mark(mark)] };
        let bytes = recording.encode().expect("it is small");
        let readable = Recording::decode_readable(&bytes).expect("its start is whole").recording.events.len();
        Recording::decode(&bytes).map_err(|error| (error.to_string(), readable)).err()
    };
    // 25 frames ahead and 20 back.
    assert_eq!((told(0, 0, 45), told(100, 80, 145), told(0, 100, 145)), (None, None, None));
    for (display, oldest, frame) in [(0, 0, 46), (100, 80, u64::MAX), (0, u64::MAX, 0), (1 << 54, 0, 1 << 54)]
    {
        let (message, readable) = told(display, oldest, frame).expect("nobody gets there");
        assert!(message.contains("a mark") && readable == 0, "{message}");
    }
    // What was computed before the lookahead was made shorter can be saved all the same.
    let mut timeline = timeline;
    timeline.set_lookahead(200);
    finish(&mut timeline);
    timeline.set_lookahead(1);
    for keep in [Keep::Commands, Keep::States] {
        let recording = Recording::of(&timeline, keep);
        assert_eq!(Recording::decode(&recording.encode().expect("it is small")).as_ref(), Ok(&recording));
    }
}

/// What the user could take back or do again is the same after, also where what was forgotten stood in between.
#[test]
fn a_recorded_session_can_be_undone_after_as_before() {
    let temporary = Temporary::new("undo");
    let (mut undone, mut kept) = (0, 0);
    for (index, mut timeline) in scenes().into_iter().enumerate() {
        let mut random = Random::new(40 + index as u64);
        let recorder = Recorder::create(temporary.file(), &timeline).expect("a place to write");
        for picture in 0..80 {
            let order = random_order(&mut timeline, &mut random);
            undone += u32::from(tell(&mut timeline, &recorder, &order) && order == Order::Undo);
            timeline.set_display(Frame(picture));
            for _ in 0..random.below(6) {
                timeline.advance();
            }
        }
        recorder.mark(&timeline);
        recorder.finish().expect("a place to write");
        let recording = Recording::read(temporary.file()).expect("it is whole");
        let mut loaded = recording.timeline().expect("it was one");
        let (is, was) = (loaded.parts(Keep::Commands), timeline.parts(Keep::Commands));
        assert!(is.undo == was.undo && is.redo == was.redo, "scene {index}");
        assert!(was.oldest > Frame(20), "scene {index}: {:?}", was.oldest);
        kept += was.undo.len() + was.redo.len();
        finish(&mut timeline);
        finish(&mut loaded);
        assert_eq!(loaded.diff(&timeline), None, "scene {index}");
        let replay = recording.replay(&mut |_| {}).expect("it was recorded");
        assert!(replay.is_same(), "scene {index}: {replay:?}");
    }
    assert!(undone > 10 && kept > 3, "{undone} undone, {kept} kept");
}

#[test]
fn a_replay_notices_another_order() {
    let bytes = session(scenes().remove(0), 3, "notices");
    let mut recording = Recording::decode(&bytes).expect("it was just written");
    let velocity = Change::SetVelocity {
        body: forerun::BodyId(3),
        velocity: Vec3::new(0.0, 0.001, 0.0),
        angular_velocity: Vec3::ZERO,
    };
    let key = CommandKey { frame: Frame(2), source: 9, sequence: 0 };
    recording.events.insert(0, Event::Order(Order::Submit(Command { key, change: velocity })));
    let replay = recording.replay(&mut |_| {}).expect("it is possible");
    assert!(!replay.is_same() && !replay.differences.is_empty(), "{replay:?}");
}

/// A display that changes things, takes them back, and shows a fork's future, while a thread computes.
#[test]
fn a_driver_records_what_it_hears() {
    let temporary = Temporary::new("driver");
    let path = temporary.file();
    let timeline = scenes().remove(0);
    let recorder = Recorder::create(&path, &timeline).expect("a place to write");
    let threads = Threads::exactly(NonZeroU16::new(2).expect("above 0")).expect("two threads");
    let settings = DecoupledSettings { recorder: Some(recorder.clone()), ..DecoupledSettings::new(threads) };
    let mut driver = Decoupled::start(timeline, settings).expect("a thread");
    let clock = Clock::system();
    let push = |body, x| Change::Push { body: BodyId(body), impulse: Vec3::X * x, at_point: None };
    let mut forks = 0;
    for picture in 0..100_u32 {
        clock.wait_until(Duration::from_millis(20) * picture);
        driver.show(0.02 * f64::from(picture)).expect("physics lives");
        match picture {
            20 | 25 | 50 => drop(driver.change(push(picture / 10, 40.0)).expect("there is room")),
            30 | 55 => driver.undo().expect("there is room"),
            32 => driver.redo().expect("there is room"),
            60 => driver.request_fork().expect("there is room"),
            75 => drop(driver.change(push(7, 50.0)).expect("there is room")),
            _ => {}
        }
        if let Some(mut fork) = driver.take_fork() {
            let body = BodyDef::new(forerun::Shape::sphere(0.2).expect("a ball")).at(Vec3::Y * 3.0);
            fork.add(driver.last_picture().frame.next(), body).expect("it is possible");
            driver.adopt(fork).expect("there is room");
            forks += 1;
        }
    }
    assert_eq!((forks, driver.refusals().len()), (1, 0));
    drop(driver);
    recorder.finish().expect("a place to write");
    let recording = Recording::read(&path).expect("it is whole");
    let restarts = recording.events.iter().filter(|event| matches!(event, Event::Restart(_))).count();
    let replay = recording.replay(&mut |_| {}).expect("it was recorded");
    assert!(replay.is_same() && replay.refused == 0, "{replay:?}");
    assert!(restarts == 1 && replay.orders >= 6 && replay.marks >= 2, "{replay:?}");
}

/// The events that both begin with.
fn is_prefix(part: &Recording, whole: &Recording) -> bool {
    let start = |parts: &forerun::timeline::TimelineParts| (parts.names.clone(), parts.environment);
    start(&part.start) == start(&whole.start)
        && part.start.commands.len() <= whole.start.commands.len()
        && whole.start.commands.starts_with(&part.start.commands)
        && whole.start.frames.starts_with(&part.start.frames)
        && whole.events.starts_with(&part.events)
}

/// A saved timeline with a few bodies, commands and states; a short session; one in which forks were adopted.
fn small_files() -> Vec<Vec<u8>> {
    let settings = TimelineSettings { lookahead: 6, past: 20, ..TimelineSettings::default() };
    let scene = Scene::open("dominoes:2").expect("a built-in scene");
    let mut timeline = timeline_of(&scene, settings).expect("it is possible");
    let mut random = Random::new(5);
    for _ in 0..6 {
        let order = random_order(&mut timeline, &mut random);
        let _ = timeline.obey(order);
    }
    finish(&mut timeline);
    let saved = Recording::of(&timeline, Keep::States).encode().expect("it is small");
    let mut session = Recording::of(&timeline, Keep::Commands);
    for _ in 0..5 {
        session.events.push(Event::Order(random_order(&mut timeline, &mut random)));
    }
    let (restart, mark) = (Event::Restart(Box::new(timeline.parts(Keep::States))), session.events[0].clone());
    let events = vec![restart.clone(), mark, restart];
    let adopting = Recording { events, start: session.start.clone() };
    let all = [session, adopting].map(|recording| recording.encode().expect("it is small"));
    Vec::from(all).into_iter().chain([saved]).collect()
}

#[test]
fn whatever_is_cut_is_an_error_and_what_comes_before_it_is_kept() {
    for bytes in small_files() {
        let whole = Recording::decode(&bytes).expect("it is whole");
        let (mut kept, mut most) = (0, 0);
        for length in 0..bytes.len() {
            let cut = &bytes[..length];
            let error = Recording::decode(cut).expect_err("it is cut");
            assert!(error.offset <= length as u64, "{error}");
            match Recording::decode_readable(cut) {
                Ok(recovered) => {
                    assert!(is_prefix(&recovered.recording, &whole), "cut at {length}");
                    assert_eq!(recovered.lost, Some(error));
                    kept += 1;
                    let events = recovered.recording.events.len();
                    assert!(events >= most, "more of the file is not less of the recording");
                    most = events;
                    let again = recovered.recording.encode().expect("it is small");
                    assert_eq!(Recording::decode(&again), Ok(recovered.recording));
                }
                Err(refused) => assert_eq!(refused, error),
            }
        }
        // A timeline that came to be another one at last does not count before the file is complete.
        let ends_with_start = matches!(whole.events.last(), Some(Event::Restart(_)));
        let expected = whole.events.len() - usize::from(ends_with_start);
        assert!(kept > bytes.len() / 4 && most == expected, "{kept} of {}", bytes.len());
        let mut longer = bytes.clone();
        longer.push(0);
        let error = Recording::decode(&longer).expect_err("something follows").to_string();
        assert!(error.contains("something follows the end"), "{error}");
    }
}

#[test]
fn whatever_bit_is_flipped_is_noticed() {
    for mut bytes in small_files() {
        let whole = Recording::decode(&bytes).expect("it is whole");
        for bit in 0..8 * bytes.len() {
            bytes[bit / 8] ^= 1 << (bit % 8);
            let error = Recording::decode(&bytes).expect_err("a bit is wrong");
            assert!(error.offset <= bit as u64 / 8, "bit {bit}: {error}");
            if let Ok(recovered) = Recording::decode_readable(&bytes) {
                assert!(is_prefix(&recovered.recording, &whole), "bit {bit}");
                assert!(recovered.lost.is_some());
            }
            bytes[bit / 8] ^= 1 << (bit % 8);
        }
    }
}

#[test]
fn a_session_that_broke_off_is_refused_and_recovered() {
    let temporary = Temporary::new("broken-off");
    let path = temporary.file();
    let mut timeline = scenes().remove(0);
    let recorder = Recorder::create(&path, &timeline).expect("a place to write");
    for frame in 1..10 {
        let change = Change::SetGravity { gravity: Vec3::Y * -(frame as f32) };
        let key = CommandKey { frame: Frame(frame), source: 0, sequence: frame };
        let order = Order::Submit(Command { key, change });
        timeline.obey(order.clone()).expect("it is possible");
        recorder.order(&order, &timeline);
    }
    finish(&mut timeline);
    recorder.mark(&timeline);
    // The program ends here.
    drop(recorder);
    let error = load_timeline(&path).expect_err("there is no end");
    assert_eq!(error.fault, RecordingFault::Cut);
    let length = std::fs::metadata(&path).expect("it is there").len();
    assert_eq!(
        error.to_string(),
        format!(
            "{}: is cut at byte {length}: no end is recorded; `forerun replay FILE --recover OUT` saves what comes before",
            path.display()
        )
    );
    let recovered = Recording::recover(&path).expect("its start is whole");
    assert_eq!(recovered.lost, Some(error));
    assert_eq!(recovered.recording.events.len(), 10);
    let mut again = recovered.recording.timeline().expect("it was one");
    finish(&mut again);
    assert_eq!(again.diff(&timeline), None);
    assert!(recovered.recording.replay(&mut |_| {}).expect("it was one").is_same());
}

#[test]
fn what_is_no_recording_is_told_by_name() {
    let temporary = Temporary::new("by-name");
    let path = temporary.file();
    let told = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("a place to write");
        let error = load_timeline(&path).expect_err("it is no recording").to_string();
        error.strip_prefix(&format!("{}: ", path.display())).expect("the file is named").to_owned()
    };
    assert!(told(b"").starts_with("is no recording"));
    assert!(told(b"name = 'dominoes'\n").starts_with("is no recording"));
    let good = &small_files()[0];
    let mut newer = good.clone();
    newer[8] = 3;
    let expected = "byte 8: is a recording of version 3, and this program reads version 2; use the program that wrote it";
    assert_eq!(told(&newer), expected);
    let missing = load_timeline(temporary.0.join("none")).expect_err("there is no such file");
    assert!(missing.to_string().contains("No such file"), "{missing}");
    let recording = Recording::decode(good).expect("it is whole");
    assert!(recording.write(temporary.0.join("no/such/folder")).is_err());
    std::fs::write(&path, good).expect("a place to write");
    recording.write(&path).expect("a place to write");
    assert_eq!(std::fs::read_dir(&temporary.0).expect("a folder").count(), 1, "nothing is left beside it");
}

/// Ten minutes, two edits a second and a hash every second: at most 1 MiB without states.
#[test]
fn ten_minutes_of_edits_are_small() {
    let scene = Scene::open("islands").expect("a built-in scene");
    let mut timeline = timeline_of(&scene, TimelineSettings::default()).expect("it is possible");
    let mut recording = Recording::of(&timeline, Keep::Commands);
    let bodies = recording.encode().expect("it is small").len();
    let mut random = Random::new(1);
    for second in 0..600_u64 {
        for edit in 0..2 {
            let frame = Frame(60 * second + 30 * edit + 1);
            let change = random_change(&mut timeline, Frame(0), &mut random);
            let key = CommandKey { frame, source: 0, sequence: 2 * second + edit };
            recording.events.push(Event::Order(Order::Submit(Command { key, change })));
        }
        let (display, oldest) = (Frame(60 * second), Frame(60 * second.saturating_sub(2)));
        let mark = Mark { display, oldest, frame: display, hash: random.bits() };
        recording.events.push(Event::Mark(mark));
    }
    let all = recording.encode().expect("it is small").len();
    // Of 10 000 bodies, which are most of it.
    assert!(all <= 1 << 20 && all - bodies < 80_000, "{bodies} bytes, and {} for the edits", all - bodies);
}
