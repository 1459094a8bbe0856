//! Blur: the cells of a field whose interpolation cuts sharp edges off, and the triangles that are near them.
//!
//! Between its nodes a grid takes the mean of the sides of an edge: the surface seems to be up to a third of a cell
//! farther away than it is. Contact asks the triangles in these cells.
//!
//! Promise: the triangles of a cell hold the surface's nearest point for every point of the cell. Where a surface is so rough that its
//! triangles are many to a cell, the cell is left to its interpolation.

use std::collections::BTreeMap;

use forerun_lanes::{LANES, Lanes, Portable, V8, dispatched};
use glam::DVec3;
use rayon::prelude::*;

use super::Field;
use super::eight::lane;
use super::facets::{Facets, ROWS, Seen};
use super::nearest::{Nearest, near_triangles, nearest, triangle_distance};
use crate::Vec3;
use crate::shape::Mesh;

/// The cells around the sharp edges of a mesh; none where all is smooth.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Blur {
    /// One bit a cell; nothing where no edge is sharp.
    cells: Vec<u64>,
    /// How many cells are marked before each 64 of them.
    before: Vec<u32>,
    /// Of each marked cell the triangles that may be nearest to its points.
    runs: Vec<Run>,
    /// Triangles by their first rows. The last one of a run fills its last eight up.
    triangles: Vec<[u32; LANES]>,
    /// The triangles themselves.
    pub(crate) facets: Facets,
    /// How far off its surface the field sees points of sharp edges. Metres.
    pub(crate) depth: f32,
    /// Cells around sharp edges that are not marked: they have too many triangles.
    pub(crate) crowded: usize,
}

/// A run of eights of triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Run {
    first: u32,
    count: u32,
}

/// Points along an edge in a cell.
const PER_CELL: f32 = 2.0;
/// Most points along an edge.
const POINTS_MAX: f32 = 65_536.0;
/// Edges may be worse between the points than at them.
const SPARE: f32 = 1.25;
/// Triangles are looked for this much farther away than they need be, for what rounding may lose.
const ROUNDING: f64 = 1.0001;
/// Most triangles that are looked at for a cell, and listed for it.
const LIST_MAX: usize = 512;
/// Most eights of triangles in all lists: 4 MiB. Where they are more, only cells with fewer triangles have lists.
const EIGHTS_MAX: usize = 1 << 17;
/// So many times 64 cells are listed at a time, to take no more memory than that.
const WORDS_AT_A_TIME: usize = 256;

impl Blur {
    /// Marks the cells that edges pass through, and those next to them.
    pub(crate) fn new(mesh: &Mesh, field: &Field, edges: &[[Vec3; 2]]) -> Blur {
        let mut blur = Blur::default();
        if edges.is_empty() {
            return blur;
        }
        let [nx, ny, nz] = field.cells();
        blur.cells = vec![0; (nx * ny * nz).div_ceil(64)];
        for [a, b] in edges {
            let parts = (PER_CELL * a.distance(*b) / field.cell()).ceil().clamp(1.0, POINTS_MAX);
            for k in 0..=parts as u32 {
                let point = *a + (*b - *a) * (k as f32 / parts);
                blur.depth = blur.depth.max(SPARE * field.distance_and_gradient(point).0);
                blur.mark_around(field, point);
            }
        }
        blur.list_triangles(mesh, field);
        blur
    }

    fn mark_around(&mut self, field: &Field, point: Vec3) {
        let (cells, at) = (field.cells(), field.cell_of(point));
        let [x, y, z] = [0, 1, 2].map(|k| at[k].saturating_sub(1)..=(at[k] + 1).min(cells[k] - 1));
        for z in z {
            for y in y.clone() {
                for x in x.clone() {
                    let index = (z * cells[1] + y) * cells[0] + x;
                    self.cells[index / 64] |= 1 << (index % 64);
                }
            }
        }
    }

    /// Finds the triangles of the marked cells, and leaves out cells that have too many.
    fn list_triangles(&mut self, mesh: &Mesh, field: &Field) {
        let marked = std::mem::take(&mut self.cells);
        let mut most = LIST_MAX;
        while !self.list_up_to(most, &marked, (mesh, field)) {
            most /= 2;
        }
        let count = |cells: &[u64]| cells.iter().map(|word| word.count_ones() as usize).sum::<usize>();
        self.crowded = count(&marked) - count(&self.cells);
        self.facets = Facets::new(mesh);
    }

    /// Lists the triangles of those of the marked cells that have no more than `most`. Cells of the same triangles share a list. Returns
    /// whether the lists are not too long in all.
    fn list_up_to(&mut self, most: usize, marked: &[u64], (mesh, field): (&Mesh, &Field)) -> bool {
        self.cells.clear();
        self.before.clear();
        self.runs.clear();
        self.triangles.clear();
        let mut known: BTreeMap<Vec<u32>, Run> = BTreeMap::new();
        for (k, words) in marked.chunks(WORDS_AT_A_TIME).enumerate() {
            let first = WORDS_AT_A_TIME * k;
            let words = words.par_iter().enumerate();
            let lists: Vec<Lists> =
                words.map(|(k, word)| lists_of(mesh, field, ((first + k) * 64, *word), most)).collect();
            for (listed, lists) in lists {
                self.cells.push(listed);
                self.before.push(self.runs.len() as u32);
                for list in lists {
                    let run = *known.entry(list).or_insert_with_key(|list| self.fill(list));
                    self.runs.push(run);
                }
            }
            if self.triangles.len() > EIGHTS_MAX {
                return false;
            }
        }
        true
    }

    /// Appends a list.
    fn fill(&mut self, list: &[u32]) -> Run {
        let (first, eights) = (self.triangles.len() as u32, list.chunks(LANES));
        let run = Run { first, count: eights.len() as u32 };
        self.triangles.extend(eights.map(|e| std::array::from_fn(|i| ROWS * e[i.min(e.len() - 1)])));
        run
    }

    /// Whether there is any sharp edge.
    pub(crate) fn is_any(&self) -> bool {
        !self.cells.is_empty()
    }

    /// The triangles that may be nearest to a point of the field's frame, if the field is blurred there.
    #[inline]
    fn triangles_at(&self, field: &Field, point: Vec3) -> Option<&[[u32; LANES]]> {
        if !field.contains(point) {
            return None;
        }
        let ([nx, ny, _], [x, y, z]) = (field.cells(), field.cell_of(point));
        let index = (z * ny + y) * nx + x;
        let (word, bit) = (self.cells[index / 64], 1_u64 << (index % 64));
        if word & bit == 0 {
            return None;
        }
        let place = self.before[index / 64] + (word & (bit - 1)).count_ones();
        let run = self.runs[place as usize];
        Some(&self.triangles[run.first as usize..][..run.count as usize])
    }

    /// Memory that it takes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.cells)
            + size_of_val(&*self.before)
            + size_of_val(&*self.runs)
            + size_of_val(&*self.triangles)
            + self.facets.bytes()
    }
}

/// Points of a field's frame: which of eight are asked about.
pub(crate) struct Asked<'a> {
    pub(crate) field: &'a Field,
    pub(crate) points: &'a V8<Portable>,
    /// Their bits.
    pub(crate) bits: u32,
}

dispatched! {
    /// Fills in what is nearest to those of the points at which the field is blurred; their bits are `known`.
    pub(crate) fn see(blur: &Blur, asked: &Asked, seen: &mut [Seen; LANES], known: &mut u32) => see_lanes
}

#[inline(always)]
fn see_lanes<F: Lanes>(blur: &Blur, asked: &Asked, seen: &mut [Seen; LANES], known: &mut u32) {
    let mut bits = asked.bits;
    *known = 0;
    while bits != 0 {
        let i = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        let point = lane(asked.points, i);
        if let Some(triangles) = blur.triangles_at(asked.field, point) {
            seen[i] = blur.facets.nearest::<F>(triangles, point);
            *known |= 1 << i;
        }
    }
}

/// Which of 64 cells have lists, as bits, and their lists.
type Lists = (u64, Vec<Vec<u32>>);

/// The triangles of each of up to 64 cells from the first that are marked, unless they are more than `most`.
fn lists_of(mesh: &Mesh, field: &Field, (first, marked): (usize, u64), most: usize) -> Lists {
    let [nx, ny, _] = field.cells();
    let mut guess = None;
    let (mut listed, mut lists) = (0, Vec::new());
    for bit in (0..64).filter(|bit| marked >> bit & 1 == 1) {
        let index = first + bit;
        let list = list_of([index % nx, index / nx % ny, index / nx / ny], mesh, field, &mut guess);
        if let Some(list) = list.filter(|list| list.len() <= most) {
            listed |= 1 << bit;
            lists.push(list);
        }
    }
    (listed, lists)
}

/// The triangles that may be nearest to points of a cell, in the order of their numbers; none if too many have to be looked at. `guess` is for the
/// next one.
fn list_of(cell: [usize; 3], mesh: &Mesh, field: &Field, guess: &mut Option<Nearest>) -> Option<Vec<u32>> {
    let size = field.cell_size();
    let low = field.bounds().min + Vec3::from_array(cell.map(|k| k as f32)) * size;
    // What is nearest to a point of a ball is no farther from its middle than what is nearest to that, and its diameter.
    let diameter = ROUNDING * f64::from(size.length());
    let middle = (low + size * 0.5).as_dvec3();
    let near = nearest(mesh, middle, guess.as_ref());
    let list = near_triangles(mesh, middle, near.distance() + diameter, LIST_MAX);
    *guess = Some(near);
    let mut list = list?;
    if list.len() > LANES {
        // Most of a long list goes if each eighth of the cell is looked at by itself.
        let mut kept = vec![false; list.len()];
        for k in 0..8_u8 {
            let part = DVec3::from_array([0, 1, 2].map(|axis| f64::from(1 + 2 * (k >> axis & 1))));
            let middle = low.as_dvec3() + size.as_dvec3() * (0.25 * part);
            let distances: Vec<f64> = list.iter().map(|t| triangle_distance(mesh, *t, middle)).collect();
            let limit = distances.iter().copied().fold(f64::INFINITY, f64::min) + 0.5 * diameter;
            kept.iter_mut().zip(&distances).for_each(|(kept, distance)| *kept |= *distance <= limit);
        }
        let mut kept = kept.into_iter();
        list.retain(|_| kept.next() == Some(true));
    }
    Some(list)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{MeshDraft, MeshOptions, mesh_make};

    #[test]
    fn cells_of_very_many_triangles_are_left_out() {
        let ball = mesh_make::ball(0.5, 24).unwrap();
        // Rough: all edges are sharp, and a cell has hundreds of triangles.
        let jitter = |k: usize| 1.0 + 0.06 * ((k * 7919 % 1009) as f32 / 1009.0 - 0.5);
        let vertices: Vec<Vec3> = ball.vertices.iter().enumerate().map(|(k, v)| *v * jitter(k)).collect();
        let baked = |cell| {
            let options = MeshOptions { cell: Some(cell), ..MeshOptions::default() };
            let draft = MeshDraft::new(vertices.clone(), ball.triangles.clone(), options).unwrap();
            draft.bake(&|_, _| {}).unwrap()
        };
        let (rough, fine) = (baked(0.3), baked(0.05));
        assert!(rough.collider().crowded_cells() > 100, "{}", rough.collider().crowded_cells());
        let blur = &rough.collider().blur;
        assert!(blur.triangles.len() <= EIGHTS_MAX && *blur == baked(0.3).collider().blur);
        assert_eq!(fine.collider().crowded_cells(), 0);
        assert!(fine.collider().blur.is_any());
    }

    #[test]
    fn the_triangles_of_a_cell_hold_the_nearest_point() {
        let mesh = mesh_make::cuboid(Vec3::new(0.3, 0.2, 0.05)).unwrap();
        let (field, blur) = (mesh.collider().field.as_ref().unwrap(), &mesh.collider().blur);
        let mut known_in_all = 0;
        for i in 0..20_000_u32 {
            let part = |k: u32| ((i * 7919 + i * i % 613 * k * 104_729) % 4001) as f32 / 2000.0 - 1.0;
            let point = Vec3::new(part(1), part(2), part(3)) * Vec3::new(0.35, 0.25, 0.1);
            let points = V8::splat(point.to_array());
            let (mut seen, mut known) = ([Seen::NOTHING; LANES], 0);
            see(blur, &Asked { field, points: &points, bits: 2 }, &mut seen, &mut known);
            if known == 2 {
                let q = point.abs() - Vec3::new(0.3, 0.2, 0.05);
                let expected = q.max(Vec3::ZERO).length() + q.max_element().min(0.0);
                let skin = crate::sdf::nearest::Skin::of(&mesh);
                let (distance, _) = seen[1].signed(&skin, &blur.facets);
                assert!((distance - expected).abs() < 1e-6, "{distance} at {point}, {expected}");
                known_in_all += 1;
            }
        }
        assert!(known_in_all > 1000, "{known_in_all}");
    }
}
