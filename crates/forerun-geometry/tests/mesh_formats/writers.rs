//! Writers of every format, so that no foreign file is needed.

use forerun_geometry::shape::Mesh;
use serde_json::{Value, json};

/// Wavefront OBJ.
pub(crate) fn obj(mesh: &Mesh) -> Vec<u8> {
    let mut text = String::from("# a mesh\no thing\n");
    for v in &mesh.vertices {
        text += &format!("v {} {} {}\n", v.x, v.y, v.z);
    }
    for t in &mesh.triangles {
        text += &format!("f {}//1 {}//1 {}//1\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    text.into_bytes()
}

/// STL as text.
pub(crate) fn stl_text(mesh: &Mesh) -> Vec<u8> {
    let mut text = String::from("solid thing\n");
    for t in 0..mesh.triangles.len() {
        text += "facet normal 0 0 0\n outer loop\n";
        for v in mesh.corners(t) {
            text += &format!("  vertex {:e} {:e} {:e}\n", v.x, v.y, v.z);
        }
        text += " endloop\nendfacet\n";
    }
    (text + "endsolid thing\n").into_bytes()
}

/// Binary STL.
pub(crate) fn stl_binary(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for t in 0..mesh.triangles.len() {
        bytes.extend([0; 12]);
        bytes.extend(mesh.corners(t).iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

/// How a PLY file is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ply {
    Text,
    LittleEndian,
    BigEndian,
}

/// PLY with normals and colours that nobody asked for.
pub(crate) fn ply(mesh: &Mesh, kind: Ply) -> Vec<u8> {
    let format = match kind {
        Ply::Text => "ascii",
        Ply::LittleEndian => "binary_little_endian",
        Ply::BigEndian => "binary_big_endian",
    };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\ncomment made by a test\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property double nx\nproperty uchar red\nelement face {}\nproperty list uchar int vertex_indices\nproperty short flags\nend_header\n",
        mesh.vertices.len(),
        mesh.triangles.len()
    )
    .into_bytes();
    let big = kind == Ply::BigEndian;
    for v in &mesh.vertices {
        if kind == Ply::Text {
            bytes.extend(format!("{} {} {} 0.5 255\n", v.x, v.y, v.z).bytes());
            continue;
        }
        bytes.extend(v.to_array().iter().flat_map(|x| if big { x.to_be_bytes() } else { x.to_le_bytes() }));
        bytes.extend([0; 9]);
    }
    for t in &mesh.triangles {
        if kind == Ply::Text {
            bytes.extend(format!("3 {} {} {} -7\n", t[0], t[1], t[2]).bytes());
            continue;
        }
        bytes.push(3);
        bytes.extend(t.iter().flat_map(|i| if big { i.to_be_bytes() } else { i.to_le_bytes() }));
        bytes.extend([1, 2]);
    }
    bytes
}

/// A glTF document with one mesh, and its buffer: positions, then indices. The buffer has no uri yet.
pub(crate) fn gltf(mesh: &Mesh) -> (Value, Vec<u8>) {
    let mut buffer: Vec<u8> =
        mesh.vertices.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes).collect();
    let positions = buffer.len();
    buffer.extend(mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()));
    let document = json!({
        "asset": { "version": "2.0", "generator": "a test" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": mesh.vertices.len(), "type": "VEC3",
              "min": mesh.bounds().min.to_array(), "max": mesh.bounds().max.to_array() },
            { "bufferView": 1, "componentType": 5125, "count": mesh.triangles.len() * 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": positions },
            { "buffer": 0, "byteOffset": positions, "byteLength": buffer.len() - positions },
        ],
        "buffers": [{ "byteLength": buffer.len() }],
    });
    (document, buffer)
}

/// The document with its buffer in its text.
pub(crate) fn embedded((mut document, buffer): (Value, Vec<u8>)) -> Vec<u8> {
    document["buffers"][0]["uri"] =
        Value::from(format!("data:application/octet-stream;base64,{}", base64(&buffer)));
    document.to_string().into_bytes()
}

/// The document and its buffer as GLB.
pub(crate) fn glb((document, mut buffer): (Value, Vec<u8>)) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF".to_vec();
    let total = 12 + 8 + json.len() + 8 + buffer.len();
    for word in [2, total as u32, json.len() as u32] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((buffer.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(buffer);
    bytes
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let word = (0..3).fold(0_u32, |word, i| word << 8 | u32::from(*chunk.get(i).unwrap_or(&0)));
        for i in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * i) & 63) as usize] as char;
            text.push(if i <= chunk.len() { digit } else { '=' });
        }
    }
    text
}
