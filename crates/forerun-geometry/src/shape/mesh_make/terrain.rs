//! Terrain: hills as an open mesh, for fixed bodies.

use super::{ShapeError, below, count};
use crate::Vec3;
use crate::shape::{TriangleList, positive};

/// A square of hills that faces up: an open mesh, for [`Mesh::open`](crate::shape::Mesh::open). Its lowest possible place is y = 0.
///
/// The heights are noise on a lattice (smoothly interpolated values), twice: large hills, and small ones of a third of the size on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terrain {
    /// Half of a side of the square, along x and z. Metres, above 0.
    pub half_width: f32,
    /// The highest possible place. Metres, above 0 and below `hill`.
    pub height: f32,
    /// From one large hill to the next, about. Metres, above 0 and below 2 `half_width`.
    pub hill: f32,
    /// Cells along a side; it has two triangles for each. 1 to 1024.
    pub cells: u32,
    /// Which hills: another number, another terrain.
    pub seed: u32,
}

/// Size of the small hills as a part of that of the large ones.
const SMALL: f64 = 1.0 / 3.0;
/// Part of the height that belongs to the small hills.
const SMALL_PART: f64 = 0.2;

impl Terrain {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        positive("half_width", self.half_width)?;
        below("hill", self.hill, 2.0 * self.half_width, "2 half_width")?;
        below("height", self.height, self.hill, "hill")?;
        count("cells", self.cells, 1..=1024)
    }

    /// Its surface.
    ///
    /// # Errors
    /// As [`Terrain::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let side = self.cells + 1;
        let place = |i: u32| (2.0 * f64::from(i) / f64::from(self.cells) - 1.0) * f64::from(self.half_width);
        let vertex = |i: u32| {
            let [x, z] = [place(i % side), place(i / side)];
            Vec3::new(x as f32, self.height_at(x, z) as f32, z as f32)
        };
        let mut triangles = Vec::with_capacity(2 * (self.cells * self.cells) as usize);
        for z in 0..self.cells {
            for x in 0..self.cells {
                let a = z * side + x;
                let [b, c, d] = [a + side, a + side + 1, a + 1];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        Ok(TriangleList { vertices: (0..side * side).map(vertex).collect(), triangles })
    }

    fn height_at(&self, x: f64, z: f64) -> f64 {
        let hill = f64::from(self.hill);
        let large = noise([x / hill, z / hill], self.seed);
        let small = noise([x / (hill * SMALL), z / (hill * SMALL)], !self.seed);
        f64::from(self.height) * (large * (1.0 - SMALL_PART) + small * SMALL_PART)
    }
}

/// From 0 to 1: values at the points of a square lattice, smooth between them.
fn noise(at: [f64; 2], seed: u32) -> f64 {
    let low = at.map(f64::floor);
    let value = |dx: i64, dz: i64| value_at([low[0] as i64 + dx, low[1] as i64 + dz], seed);
    let [u, v] = [0, 1].map(|i| {
        let part = at[i] - low[i];
        part * part * (3.0 - 2.0 * part)
    });
    let along = |dz: i64| value(0, dz) + (value(1, dz) - value(0, dz)) * u;
    along(0) + (along(1) - along(0)) * v
}

/// A number from 0 to 1 for a point of the lattice: SplitMix64's last steps (Steele, Lea, Flood 2014) on its coordinates.
fn value_at([x, z]: [i64; 2], seed: u32) -> f64 {
    let mut bits =
        (x as u64) << 32 ^ (z as u64 & 0xffff_ffff) ^ u64::from(seed).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    (bits >> 40) as f64 / 16_777_215.0
}
