//! Lines through a mesh: the nearest triangles that they meet, and from that how thick the mesh is.

use glam::DVec3;
use robust::{Coord3D, orient3d};

use super::Mesh;
use crate::Aabb;
use crate::sdf::crossing::touching;
use crate::sdf::triangle::{corners, face_vector};

/// How many lines thickness and gaps are measured along, at most.
const PROBES: u32 = 1024;
/// The part of the surface where it is thinnest, or nearest to another part, that does not count: sharp edges are thin without end.
const NARROW_PARTS: f64 = 0.05;
/// Half a thickness below this part of half the longest side of the mesh is not told from none.
const THINNEST: f32 = 1e-3;

/// The nearest triangle met on one of its sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// Distance in lengths of the direction; infinite when there is none.
    pub(crate) t: f64,
    /// Which triangle.
    pub(crate) triangle: u32,
}

impl Nearest {
    const NONE: Nearest = Nearest { t: f64::INFINITY, triangle: u32::MAX };

    /// Of equal distances the lower triangle, whatever the order of the tree.
    fn offer(&mut self, t: f64, triangle: u32) {
        if (t, triangle) < (self.t, self.triangle) {
            *self = Nearest { t, triangle };
        }
    }
}

/// What a half line meets first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FirstHits {
    /// The nearest triangle that faces the line's origin.
    pub(crate) front: Nearest,
    /// The nearest triangle that faces away.
    pub(crate) back: Nearest,
}

impl Mesh {
    /// The nearest triangles on a half line in the mesh's frame. `reach` says from what has been met how far it is still worth looking.
    pub(crate) fn first_hits(
        &self,
        origin: DVec3,
        direction: DVec3,
        reach: impl Fn(&FirstHits) -> f64,
    ) -> FirstHits {
        let inverse = direction.recip();
        let mut first = FirstHits { front: Nearest::NONE, back: Nearest::NONE };
        self.tree().walk(
            |bounds| box_entry(bounds, origin, inverse),
            |triangle| {
                let hit = corners(self, triangle as usize);
                if let Some((t, side)) = triangle_hit(origin, direction, hit) {
                    let nearest = if side == Side::Front { &mut first.front } else { &mut first.back };
                    nearest.offer(t, triangle);
                }
                reach(&first)
            },
            f64::INFINITY,
        );
        first
    }

    /// Outward normal of a triangle, not of unit length.
    pub(crate) fn face_vector(&self, triangle: u32) -> DVec3 {
        face_vector(corners(self, triangle as usize))
    }

    /// Half the thickness below which only a twentieth of the surface lies, measured from the middles of triangles straight
    /// through to the other side.
    pub(super) fn measure_half_thickness(&self) -> f32 {
        let thickness =
            self.narrow(|middle, outward| self.first_hits(middle, -outward, |first| first.back.t).back.t);
        let half_extents = self.bounds().half_extents();
        let half_thickness = ((0.5 * thickness) as f32).min(half_extents.min_element());
        // Walls that touch each other are not a part of the solid without thickness.
        half_thickness.max(THINNEST * half_extents.max_element())
    }

    /// Half the width of the narrowest gaps between parts of the surface that face each other: grooves of a thread, slits, holes. Measured from
    /// the middles of triangles straight out, but for the narrowest twentieth of the surface; infinite where less of it faces anything. What
    /// touches leaves no gap. Metres.
    pub(crate) fn measure_half_gap(&self) -> f32 {
        let touching = touching(self);
        let gap = self.narrow(|middle, outward| {
            let width = self.first_hits(middle, outward, |first| first.front.t).front.t;
            if width > touching { width } else { f64::INFINITY }
        });
        (0.5 * gap) as f32
    }

    /// The length below which only a twentieth of the surface lies. `length` tells it at the middle of a triangle with its outward unit normal.
    fn narrow(&self, length: impl Fn(DVec3, DVec3) -> f64) -> f64 {
        let mut probes: Vec<(f64, f64)> = Vec::new();
        for (triangle, area) in self.probed() {
            let [a, b, c] = corners(self, triangle as usize);
            if let Some(unit) = self.face_vector(triangle).try_normalize() {
                probes.push((length((a + b + c) / 3.0, unit), area));
            }
        }
        probes.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let area: f64 = probes.iter().map(|p| p.1).sum();
        let mut narrower = 0.0;
        for (length, part) in probes {
            narrower += part;
            if narrower >= NARROW_PARTS * area {
                return length;
            }
        }
        f64::INFINITY
    }

    /// Triangles to measure at, and areas that they stand for, in whatever unit: all of them if they are few, else one for each of some equal parts
    /// of the surface.
    fn probed(&self) -> Vec<(u32, f64)> {
        let all = self.triangles.len() as u32;
        if all <= PROBES {
            return (0..all).map(|t| (t, self.face_vector(t).length())).collect();
        }
        let mut probed: Vec<(u32, f64)> = Vec::new();
        self.each_part(PROBES, |_, t| match probed.last_mut() {
            Some((last, parts)) if *last == t => *parts += 1.0,
            _ => probed.push((t, 1.0)),
        });
        probed
    }
}

#[derive(PartialEq)]
enum Side {
    Front,
    Back,
}

/// Where a half line enters a box (0 inside); `None` when it misses. Slightly generous, so that rounding loses no triangle.
fn box_entry(bounds: &Aabb, origin: DVec3, inverse_direction: DVec3) -> Option<f64> {
    let near = (bounds.min.as_dvec3() - origin) * inverse_direction;
    let far = (bounds.max.as_dvec3() - origin) * inverse_direction;
    let (mut enter, mut exit) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let (a, b) = (near[axis], far[axis]);
        // 0 * infinity: the line runs in a side of the box, which cuts nothing off.
        if a.is_nan() || b.is_nan() {
            continue;
        }
        enter = enter.max(a.min(b));
        exit = exit.min(a.max(b));
    }
    (enter <= exit * (1.0 + 1e-12)).then_some(enter)
}

/// Distance to a triangle, and which side of it the line meets.
///
/// By the signs of the volumes between the line and each edge. They are exact: triangles agree on which side of a common edge, and round a
/// common corner, the line passes, so that it never slips in or out between them.
fn triangle_hit(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, Side)> {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    let (from, to) = (coord(origin), coord(origin + direction));
    let volume = |p: DVec3, q: DVec3| -orient3d(from, to, coord(p), coord(q));
    let (u, v, w) = (volume(b, c), volume(c, a), volume(a, b));
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let sum = u + v + w;
    if sum == 0.0 {
        return None;
    }
    let point = ((a - origin) * u + (b - origin) * v + (c - origin) * w) / sum;
    let t = point.dot(direction) / direction.length_squared();
    // The volumes are positive where the triangle turns clockwise seen from the origin: it shows its back.
    (t >= 0.0).then_some((t, if sum < 0.0 { Side::Front } else { Side::Back }))
}

#[cfg(test)]
mod tests {
    use super::super::{Mesh, mesh_make};
    use crate::Vec3;
    use glam::DVec3;
    use std::cell::Cell;

    #[test]
    fn a_line_looks_at_few_triangles() {
        let mesh = mesh_make::torus(1.0, 0.4, 80, 40).unwrap();
        let mut most = 0;
        for i in 0..100 {
            let origin = DVec3::new(3.0, 1.98 - 0.04 * f64::from(i), 0.3);
            let looked = Cell::new(0);
            let first = mesh.first_hits(origin, DVec3::new(-1.0, 0.0, 0.2), |first| {
                looked.set(looked.get() + 1);
                first.front.t
            });
            most = looked.get().max(most);
            assert_eq!(first.front.t.is_finite(), origin.y.abs() < 0.39);
        }
        assert!(most < 400, "{most} of 6400 triangles");
    }

    #[test]
    fn thickness_of_known_solids() {
        let about =
            |found: f32, wanted: f32| assert!((found / wanted - 1.0).abs() < 0.03, "{found}, not {wanted}");
        about(mesh_make::torus(0.4, 0.2, 48, 16).unwrap().half_thickness(), 0.2);
        about(mesh_make::ball(0.7, 12).unwrap().half_thickness(), 0.7);
        about(mesh_make::cuboid(Vec3::new(1.0, 0.02, 0.5)).unwrap().half_thickness(), 0.02);
        about(mesh_make::cuboid(Vec3::new(0.1, 2.0, 0.1)).unwrap().half_thickness(), 0.1);
        about(mesh_make::frame(Vec3::new(0.5, 0.06, 0.5), 0.08).unwrap().half_thickness(), 0.04);
        about(mesh_make::ring(1.0, 0.9, 0.5, 64).unwrap().half_thickness(), 0.05);
    }

    #[test]
    fn a_few_large_triangles_among_many_small_ones_count_by_their_area() {
        let plate = mesh_make::cuboid(Vec3::new(0.5, 0.01, 0.5)).unwrap();
        let ball = mesh_make::ball(0.3, 16).unwrap();
        let first = ball.vertices.len() as u32;
        let vertices: Vec<Vec3> =
            ball.vertices.iter().copied().chain(plate.vertices.iter().map(|v| *v + Vec3::Y)).collect();
        let triangles: Vec<[u32; 3]> = ball
            .triangles
            .iter()
            .copied()
            .chain(plate.triangles.iter().map(|t| t.map(|i| i + first)))
            .collect();
        // Wherever in the list they stand.
        for shift in 0..6 {
            let mut triangles = triangles.clone();
            triangles.rotate_left(shift);
            let mesh = Mesh::assemble(vertices.clone(), triangles);
            let found = mesh.measure_half_thickness();
            assert!((found / 0.01 - 1.0).abs() < 0.01, "{found} m, rotated by {shift}");
        }
    }

    #[test]
    fn gaps_of_known_solids() {
        let about =
            |found: f32, wanted: f32| assert!((found / wanted - 1.0).abs() < 0.03, "{found}, not {wanted}");
        // Across the hole; a round one is wider where it is measured from the middle of a facet.
        about(mesh_make::frame(Vec3::new(0.5, 0.3, 0.5), 0.4).unwrap().measure_half_gap(), 0.1);
        about(mesh_make::ring(1.0, 0.2, 0.5, 128).unwrap().measure_half_gap(), 0.2);
        let cube = mesh_make::cuboid(Vec3::ONE).unwrap();
        assert!(cube.measure_half_gap().is_infinite());
        // Two that touch with a whole face.
        let vertices = cube.vertices.iter().copied().chain(cube.vertices.iter().map(|v| *v + 2.0 * Vec3::X));
        let triangles = cube.triangles.iter().copied().chain(cube.triangles.iter().map(|t| t.map(|i| i + 8)));
        assert!(Mesh::assemble(vertices.collect(), triangles.collect()).measure_half_gap().is_infinite());
        // The groove of a thread: at most the pitch less its crest, at least the root.
        let thread = mesh_make::Thread { radius: 0.24, pitch: 0.08 };
        let (head, outside) = (mesh_make::Grip::Round, mesh_make::Grip::Round);
        let bolt =
            mesh_make::Bolt { thread, length: 0.8, head_radius: 0.3, head_height: 0.1, head, segments: 24 };
        let nut = mesh_make::Nut {
            thread,
            clearance: 0.001,
            height: 0.3,
            outer_radius: 0.4,
            outside,
            segments: 24,
        };
        for list in [bolt.triangles().unwrap(), nut.triangles().unwrap()] {
            let gap = 2.0 * list.mesh().unwrap().measure_half_gap();
            assert!((0.02..0.07).contains(&gap), "{gap}");
        }
    }
}
