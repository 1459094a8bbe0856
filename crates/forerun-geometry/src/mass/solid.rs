//! Solid: volume, centroid and second moments of shapes of density 1, in double precision.

use std::f64::consts::PI;

use glam::{DMat3, DQuat, DVec3};

use super::{outer, point_inertia};
use crate::Pose;

/// A solid of density 1 kg/m³.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid {
    /// m³, which is also its mass in kg.
    pub(super) volume: f64,
    /// Centroid. Metres.
    pub(super) centre: DVec3,
    /// Inertia tensor about the centroid. kg m².
    pub(super) inertia: DMat3,
}

impl Solid {
    pub(super) const NOTHING: Solid = Solid { volume: 0.0, centre: DVec3::ZERO, inertia: DMat3::ZERO };

    fn about_origin(volume: f64, moments: DVec3) -> Solid {
        Solid { volume, centre: DVec3::ZERO, inertia: DMat3::from_diagonal(moments) }
    }

    pub(super) fn sphere(r: f64) -> Solid {
        let volume = 4.0 / 3.0 * PI * r * r * r;
        Solid::about_origin(volume, DVec3::splat(0.4 * volume * r * r))
    }

    pub(super) fn cuboid(h: DVec3) -> Solid {
        let volume = 8.0 * h.x * h.y * h.z;
        let q = h * h;
        Solid::about_origin(volume, DVec3::new(q.y + q.z, q.x + q.z, q.x + q.y) * (volume / 3.0))
    }

    pub(super) fn cylinder(h: f64, r: f64) -> Solid {
        let volume = 2.0 * PI * r * r * h;
        let across = volume * (r * r / 4.0 + h * h / 3.0);
        Solid::about_origin(volume, DVec3::new(across, 0.5 * volume * r * r, across))
    }

    /// A cylinder and two half balls.
    pub(super) fn capsule(h: f64, r: f64) -> Solid {
        let cylinder = Solid::cylinder(h, r);
        let ball = Solid::sphere(r);
        // A half ball's centroid is 3r/8 from its flat face. Moved from the ball's centre to its own centroid and from there to
        // h + 3r/8, the ball's moment 2/5 m r² across grows by m h² + 3/4 m h r.
        let caps = ball.inertia.x_axis.x + ball.volume * (h * h + 0.75 * h * r);
        let across = cylinder.inertia.x_axis.x + caps;
        let along = cylinder.inertia.y_axis.y + ball.inertia.y_axis.y;
        Solid::about_origin(cylinder.volume + ball.volume, DVec3::new(across, along, across))
    }

    /// What closed, outward-facing triangles enclose: the sum of the signed tetrahedra between each triangle and a common point.
    ///
    /// Of the tetrahedron (0, a, b, c) with d = a . (b x c): volume d/6, first moment d/24 s and second moment
    /// d/120 (s sᵀ + a aᵀ + b bᵀ + c cᵀ), with s = a + b + c; the inertia is its trace times 1 less the second moment.
    pub(super) fn within(triangles: impl Iterator<Item = [DVec3; 3]> + Clone) -> Solid {
        // A common point on the surface, not the origin: far from it the tetrahedra would cancel.
        let Some([origin, ..]) = triangles.clone().next() else {
            return Solid::NOTHING;
        };
        let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for corners in triangles {
            let [a, b, c] = corners.map(|v| v - origin);
            let d = a.dot(b.cross(c));
            let s = a + b + c;
            volume += d / 6.0;
            first += s * (d / 24.0);
            second += (outer(s, s) + outer(a, a) + outer(b, b) + outer(c, c)) * (d / 120.0);
        }
        let solid = Solid::of_moments(volume, first, second);
        Solid { centre: origin + solid.centre, ..solid }
    }

    /// By volume, first moment and second moment (the integral of x xᵀ).
    pub(super) fn of_moments(volume: f64, first: DVec3, second: DMat3) -> Solid {
        if volume <= 0.0 {
            return Solid::NOTHING;
        }
        let centre = first / volume;
        let about_centre = second - outer(centre, centre) * volume;
        let trace = about_centre.x_axis.x + about_centre.y_axis.y + about_centre.z_axis.z;
        let inertia = DMat3::from_diagonal(DVec3::splat(trace)) - about_centre;
        Solid { volume, centre, inertia }
    }

    /// The same solid at a pose.
    pub(super) fn at(&self, pose: &Pose) -> Solid {
        let q = pose.rotation;
        let rotation = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into()).normalize();
        let axes = DMat3::from_quat(rotation);
        Solid {
            volume: self.volume,
            centre: rotation * self.centre + pose.position.as_dvec3(),
            inertia: axes * self.inertia * axes.transpose(),
        }
    }

    /// All parts as one, by the parallel axis theorem.
    pub(super) fn sum(parts: &[Solid]) -> Solid {
        let volume: f64 = parts.iter().map(|p| p.volume).sum();
        if volume <= 0.0 {
            return Solid::NOTHING;
        }
        let centre = parts.iter().map(|p| p.centre * p.volume).sum::<DVec3>() / volume;
        let about_centre = |p: &Solid| p.inertia + point_inertia(p.centre - centre) * p.volume;
        Solid { volume, centre, inertia: parts.iter().map(about_centre).sum() }
    }
}
