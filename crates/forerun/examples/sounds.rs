//! Sounds that are known before they are heard: a row of dominoes falls, the program lists what is about to hit what, and tells each hit
//! when the display passes it. Early on somebody takes three dominoes away: what was about to happen behind them never does, and is never told.
//!
//! ```text
//! cargo run --release --example sounds
//! ```

#![allow(clippy::print_stdout, reason = "an example talks to whoever runs it")]

use std::error::Error;
use std::time::Duration;

use forerun::timeline::{ContactKind, ContactListener, ContactNotice, ListenerSettings};
use forerun::{
    BodyId, Change, Clock, Decoupled, DecoupledSettings, Scene, Threads, TimelineSettings, timeline_of,
};

/// The dominoes that are taken away.
const TAKEN: [BodyId; 3] = [BodyId(13), BodyId(14), BodyId(15)];

/// When they are. Seconds.
const TAKEN_S: f64 = 0.5;

/// What comes together slower makes no sound. m/s.
const LOUD: f32 = 0.5;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = Scene::open("dominoes:20")?;
    let settings = TimelineSettings { record_contacts: true, ..TimelineSettings::default() };
    let mut physics =
        Decoupled::start(timeline_of(&scene, settings)?, DecoupledSettings::new(Threads::all()?))?;
    let mut listener =
        ContactListener::new(ListenerSettings { hit_speed_min: LOUD, ..ListenerSettings::default() });
    let clock = Clock::system();
    let (mut taken, mut next_list_s) = (false, 0.25);
    loop {
        let picture = physics.show(clock.now().as_secs_f64())?;
        let now = picture.time_s;
        if now >= next_list_s {
            // What an audio mixer would load by now.
            let ahead = picture.snapshot.hits(now, now + 1.0, LOUD);
            println!("{now:.2} s: {} hits are known within the next second", ahead.len());
            next_list_s += 0.5;
        }
        for notice in listener.pass(&picture.snapshot, now) {
            let ContactNotice::Happened(event) = notice else { continue };
            if event.kind == ContactKind::Hit {
                let touch = event.touch;
                println!("{now:.2} s: {} hits {} at {:.2} m/s", touch.first.0, touch.second.0, touch.speed);
            }
        }
        if !taken && now >= TAKEN_S {
            for body in TAKEN {
                physics.change(Change::Remove { body })?;
            }
            println!("{now:.2} s: dominoes {} to {} are taken away", TAKEN[0].0, TAKEN[2].0);
            taken = true;
        }
        if now > 3.0 {
            return Ok(());
        }
        std::thread::sleep(Duration::from_millis(16));
    }
}
