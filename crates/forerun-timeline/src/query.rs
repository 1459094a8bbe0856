//! Query: questions about space at a time, asked of a snapshot: where a body is, what a ray meets, who overlaps a shape.
//!
//! Promise: the answer is about the bodies exactly as [`Snapshot::sample`] shows them at that time, past, present or future, and is the
//! same on every platform. All bodies are looked at in turn, most only as far as the ball around them.

use forerun_dynamics::{Body, BodyId};
use forerun_geometry::{Aabb, Pose, Ray, Shape, Vec3};

use crate::Snapshot;
use crate::snapshot::{Look, Moment};

/// Rounding may put a surface this much farther out than the ball around it says: part of its radius, and of where it is.
const ROUNDING: f32 = 1e-5;

/// Where a ray meets a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyHit {
    /// The body.
    pub body: BodyId,
    /// Distance from the origin of the ray. Metres; 0 when it starts in the body.
    pub distance: f32,
    /// The point, in the world. Metres.
    pub point: Vec3,
    /// Unit normal of the surface, against the ray; the ray turned round when it starts in the body.
    pub normal: Vec3,
}

impl Snapshot {
    /// Where a body's own frame is at a time (seconds). `None` where the body does not exist or the time is no number.
    #[must_use]
    pub fn pose(&self, body: BodyId, seconds: f64) -> Option<Pose> {
        let (body, state, _) = self.shown(body, &self.time(seconds)?)?;
        Some(body.own_pose(&state))
    }

    /// Velocity (m/s) of a body's material at a point of the world (metres), at a time (seconds). The point need not be in the body.
    /// `None` where the body does not exist, or where time or point are no numbers.
    #[must_use]
    pub fn velocity_at(&self, body: BodyId, point: Vec3, seconds: f64) -> Option<Vec3> {
        let (_, state, _) = self.shown(body, &self.time(seconds)?)?;
        point.is_finite().then(|| state.velocity_at(point))
    }

    /// The first body that a ray meets at a time (seconds), if that is within a distance (metres, may be infinite). Of bodies at the
    /// same distance the one with the lowest id.
    ///
    /// The direction of the ray may have any length. `None` also where its length is 0, or where a number is none.
    ///
    /// ```
    /// # use forerun_dynamics::{BodyDef, BodyId, Environment};
    /// # use forerun_geometry::{Ray, Vec3, shape::Shape};
    /// # use forerun_timeline::{Progress, Timeline, TimelineSettings};
    /// let ball = BodyDef::new(Shape::sphere(0.5)?).at(Vec3::new(0.0, 5.0, 0.0));
    /// let bodies = [BodyDef::fixed(Shape::HalfSpace), ball];
    /// let mut timeline = Timeline::new(&bodies, Environment::default(), TimelineSettings::default())?;
    /// while timeline.advance() != Progress::Idle {}
    /// let down = Ray { origin: Vec3::new(0.0, 9.0, 0.0), direction: -Vec3::Y };
    /// let snapshot = timeline.snapshot();
    /// // Now, and in one and a half seconds.
    /// let now = snapshot.cast_ray(0.0, &down, f32::INFINITY).expect("the ball is below");
    /// let then = snapshot.cast_ray(1.5, &down, f32::INFINITY).expect("the ball is below");
    /// assert!(now.body == BodyId(1) && now.distance == 3.5);
    /// assert!(then.body == BodyId(1) && (then.distance - 8.0).abs() < 0.01);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn cast_ray(&self, seconds: f64, ray: &Ray, max_distance: f32) -> Option<BodyHit> {
        self.cast_ray_among(seconds, ray, max_distance, |_| true)
    }

    /// As [`Snapshot::cast_ray`], of the bodies that `meant` says yes to.
    #[must_use]
    pub fn cast_ray_among(
        &self,
        seconds: f64,
        ray: &Ray,
        max_distance: f32,
        meant: impl Fn(BodyId) -> bool,
    ) -> Option<BodyHit> {
        let mut nearest: Option<BodyHit> = None;
        self.follow(seconds, ray, max_distance, |body, hit| {
            if !meant(body) {
                return f32::INFINITY;
            }
            match hit() {
                Some(hit) if nearest.is_none_or(|best| hit.distance < best.distance) => {
                    nearest = Some(hit);
                    hit.distance
                }
                _ => f32::INFINITY,
            }
        });
        nearest
    }

    /// All bodies that a ray meets at a time (seconds) within a distance (metres, may be infinite), each where the ray enters it first,
    /// sorted by distance, then by body. The direction may have any length but 0.
    #[must_use]
    pub fn cast_ray_through(&self, seconds: f64, ray: &Ray, max_distance: f32) -> Vec<BodyHit> {
        let mut hits = Vec::new();
        self.follow(seconds, ray, max_distance, |_, hit| {
            hits.extend(hit());
            f32::INFINITY
        });
        // Stable: the bodies come in the order of their ids.
        hits.sort_by(|a: &BodyHit, b| a.distance.total_cmp(&b.distance));
        hits
    }

    /// The bodies that share a point with a shape at a pose, at a time (seconds), in the order of their ids. Those that touch do, to within
    /// a few micrometres. None where time or pose are no numbers.
    #[must_use]
    pub fn overlapping(&self, seconds: f64, shape: &Shape, pose: &Pose) -> Vec<BodyId> {
        let radius = shape.radius_about(Vec3::ZERO);
        let near = |centre: Vec3, reach: f32| {
            let distance = radius + reach;
            let slack = ROUNDING * (1.0 + distance + pose.position.length());
            let apart = centre.distance_squared(pose.position) > (distance + slack) * (distance + slack);
            !apart
        };
        let mut found = Vec::new();
        self.for_each_near(seconds, near, |id, body, own_pose| {
            if body.shape.overlaps(&own_pose, shape, pose) {
                found.push(id);
            }
        });
        found
    }

    /// The bodies that may have a point in a box, at a time (seconds), in the order of their ids: those of which both the bounds
    /// ([`Shape::aabb`]) and the ball about the centre of mass share a point with it. A cheap first question: nobody who is in the box is
    /// left out, and [`Snapshot::overlapping`] asks the shapes. None where the time or a corner is no number, or the box is inside out.
    #[must_use]
    pub fn in_box(&self, seconds: f64, aabb: &Aabb) -> Vec<BodyId> {
        let mut found = Vec::new();
        if !aabb.min.cmple(aabb.max).all() {
            return found;
        }
        let near = |centre: Vec3, reach: f32| {
            let reach = reach + ROUNDING * (1.0 + reach + centre.length());
            let apart = aabb.closest_point(centre).distance_squared(centre) > reach * reach;
            !apart
        };
        self.for_each_near(seconds, near, |id, body, pose| {
            if body.shape.aabb(&pose).overlaps(aabb) {
                found.push(id);
            }
        });
        found
    }

    fn time(&self, seconds: f64) -> Option<Look<'_>> {
        seconds.is_finite().then(|| self.look_at(seconds))
    }

    /// Calls `met` with every body whose ball a ray meets within a distance, and how to find out where it meets the body itself. What
    /// `met` returns is as far as the ray goes on.
    fn follow(
        &self,
        seconds: f64,
        ray: &Ray,
        max_distance: f32,
        mut met: impl FnMut(BodyId, &dyn Fn() -> Option<BodyHit>) -> f32,
    ) {
        let Some(direction) = ray.direction.as_dvec3().try_normalize() else { return };
        if !ray.origin.is_finite() || max_distance.is_nan() || max_distance < 0.0 {
            return;
        }
        let ray = Ray { origin: ray.origin, direction: direction.as_vec3() };
        let limit = std::cell::Cell::new(max_distance);
        let near = |centre: Vec3, reach: f32| {
            let arm = centre.as_dvec3() - ray.origin.as_dvec3();
            let along = arm.dot(direction).clamp(0.0, f64::from(limit.get()));
            let reach = f64::from(reach + ROUNDING * (1.0 + reach + centre.length() + ray.origin.length()));
            let apart = (arm - direction * along).length_squared() > reach * reach;
            !apart
        };
        self.for_each_near(seconds, near, |id, body, pose| {
            let goes_on = met(id, &|| {
                let hit = body.shape.cast_ray(&pose, &ray, max_distance)?;
                Some(BodyHit { body: id, distance: hit.distance, point: hit.point, normal: hit.normal })
            });
            limit.set(limit.get().min(goes_on));
        });
    }

    /// Calls `look` with every body that is there at a time, and its pose, but for those whose ball (centre, radius) `near` rules out.
    fn for_each_near(
        &self,
        seconds: f64,
        near: impl Fn(Vec3, f32) -> bool,
        mut look: impl FnMut(BodyId, &Body, Pose),
    ) {
        let Some(at) = self.time(seconds) else { return };
        self.for_each_shown(at.moment, |id| {
            if self.ball(id, &at).is_some_and(|(centre, radius)| !near(centre, radius)) {
                return;
            }
            if let Some((body, state, _)) = self.shown(id, &at) {
                look(id, body, body.own_pose(&state));
            }
        });
    }

    /// A ball around a body at a time, cheaper than its state; `None` where there is no such short way.
    fn ball(&self, id: BodyId, at: &Look) -> Option<(Vec3, f32)> {
        let Moment { frame, part } = at.moment;
        if self.known_to(id) <= frame {
            return None;
        }
        let radius = self.body_at(id, frame)?.radius;
        let state = at.here?.get(id)?;
        let next = at.arrival(id)?;
        if part <= 0.0 || std::ptr::eq(state, next) {
            return Some((state.position, radius));
        }
        // The cubic of a free flight leaves the straight line by at most 4/27 of what each end's velocity would.
        let line = next.position - state.position;
        let seconds = at.environment.settings.frame_seconds;
        let off = |velocity: Vec3| (velocity * seconds - line).abs().element_sum();
        let slack = 0.149 * (off(state.velocity) + off(next.velocity));
        Some((state.position + line * part, radius + slack))
    }
}
