//! Triangle meshes of a scene: from a file, or made by a formula.

use forerun_geometry::Vec3;
use forerun_geometry::mesh_file::{
    LIKELY_MILLIMETRES, MeshFileError, MeshFileOptions, MeshFileProblem, TriangleList, UpAxis, load_triangles,
};
use forerun_geometry::shape::mesh_make::{ball, torus};
use forerun_geometry::shape::{Inside, Mesh};
use serde::{Deserialize, Serialize};

use crate::error::{Fault, Within};
use crate::mesh_baking::BakeSite;
use crate::range;

/// A mesh in a scene file: exactly one of `file`, `torus`, `torus_knot` and `ball`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshEntry {
    /// An OBJ, STL, PLY or glTF file. A relative name starts at the folder of the scene file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// A ring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torus: Option<TorusEntry>,
    /// A closed tube that winds round a torus.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torus_knot: Option<TorusKnotEntry>,
    /// A ball made of triangles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ball: Option<BallEntry>,
    /// Factor on all coordinates. Above 0, default 1.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub scale: f32,
    /// Which axis of the file points up. Default y.
    #[serde(default, skip_serializing_if = "UpEntry::is_y")]
    pub up: UpEntry,
    /// Whether it may have holes and edges: a terrain. Such a mesh has no inside and is for fixed and kinematic bodies only. Default false.
    #[serde(default, skip_serializing_if = "is_false")]
    pub open: bool,
}

/// Which axis of a mesh file points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UpEntry {
    /// x is up.
    X,
    /// y is up: glTF, and most programs that draw.
    #[default]
    Y,
    /// z is up: most programs that construct.
    Z,
}

impl UpEntry {
    /// Whether nothing has to be turned.
    fn is_y(&self) -> bool {
        *self == UpEntry::Y
    }
}

impl From<UpEntry> for UpAxis {
    fn from(entry: UpEntry) -> Self {
        match entry {
            UpEntry::X => UpAxis::X,
            UpEntry::Y => UpAxis::Y,
            UpEntry::Z => UpAxis::Z,
        }
    }
}

/// A torus about the y axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorusEntry {
    /// From the axis to the middle of the tube. Metres, above `tube_radius`.
    pub radius: f32,
    /// Radius of the tube. Metres, above 0.
    pub tube_radius: f32,
    /// Points along the ring. 3 to 1024.
    pub segments: u32,
    /// Points round the tube. 3 to 256.
    pub sides: u32,
}

/// A tube along a (p, q) torus knot about the y axis: p turns about the axis while it winds q times round the ring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorusKnotEntry {
    /// Turns about the axis. 1 to 12, without a common factor with `q`.
    pub p: u32,
    /// Windings round the ring. 1 to 12.
    pub q: u32,
    /// Radius of the ring that the tube winds round. Metres, above `winding_radius`.
    pub radius: f32,
    /// How far the middle of the tube is from the ring. Metres, above 0.
    pub winding_radius: f32,
    /// Radius of the tube. Metres, above 0 and so small that the tube does not cut itself.
    pub tube_radius: f32,
    /// Points along the tube. 16 to 4096.
    pub segments: u32,
    /// Points round the tube. 3 to 256.
    pub sides: u32,
}

/// A ball of triangles about the origin: an icosahedron whose edges are cut into parts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BallEntry {
    /// Metres, above 0.
    pub radius: f32,
    /// 1 to 128: the ball has 20 times as many triangles as this squared.
    pub parts: u32,
}

fn one() -> f32 {
    1.0
}

fn is_one(scale: &f32) -> bool {
    scale.to_bits() == 1.0_f32.to_bits()
}

fn is_false(open: &bool) -> bool {
    !open
}

impl MeshEntry {
    const NONE: MeshEntry = MeshEntry {
        file: None,
        torus: None,
        torus_knot: None,
        ball: None,
        scale: 1.0,
        up: UpEntry::Y,
        open: false,
    };

    /// A ring.
    #[must_use]
    pub fn torus(torus: TorusEntry) -> MeshEntry {
        MeshEntry { torus: Some(torus), ..MeshEntry::NONE }
    }

    /// A knotted tube.
    #[must_use]
    pub fn torus_knot(knot: TorusKnotEntry) -> MeshEntry {
        MeshEntry { torus_knot: Some(knot), ..MeshEntry::NONE }
    }

    /// A ball of triangles.
    #[must_use]
    pub fn ball(ball: BallEntry) -> MeshEntry {
        MeshEntry { ball: Some(ball), ..MeshEntry::NONE }
    }

    /// Everything but whether the file can be read.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        range::above_zero(self.scale, "scale")?;
        let given =
            [self.file.is_some(), self.torus.is_some(), self.torus_knot.is_some(), self.ball.is_some()];
        if given.iter().filter(|x| **x).count() != 1 {
            return Err(Fault::new(
                "a mesh has exactly one of `file`, `torus`, `torus_knot` and `ball`",
                "for example torus = { radius = 0.5, tube_radius = 0.2, segments = 48, sides = 16 }",
            ));
        }
        if self.file.is_none() && !self.up.is_y() {
            let fault =
                Fault::new("only a mesh from a file may have another axis up", "turn the body instead");
            return Err(fault).in_field("up");
        }
        if let Some(torus) = &self.torus {
            torus.check().in_field("torus")?;
        }
        if let Some(knot) = &self.torus_knot {
            knot.check().in_field("torus_knot")?;
        }
        if let Some(ball) = &self.ball {
            range::above_zero(ball.radius, "radius").in_field("ball")?;
            range::whole_between(ball.parts, (1, 128), "parts").in_field("ball")?;
        }
        Ok(())
    }

    /// The mesh itself. Reads a file if there is one to read.
    pub(crate) fn build(&self, site: &BakeSite<'_>) -> Result<Mesh, Fault> {
        let scale = self.scale;
        if let Some(file) = &self.file {
            self.load(file, site).in_field("file")
        } else if let Some(t) = &self.torus {
            torus(t.radius * scale, t.tube_radius * scale, t.segments, t.sides).map_err(not_possible)
        } else if let Some(knot) = &self.torus_knot {
            self.scaled(knot.build(), site).in_field("torus_knot")
        } else if let Some(b) = &self.ball {
            ball(b.radius * scale, b.parts).map_err(not_possible)
        } else {
            Err(Fault::new("a mesh needs a `file` or a formula", "add one"))
        }
    }

    fn load(&self, file: &str, site: &BakeSite<'_>) -> Result<Mesh, Fault> {
        let path = site.folder.join(file);
        let options = MeshFileOptions { scale: self.scale, up: self.up.into() };
        let list = load_triangles(&path, options).map_err(|error| file_fault(&error))?;
        let mesh = site.make(list, self.inside()).map_err(|error| {
            file_fault(&MeshFileError { path: path.clone(), problem: MeshFileProblem::Mesh(error) })
        })?;
        let bounds = mesh.bounds();
        let size = (bounds.max - bounds.min).max_element();
        if mesh.has_inside() && size > LIKELY_MILLIMETRES {
            site.warn(&format!("is {size} m large; write scale = 0.001 if the file is in millimetres"));
        }
        Ok(mesh)
    }

    fn scaled(&self, triangles: TriangleList, site: &BakeSite<'_>) -> Result<Mesh, Fault> {
        let vertices = triangles.vertices.into_iter().map(|v| v * self.scale).collect();
        let list = TriangleList { vertices, triangles: triangles.triangles };
        site.make(list, self.inside()).map_err(not_possible)
    }

    fn inside(&self) -> Inside {
        if self.open { Inside::Optional } else { Inside::Needed }
    }
}

const MEND: &str = "mend the mesh, or say open = true if it is a fixed terrain";

fn not_possible(error: impl std::fmt::Display) -> Fault {
    Fault::new(error.to_string(), MEND)
}

fn file_fault(error: &MeshFileError) -> Fault {
    let remedy = match error.problem {
        MeshFileProblem::Unreadable(_) => "the name is relative to the folder of the scene file",
        MeshFileProblem::TooLarge => "simplify the mesh",
        MeshFileProblem::UnknownFormat => "convert the mesh to glTF, PLY, OBJ or STL",
        MeshFileProblem::Scale(_) => "write a factor above 0",
        MeshFileProblem::Parse(_) => "export the mesh again from its program",
        MeshFileProblem::Mesh(_) => MEND,
    };
    Fault::new(error.to_string(), remedy)
}

impl TorusEntry {
    fn check(&self) -> Result<(), Fault> {
        range::above_zero(self.tube_radius, "tube_radius")?;
        range::above_zero(self.radius, "radius")?;
        larger(self.radius, "radius", self.tube_radius, "tube_radius")?;
        range::whole_between(self.segments, (3, 1024), "segments")?;
        range::whole_between(self.sides, (3, 256), "sides")
    }
}

impl TorusKnotEntry {
    fn check(&self) -> Result<(), Fault> {
        range::whole_between(self.p, (1, 12), "p")?;
        range::whole_between(self.q, (1, 12), "q")?;
        if common_factor(self.p, self.q) != 1 {
            let message = format!("p and q must have no common factor, are {} and {}", self.p, self.q);
            return Err(Fault::new(message, "2 and 3 make a trefoil")).in_field("q");
        }
        range::above_zero(self.winding_radius, "winding_radius")?;
        range::above_zero(self.radius, "radius")?;
        larger(self.radius, "radius", self.winding_radius, "winding_radius")?;
        range::above_zero(self.tube_radius, "tube_radius")?;
        range::whole_between(self.segments, (16, 4096), "segments")?;
        range::whole_between(self.sides, (3, 256), "sides")?;
        let room = self.room();
        if self.tube_radius >= room {
            let message =
                format!("the tube cuts itself: must be below {room:.4} here, is {}", self.tube_radius);
            return Err(Fault::new(message, "make the tube thinner or the radii larger"))
                .in_field("tube_radius");
        }
        Ok(())
    }

    /// Largest tube radius at which strands stay apart: half of the smallest distance between parts of the middle line that are
    /// not neighbours along it (further apart than half a turn of a circle with that diameter).
    fn room(&self) -> f32 {
        let count = 256;
        let line: Vec<Vec3> = (0..count).map(|i| self.point(i, count)).collect();
        let step: Vec<f32> =
            (0..count as usize).map(|i| line[i].distance(line[(i + 1) % count as usize])).collect();
        let length: f32 = step.iter().sum();
        let mut room = f32::INFINITY;
        for i in 0..line.len() {
            let mut along = 0.0;
            for j in i + 1..line.len() {
                along += step[j - 1];
                let distance = line[i].distance(line[j]);
                if along.min(length - along) > std::f32::consts::FRAC_PI_2 * distance {
                    room = room.min(0.5 * distance);
                }
            }
        }
        room
    }

    fn point(&self, i: u32, count: u32) -> Vec3 {
        let (sin_p, cos_p) = turn(i * self.p, count);
        let (sin_q, cos_q) = turn(i * self.q, count);
        let out = self.radius + self.winding_radius * cos_q;
        Vec3::new(out * cos_p, self.winding_radius * sin_q, out * sin_p)
    }

    fn build(&self) -> TriangleList {
        let n = self.segments;
        let sections: Vec<Section> = (0..n)
            .map(|i| {
                let centre = self.point(i, n);
                let tangent = (self.point((i + 1) % n, n) - self.point((i + n - 1) % n, n)).normalize();
                // From the ring outwards, made square to the tangent: it closes after p turns, as the curve does.
                let (sin_p, cos_p) = turn(i * self.p, n);
                let outward = centre - Vec3::new(cos_p, 0.0, sin_p) * self.radius;
                let normal = (outward - tangent * outward.dot(tangent)).normalize();
                Section { centre, normal, binormal: tangent.cross(normal) }
            })
            .collect();
        tube(&sections, self.tube_radius, self.sides)
    }
}

/// A cut through a tube: normal, binormal and the direction of the tube are a right-handed set of unit vectors.
struct Section {
    centre: Vec3,
    normal: Vec3,
    binormal: Vec3,
}

/// The closed tube round a ring of sections, wound counter-clockwise seen from outside.
fn tube(sections: &[Section], radius: f32, sides: u32) -> TriangleList {
    let count = sections.len() as u32;
    let mut vertices = Vec::with_capacity(sections.len() * sides as usize);
    for section in sections {
        for j in 0..sides {
            let (sin, cos) = turn(j, sides);
            vertices.push(section.centre + (section.normal * cos + section.binormal * sin) * radius);
        }
    }
    let at = |i: u32, j: u32| (i % count) * sides + j % sides;
    let mut triangles = Vec::with_capacity(vertices.len() * 2);
    for i in 0..count {
        for j in 0..sides {
            triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            triangles.push([at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]);
        }
    }
    TriangleList { vertices, triangles }
}

/// Sine and cosine of `part / whole` of a full turn.
fn turn(part: u32, whole: u32) -> (f32, f32) {
    libm::sincosf((part % whole) as f32 * (std::f32::consts::TAU / whole as f32))
}

fn common_factor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { common_factor(b, a % b) }
}

fn larger(value: f32, field: &str, other: f32, other_field: &str) -> Result<(), Fault> {
    if value > other {
        return Ok(());
    }
    let message = format!("must be above {other_field} ({other}), is {value}");
    Err(Fault::new(message, format!("raise {field} or lower {other_field}"))).in_field(field)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(mesh: &Mesh) -> f32 {
        (0..mesh.triangles.len())
            .map(|i| {
                let [a, b, c] = mesh.corners(i);
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    }

    #[test]
    fn a_knot_is_closed_and_has_the_volume_of_its_tube() {
        let knot = TorusKnotEntry {
            p: 2,
            q: 3,
            radius: 0.5,
            winding_radius: 0.22,
            tube_radius: 0.1,
            segments: 256,
            sides: 32,
        };
        knot.check().unwrap();
        let mesh = MeshEntry::torus_knot(knot).build(&BakeSite::nowhere()).unwrap();
        assert!(mesh.has_inside() && mesh.repairs.is_none(), "{}", mesh.repairs);
        let length: f32 =
            (0..1000).map(|i| knot.point(i, 1000).distance(knot.point((i + 1) % 1000, 1000))).sum();
        // Pappus: section times the length of the middle line.
        let ratio = volume(&mesh) / (length * std::f32::consts::PI * 0.01);
        assert!((0.97..1.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_knot_whose_tube_cuts_itself_is_refused() {
        let knot = TorusKnotEntry {
            p: 2,
            q: 3,
            radius: 0.5,
            winding_radius: 0.22,
            tube_radius: 0.23,
            segments: 256,
            sides: 32,
        };
        let fault = knot.check().unwrap_err();
        assert_eq!(fault.path.to_string(), "tube_radius");
    }
}
