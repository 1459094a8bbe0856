//! Load: what each contact has to carry, from the bodies above it; a first guess that needs no memory of the last frame.
//!
//! From the top of the contact graph down, every body spreads its weight, and the momentum that its supports must take, over the points below
//! it: an affine pressure whose sum and moments match. It is the dual of shock propagation (Guendelman et al. 2003, section 8): forces
//! travel down instead of velocities up. Only a guess: the sweeps may lower or raise it.

use forerun_geometry::Vec3;

use super::contact_graph::{ContactGraph, Link};
use super::prepare::combine;
use super::pressure::{Carried, Support, fit};
use crate::narrow_phase::Contact;
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
}

/// How well the guess holds a body, in mass-scaled squares: of the weight's impulse, and of the part that no support takes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Strain {
    pub(crate) weight: f32,
    pub(crate) lost: f32,
}

pub(crate) struct LoadPass<'a> {
    pub(crate) members: &'a [Member<'a>],
    pub(crate) contacts: &'a [Contact],
    pub(crate) graph: &'a ContactGraph,
    pub(crate) environment: &'a Environment,
    pub(crate) substep_seconds: f32,
}

impl LoadPass<'_> {
    /// The load of every contact, and the strain of every body.
    pub(crate) fn run(&self) -> (Vec<Load>, Vec<Strain>) {
        let mut loads: Vec<Load> =
            self.contacts.iter().map(|c| Load { slide: self.slide(c), ..Load::default() }).collect();
        let mut strains = vec![Strain::default(); self.members.len()];
        let Some(compass) = Compass::new(self.environment.gravity) else {
            return (loads, strains);
        };
        let mut total = vec![Carried::default(); self.members.len()];
        let mut still = vec![Carried::default(); self.members.len()];
        self.weigh(&compass, &mut total, &mut still);
        let mut supports = Vec::with_capacity(32);
        for &i in self.graph.order.iter().rev() {
            let i = i as usize;
            if !self.members[i].body.is_dynamic() {
                continue;
            }
            self.supports_of(i, &compass, &loads, &mut supports);
            let own = 1.0 / self.members[i].body.inverse_mass;
            let weight = own * self.fall(i, &compass) * self.fall(i, &compass);
            strains[i].weight = weight;
            if supports.is_empty() {
                strains[i].lost = weight;
                continue;
            }
            let radius = self.members[i].body.radius;
            fit(&mut supports, &total[i], &still[i], (1e-6 * radius * radius).max(1e-12));
            strains[i].lost = self.lost(i, &supports, &still[i]);
            for s in supports.iter().filter(|s| !s.dropped) {
                let (c, p, j) = (s.contact as usize, s.point as usize, s.below as usize);
                loads[c].total[p] = s.total * s.rise;
                loads[c].weight[p] = s.still * s.rise;
                let (x, z) = self.place(&self.contacts[c], (p, j), &compass, loads[c].slide);
                total[j].add(s.total, x, z);
                still[j].add(s.still, x, z);
            }
        }
        (loads, strains)
    }

    /// What gravity adds to the speed of a body in a substep. m/s
    fn fall(&self, i: usize, compass: &Compass) -> f32 {
        let gravity = -self.environment.gravity.dot(compass.up) * self.members[i].body.gravity_scale;
        (gravity * self.substep_seconds).max(0.0)
    }

    /// The part of a body's load that its supports do not take: moments that do not match, and sideways forces beyond friction.
    fn lost(&self, i: usize, supports: &[Support], still: &Carried) -> f32 {
        let body = self.members[i].body;
        let (mut moment_1, mut moment_2, mut slips) = (still.moment_1, still.moment_2, 0.0);
        for s in supports.iter().filter(|s| !s.dropped) {
            moment_1 -= s.still * s.x;
            moment_2 -= s.still * s.z;
            let below = self.members[s.below as usize].body.material.friction;
            let friction = (body.material.friction * below).sqrt();
            let steep = (1.0 - s.rise * s.rise).max(0.0).sqrt();
            let slip = s.still * (steep - friction * s.rise).max(0.0);
            slips += slip * slip;
        }
        // Turning costs as for a ball of the same radius: I = 0.4 m r².
        let turns = (moment_1 * moment_1 + moment_2 * moment_2) / (0.4 * body.radius * body.radius);
        (turns + slips) * body.inverse_mass
    }

    /// Own weight of each body, and the momentum that its supports must take from it.
    fn weigh(&self, compass: &Compass, total: &mut [Carried], still: &mut [Carried]) {
        let h = self.substep_seconds;
        let mut allowed = vec![0.0f32; self.members.len()];
        for &i in &self.graph.order {
            let i = i as usize;
            let member = &self.members[i];
            let (body, state) = (member.body, &member.state);
            let sinking = -state.velocity.dot(compass.up);
            if !body.is_dynamic() {
                allowed[i] = sinking;
                continue;
            }
            let fall = self.fall(i, compass);
            let mass = 1.0 / body.inverse_mass;
            still[i].sum = mass * fall;
            total[i].sum = mass * fall;
            let mut lowest: Option<f32> = None;
            for (link, point) in self.points_below(i, compass) {
                let separation = self.contacts[link.contact as usize].manifold.points[point].separation;
                let here = allowed[link.body as usize]
                    + separation.max(0.0) / h
                    + self.descent(i, link, point, compass);
                lowest = Some(lowest.map_or(here, |l| l.min(here)));
            }
            let Some(lowest) = lowest else {
                allowed[i] = UNSUPPORTED;
                continue;
            };
            allowed[i] = lowest;
            total[i].sum = mass * (fall + shrink(sinking - lowest)).max(0.0);
            let spin = state.angular_velocity.length() * body.radius;
            if spin > DEAD_SPEED {
                // A vertical force f at (x, z) turns by (-z f, 0, x f): the supports must take -L.
                let axes = state.pose().axes();
                let l = axes * ((axes.transpose() * state.angular_velocity) / body.inverse_inertia);
                let part = 1.0 - DEAD_SPEED / spin;
                total[i].moment_1 -= l.dot(compass.two) * part;
                total[i].moment_2 += l.dot(compass.one) * part;
            }
        }
    }

    /// How fast a body sinks by moving along the surface that a point below it lies on. m/s
    fn descent(&self, i: usize, link: &Link, point: usize, compass: &Compass) -> f32 {
        let normal = self.contacts[link.contact as usize].manifold.points[point].normal;
        let velocity = self.members[i].state.velocity - self.members[link.body as usize].state.velocity;
        let along = velocity - normal * velocity.dot(normal);
        -along.dot(compass.up)
    }

    /// The points on which a body may rest: of contacts with lower bodies, near enough, rising.
    fn points_below<'b>(
        &'b self,
        i: usize,
        compass: &'b Compass,
    ) -> impl Iterator<Item = (&'b Link, usize)> + 'b {
        let level = self.graph.level(i);
        self.graph.links(i).iter().filter(move |link| self.graph.level(link.body as usize) < level).flat_map(
            move |link| {
                let contact = &self.contacts[link.contact as usize];
                (0..contact.manifold.count as usize)
                    .filter(move |&p| {
                        contact.manifold.points[p].separation < self.graph.touch(link.contact as usize)
                    })
                    .filter(move |&p| self.rise(contact, p, i, compass) >= RISE_MIN)
                    .map(move |p| (link, p))
            },
        )
    }

    fn rise(&self, contact: &Contact, point: usize, upper: usize, compass: &Compass) -> f32 {
        let rise = contact.manifold.points[point].normal.dot(compass.up);
        if contact.second as usize == upper { rise } else { -rise }
    }

    /// Which way friction pushes the second body of a contact, where a body slides on one that does not yield faster than friction can stop within
    /// the frame. (Two bodies that a jolt sets sliding on each other soon stick again: guessed as slides they make piles with heavy tops collapse.)
    fn slide(&self, contact: &Contact) -> Vec3 {
        let m = &contact.manifold;
        let (a, b) = (&self.members[contact.first as usize], &self.members[contact.second as usize]);
        if a.body.is_dynamic() && b.body.is_dynamic() {
            return Vec3::ZERO;
        }
        let points = &m.points[..m.count as usize];
        let centre = points.iter().fold(Vec3::ZERO, |sum, p| sum + p.position) / m.count as f32;
        let velocity = b.state.velocity_at(centre) - a.state.velocity_at(centre);
        let along = velocity - m.normal * velocity.dot(m.normal);
        let speed = along.length();
        let friction = combine(&a.body.material, &b.body.material).friction;
        let stopped = friction * self.environment.gravity.length() * self.environment.settings.frame_seconds;
        if speed > stopped { along / -speed } else { Vec3::ZERO }
    }

    /// Where a contact point's force acts on a body: its horizontal place relative to the centre, at the height of the centre.
    fn place(
        &self,
        contact: &Contact,
        (point, body): (usize, usize),
        compass: &Compass,
        slide: Vec3,
    ) -> (f32, f32) {
        let p = &contact.manifold.points[point];
        let r = p.position - self.members[body].state.position;
        let (mut x, mut z) = (r.dot(compass.one), r.dot(compass.two));
        if slide != Vec3::ZERO {
            let (a, b) = (&self.members[contact.first as usize], &self.members[contact.second as usize]);
            let force = p.normal + slide * combine(&a.body.material, &b.body.material).friction;
            let rise = force.dot(compass.up);
            if rise.abs() > RISE_MIN {
                let t = r.dot(compass.up) / rise;
                x -= t * force.dot(compass.one);
                z -= t * force.dot(compass.two);
            }
        }
        (x, z)
    }

    fn supports_of(&self, i: usize, compass: &Compass, loads: &[Load], out: &mut Vec<Support>) {
        out.clear();
        for (link, p) in self.points_below(i, compass) {
            let contact = &self.contacts[link.contact as usize];
            let point = &contact.manifold.points[p];
            let touch = self.graph.touch(link.contact as usize);
            let (x, z) = self.place(contact, (p, i), compass, loads[link.contact as usize].slide);
            out.push(Support {
                x,
                z,
                contact: link.contact,
                point: p as u32,
                below: link.body,
                rise: self.rise(contact, p, i, compass),
                weight: ((touch - point.separation) / touch).clamp(1e-4, 1.0),
                dropped: false,
                total: 0.0,
                still: 0.0,
            });
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
