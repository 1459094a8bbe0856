//! Mesh report: what was found and mended in triangles, and why they are no usable mesh.

use std::fmt;

use crate::Vec3;

/// How the triangles of a mesh bound a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Enclosure {
    /// Every edge belongs to two triangles that pass it in opposite directions, or to several such pairs where parts touch, and no part
    /// of the surface is inside of another.
    Closed,
    /// There is an inside all the same: small holes are covered, and walls inside of the volume do not count.
    Mended,
    /// Nothing is inside: a sheet, like terrain. Contact goes to the triangles, and only their front collides.
    Open,
}

impl Enclosure {
    /// Whether there is an inside: a volume, a mass, and depth that a body can be pushed out of.
    #[must_use]
    pub fn has_inside(self) -> bool {
        self != Enclosure::Open
    }
}

/// What was found and mended when a mesh was made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshRepairs {
    /// Vertices that had exactly the position of an earlier one and were merged with it.
    pub welded_vertices: u32,
    /// Vertices that no triangle used and that were left out.
    pub unused_vertices: u32,
    /// Triangles that were left out because two of their corners are the same or all three lie in a line.
    pub dropped_triangles: u32,
    /// Triangles with their corners in a line that were cut anew together with a neighbour, so that the mesh stays closed.
    pub recut_triangles: u32,
    /// Whether all triangles faced inwards and were turned round.
    pub turned: bool,
    /// Triangles that were turned round because their neighbours face the other way, or because their whole shell faced inwards without being a cavity.
    pub flipped_triangles: u32,
    /// Holes, which were covered. Rims that share a vertex are those of one.
    pub holes: u32,
    /// Edges of the holes.
    pub hole_edges: u32,
    /// Ends of the first of those edges. Metres.
    pub first_hole: Option<[Vec3; 2]>,
    /// Area of what covers the holes. Square metres.
    pub cover_area: f32,
    /// Edges of more than two triangles.
    pub crowded_edges: u32,
    /// Ends of the first of them. Metres.
    pub first_crowded: Option<[Vec3; 2]>,
    /// Triangles that are, at least in part, inside of the volume that others bound. What is inside does not count.
    pub inner_triangles: u32,
    /// Triangles with nothing on either side: sheets that do not count.
    pub sheet_triangles: u32,
}

impl MeshRepairs {
    /// Whether the mesh was taken as it was given.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == MeshRepairs::default()
    }

    /// What keeps a mesh with these from being [closed](Enclosure::Closed) where it is [mended](Enclosure::Mended), in words: holes, edges of
    /// more than two triangles, walls that are not between inside and outside.
    #[must_use]
    pub fn why_not_closed(&self) -> String {
        let mut reasons = Vec::new();
        if let Some(first) = self.first_hole {
            reasons.push(format!("{}, the first {}", self.holes_in_words(), between(first)));
        }
        if let Some(first) = self.first_crowded {
            let edges = counted(self.crowded_edges, "edge", "edges");
            reasons.push(format!("{edges} of more than two triangles, the first {}", between(first)));
        }
        if self.inner_triangles > 0 {
            let triangles = counted(self.inner_triangles, "triangle", "triangles");
            reasons.push(format!("{triangles} at least partly inside of other parts"));
        }
        if self.sheet_triangles > 0 {
            let triangles = counted(self.sheet_triangles, "triangle", "triangles");
            reasons.push(format!("{triangles} of sheets without thickness"));
        }
        if reasons.is_empty() {
            // Neither holes nor walls in the wrong place: then triangles were found to cross.
            reasons.push("triangles touch or cross each other".to_owned());
        }
        reasons.join("; ")
    }

    fn holes_in_words(&self) -> String {
        let (holes, edges) =
            (counted(self.holes, "hole", "holes"), counted(self.hole_edges, "edge", "edges"));
        format!("{holes} with {edges}")
    }
}

fn counted(n: u32, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

fn between([a, b]: [Vec3; 2]) -> String {
    format!("between {a} and {b}")
}

impl fmt::Display for MeshRepairs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counted = [
            (self.welded_vertices, "duplicate vertices welded"),
            (self.unused_vertices, "unused vertices left out"),
            (self.dropped_triangles, "degenerate triangles left out"),
            (self.recut_triangles, "triangles with their corners in a line cut anew"),
            (self.flipped_triangles, "triangles turned to face outwards like their neighbours"),
            (self.crowded_edges, "edges of more than two triangles"),
            (self.inner_triangles, "triangles inside of other parts do not count where they are inside"),
            (self.sheet_triangles, "triangles of sheets without thickness do not count"),
        ];
        let mut notes: Vec<String> =
            counted.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
        if self.turned {
            notes.push("all triangles faced inwards and were turned round".to_owned());
        }
        if self.holes > 0 {
            notes.push(format!("{} covered ({:.3e} m²)", self.holes_in_words(), self.cover_area));
        }
        if notes.is_empty() { write!(f, "nothing mended") } else { write!(f, "{}", notes.join(", ")) }
    }
}

/// Why triangles are no usable mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshError {
    /// There is no triangle (left).
    Empty {
        /// Triangles that were left out as degenerate.
        dropped: u32,
    },
    /// A vertex is not finite.
    NotFinite {
        /// Its index.
        vertex: usize,
        /// Its position.
        position: Vec3,
    },
    /// A vertex is farther from the origin than positions are exact, and masses finite.
    TooFar {
        /// Its index.
        vertex: usize,
        /// Its position. Metres.
        position: Vec3,
        /// How far along each axis is allowed. Metres.
        most: f32,
    },
    /// A triangle names a vertex that does not exist.
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// Edges with a triangle on one side only.
    Open {
        /// How many.
        edges: usize,
        /// Ends of the first. Metres.
        first: [Vec3; 2],
    },
    /// Edges of two triangles that face opposite ways.
    Twisted {
        /// How many.
        edges: usize,
        /// Ends of the first. Metres.
        first: [Vec3; 2],
    },
    /// Edges of more than two triangles.
    Crowded {
        /// How many.
        edges: usize,
        /// Ends of the first. Metres.
        first: [Vec3; 2],
        /// How many triangles have the first.
        triangles: usize,
    },
    /// The wished size of cells is no length.
    Cell {
        /// What was wished. Metres.
        cell: f32,
    },
    /// The volume is zero to rounding.
    NoVolume {
        /// What was computed. m³.
        volume: f64,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MeshError::Empty { dropped: 0 } => write!(f, "the mesh has no triangles"),
            MeshError::Empty { dropped } => {
                write!(
                    f,
                    "the mesh has no triangles but {dropped} degenerate ones (corners equal or in a line)"
                )
            }
            MeshError::NotFinite { vertex, position } => {
                write!(f, "vertex {vertex} is {position}; positions must be finite numbers")
            }
            MeshError::TooFar { vertex, position, most } => write!(
                f,
                "vertex {vertex} is at {position}, beyond {most:e} m; scale the mesh (its unit may not be the metre), or move it to the origin"
            ),
            MeshError::IndexOutOfRange { triangle, index, vertices } => write!(
                f,
                "triangle {triangle} names vertex {index}, but there are {vertices} vertices (0 to {})",
                vertices.saturating_sub(1)
            ),
            MeshError::Open { edges, first } => write!(
                f,
                "the mesh is not closed: {edges} edges have a triangle on one side only, the first {}; close the holes (weld vertices that \
                 should be one), or use it for a fixed body as an open mesh",
                between(*first)
            ),
            MeshError::Twisted { edges, first } => write!(
                f,
                "{edges} edges join triangles that face opposite ways, the first {}; give all triangles the same winding",
                between(*first)
            ),
            MeshError::Crowded { edges, first, triangles } => write!(
                f,
                "{edges} edges belong to more than two triangles, the first {} has {triangles}; remove inner walls and doubled triangles",
                between(*first)
            ),
            MeshError::Cell { cell } => {
                write!(f, "cells of the distance field must have a finite size above 0 m, not {cell}")
            }
            MeshError::NoVolume { volume } => write!(
                f,
                "the mesh encloses no volume ({volume:e} m³); a sheet needs thickness, and shells must not cancel each other"
            ),
        }
    }
}

impl std::error::Error for MeshError {}
