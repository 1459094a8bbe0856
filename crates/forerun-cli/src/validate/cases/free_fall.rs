//! Free fall: a thrown ball against x = v t, y = h - g t²/2.

use forerun::dynamics::Unobserved;
use forerun::{BodyDef, Environment, Shape, Sphere, Vec3};

use crate::validate::Figure;
use crate::validate::lab::world;

const FRAMES: u32 = 120;
const START: Vec3 = Vec3::new(0.0, 100.0, 0.0);
const VELOCITY: Vec3 = Vec3::new(3.0, 4.0, 0.0);

/// Two seconds of flight. A step whose position follows the mean of old and new velocity is exact up to rounding; one that is of
/// first order is g t dt/2 = 0.16 m off at 60 frames per second, and substeps divide that.
pub(crate) fn run() -> Vec<Figure> {
    let environment = Environment::default();
    let time = environment.settings.frame_seconds * FRAMES as f32;
    let mut ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.1 })).at(START);
    ball.velocity = VELOCITY;
    let mut world = world(environment, &[ball]);
    for _ in 0..FRAMES {
        world.step(&mut Unobserved);
    }
    let expected = START + VELOCITY * time + environment.gravity * (0.5 * time * time);
    let state = world.states()[0];
    let speed = VELOCITY + environment.gravity * time;
    vec![
        Figure::at_most(
            "distance from the parabola after 2 s, m",
            f64::from(state.position.distance(expected)),
            0.05,
        ),
        Figure::near("vertical speed after 2 s, m/s", f64::from(state.velocity.y), f64::from(speed.y), 1e-3),
    ]
}
