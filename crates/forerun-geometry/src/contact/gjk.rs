//! GJK: the distance between two convex cores (Gilbert, Johnson, Keerthi, 1988).
//!
//! In double precision, the only place besides `penetration`: the search ends on differences of nearly equal squares, and
//! with single precision the normal of bodies at rest would be noise. Addition, multiplication, division and square root
//! of doubles are as exact on every platform as those of singles.

use glam::DVec3;

use super::solid::Solid;

/// No pair of finite shapes needs more; a smooth pair takes about twenty.
const ROUNDS_MAX: usize = 64;

/// The search ends when the squared distance is known to this part of itself; the normal, to its square root.
const GAP: f64 = 1.0e-10;

/// Cores nearer than this overlap. Metres.
const TOUCHING: f64 = 1.0e-9;

/// A point of the difference of two cores: `b - a`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub(super) w: DVec3,
    pub(super) on_a: DVec3,
    pub(super) on_b: DVec3,
}

/// The nearest points of two cores, or of their surfaces where they overlap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Witness {
    pub(super) on_a: DVec3,
    pub(super) on_b: DVec3,
    /// Unit, from the first to the second.
    pub(super) normal: DVec3,
    /// Along the normal; negative where they overlap. Metres.
    pub(super) separation: f64,
}

/// What the search found.
#[allow(clippy::large_enum_variant, reason = "made and taken apart once per pair; a box would allocate")]
pub(super) enum Distance {
    Apart(Witness),
    /// The cores share a point; the simplex (one to four vertices) holds the origin.
    Overlap(Simplex),
}

/// Up to four vertices and the weights of the point of theirs that is nearest to the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simplex {
    vertices: [Vertex; 4],
    weights: [f64; 4],
    count: usize,
}

/// The vertex of the difference that is outermost in a direction.
pub(super) fn support(a: &Solid, b: &Solid, direction: DVec3) -> Vertex {
    let (on_a, on_b) = (a.support(-direction), b.support(direction));
    Vertex { w: on_b - on_a, on_a, on_b }
}

/// The distance between two cores. Of cores farther apart than `enough` (metres) only that they are so is known: the
/// witness has some distance above it.
pub(super) fn distance(a: &Solid, b: &Solid, enough: f32) -> Distance {
    let enough = f64::from(enough);
    let arm = (b.middle() - a.middle()).as_dvec3();
    let start = if arm.length_squared() > 1.0e-12 { -arm } else { DVec3::X };
    let mut simplex = Simplex::of(support(a, b, start));
    let mut nearest = simplex.vertices[0].w;
    for _ in 0..ROUNDS_MAX {
        let square = nearest.length_squared();
        if square < TOUCHING * TOUCHING {
            return Distance::Overlap(simplex);
        }
        let vertex = support(a, b, -nearest);
        let known = simplex.vertices().iter().any(|other| other.w == vertex.w);
        // All of the difference is at least this far along `nearest`, times its length.
        let bound = nearest.dot(vertex.w);
        let far = bound > 0.0 && bound * bound > enough * enough * square;
        if known || far || square - bound <= GAP * square {
            break;
        }
        let mut next = simplex;
        next.vertices[next.count] = vertex;
        next.count += 1;
        if next.reduce() {
            return Distance::Overlap(next);
        }
        let point = next.point();
        if point.length_squared() >= square {
            break;
        }
        (simplex, nearest) = (next, point);
    }
    let separation = nearest.length();
    let (on_a, on_b) = simplex.witnesses();
    Distance::Apart(Witness { on_a, on_b, normal: nearest / separation, separation })
}

impl Simplex {
    fn of(vertex: Vertex) -> Self {
        Simplex { vertices: [vertex; 4], weights: [1.0, 0.0, 0.0, 0.0], count: 1 }
    }

    pub(super) fn vertices(&self) -> &[Vertex] {
        &self.vertices[..self.count]
    }

    fn point(&self) -> DVec3 {
        self.sum(|vertex| vertex.w)
    }

    fn witnesses(&self) -> (DVec3, DVec3) {
        (self.sum(|vertex| vertex.on_a), self.sum(|vertex| vertex.on_b))
    }

    fn sum(&self, of: impl Fn(&Vertex) -> DVec3) -> DVec3 {
        let terms = self.vertices().iter().zip(self.weights);
        terms.fold(DVec3::ZERO, |sum, (vertex, weight)| sum + of(vertex) * weight)
    }

    fn keep(&self, kept: &[(usize, f64)]) -> Simplex {
        let mut next = *self;
        next.count = kept.len();
        for (slot, &(index, weight)) in kept.iter().enumerate() {
            next.vertices[slot] = self.vertices[index];
            next.weights[slot] = weight;
        }
        next
    }

    /// Drops the vertices that do not carry the nearest point. Says whether the simplex holds the origin.
    fn reduce(&mut self) -> bool {
        match self.count {
            2 => *self = self.nearest_on_edge(0, 1),
            3 => *self = self.nearest_on_triangle([0, 1, 2]),
            4 => return self.reduce_tetrahedron(),
            _ => {}
        }
        false
    }

    fn nearest_on_edge(&self, i: usize, j: usize) -> Simplex {
        let (p, q) = (self.vertices[i].w, self.vertices[j].w);
        let along = q - p;
        let t = -p.dot(along);
        let square = along.length_squared();
        if t <= 0.0 || square <= 0.0 {
            self.keep(&[(i, 1.0)])
        } else if t >= square {
            self.keep(&[(j, 1.0)])
        } else {
            self.keep(&[(i, 1.0 - t / square), (j, t / square)])
        }
    }

    /// Inside of the triangle, or on the nearest of its edges.
    fn nearest_on_triangle(&self, [i, j, k]: [usize; 3]) -> Simplex {
        let (p, q, r) = (self.vertices[i].w, self.vertices[j].w, self.vertices[k].w);
        let normal = (q - p).cross(r - p);
        let square = normal.length_squared();
        // Areas of the three parts that the origin's foot cuts the triangle into, times the normal's length squared.
        let of_p = normal.dot(q.cross(r));
        let of_q = normal.dot(r.cross(p));
        let of_r = normal.dot(p.cross(q));
        if square > 0.0 && of_p > 0.0 && of_q > 0.0 && of_r > 0.0 {
            let sum = of_p + of_q + of_r;
            return self.keep(&[(i, of_p / sum), (j, of_q / sum), (k, of_r / sum)]);
        }
        self.nearest_of([self.nearest_on_edge(i, j), self.nearest_on_edge(j, k), self.nearest_on_edge(k, i)])
    }

    fn reduce_tetrahedron(&mut self) -> bool {
        let [p, q, r, s] = self.vertices.map(|vertex| vertex.w);
        let volume = (q - p).dot((r - p).cross(s - p));
        let longest =
            [q - p, r - p, s - p].iter().fold(0.0_f64, |most, edge| most.max(edge.length_squared()));
        let flat = volume.abs() <= 1.0e-14 * longest * longest.sqrt();
        // Signed volumes with the origin in place of one vertex: all of one sign if it is inside.
        let inside = [q.dot(r.cross(s)), -p.dot(r.cross(s)), p.dot(q.cross(s)), -p.dot(q.cross(r))];
        if !flat && inside.iter().all(|part| part * volume >= 0.0) {
            return true;
        }
        let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
        *self = self.nearest_of(faces.map(|face| self.nearest_on_triangle(face)));
        false
    }

    fn nearest_of<const N: usize>(&self, candidates: [Simplex; N]) -> Simplex {
        let mut best = candidates[0];
        for candidate in &candidates[1..] {
            if candidate.point().length_squared() < best.point().length_squared() {
                best = *candidate;
            }
        }
        best
    }
}
