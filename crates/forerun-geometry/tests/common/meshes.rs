//! Meshes and distances by formula, for tests.

use std::f32::consts::TAU;

use forerun_geometry::Vec3;

pub(crate) type Triangles = (Vec<Vec3>, Vec<[u32; 3]>);

/// A torus about y: `n` segments around the axis, `m` around the tube.
pub(crate) fn torus(major: f32, minor: f32, n: u32, m: u32) -> Triangles {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..n {
        let (su, cu) = libm::sincosf(TAU * i as f32 / n as f32);
        for j in 0..m {
            let (sv, cv) = libm::sincosf(TAU * (j as f32 + 0.5) / m as f32);
            let r = major + minor * cv;
            vertices.push(Vec3::new(r * cu, minor * sv, r * su));
            let at = |i: u32, j: u32| (i % n) * m + j % m;
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (vertices, triangles)
}

pub(crate) fn torus_distance(major: f32, minor: f32, p: Vec3) -> f32 {
    let across = (p.x * p.x + p.z * p.z).sqrt() - major;
    (across * across + p.y * p.y).sqrt() - minor
}

pub(crate) fn torus_normal(major: f32, p: Vec3) -> Vec3 {
    let ring = Vec3::new(p.x, 0.0, p.z).normalize() * major;
    (p - ring).normalize()
}

/// A ball of latitudes and longitudes about y.
pub(crate) fn sphere(radius: f32, n: u32, m: u32) -> Triangles {
    let mut vertices = vec![Vec3::Y * radius, Vec3::NEG_Y * radius];
    let mut triangles = Vec::new();
    for j in 1..m {
        let (sv, cv) = libm::sincosf(0.5 * TAU * j as f32 / m as f32);
        for i in 0..n {
            let (su, cu) = libm::sincosf(TAU * i as f32 / n as f32);
            vertices.push(Vec3::new(sv * cu, cv, sv * su) * radius);
        }
    }
    let at = |i: u32, j: u32| 2 + (j - 1) * n + i % n;
    for i in 0..n {
        triangles.extend([[0, at(i + 1, 1), at(i, 1)], [1, at(i, m - 1), at(i + 1, m - 1)]]);
        for j in 1..m - 1 {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (vertices, triangles)
}

/// A prism along y over an outline in x and z that turns from +x to +z.
fn prism(outline: &[(f32, f32)], lids: &[[u32; 3]], half_height: f32) -> Triangles {
    let n = outline.len() as u32;
    let ring = |y: f32| outline.iter().map(move |(x, z)| Vec3::new(*x, y, *z));
    let vertices = ring(-half_height).chain(ring(half_height)).collect();
    let mut triangles = Vec::new();
    for [a, b, c] in lids {
        triangles.extend([[*a, *b, *c], [a + n, c + n, b + n]]);
    }
    for i in 0..n {
        let j = (i + 1) % n;
        triangles.extend([[i, i + n, j + n], [i, j + n, j]]);
    }
    (vertices, triangles)
}

pub(crate) fn cuboid(half: Vec3) -> Triangles {
    let (x, z) = (half.x, half.z);
    prism(&[(-x, -z), (x, -z), (x, z), (-x, z)], &[[0, 1, 2], [0, 2, 3]], half.y)
}

/// An L of two unit arms, 0.4 thick and 0.4 high: x or z from 0 to 0.4, the other from 0 to 1.
pub(crate) fn l_shape() -> Triangles {
    let outline = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.4), (0.4, 0.4), (0.4, 1.0), (0.0, 1.0)];
    prism(&outline, &[[0, 1, 3], [1, 2, 3], [0, 3, 5], [3, 4, 5]], 0.2)
}

pub(crate) fn inside_l_shape(p: Vec3) -> bool {
    let inside = |x: f32, z: f32| (0.0..=x).contains(&p.x) && (0.0..=z).contains(&p.z);
    p.y.abs() <= 0.2 && (inside(1.0, 0.4) || inside(0.4, 1.0))
}

/// A square frame about y: its middle line has half side `half_side`, its square section half side `half_section`.
pub(crate) fn frame(half_side: f32, half_section: f32) -> Triangles {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    let (a, s) = (half_side, half_section);
    for (sx, sz) in [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)] {
        for (r, y) in [(a + s, s), (a - s, s), (a - s, -s), (a + s, -s)] {
            vertices.push(Vec3::new(r * sx, y, r * sz));
        }
    }
    for i in 0..4 {
        let j = (i + 1) % 4;
        for k in 0..4 {
            let l = (k + 1) % 4;
            let [p, q, r, u] = [i * 4 + k, i * 4 + l, j * 4 + l, j * 4 + k];
            triangles.extend([[p, r, q], [p, u, r]]);
        }
    }
    (vertices, triangles)
}

/// Numbers that look random (xorshift), the same in every run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// From -1 to 1.
    pub(crate) fn number(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }

    pub(crate) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }
}
