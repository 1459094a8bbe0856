//! Load: what each contact has to carry, from the bodies above it; a first guess that needs no memory of the last frame.
//!
//! From the top of the contact graph down, every body spreads its weight, and the momentum that its supports must take, over the points below
//! it: an affine pressure whose sum and moments match. It is the dual of shock propagation (Guendelman et al. 2003, section 8): forces
//! travel down instead of velocities up. Only a guess: the sweeps may lower or raise it.

use std::ops::Range;

use forerun_geometry::contact::ContactPoint;
use forerun_geometry::{Manifold, Vec3};

use super::batch::ContactList;
use super::contact_graph::ContactGraph;
use super::pressure::{Carried, Footing, Pressure};
use crate::lanes::Row;
use crate::scratch::fill;
use crate::{Environment, Member};

/// Sinking slower than this is noise, not momentum. m/s
const DEAD_SPEED: f32 = 0.1;
/// What a body that nothing supports may sink at: anything. m/s
const UNSUPPORTED: f32 = 1e9;
/// A point that just supports weighs so much against one in full touch.
const WEIGHT_MIN: f32 = 1e-4;
/// A support's normal must rise by at least this.
const RISE_MIN: f32 = 0.3;

/// Normal impulses of a contact's points in the first substep.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Load {
    /// With momentum.
    pub(crate) total: [f32; 4],
    /// Weight alone: what the later substeps start from.
    pub(crate) weight: [f32; 4],
    /// Which way friction pushes the second body, where the two slide: a unit vector; else zero.
    pub(crate) slide: Vec3,
}

/// The vertical and two horizontal directions.
struct Compass {
    up: Vec3,
    one: Vec3,
    two: Vec3,
}

impl Compass {
    fn new(gravity: Vec3) -> Option<Compass> {
        let length = gravity.length();
        if length <= 0.0 {
            return None;
        }
        let up = gravity * (-1.0 / length);
        // x for the usual gravity; any direction across otherwise.
        let across = if up.x.abs() < 0.9 { Vec3::X } else { Vec3::Z };
        let one = (across - up * across.dot(up)).normalize();
        Some(Compass { up, one, two: one.cross(up) })
    }
}

/// The four points of a manifold, place by place; those that are not meant do not touch.
struct Points {
    position: [[f32; 4]; 3],
    normal: [[f32; 4]; 3],
    separation: [f32; 4],
}

impl Points {
    fn of(manifold: &Manifold) -> Points {
        // What fills the other places of a manifold is left open: here it is its first point, out of touch.
        let mut p = [&manifold.points[0]; 4];
        let mut separation = [f32::INFINITY; 4];
        for (q, point) in manifold.points().iter().enumerate() {
            p[q] = point;
            separation[q] = point.separation;
        }
        let each = |of: fn(&ContactPoint) -> f32| [of(p[0]), of(p[1]), of(p[2]), of(p[3])];
        Points {
            position: [each(|p| p.position.x), each(|p| p.position.y), each(|p| p.position.z)],
            normal: [each(|p| p.normal.x), each(|p| p.normal.y), each(|p| p.normal.z)],
            separation,
        }
    }

    fn normal_along(&self, direction: Vec3) -> [f32; 4] {
        let [x, y, z] = &self.normal;
        std::array::from_fn(|q| x[q] * direction.x + y[q] * direction.y + z[q] * direction.z)
    }

    /// 1 for a point in full touch, next to 0 where it just misses, 0 where it is farther or does not rise.
    fn weight(&self, rise: &[f32; 4], touch: f32) -> [f32; 4] {
        std::array::from_fn(|q| {
            let weight = (touch - self.separation[q]) / touch;
            let weight = if weight < WEIGHT_MIN { WEIGHT_MIN } else { weight };
            let weight = if weight > 1.0 { 1.0 } else { weight };
            if self.separation[q] < touch && rise[q] >= RISE_MIN { weight } else { 0.0 }
        })
    }

    /// How fast a body sinks by closing the gap in a substep, and by moving along the surface that a point lies on. m/s
    fn sinks(&self, velocity: Vec3, up: Vec3, substep_seconds: f32) -> [f32; 4] {
        let (closing, rise) = (self.normal_along(velocity), self.normal_along(up));
        let rises = velocity.dot(up);
        std::array::from_fn(|q| {
            let gap = if self.separation[q] > 0.0 { self.separation[q] } else { 0.0 };
            gap / substep_seconds - (rises - rise[q] * closing[q])
        })
    }

    /// Where forces along the normals, and so much friction for each, act on a body: horizontal places relative to its centre, at the height of the
    /// centre. Without friction the forces count as vertical.
    fn places(&self, centre: Vec3, rubs: Vec3, compass: &Compass) -> ([f32; 4], [f32; 4]) {
        let [px, py, pz] = &self.position;
        let along = |direction: Vec3| -> [f32; 4] {
            std::array::from_fn(|q| {
                let (x, y, z) = (px[q] - centre.x, py[q] - centre.y, pz[q] - centre.z);
                x * direction.x + y * direction.y + z * direction.z
            })
        };
        let (mut x, mut z) = (along(compass.one), along(compass.two));
        if rubs != Vec3::ZERO {
            let height = along(compass.up);
            let [nx, ny, nz] = &self.normal;
            for q in 0..4 {
                let force = Vec3::new(nx[q], ny[q], nz[q]) + rubs;
                let rise = force.dot(compass.up);
                if rise.abs() > RISE_MIN {
                    let t = height[q] / rise;
                    x[q] -= t * force.dot(compass.one);
                    z[q] -= t * force.dot(compass.two);
                }
            }
        }
        (x, z)
    }
}

/// How well the guess holds a body, in mass-scaled squares: of the weight's impulse, and of the part that no support takes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Strain {
    pub(crate) weight: f32,
    pub(crate) lost: f32,
}

/// What the load pass finds, and the memory that it works in.
#[derive(Debug, Default)]
pub(crate) struct Loads {
    /// By contact.
    pub(crate) of_contact: Vec<Load>,
    /// By body.
    pub(crate) strain: Vec<Strain>,
    /// By body: its load, with momentum and without.
    carried: Vec<Both>,
    /// By body: how fast it may sink. m/s
    allowed: Vec<f32>,
    /// The points below each body, in the order of the graph.
    footings: Vec<Footing>,
    starts: Vec<u32>,
    pressure: Pressure,
}

/// A body's load.
#[derive(Clone, Copy, Debug, Default)]
struct Both {
    total: Carried,
    still: Carried,
}

pub(crate) struct LoadPass<'a> {
    pub(crate) members: &'a [Member<'a>],
    pub(crate) contacts: ContactList<'a>,
    pub(crate) graph: &'a ContactGraph,
    /// By body; see [`Bodies::centres`](super::bodies::Bodies::centres).
    pub(crate) centres: &'a [Row],
    pub(crate) environment: &'a Environment,
    pub(crate) substep_seconds: f32,
}

impl LoadPass<'_> {
    /// Finds the load of every contact, and the strain of every body.
    pub(crate) fn run(&self, loads: &mut Loads) {
        fill(&mut loads.of_contact, self.contacts.ends.len(), Load::default());
        fill(&mut loads.strain, self.members.len(), Strain::default());
        self.find_slides(&mut loads.of_contact);
        let Some(compass) = Compass::new(self.environment.gravity) else {
            return;
        };
        fill(&mut loads.carried, self.members.len(), Both::default());
        fill(&mut loads.allowed, self.members.len(), 0.0);
        loads.footings.clear();
        loads.starts.clear();
        for &i in &self.graph.order {
            loads.starts.push(loads.footings.len() as u32);
            self.weigh(i as usize, &compass, loads);
        }
        let mut end = loads.footings.len();
        for k in (0..self.graph.order.len()).rev() {
            let start = loads.starts[k] as usize;
            self.hand_down(self.graph.order[k] as usize, start..end, &compass, loads);
            end = start;
        }
    }

    /// Spreads the load of a body over the points below it.
    fn hand_down(&self, i: usize, footings: Range<usize>, compass: &Compass, loads: &mut Loads) {
        let body = self.members[i].body;
        if !body.is_dynamic() {
            return;
        }
        let fall = self.fall(i, compass);
        let weight = 1.0 / body.inverse_mass * fall * fall;
        loads.strain[i].weight = weight;
        if footings.is_empty() {
            loads.strain[i].lost = weight;
            return;
        }
        let footings = &loads.footings[footings];
        let Both { total, still } = loads.carried[i];
        loads.pressure.fit(footings, &total, &still, (1e-6 * body.radius * body.radius).max(1e-12));
        loads.strain[i].lost = self.lost(i, footings, &loads.pressure, &still);
        for (f, s) in footings.iter().zip(&loads.pressure.shares) {
            let load = &mut loads.of_contact[f.contact as usize];
            let below = &mut loads.carried[f.below as usize];
            for q in 0..4 {
                load.total[q] = s.total[q] * f.rise[q];
                load.weight[q] = s.still[q] * f.rise[q];
                below.total.add(s.total[q], f.below_x[q], f.below_z[q]);
                below.still.add(s.still[q], f.below_x[q], f.below_z[q]);
            }
        }
    }

    /// The centre of mass of a body, where its contacts are looked at.
    fn centre(&self, i: usize) -> Vec3 {
        let [x, y, z, ..] = self.centres[i].0;
        Vec3::new(x, y, z)
    }

    /// What gravity adds to the speed of a body in a substep. m/s
    fn fall(&self, i: usize, compass: &Compass) -> f32 {
        let gravity = -self.environment.gravity.dot(compass.up) * self.members[i].body.gravity_scale;
        (gravity * self.substep_seconds).max(0.0)
    }

    /// The part of a body's load that its supports do not take: moments that do not match, and sideways forces beyond friction.
    fn lost(&self, i: usize, footings: &[Footing], pressure: &Pressure, still: &Carried) -> f32 {
        let body = self.members[i].body;
        let (mut moment_1, mut moment_2, mut slips) = (still.moment_1, still.moment_2, 0.0);
        for (f, s) in footings.iter().zip(&pressure.shares) {
            let friction = self.friction(i, f.below as usize);
            for q in 0..4 {
                moment_1 -= s.still[q] * f.x[q];
                moment_2 -= s.still[q] * f.z[q];
                let flat = f.rise[q] * f.rise[q];
                let steep = if flat < 1.0 { (1.0 - flat).sqrt() } else { 0.0 };
                let beyond = steep - friction * f.rise[q];
                let slip = if beyond > 0.0 { s.still[q] * beyond } else { 0.0 };
                slips += slip * slip;
            }
        }
        // Turning costs as for a ball of the same radius: I = 0.4 m r².
        let turns = (moment_1 * moment_1 + moment_2 * moment_2) / (0.4 * body.radius * body.radius);
        (turns + slips) * body.inverse_mass
    }

    /// Kinetic friction between two bodies.
    fn friction(&self, a: usize, b: usize) -> f32 {
        (self.members[a].body.material.friction * self.members[b].body.material.friction).sqrt()
    }

    /// Own weight of a body, the momentum that its supports must take from it, and the supports: those below are weighed.
    fn weigh(&self, i: usize, compass: &Compass, loads: &mut Loads) {
        let member = &self.members[i];
        let (body, state) = (member.body, &member.state);
        let sinking = -state.velocity.dot(compass.up);
        if !body.is_dynamic() {
            loads.allowed[i] = sinking;
            return;
        }
        let fall = self.fall(i, compass);
        let mass = 1.0 / body.inverse_mass;
        let mut carried = Both::default();
        carried.still.sum = mass * fall;
        carried.total.sum = mass * fall;
        if let Some(lowest) = self.find_footings(i, compass, loads) {
            loads.allowed[i] = lowest;
            carried.total.sum = mass * (fall + shrink(sinking - lowest)).max(0.0);
            let spin = state.angular_velocity.length() * body.radius;
            if spin > DEAD_SPEED {
                // A vertical force f at (x, z) turns by (-z f, 0, x f): the supports must take -L.
                let axes = state.pose().axes();
                let l = axes * ((axes.transpose() * state.angular_velocity) / body.inverse_inertia);
                let part = 1.0 - DEAD_SPEED / spin;
                carried.total.moment_1 -= l.dot(compass.two) * part;
                carried.total.moment_2 += l.dot(compass.one) * part;
            }
        } else {
            loads.allowed[i] = UNSUPPORTED;
        }
        loads.carried[i] = carried;
    }

    /// Lists the points on which a body may rest: of contacts with lower bodies, near enough, rising. Returns how fast they let it sink, if there
    /// are any. m/s
    fn find_footings(&self, i: usize, compass: &Compass, loads: &mut Loads) -> Option<f32> {
        let (levels, here) = (self.graph.levels(), &self.members[i].state);
        let mut lowest = f32::INFINITY;
        let start = loads.footings.len();
        for link in self.graph.links(i) {
            let (k, below) = (link.contact as usize, link.body as usize);
            if !link.touches || levels[below] >= levels[i] {
                continue;
            }
            let upwards = if self.contacts.ends[k].second as usize == i { 1.0 } else { -1.0 };
            let there = &self.members[below].state;
            let points = Points::of(self.contacts.manifold(k));
            let rise = points.normal_along(compass.up * upwards);
            let touch = self.graph.touch(k);
            let weight = points.weight(&rise, touch);
            if !weight.iter().any(|&w| w > 0.0) {
                continue;
            }
            let sinks = points.sinks(here.velocity - there.velocity, compass.up, self.substep_seconds);
            for q in 0..4 {
                let sinks = loads.allowed[below] + sinks[q];
                lowest = if weight[q] > 0.0 && sinks < lowest { sinks } else { lowest };
            }
            let slide = loads.of_contact[k].slide;
            let rubs = if slide == Vec3::ZERO { slide } else { slide * self.friction(i, below) };
            let (x, z) = points.places(self.centre(i), rubs, compass);
            let (below_x, below_z) = points.places(self.centre(below), rubs, compass);
            loads.footings.push(Footing {
                x,
                z,
                below_x,
                below_z,
                rise,
                weight,
                below: link.body,
                contact: link.contact,
            });
        }
        (loads.footings.len() > start).then_some(lowest)
    }

    /// Which way friction pushes the second body of a contact, where a body slides on one that does not yield faster than friction can stop within
    /// the frame. (Two bodies that a jolt sets sliding on each other soon stick again: guessed as slides they make piles with heavy tops collapse.)
    fn find_slides(&self, loads: &mut [Load]) {
        let change = self.environment.gravity.length() * self.environment.settings.frame_seconds;
        let yields = |i: u32| self.members[i as usize].body.is_dynamic();
        for (k, (e, load)) in self.contacts.ends.iter().zip(loads).enumerate() {
            if yields(e.first) && yields(e.second) {
                continue;
            }
            let (a, b) = (&self.members[e.first as usize], &self.members[e.second as usize]);
            let m = self.contacts.manifold(k);
            let centre = m.points().iter().fold(Vec3::ZERO, |sum, p| sum + p.position) / m.count as f32;
            let velocity = b.state.velocity_at(centre) - a.state.velocity_at(centre);
            let along = velocity - m.normal * velocity.dot(m.normal);
            let speed = along.length();
            if speed > self.friction(e.first as usize, e.second as usize) * change {
                load.slide = along / -speed;
            }
        }
    }
}

/// Soft threshold: small speeds count as nothing, larger ones for the excess.
fn shrink(speed: f32) -> f32 {
    if speed > DEAD_SPEED {
        speed - DEAD_SPEED
    } else if speed < -DEAD_SPEED {
        speed + DEAD_SPEED
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_that_are_not_meant_carry_nothing() {
        let point = ContactPoint { position: Vec3::X, normal: Vec3::Y, separation: 0.0 };
        let manifold = Manifold { normal: Vec3::Y, points: [point; 4], count: 1 };
        let points = Points::of(&manifold);
        let rise = points.normal_along(Vec3::Y);
        assert_eq!(points.weight(&rise, 0.01).map(|w| w > 0.0), [true, false, false, false]);
    }
}
