//! glTF 2.0, as JSON (`.gltf`) or binary (`.glb`): the triangles of the default scene, each mesh where its nodes put it.
//!
//! Materials, skins, morph targets and animations are not read; points and lines are skipped.

use glam::{DMat4, DQuat, DVec3};

use super::polygon::{fan, strip};
use super::{ParseError, TriangleList};
use crate::Vec3;

mod accessor;
mod buffers;
mod document;

use accessor::Data;
pub use buffers::ReadBeside;
use document::{Document, Node, Primitive, Versioned};

/// Most vertices and triangles, all copies of a mesh counted.
const LARGEST_LIST: usize = 1 << 24;
/// Most vertices and corners that are read, those included that make no triangle, and again for each copy.
const MOST_READ: usize = 4 * LARGEST_LIST;
/// Most parts of meshes, all copies counted.
const MOST_PRIMITIVES: usize = 1 << 20;
/// What keeps triangles in a form that only its own decoder reads.
const COMPRESSED: [&str; 3] =
    ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];
/// What triangles and their places do not depend on, or what is read.
const HARMLESS: [&str; 11] = [
    "KHR_mesh_quantization",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_lights_punctual",
    "KHR_animation_pointer",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "EXT_lights_image_based",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "MSFT_texture_dds",
];
/// How the names of kinds of materials begin, which are harmless too.
const MATERIALS: [&str; 2] = ["KHR_materials_", "EXT_materials_"];

/// The triangles of a glTF or GLB file. `beside` reads a file by its name relative to the glTF file, and says why it cannot.
///
/// # Errors
/// With the place in the document: JSON that is none, a buffer that is missing or too short, an index out of range, a position that is not
/// finite, a node with two parents, compressed meshes and other extensions that it cannot be read without, or no triangle at all.
pub fn parse_gltf(bytes: &[u8], beside: ReadBeside<'_>) -> Result<TriangleList, ParseError> {
    let (json, chunk) = if bytes.starts_with(b"glTF") { unpack(bytes)? } else { (bytes, None) };
    let document: Document = serde_json::from_slice(json).map_err(|error| {
        // The lists of glTF 1.0 are tables: its version says more than the first of them.
        if let Ok(Versioned { asset: Some(asset) }) = serde_json::from_slice(json)
            && let Err(error) = check_version(&asset.version)
        {
            return error;
        }
        let place = format!("line {} column {}", error.line(), error.column());
        // It may quote all of a buffer.
        let message: String = error.to_string().chars().take(120).flat_map(char::escape_debug).collect();
        let message = message.rfind(" at line ").map_or(message.as_str(), |end| &message[..end]);
        ParseError::new(place, format!("{message}: not a glTF file, or cut; export it again"))
    })?;
    check(&document)?;
    let buffers = buffers::read_buffers(&document.buffers, chunk, beside)?;
    let mut reader = Reader {
        data: Data { document: &document, buffers: &buffers },
        list: TriangleList::default(),
        primitives: 0,
        read: 0,
    };
    reader.read_scene()?;
    if reader.list.triangles.is_empty() {
        let message = "the default scene has no triangles; export what is to collide as a mesh";
        return Err(ParseError::new("scenes", message));
    }
    Ok(reader.list)
}

/// The JSON and the binary part of a GLB file.
fn unpack(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ParseError> {
    let word = |at: usize| -> Option<u32> {
        let word = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(word.try_into().ok()?))
    };
    let cut = || ParseError::new("header", "the file is shorter than it says: cut; export it again");
    if word(4).ok_or_else(cut)? != 2 {
        return Err(ParseError::new("header", "only version 2 of glTF is read; export it as glTF 2.0"));
    }
    let chunk = |at: usize| {
        let length = word(at)? as usize;
        let content = bytes.get(at + 8..at.checked_add(8)?.checked_add(length)?)?;
        Some((word(at + 4)?.to_le_bytes(), content))
    };
    let (kind, json) = chunk(12).ok_or_else(cut)?;
    if &kind != b"JSON" {
        return Err(ParseError::new("first chunk", "is not JSON: not a GLB file; export it again"));
    }
    // Chunks begin at multiples of four bytes.
    let next = 20 + json.len().next_multiple_of(4);
    if next >= bytes.len() {
        return Ok((json, None));
    }
    let (kind, binary) = chunk(next).ok_or_else(cut)?;
    Ok((json, (&kind == b"BIN\0").then_some(binary)))
}

fn check(document: &Document) -> Result<(), ParseError> {
    check_version(document.asset.as_ref().map_or("", |asset| asset.version.as_str()))?;
    let is_harmless =
        |name: &str| HARMLESS.contains(&name) || MATERIALS.iter().any(|kind| name.starts_with(kind));
    let unknown = document.extensions_required.iter().find(|name| !is_harmless(name));
    unknown.map_or(Ok(()), |name| {
        let what =
            if COMPRESSED.contains(&name.as_str()) { "compression of meshes" } else { "this extension" };
        let name: String = name.chars().take(48).flat_map(char::escape_debug).collect();
        Err(ParseError::new(
            "extensionsRequired",
            format!("{name} is not read; export the file without {what}"),
        ))
    })
}

fn check_version(version: &str) -> Result<(), ParseError> {
    if version.starts_with("2.") {
        return Ok(());
    }
    Err(ParseError::new("asset.version", "must be 2.0; export the file as glTF 2.0"))
}

/// Triangles in the making.
struct Reader<'a> {
    data: Data<'a>,
    list: TriangleList,
    /// Parts of meshes so far, all copies counted.
    primitives: usize,
    /// Vertices and corners so far, of all copies.
    read: usize,
}

impl Reader<'_> {
    fn read_scene(&mut self) -> Result<(), ParseError> {
        let document = self.data.document;
        if document.nodes.is_empty() {
            return (0..document.meshes.len()).try_for_each(|mesh| self.read_mesh(mesh, DMat4::IDENTITY));
        }
        let mut nodes: Vec<(usize, DMat4)> =
            roots(document)?.into_iter().rev().map(|node| (node, DMat4::IDENTITY)).collect();
        let mut visited = vec![false; document.nodes.len()];
        while let Some((index, parent)) = nodes.pop() {
            let fail = |message: &str| ParseError::new(format!("nodes[{index}]"), message);
            let node = document.nodes.get(index).ok_or_else(|| fail("does not exist"))?;
            if std::mem::replace(&mut visited[index], true) {
                return Err(fail("has two parents, or is a child of its own; export the file again"));
            }
            let placed = parent * transform(node);
            if let Some(mesh) = node.mesh {
                // A skinned mesh is put in its place by its bones alone.
                self.read_mesh(mesh, if node.skin.is_some() { DMat4::IDENTITY } else { placed })?;
            }
            nodes.extend(node.children.iter().rev().map(|child| (*child, placed)));
        }
        Ok(())
    }

    fn read_mesh(&mut self, mesh: usize, placed: DMat4) -> Result<(), ParseError> {
        let document = self.data.document;
        let entry = document.meshes.get(mesh);
        let entry = entry.ok_or_else(|| ParseError::new(format!("meshes[{mesh}]"), "does not exist"))?;
        for (i, primitive) in entry.primitives.iter().enumerate() {
            self.primitives += 1;
            if self.primitives > MOST_PRIMITIVES {
                let message = format!("there are more than {MOST_PRIMITIVES} parts of meshes; join them");
                return Err(ParseError::new("nodes", message));
            }
            self.read_primitive(primitive, placed, || format!("meshes[{mesh}].primitives[{i}]"))?;
        }
        Ok(())
    }

    fn read_primitive(
        &mut self,
        primitive: &Primitive,
        placed: DMat4,
        place: impl Fn() -> String,
    ) -> Result<(), ParseError> {
        let fail = |message: String| ParseError::new(place(), message);
        let mode = primitive.mode.unwrap_or(4);
        let (Some(position), true) = (primitive.attributes.position, mode > 3) else {
            return Ok(());
        };
        let positions = self.data.positions(position)?;
        let corners = match primitive.indices {
            Some(indices) => self.data.indices(indices)?,
            None => (0..positions.len() as u32).collect(),
        };
        self.read += positions.len() + corners.len();
        if self.read > MOST_READ {
            return Err(fail(format!(
                "the scene has more than {MOST_READ} vertices and corners with all its copies; simplify it"
            )));
        }
        if let Some(index) = corners.iter().find(|i| **i as usize >= positions.len()) {
            return Err(fail(format!("vertex {index} does not exist; there are {}", positions.len())));
        }
        let (whole, rest) = corners.as_chunks::<3>();
        let mut triangles = match mode {
            4 if rest.is_empty() => whole.to_vec(),
            4 => return Err(fail(format!("{} corners make no whole number of triangles", corners.len()))),
            5 => strip(&corners),
            6 => fan(&corners),
            _ => return Err(fail(format!("mode {mode} is none of glTF"))),
        };
        let first = self.list.vertices.len();
        if first.saturating_add(positions.len()).max(self.list.triangles.len() + triangles.len())
            > LARGEST_LIST
        {
            return Err(fail(format!(
                "the scene has more than {LARGEST_LIST} vertices or triangles with all its copies; simplify it"
            )));
        }
        for position in positions {
            let at = placed.transform_point3(Vec3::from(position).as_dvec3()).as_vec3();
            if !at.is_finite() {
                return Err(fail(format!("a vertex is at {at}; positions must be finite numbers")));
            }
            self.list.vertices.push(at);
        }
        // A mirror turns the winding round.
        let mirrored = placed.determinant() < 0.0;
        for triangle in &mut triangles {
            *triangle = triangle.map(|i| i + first as u32);
            if mirrored {
                triangle.swap(1, 2);
            }
        }
        self.list.triangles.extend(triangles);
        Ok(())
    }
}

/// The nodes that the default scene begins with; without a scene all that are nobody's children.
fn roots(document: &Document) -> Result<Vec<usize>, ParseError> {
    let scene = document.scene.unwrap_or(0);
    if let Some(scene) = document.scenes.get(scene) {
        return Ok(scene.nodes.clone());
    }
    if document.scene.is_some() {
        return Err(ParseError::new("scene", format!("scenes[{scene}] does not exist")));
    }
    let mut is_child = vec![false; document.nodes.len()];
    for child in document.nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_child) = is_child.get_mut(*child) {
            *is_child = true;
        }
    }
    Ok((0..is_child.len()).filter(|node| !is_child[*node]).collect())
}

/// Where a node is in its parent.
fn transform(node: &Node) -> DMat4 {
    if let Some(matrix) = &node.matrix {
        return DMat4::from_cols_array(matrix);
    }
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |r| DQuat::from_array(r).normalize());
    DMat4::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, DVec3::from_array),
        rotation,
        node.translation.map_or(DVec3::ZERO, DVec3::from_array),
    )
}
