//! glTF files: where buffers may be, where nodes put meshes, what primitives are made of.

use std::path::Path;

use forerun_geometry::Vec3;
use forerun_geometry::mesh_file::{MeshFileOptions, TriangleList, load_triangles, parse_gltf};
use forerun_geometry::shape::{Mesh, mesh_make};
use serde_json::{Value, json};

use crate::writers::{embedded, glb, gltf};

fn torus() -> Mesh {
    mesh_make::torus(0.4, 0.15, 20, 10).unwrap()
}

fn nothing_beside(_: &str) -> Result<Vec<u8>, String> {
    Err("there is nothing beside it".to_owned())
}

fn parse(bytes: &[u8]) -> Result<TriangleList, String> {
    parse_gltf(bytes, &nothing_beside).map_err(|error| error.to_string())
}

#[test]
fn buffers_may_be_inside_beside_or_in_the_text() {
    let torus = torus();
    let parts = gltf(&torus);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gltf beside");
    std::fs::create_dir_all(&folder).unwrap();
    let (mut document, buffer) = parts.clone();
    document["buffers"][0]["uri"] = Value::from("the%20buffer.bin");
    std::fs::write(folder.join("the buffer.bin"), &buffer).unwrap();
    for (name, bytes) in [
        ("beside.gltf", document.to_string().into_bytes()),
        ("text.gltf", embedded(parts.clone())),
        ("inside.glb", glb(parts)),
    ] {
        std::fs::write(folder.join(name), bytes).unwrap();
        let list = load_triangles(folder.join(name), MeshFileOptions::default()).unwrap();
        assert_eq!(
            (list.vertices, list.triangles),
            (torus.vertices.clone(), torus.triangles.clone()),
            "{name}"
        );
    }
}

/// A document with a tree of nodes: turned, moved, stretched, mirrored, and a mesh that is used twice.
fn tree() -> Vec<u8> {
    let (mut document, buffer) = gltf(&torus());
    document["scenes"] = json!([{ "nodes": [] }, { "nodes": [0, 3] }]);
    document["scene"] = json!(1);
    document["nodes"] = json!([
        { "children": [1, 2], "translation": [1.0, 2.0, 3.0], "rotation": [0.5, 0.5, 0.5, 0.5], "scale": [2.0, 2.0, 2.0] },
        { "mesh": 0, "matrix": [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0, 0.0, 1.0] },
        { "children": [] },
        { "mesh": 0, "scale": [-1.0, 1.0, 1.0] },
    ]);
    glb((document, buffer))
}

/// All triangles of the default scene as the `gltf` crate reads them.
fn as_the_crate_reads_them(bytes: &[u8]) -> Vec<[Vec3; 3]> {
    fn visit(node: &gltf::Node<'_>, parent: glam::Mat4, blob: &[u8], found: &mut Vec<[Vec3; 3]>) {
        let placed = parent * glam::Mat4::from_cols_array_2d(&node.transform().matrix());
        for primitive in node.mesh().into_iter().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>()) {
            let reader = primitive.reader(|_| Some(blob));
            let positions: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
            let corners: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
            for [a, b, c] in corners.as_chunks::<3>().0 {
                found.push([a, b, c].map(|i| placed.transform_point3(positions[*i as usize])));
            }
        }
        node.children().for_each(|child| visit(&child, placed, blob, found));
    }
    let document = gltf::Gltf::from_slice(bytes).unwrap();
    let blob = document.blob.clone().unwrap();
    let mut found = Vec::new();
    for node in document.default_scene().unwrap().nodes() {
        visit(&node, glam::Mat4::IDENTITY, &blob, &mut found);
    }
    found
}

#[test]
fn nodes_put_meshes_where_the_gltf_crate_puts_them() {
    let bytes = tree();
    let list = parse(&bytes).unwrap();
    let theirs = as_the_crate_reads_them(&bytes);
    assert_eq!(list.triangles.len(), 800);
    assert_eq!(theirs.len(), 800);
    for (i, (own, their)) in list.triangles.iter().zip(&theirs).enumerate() {
        let mut own = own.map(|i| list.vertices[i as usize]);
        // The second copy is mirrored: its winding is turned so that normals stay outside.
        if i >= 400 {
            own.swap(1, 2);
        }
        for (a, b) in own.iter().zip(their) {
            assert!(a.distance(*b) < 1e-5, "triangle {i}: {a} and {b}");
        }
    }
    let mesh = Mesh::new(list.vertices, list.triangles).unwrap();
    assert!(mesh.has_inside() && !mesh.repairs.turned);
}

/// The document with one primitive anew, and bytes behind its buffer.
fn with_primitive(
    primitive: Value,
    change: impl FnOnce(&mut Value, &mut Vec<u8>),
) -> Result<TriangleList, String> {
    let quad = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 3 2 4\n";
    let list = forerun_geometry::mesh_file::parse_obj(quad.as_bytes()).unwrap();
    let (mut document, mut buffer) = gltf(&Mesh::open(list.vertices, list.triangles).unwrap());
    document["meshes"][0]["primitives"][0] = primitive;
    change(&mut document, &mut buffer);
    document["buffers"][0]["byteLength"] = json!(buffer.len());
    parse(&glb((document, buffer)))
}

#[test]
fn strips_fans_and_plain_vertices_make_triangles() {
    let positions = json!({ "POSITION": 0 });
    let triangles = |mode: u32| {
        let primitive = json!({ "attributes": positions, "mode": mode });
        with_primitive(primitive, |_, _| {}).map(|list| list.triangles)
    };
    assert_eq!(triangles(5).unwrap(), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(triangles(6).unwrap(), [[0, 1, 2], [0, 2, 3]]);
    let message = triangles(4).unwrap_err();
    assert_eq!(message, "meshes[0].primitives[0]: 4 corners make no whole number of triangles");
    assert!(triangles(1).unwrap_err().contains("no triangles"));
    assert_eq!(triangles(7).unwrap_err(), "meshes[0].primitives[0]: mode 7 is none of glTF");
}

#[test]
fn small_interleaved_sparse_and_quantised_numbers_are_read() {
    let primitive = json!({ "attributes": { "POSITION": 2 }, "indices": 3 });
    let list = with_primitive(primitive.clone(), |document, buffer| {
        // Positions with a number between them that is not meant, and indices of one byte.
        let at = buffer.len();
        for x in [5.0_f32, 0.0, 0.0, 9.0, 6.0, 0.0, 0.0, 9.0, 5.0, 1.0, 0.0, 9.0] {
            buffer.extend(x.to_le_bytes());
        }
        buffer.extend([0, 1, 2]);
        let views = document["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": at, "byteLength": 48, "byteStride": 16 }));
        views.push(json!({ "buffer": 0, "byteOffset": at + 48, "byteLength": 3 }));
        let accessors = document["accessors"].as_array_mut().unwrap();
        accessors.push(json!({ "bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC3" }));
        accessors.push(json!({ "bufferView": 3, "componentType": 5121, "count": 3, "type": "SCALAR" }));
    });
    assert_eq!(
        list.unwrap().vertices,
        [5.0, 6.0]
            .map(|x| Vec3::new(x, 0.0, 0.0))
            .into_iter()
            .chain([Vec3::new(5.0, 1.0, 0.0)])
            .collect::<Vec<_>>()
    );

    let primitive = json!({ "attributes": { "POSITION": 2 } });
    let sparse = with_primitive(primitive.clone(), |document, buffer| {
        // All zero but for elements 1 and 2.
        let at = buffer.len();
        for x in [7.0_f32, 0.0, 0.0, 0.0, 8.0, 0.0] {
            buffer.extend(x.to_le_bytes());
        }
        buffer.extend([1, 0, 2, 0]);
        let views = document["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": at, "byteLength": 24 }));
        views.push(json!({ "buffer": 0, "byteOffset": at + 24, "byteLength": 4 }));
        document["accessors"].as_array_mut().unwrap().push(json!({
            "componentType": 5126, "count": 3, "type": "VEC3",
            "sparse": { "count": 2, "indices": { "bufferView": 3, "componentType": 5123 }, "values": { "bufferView": 2 } },
        }));
    });
    assert_eq!(sparse.unwrap().vertices, [Vec3::ZERO, Vec3::X * 7.0, Vec3::Y * 8.0]);

    let quantised = with_primitive(primitive, |document, buffer| {
        document["extensionsRequired"] =
            json!(["KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_transform"]);
        document["nodes"][0]["scale"] = json!([2.0, 2.0, 2.0]);
        let at = buffer.len();
        for x in [0_i16, 0, 0, 0, 32767, 0, 0, 0, -32768, 0, 32767, 0] {
            buffer.extend(x.to_le_bytes());
        }
        document["bufferViews"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "buffer": 0, "byteOffset": at, "byteLength": 24, "byteStride": 8 }));
        document["accessors"].as_array_mut().unwrap().push(
            json!({ "bufferView": 2, "componentType": 5122, "normalized": true, "count": 3, "type": "VEC3" }),
        );
    });
    assert_eq!(quantised.unwrap().vertices, [Vec3::ZERO, Vec3::X * 2.0, Vec3::new(-2.0, 0.0, 2.0)]);
}

#[test]
fn errors_name_the_place_in_the_document() {
    let says = |change: &dyn Fn(&mut Value), expected: &str| {
        let (mut document, buffer) = gltf(&torus());
        change(&mut document);
        let message = parse(&glb((document, buffer))).unwrap_err();
        assert!(message.contains(expected), "\"{expected}\" is not in: {message}");
    };
    says(&|d| d["asset"]["version"] = json!("1.0"), "asset.version: must be 2.0");
    says(
        &|d| {
            d["asset"]["version"] = json!("1.0");
            d["meshes"] = json!({});
        },
        "asset.version: must be 2.0",
    );
    says(&|d| d["scene"] = json!(4), "scene: scenes[4] does not exist");
    says(&|d| d["nodes"][0]["children"] = json!([0]), "nodes[0]: has two parents");
    says(&|d| d["nodes"][0]["children"] = json!([9]), "nodes[9]: does not exist");
    says(&|d| d["nodes"][0]["mesh"] = json!(9), "meshes[9]: does not exist");
    says(&|d| d["nodes"][0]["scale"] = json!([1e300, 1, 1]), "meshes[0].primitives[0]: a vertex is at [");
    says(&|d| d["accessors"][0]["count"] = json!(100), "meshes[0].primitives[0]: vertex ");
    says(
        &|d| d["accessors"][0]["count"] = json!(u64::MAX),
        "accessors[0]: bufferViews[0] is too small for 18446744073709551615",
    );
    says(&|d| d["accessors"][0]["type"] = json!("VEC2"), "accessors[0]: must be of type VEC3");
    says(&|d| d["accessors"][1]["componentType"] = json!(5126), "accessors[1]: indices must be whole");
    says(&|d| d["accessors"][0]["componentType"] = json!(1), "accessors[0]: positions must be floating");
    says(&|d| d["bufferViews"][0]["byteLength"] = json!(9_999_999), "bufferViews[0] goes beyond the end");
    says(&|d| d["bufferViews"][0]["byteStride"] = json!(4), "elements of 4 bytes, 12 are needed");
    says(&|d| d["bufferViews"][0]["buffer"] = json!(1), "buffers[1] does not exist");
    says(
        &|d| d["buffers"][0]["byteLength"] = json!(9_999_999),
        "buffers[0]: has 7200 bytes instead of 9999999",
    );
    says(&|d| d["buffers"][0]["uri"] = json!("../x.bin"), "buffers[0]: \"../x.bin\" is not in the folder");
    says(
        &|d| d["buffers"][0]["uri"] = json!("x.bin"),
        "buffers[0]: \"x.bin\" cannot be read: there is nothing",
    );
    says(
        &|d| d["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]),
        "extensionsRequired: KHR_draco_mesh_compression is not read; export",
    );
    says(
        &|d| d["extensionsRequired"] = json!(["KHR_materials_unlit", "EXT_mesh_gpu_instancing"]),
        "extensionsRequired: EXT_mesh_gpu_instancing is not read; export the file without this extension",
    );
    says(
        &|d| {
            d["accessors"][0]["sparse"] = json!({
                "count": 1,
                "indices": { "bufferView": 0, "componentType": 5126 },
                "values": { "bufferView": 0 },
            });
        },
        "accessors[0]: sparse: indices must be whole",
    );
    says(&|d| d["meshes"] = json!([{ "primitives": [] }]), "the default scene has no triangles");
    says(&|d| d["nodes"] = json!({}), "line 1 column ");
    assert!(parse(b"{").unwrap_err().contains("line 1 column 1: EOF"), "{:?}", parse(b"{"));
    let bytes = tree();
    assert!(parse(&bytes[..bytes.len() - 8]).unwrap_err().contains("header: the file is shorter"));
}
