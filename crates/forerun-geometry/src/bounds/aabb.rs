//! Axis-aligned bounding boxes (dissertation, section 2.3.1).

use glam::Vec3;

/// Axis-aligned bounding box. Touching boxes overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Corner with the smallest coordinates. Metres.
    pub min: Vec3,
    /// Corner with the largest coordinates. Metres.
    pub max: Vec3,
}

impl Aabb {
    /// The box around a centre with the given half extents (metres, not negative).
    #[must_use]
    pub fn from_centre(centre: Vec3, half_extents: Vec3) -> Self {
        Aabb { min: centre - half_extents, max: centre + half_extents }
    }

    /// The smallest box around points. Of no points: a box with `min` above `max`, which overlaps nothing finite.
    #[must_use]
    pub fn around(points: impl Iterator<Item = Vec3>) -> Self {
        let nothing = Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };
        points.fold(nothing, |bounds, p| Aabb { min: bounds.min.min(p), max: bounds.max.max(p) })
    }

    /// The middle. Metres.
    #[must_use]
    pub fn centre(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Half the size along each axis. Metres.
    #[must_use]
    pub fn half_extents(&self) -> Vec3 {
        (self.max - self.min) * 0.5
    }

    /// Whether the two boxes share a point.
    #[must_use]
    pub fn overlaps(&self, other: &Aabb) -> bool {
        self.min.x <= other.max.x
            && other.min.x <= self.max.x
            && self.min.y <= other.max.y
            && other.min.y <= self.max.y
            && self.min.z <= other.max.z
            && other.min.z <= self.max.z
    }

    /// Whether the point is in the box or on it.
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        self.closest_point(point) == point
    }

    /// The point of the box closest to `point`: itself when inside. Metres.
    #[must_use]
    pub fn closest_point(&self, point: Vec3) -> Vec3 {
        point.max(self.min).min(self.max)
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(&self, other: &Aabb) -> Aabb {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box grown on every side by `margin` metres.
    #[must_use]
    pub fn grown(&self, margin: f32) -> Aabb {
        Aabb { min: self.min - Vec3::splat(margin), max: self.max + Vec3::splat(margin) }
    }
}
