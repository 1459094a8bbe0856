//! Mending: the surface between inside and outside of triangles that do not quite bound a volume, or do so more than once.
//!
//! Holes are covered first, so that the triangles go round every point a whole number of times (see [`winding`]); what they go round at
//! least once is inside. Walls with the inside, or the outside, on both sides do not count.
//!
//! Needs: triangles of one part that face the same way, and crowded edges counted. Promise: a surface made of pieces of the triangles and
//! covers; where two shells cross it may end up to a piece too late or too early.

use glam::DVec3;
use rayon::prelude::*;

use super::crossing::has_crossings;
use super::kept::Found;
use super::triangle::{area, corners, face_vector};
use super::winding::winding;
use crate::Vec3;
use crate::shape::Mesh;

/// What covers holes: triangles over vertices of the mesh and, numbered after them, apexes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Covers {
    /// Middles of holes. Metres.
    pub(crate) apexes: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// What the triangles bound.
pub(crate) enum Verdict {
    /// What they are the surface of, all of them.
    Sound,
    /// What they are the surface of by and large.
    Mended(Box<Mended>),
    /// Nothing that one could tell.
    Hopeless,
}

/// The surface between inside and outside.
pub(crate) struct Mended {
    /// The triangles and the covers of holes: they wind round what is inside.
    pub(crate) covered: Mesh,
    /// The walls with the inside on one side.
    pub(crate) surface: Mesh,
    /// No hole in the surface is wider. Metres.
    pub(crate) gap: f64,
    pub(crate) found: Found,
}

/// Most of the surface that may be covers, or face inwards.
const DOUBTFUL_MAX: f64 = 0.05;
/// Most of the triangles that may have nothing on either side.
const SHEETS_MAX: f64 = 0.25;
/// How far beside a wall one looks what is there, as part of a cell: walls nearer to each other than that are one.
const BESIDE: f64 = 0.02;
/// The same as part of the radius of the circle in the piece of wall: not to look past a corner.
const BESIDE_PIECE: f64 = 0.1;
/// Pieces that walls may be cut into, about.
const PIECES_MAX: f64 = 65_536.0;

/// Areas of a triangle by what is on its sides. Square metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Areas {
    /// Outside in front and inside behind.
    surface: f64,
    /// The other way round.
    reversed: f64,
    /// Inside on both sides.
    inner: f64,
    /// Outside on both sides.
    sheet: f64,
}

impl Areas {
    fn mixed(&self) -> bool {
        self.inner + self.sheet > 0.0
    }

    /// Whether all of it is a wall between outside and inside, as it should be.
    fn is_surface(&self) -> bool {
        !self.mixed() && self.reversed <= 0.0
    }
}

/// Tells what a mesh is the surface of. `shells`: a triangle of each part of it. `cell`: size of the cells that its field will have,
/// about. Metres.
pub(crate) fn survey(mesh: &Mesh, shells: &[usize], covers: &Covers, cell: f64) -> Verdict {
    let may_be_sound = covers.triangles.is_empty() && !has_crossings(mesh);
    let is_crowded = mesh.repairs.crowded_edges > 0;
    if may_be_sound && !is_crowded {
        let walls = Walls { covered: mesh, beside: BESIDE * cell };
        // Shells that do not cross are wholly inside of others or wholly outside.
        if shells.len() < 2 || shells.iter().all(|t| walls.sides(corners(mesh, *t)) == (false, true)) {
            return Verdict::Sound;
        }
    }
    let mut vertices = mesh.vertices.clone();
    vertices.extend(&covers.apexes);
    let mut triangles = mesh.triangles.clone();
    triangles.extend(&covers.triangles);
    let covered = Mesh::assemble(vertices, triangles);
    let walls = Walls { covered: &covered, beside: BESIDE * cell };
    // Nothing that is as thick as the mesh passes between points that are half as far apart.
    let thickness = f64::from(mesh.half_thickness()).max(2.0 * cell);
    let mut areas = walls.areas(walls.piece_size(|_| true, thickness));
    // Parts that touch at edges may share walls too, or be there twice.
    if may_be_sound && is_crowded && areas.iter().all(Areas::is_surface) && walls.are_single() {
        return Verdict::Sound;
    }
    if areas.iter().any(Areas::mixed) {
        areas = walls.areas(walls.piece_size(|t| areas[t].mixed(), 2.0 * cell));
    }
    let Some(found) = judge(&areas, mesh.triangles.len()) else { return Verdict::Hopeless };
    let size = walls.piece_size(|t| areas[t].mixed(), cell);
    let surface = walls.surface(&areas, size);
    if surface.is_empty() {
        return Verdict::Hopeless;
    }
    let vertices: Vec<Vec3> = surface.iter().flatten().map(|v| v.as_vec3()).collect();
    let triangles = (0..surface.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let surface = Mesh::assemble(vertices, triangles);
    Verdict::Mended(Box::new(Mended { surface, gap: size, found, covered }))
}

/// Whether the areas of triangles, and of covers after the first `triangles`, are those of the surface of something, and what to say about it.
fn judge(areas: &[Areas], triangles: usize) -> Option<Found> {
    let (given, covers) = areas.split_at(triangles);
    let sum = |of: fn(&Areas) -> f64| given.iter().map(of).sum::<f64>();
    let surface = sum(|a| a.surface);
    let cover: f64 = covers.iter().map(|a| a.surface).sum();
    let reversed = areas.iter().map(|a| a.reversed).sum::<f64>();
    let sheet = sum(|a| a.sheet);
    let clear = cover + reversed <= DOUBTFUL_MAX * surface
        && sheet <= SHEETS_MAX * (surface + sum(|a| a.inner))
        && surface > 0.0;
    clear.then(|| Found {
        cover_area: cover as f32,
        inner_triangles: given.iter().filter(|a| a.inner > 0.0).count() as u32,
        sheet_triangles: given.iter().filter(|a| a.inner <= 0.0 && a.sheet > 0.0).count() as u32,
    })
}

/// Triangles and what they wind round.
struct Walls<'a> {
    covered: &'a Mesh,
    /// How far beside a wall one looks. Metres.
    beside: f64,
}

impl Walls<'_> {
    /// The areas of each triangle, from pieces no longer than `size`.
    fn areas(&self, size: f64) -> Vec<Areas> {
        let of = |t: usize| {
            let mut areas = Areas::default();
            cut(corners(self.covered, t), size, &mut |piece| {
                let area = area(piece);
                match self.sides(piece) {
                    (false, true) => areas.surface += area,
                    (true, false) => areas.reversed += area,
                    (true, true) => areas.inner += area,
                    (false, false) => areas.sheet += area,
                }
            });
            areas
        };
        (0..self.covered.triangles.len()).into_par_iter().map(of).collect()
    }

    /// The triangles with the inside on one side only: whole ones, and pieces no longer than `size` of mixed ones.
    fn surface(&self, areas: &[Areas], size: f64) -> Vec<[DVec3; 3]> {
        let of = |t: usize| {
            let mut kept = Vec::new();
            if areas[t].mixed() {
                cut(corners(self.covered, t), size, &mut |piece| {
                    let (front, back) = self.sides(piece);
                    if front != back {
                        kept.push(piece);
                    }
                });
            } else {
                kept.push(corners(self.covered, t));
            }
            kept
        };
        let pieces: Vec<Vec<[DVec3; 3]>> = (0..areas.len()).into_par_iter().map(of).collect();
        // Covers of cracks have no area, and no side.
        pieces.into_iter().flatten().filter(|piece| area(*piece) > 0.0).collect()
    }

    /// The wished size of pieces, or a larger one if the triangles to be cut would be cut into too many.
    fn piece_size(&self, to_cut: impl Fn(usize) -> bool, wished: f64) -> f64 {
        let triangles = (0..self.covered.triangles.len()).filter(|t| to_cut(*t));
        let total: f64 = triangles.map(|t| area(corners(self.covered, t))).sum();
        // A piece has, on average, about a quarter of the square of its longest edge.
        wished.max((4.0 * total / PIECES_MAX).sqrt())
    }

    /// Whether what is behind the middles of all triangles is gone round once.
    fn are_single(&self) -> bool {
        let is_single =
            |t: usize| self.counts(corners(self.covered, t)).is_none_or(|(_, behind)| behind == 1);
        (0..self.covered.triangles.len()).into_par_iter().all(is_single)
    }

    /// Whether inside is in front of a piece of a wall, and behind it.
    fn sides(&self, piece: [DVec3; 3]) -> (bool, bool) {
        self.counts(piece).map_or((false, true), |(front, behind)| (front > 0, behind > 0))
    }

    /// How often what is in front of a piece of a wall is gone round, and what is behind it; none for a piece without area.
    fn counts(&self, piece: [DVec3; 3]) -> Option<(i32, i32)> {
        let [a, b, c] = piece;
        let vector = face_vector(piece);
        let normal = vector.try_normalize()?;
        let around = a.distance(b) + b.distance(c) + c.distance(a);
        // The radius of the circle inside is twice the area over the length around.
        let beside = self.beside.min(BESIDE_PIECE * vector.length() / around);
        let middle = (a + b + c) / 3.0;
        let count = |p: DVec3| winding(self.covered, p);
        Some((count(middle + normal * beside), count(middle - normal * beside)))
    }
}

/// Calls `visit` with pieces of a triangle whose edges are no longer than `size`, by cutting the longest in half again and again.
fn cut(triangle: [DVec3; 3], size: f64, visit: &mut impl FnMut([DVec3; 3])) {
    let [a, b, c] = triangle;
    let (ab, bc, ca) = (a.distance_squared(b), b.distance_squared(c), c.distance_squared(a));
    let longest = ab.max(bc).max(ca);
    if longest <= size * size {
        visit(triangle);
        return;
    }
    let [a, b, c] = if ab >= longest {
        [a, b, c]
    } else if bc >= longest {
        [b, c, a]
    } else {
        [c, a, b]
    };
    let middle = (a + b) * 0.5;
    cut([a, middle, c], size, visit);
    cut([middle, b, c], size, visit);
}
