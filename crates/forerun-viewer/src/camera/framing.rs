//! Framing: from where a scene is seen well: what has strayed is ignored, what lies flat is seen from above, what is long across the picture.

use forerun::Vec3;

use super::{Camera, HALF_ANGLE};

/// What is looked at fills no more than this part of what panels leave free.
const FILLED: f32 = 0.88;
/// A body is a stray when it is so many times as far from the middle as half of all bodies are.
const STRAY: f32 = 7.0;
/// Fewer bodies have no strays.
const CROWD: usize = 8;

/// Where a camera stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framed {
    /// What it looks at. Metres.
    pub target: Vec3,
    /// From there. Metres.
    pub distance: f32,
    /// About the vertical. Radians.
    pub yaw: f32,
    /// Above the horizontal. Radians.
    pub pitch: f32,
}

impl Framed {
    /// From where all of these balls (centre and radius, metres) are seen but for strays; none without balls. `free`: width and height of what is free of panels, in
    /// heights of the picture.
    #[must_use]
    pub fn around(balls: &[(Vec3, f32)], free: [f32; 2]) -> Option<Framed> {
        let kept = without_strays(balls);
        let low = kept.iter().fold(Vec3::INFINITY, |low, (at, radius)| low.min(*at - *radius));
        let high = kept.iter().fold(Vec3::NEG_INFINITY, |high, (at, radius)| high.max(*at + *radius));
        if kept.is_empty() {
            return None;
        }
        let size = high - low;
        let across = size.x.max(size.z).max(1e-6);
        // From a low angle where things are high, from above where they lie about in the plane.
        let depth = size.x.min(size.z);
        let flatness = (depth - size.y).max(0.0) / across;
        let pitch = 0.34 + 0.52 * flatness.min(1.0);
        let yaw = if size.x >= size.z { 0.42 } else { std::f32::consts::FRAC_PI_2 - 0.42 };
        Some(Framed { target: 0.5 * (low + high), distance: 1.0, yaw, pitch }.fitting(&kept, free))
    }

    /// In the same direction, so near that all balls (centre and radius, metres) just fit.
    #[must_use]
    pub fn fitting(self, balls: &[(Vec3, f32)], free: [f32; 2]) -> Framed {
        let camera = Camera { yaw: self.yaw, pitch: self.pitch, ..Camera::default() };
        let (forward, axes) = (camera.forward(), [camera.right(), camera.up()]);
        let tangents = free.map(|free| FILLED * HALF_ANGLE.tan() * free.max(0.1));
        // A ball is left of a side of the picture where its distance from that side is its radius or more.
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for (centre, radius) in balls {
            let depth = centre.dot(forward);
            for k in 0..2 {
                let (at, room) = (centre.dot(axes[k]), radius * (1.0 + tangents[k] * tangents[k]).sqrt());
                high[k] = high[k].max(at + room - tangents[k] * depth);
                low[k] = low[k].min(at - room + tangents[k] * depth);
            }
        }
        let depth = [0, 1].map(|k| (low[k] - high[k]) / (2.0 * tangents[k]));
        let eye = axes[0] * (0.5 * (low[0] + high[0]))
            + axes[1] * (0.5 * (low[1] + high[1]))
            + forward * depth[0].min(depth[1]);
        // The target is on the line of sight, as deep as the middle of what is seen.
        let distance = (self.target - eye).dot(forward).max(1e-3);
        Framed { target: eye + forward * distance, distance, ..self }
    }
}

/// The balls, but those that lie far off.
fn without_strays(balls: &[(Vec3, f32)]) -> Vec<(Vec3, f32)> {
    let finite = |(at, radius): &&(Vec3, f32)| at.is_finite() && radius.is_finite();
    let balls: Vec<(Vec3, f32)> = balls.iter().filter(finite).copied().collect();
    if balls.len() < CROWD {
        return balls;
    }
    let median = |value: &dyn Fn(&(Vec3, f32)) -> f32| {
        let mut sorted: Vec<f32> = balls.iter().map(value).collect();
        sorted.sort_unstable_by(f32::total_cmp);
        sorted[sorted.len() / 2]
    };
    let middle = Vec3::new(median(&|b| b.0.x), median(&|b| b.0.y), median(&|b| b.0.z));
    let usual = median(&|(at, radius)| (*at - middle).length() + radius);
    balls.iter().filter(|(at, radius)| (*at - middle).length() + radius <= STRAY * usual).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(framed: &Framed, balls: &[(Vec3, f32)], aspect: f32) -> Vec<[f32; 2]> {
        let mut camera = Camera::default();
        camera.jump(*framed);
        balls.iter().map(|(at, _)| camera.project(*at, aspect).expect("in front of the eye")).collect()
    }

    #[test]
    fn everything_is_in_the_picture_and_fills_it() {
        let row: Vec<(Vec3, f32)> = (0..40).map(|i| (Vec3::new(i as f32, 0.5, 0.0), 0.6)).collect();
        let tower: Vec<(Vec3, f32)> = (0..40).map(|i| (Vec3::new(2.0, i as f32, -7.0), 0.6)).collect();
        for (balls, aspect) in [(&row, 1.6), (&tower, 1.6), (&row, 0.5)] {
            let framed = Framed::around(balls, [aspect, 1.0]).unwrap();
            let seen = places(&framed, balls, aspect);
            let most = seen.iter().flatten().fold(0.0_f32, |most, at| most.max(at.abs()));
            assert!((0.6..0.9).contains(&most), "{most}");
            // Half as much room: half as large.
            let less = Framed::around(balls, [0.5 * aspect, 0.5]).unwrap();
            let seen = places(&less, balls, aspect);
            assert!(seen.iter().flatten().all(|at| at.abs() < 0.5), "{seen:?}");
        }
    }

    #[test]
    fn a_stray_is_ignored_and_a_plane_is_seen_from_above() {
        let spiral = |i: u32| {
            let (sin, cos) = (0.1 * i as f32).sin_cos();
            (Vec3::new(cos, 0.0, sin) * (0.02 * i as f32) + Vec3::Y * 0.3, 0.3)
        };
        let mut balls: Vec<(Vec3, f32)> = (0..500).map(spiral).collect();
        let framed = Framed::around(&balls, [1.6, 1.0]).unwrap();
        assert!(framed.pitch > 0.7, "{}", framed.pitch);
        balls.push((Vec3::new(0.0, -4000.0, 0.0), 0.3));
        let again = Framed::around(&balls, [1.6, 1.0]).unwrap();
        assert!((again.target - framed.target).length() < 0.1 && (again.pitch - framed.pitch).abs() < 1e-6);
        assert_eq!(Framed::around(&[], [1.6, 1.0]), None);
    }
}
