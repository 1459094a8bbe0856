//! Linkage: how rings hold each other and go round poles, and how deep they overlap, from their poses alone, in double precision.
//!
//! A ring is a torus about the y axis of its shape: all points within the tube's radius of a circle. Two rings overlap where their circles come nearer
//! than both tubes are thick; they have gone through each other where their linking number changes, or a pole has gone through a ring where it
//! did not go over the pole's top. None of the engine's contact code is used, and the facets of meshes (which lie inside of the torus) are not seen.

use forerun::dynamics::{Body, BodyState, World};
use forerun::geometry::shape::Shape;

use super::lab::{cross, dot, doubled, length, rotated};

/// Poses between two frames that links are looked at in: whoever goes straight through crosses twice, and is linked in between only.
const BETWEEN_FRAMES: u32 = 8;
/// Points of a circle among which the nearest one is looked for, before it is refined.
const CIRCLE_POINTS: u32 = 48;

/// A torus. Metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Torus {
    pub(crate) radius: f64,
    pub(crate) tube_radius: f64,
}

/// A vertical cylinder.
#[derive(Clone, Copy, Debug)]
struct Pole {
    centre: [f64; 3],
    half_height: f64,
    radius: f64,
}

/// A circle in the world.
#[derive(Clone, Copy, Debug)]
struct Circle {
    centre: [f64; 3],
    /// Unit vectors: two in its plane, and the one at right angles to both.
    axes: [[f64; 3]; 3],
    radius: f64,
}

/// Watches the rings of a world: every dynamic body is one of the same torus, fixed cylinders are poles, and the ground is y = 0.
#[derive(Clone, Debug)]
pub(crate) struct Linkage {
    torus: Torus,
    /// Indices and bodies of the rings.
    rings: Vec<(usize, Body)>,
    poles: Vec<Pole>,
    /// As last seen.
    circles: Vec<Circle>,
    /// How often two rings have gone through each other.
    pub(crate) ring_changes: u32,
    /// How often a ring has gone through a pole.
    pub(crate) pole_changes: u32,
}

impl Linkage {
    pub(crate) fn new(world: &World, torus: Torus) -> Linkage {
        let (bodies, states) = (world.bodies(), world.states());
        let rings = bodies.iter().enumerate().filter(|(_, body)| body.is_dynamic());
        let rings: Vec<(usize, Body)> = rings.map(|(i, body)| (i, body.clone())).collect();
        let poles = bodies.iter().zip(states).filter_map(|(body, state)| match &body.shape {
            Shape::Cylinder(c) => Some(Pole {
                centre: doubled(body.own_pose(state).position),
                half_height: f64::from(c.half_height),
                radius: f64::from(c.radius),
            }),
            _ => None,
        });
        let poles = poles.collect();
        let mut linkage =
            Linkage { torus, rings, poles, circles: Vec::new(), ring_changes: 0, pole_changes: 0 };
        linkage.circles = linkage.circles(states);
        linkage
    }

    fn circles(&self, states: &[BodyState]) -> Vec<Circle> {
        let circle = |(i, body): &(usize, Body)| {
            let pose = body.own_pose(&states[*i]);
            let q = pose.rotation.to_array().map(f64::from);
            let axes = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|axis| rotated(q, axis));
            Circle { centre: doubled(pose.position), axes, radius: self.torus.radius }
        };
        self.rings.iter().map(circle).collect()
    }

    /// Counts who has gone through whom since the states seen last.
    pub(crate) fn follow(&mut self, states: &[BodyState]) {
        let now = self.circles(states);
        let before = std::mem::replace(&mut self.circles, now);
        let now = &self.circles;
        let moved: Vec<f64> =
            before.iter().zip(now).map(|(a, b)| length(minus(b.centre, a.centre))).collect();
        for i in 0..now.len() {
            for j in 0..i {
                let reach = 2.0 * self.torus.radius + moved[i] + moved[j];
                let apart = minus(now[i].centre, now[j].centre);
                if dot(apart, apart) < reach * reach {
                    let linking = |part: f64| {
                        between(&before[i], &now[i], part).linking(&between(&before[j], &now[j], part))
                    };
                    self.ring_changes += changes(linking);
                }
            }
        }
        for (before, now) in before.iter().zip(now) {
            for pole in &self.poles {
                self.pole_changes += pole.changes(before, now);
            }
        }
    }

    /// How deep rings overlap each other, poles and the ground: each pair that does, in the states seen last. Metres.
    pub(crate) fn overlaps(&self) -> Vec<f64> {
        let Torus { radius, tube_radius } = self.torus;
        let reach = 2.0 * (radius + tube_radius);
        let mut overlaps = Vec::new();
        for (i, a) in self.circles.iter().enumerate() {
            let tilt = a.axes[2][1];
            overlaps.push(tube_radius + radius * (1.0 - tilt * tilt).max(0.0).sqrt() - a.centre[1]);
            for b in &self.circles[..i] {
                let apart = minus(a.centre, b.centre);
                if dot(apart, apart) < reach * reach {
                    overlaps.push(2.0 * tube_radius - a.nearest(|point| b.distance(point)));
                }
            }
            for pole in &self.poles {
                let apart = minus(a.centre, pole.centre);
                let near = radius + tube_radius + pole.radius;
                if apart[0] * apart[0] + apart[2] * apart[2] < near * near {
                    overlaps.push(tube_radius - a.nearest(|point| pole.distance(point)));
                }
            }
        }
        overlaps.retain(|overlap| *overlap > 0.0);
        overlaps
    }
}

impl Circle {
    fn at(&self, angle: f64) -> [f64; 3] {
        let (sin, cos) = angle.sin_cos();
        let [u, v, _] = self.axes;
        [0, 1, 2].map(|k| self.centre[k] + self.radius * (cos * u[k] + sin * v[k]))
    }

    /// From the circle to a point. Metres.
    fn distance(&self, point: [f64; 3]) -> f64 {
        let from = minus(point, self.centre);
        let height = dot(from, self.axes[2]);
        let out = (dot(from, from) - height * height).max(0.0).sqrt() - self.radius;
        (height * height + out * out).sqrt()
    }

    /// The least of a function over the points of the circle.
    fn nearest(&self, distance: impl Fn([f64; 3]) -> f64) -> f64 {
        let step = std::f64::consts::TAU / f64::from(CIRCLE_POINTS);
        let at = |angle: f64| distance(self.at(angle));
        let values: Vec<f64> = (0..CIRCLE_POINTS).map(|k| at(f64::from(k) * step)).collect();
        let n = values.len();
        let mut least = f64::INFINITY;
        for k in 0..n {
            if values[k] <= values[(k + 1) % n] && values[k] <= values[(k + n - 1) % n] {
                // Thirds: each time the part with the larger end is cut off.
                let (mut low, mut high) = ((k as f64 - 1.0) * step, (k as f64 + 1.0) * step);
                for _ in 0..30 {
                    let third = (high - low) / 3.0;
                    if at(low + third) < at(high - third) { high -= third } else { low += third }
                }
                least = least.min(at(0.5 * (low + high)));
            }
        }
        least
    }

    /// How often another circle goes through the disc of this one, there and back: -1, 0 or 1.
    fn linking(&self, other: &Circle) -> i32 {
        let normal = self.axes[2];
        let [u, v, _] = other.axes;
        let height = dot(minus(other.centre, self.centre), normal);
        let (a, b) = (other.radius * dot(u, normal), other.radius * dot(v, normal));
        let swing = (a * a + b * b).sqrt();
        if height.abs() >= swing {
            return 0;
        }
        // The two points at which height + a cos t + b sin t is 0: up through the disc at one, down at the other.
        let (middle, half) = (b.atan2(a), (-height / swing).acos());
        let inside = |angle: f64| {
            let from = minus(other.at(angle), self.centre);
            i32::from(dot(from, from) < self.radius * self.radius)
        };
        inside(middle - half) - inside(middle + half)
    }
}

impl Pole {
    /// From its surface to a point, negative inside. Metres.
    fn distance(&self, point: [f64; 3]) -> f64 {
        let [x, y, z] = minus(point, self.centre);
        let (out, up) = ((x * x + z * z).sqrt() - self.radius, y.abs() - self.half_height);
        out.max(up).min(0.0) + length([out.max(0.0), up.max(0.0), 0.0])
    }

    /// How often a ring comes round its axis, or off it, otherwise than over its top.
    fn changes(&self, before: &Circle, now: &Circle) -> u32 {
        let [x, y, z] = self.centre;
        let (foot, top) = ([x, y - self.half_height, z], [x, y + self.half_height, z]);
        let mut count = 0;
        let mut last: Option<(bool, f64)> = None;
        for k in 0..=BETWEEN_FRAMES {
            let ring = between(before, now, f64::from(k) / f64::from(BETWEEN_FRAMES));
            let height = |point| dot(minus(point, ring.centre), ring.axes[2]);
            let (low, high) = (height(foot), height(top));
            let crossing = low / (low - high);
            let at = minus([x, foot[1] + crossing * (top[1] - foot[1]), z], ring.centre);
            let round = (low < 0.0) != (high < 0.0) && length(at) < ring.radius;
            if let Some((was_round, was_high)) = last {
                count += u32::from(round != was_round && (high < 0.0) == (was_high < 0.0));
            }
            last = Some((round, high));
        }
        count
    }
}

/// How often a number changes from one pose to the next, from one frame to another.
fn changes(number: impl Fn(f64) -> i32) -> u32 {
    let mut last = number(0.0);
    let mut count = 0;
    for k in 1..=BETWEEN_FRAMES {
        let next = number(f64::from(k) / f64::from(BETWEEN_FRAMES));
        count += u32::from(next != last);
        last = next;
    }
    count
}

/// A part of the way from one place of a circle to another.
fn between(a: &Circle, b: &Circle, part: f64) -> Circle {
    let mix = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] + part * (b[k] - a[k]));
    let unit = |v: [f64; 3]| v.map(|x| x / length(v));
    let normal = unit(mix(a.axes[2], b.axes[2]));
    let first = mix(a.axes[0], b.axes[0]);
    let u = unit([0, 1, 2].map(|k| first[k] - dot(first, normal) * normal[k]));
    Circle { centre: mix(a.centre, b.centre), axes: [u, cross(normal, u), normal], radius: a.radius }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];

    fn flat(centre: [f64; 3]) -> Circle {
        Circle { centre, axes: [Z, X, Y], radius: 1.0 }
    }

    fn upright(centre: [f64; 3]) -> Circle {
        Circle { centre, axes: [X, Y, Z], radius: 1.0 }
    }

    #[test]
    fn linked_circles_are_told_from_others() {
        assert_eq!(flat([0.0; 3]).linking(&upright([1.0, 0.0, 0.0])).abs(), 1);
        assert_eq!(upright([1.0, 0.0, 0.0]).linking(&flat([0.0; 3])).abs(), 1);
        assert_eq!(flat([0.0; 3]).linking(&upright([2.1, 0.0, 0.0])), 0);
        assert_eq!(flat([0.0; 3]).linking(&flat([0.3, 0.1, 0.0])), 0);
        // Inside of the disc with both sides: not linked.
        let small = Circle { radius: 0.3, ..upright([0.1, 0.0, 0.0]) };
        assert_eq!(flat([0.0; 3]).linking(&small), 0);
    }

    #[test]
    fn a_circle_that_is_dragged_through_another_changes_links() {
        let held = flat([0.0; 3]);
        let through = |part: f64| held.linking(&upright([3.0 - 2.0 * part, 0.0, 0.0]));
        assert_eq!(changes(through), 1);
        let in_and_out = |part: f64| held.linking(&upright([2.6 - 5.2 * part, 0.0, 0.0]));
        assert!(changes(in_and_out) >= 2);
    }

    #[test]
    fn distances_of_circles_are_those_of_a_fine_search() {
        let (a, b) = (flat([0.0; 3]), upright([0.9, 0.3, 1.7]));
        let fine = (0..100_000).map(|k| b.distance(a.at(f64::from(k) * std::f64::consts::TAU / 1e5)));
        let least = fine.fold(f64::INFINITY, f64::min);
        assert!((a.nearest(|p| b.distance(p)) - least).abs() < 1e-7);
        assert!((flat([0.0; 3]).nearest(|p| flat([2.5, 0.0, 0.0]).distance(p)) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn poles_may_be_left_over_the_top_only() {
        let pole = Pole { centre: [0.0, 5.0, 0.0], half_height: 5.0, radius: 0.1 };
        let changes = |from, to| pole.changes(&flat(from), &flat(to));
        assert_eq!(changes([0.1, 11.0, 0.0], [0.1, 9.0, 0.0]), 0);
        assert_eq!(changes([0.1, 9.0, 0.0], [0.1, 4.0, 0.2]), 0);
        assert_eq!(changes([0.1, 4.0, 0.0], [1.4, 4.0, 0.0]), 1);
        assert_eq!(changes([1.4, 4.0, 0.0], [-1.4, 4.0, 0.0]), 2);
        assert!((pole.distance([0.0, 10.3, 0.4]) - 0.3_f64.hypot(0.3)).abs() < 1e-12);
    }
}
