//! Load: what each contact has to carry, from the bodies above it; a first guess that needs no memory of the last frame.
//!
//! From the top of the contact graph down, every body spreads its weight, and the momentum that its supports must take, over the points below
//! it: an affine pressure whose sum and moments match. It is the dual of shock propagation (Guendelman et al. 2003, section 8): forces
//! travel down instead of velocities up. Only a guess: the sweeps may lower or raise it.

use forerun_geometry::Vec3;

use super::batch::ContactList;
use super::contact_graph::ContactGraph;
use super::pressure::{Carried, Pressure, Support};
use crate::scratch::fill;
use crate::{Environment, Member};

/// Sinking slower than this is noise, not momentum. m/s
const DEAD_SPEED: f32 = 0.1;
/// What a body that nothing supports may sink at: anything. m/s
const UNSUPPORTED: f32 = 1e9;
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

    /// Where a force acts on a body: its horizontal place relative to the centre, at the height of the centre. `arm` is that of its point; the force
    /// is vertical where it is given as zero.
    fn place(&self, arm: Vec3, force: Vec3) -> (f32, f32) {
        let (mut x, mut z) = (arm.dot(self.one), arm.dot(self.two));
        if force != Vec3::ZERO {
            let rise = force.dot(self.up);
            if rise.abs() > RISE_MIN {
                let t = arm.dot(self.up) / rise;
                x -= t * force.dot(self.one);
                z -= t * force.dot(self.two);
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
    supports: Vec<Support>,
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
        loads.supports.clear();
        loads.starts.clear();
        for &i in &self.graph.order {
            loads.starts.push(loads.supports.len() as u32);
            self.weigh(i as usize, &compass, loads);
        }
        let mut end = loads.supports.len();
        for (&i, &start) in self.graph.order.iter().zip(&loads.starts).rev() {
            let supports = &loads.supports[start as usize..end];
            end = start as usize;
            let i = i as usize;
            let body = self.members[i].body;
            if !body.is_dynamic() {
                continue;
            }
            let fall = self.fall(i, &compass);
            let weight = 1.0 / body.inverse_mass * fall * fall;
            loads.strain[i].weight = weight;
            if supports.is_empty() {
                loads.strain[i].lost = weight;
                continue;
            }
            let Both { total, still } = loads.carried[i];
            loads.pressure.fit(supports, &total, &still, (1e-6 * body.radius * body.radius).max(1e-12));
            loads.strain[i].lost = self.lost(i, supports, &loads.pressure, &still);
            for (s, p) in supports.iter().zip(&loads.pressure.points).filter(|(_, p)| !p.dropped()) {
                let load = &mut loads.of_contact[s.slot as usize / 4];
                load.total[s.slot as usize % 4] = p.total * s.rise;
                load.weight[s.slot as usize % 4] = p.still * s.rise;
                let below = &mut loads.carried[s.below as usize];
                below.total.add(p.total, s.below_x, s.below_z);
                below.still.add(p.still, s.below_x, s.below_z);
            }
        }
    }

    /// What gravity adds to the speed of a body in a substep. m/s
    fn fall(&self, i: usize, compass: &Compass) -> f32 {
        let gravity = -self.environment.gravity.dot(compass.up) * self.members[i].body.gravity_scale;
        (gravity * self.substep_seconds).max(0.0)
    }

    /// The part of a body's load that its supports do not take: moments that do not match, and sideways forces beyond friction.
    fn lost(&self, i: usize, supports: &[Support], pressure: &Pressure, still: &Carried) -> f32 {
        let body = self.members[i].body;
        let (mut moment_1, mut moment_2, mut slips) = (still.moment_1, still.moment_2, 0.0);
        for (s, p) in supports.iter().zip(&pressure.points).filter(|(_, p)| !p.dropped()) {
            moment_1 -= p.still * s.x;
            moment_2 -= p.still * s.z;
            let steep = 1.0 - s.rise * s.rise;
            if steep > 0.0 {
                let friction = self.friction(i, s.below as usize);
                let slip = p.still * (steep.sqrt() - friction * s.rise).max(0.0);
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
        if let Some(lowest) = self.find_supports(i, compass, loads) {
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
    fn find_supports(&self, i: usize, compass: &Compass, loads: &mut Loads) -> Option<f32> {
        let (levels, here) = (self.graph.levels(), &self.members[i].state);
        let mut lowest: Option<f32> = None;
        for link in self.graph.links(i) {
            let (k, below) = (link.contact as usize, link.body as usize);
            if !link.touches || levels[below] >= levels[i] {
                continue;
            }
            let upwards = if self.contacts.ends[k].second as usize == i { 1.0 } else { -1.0 };
            let (touch, slide) = (self.graph.touch(k), loads.of_contact[k].slide);
            let there = &self.members[below].state;
            let velocity = here.velocity - there.velocity;
            let allowed = loads.allowed[below];
            // Mostly the points share their normal.
            let mut normal = Vec3::ZERO;
            let (mut rise, mut descent, mut force) = (0.0, 0.0, Vec3::ZERO);
            for (q, point) in self.contacts.manifold(k).points().iter().enumerate() {
                if point.normal != normal {
                    normal = point.normal;
                    rise = normal.dot(compass.up) * upwards;
                    // How fast the body sinks by moving along the surface that the point lies on.
                    let along = velocity - normal * velocity.dot(normal);
                    descent = -along.dot(compass.up);
                    if slide != Vec3::ZERO {
                        force = normal + slide * self.friction(i, below);
                    }
                }
                if point.separation >= touch || rise < RISE_MIN {
                    continue;
                }
                let gap = if point.separation > 0.0 { point.separation } else { 0.0 };
                let sinks = allowed + gap / self.substep_seconds + descent;
                lowest = if lowest.is_some_and(|least| least <= sinks) { lowest } else { Some(sinks) };
                let (x, z) = compass.place(point.position - here.position, force);
                let (below_x, below_z) = compass.place(point.position - there.position, force);
                loads.supports.push(Support {
                    x,
                    z,
                    below_x,
                    below_z,
                    rise,
                    weight: ((touch - point.separation) / touch).clamp(1e-4, 1.0),
                    below: link.body,
                    slot: link.contact * 4 + q as u32,
                });
            }
        }
        lowest
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
