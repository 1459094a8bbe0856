use forerun::dynamics::{Unobserved, World};
use forerun::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let scene = Scene::open(&args[1]).unwrap();
    let frames: u32 = args[2].parse().unwrap();
    let every: u32 = args[3].parse().unwrap();
    let bodies = scene.bodies().unwrap();
    let mut w = World::new(scene.environment());
    for b in &bodies {
        w.add(b).unwrap();
    }
    let t = std::time::Instant::now();
    for k in 0..=frames {
        if k % every == 0 {
            let s = w.states();
            let moving = s.iter().filter(|s| s.velocity.length() > 1e-3).count();
            let resting = s.iter().filter(|s| s.rest >= 120).count();
            let e: f64 = s.iter().map(|s| 0.5 * (s.velocity.length() as f64).powi(2)).sum();
            let far = s.iter().map(|s| s.position.length()).fold(0.0f32, f32::max);
            println!(
                "{k}: moving {moving} rest {resting} of {} e {e:.3} far {far:.2} {:?}",
                s.len(),
                t.elapsed()
            );
            for a in &args[4..] {
                let (i,) = (a.parse::<usize>().unwrap(),);
                println!("   {i}: {} v {}", s[i].position, s[i].velocity);
            }
        }
        w.step(&mut Unobserved);
    }
}
