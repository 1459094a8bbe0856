//! Damaged files of every format: a mesh or a message, never a panic, and no more memory than a small multiple of the file; files that copy a lot.
#![allow(unsafe_code, reason = "to count what is allocated is to be the allocator")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use forerun_geometry::Vec3;
use forerun_geometry::mesh_file::{ParseError, TriangleList, parse_gltf, parse_obj, parse_ply, parse_stl};
use forerun_geometry::shape::{Mesh, MeshDraft, MeshOptions, mesh_make};
use serde_json::json;

use crate::writers::{Ply, embedded, glb, gltf, obj, ply, stl_binary, stl_text};

thread_local! {
    static LARGEST: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator; notes the largest piece asked for.
struct Noting;

// SAFETY: it does what the system's does.
unsafe impl GlobalAlloc for Noting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST.set(LARGEST.get().max(layout.size()));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        unsafe { System.dealloc(place, layout) }
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        LARGEST.set(LARGEST.get().max(size));
        unsafe { System.realloc(place, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Noting = Noting;

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }
}

/// What stands in files that were not meant well, or well and badly written.
const WORDS: [&[u8]; 22] = [
    b"-9223372036854775808",
    b"18446744073709551615",
    b"4294967295",
    b"99999999999",
    b"nan",
    b"inf",
    b" 1e39",
    b"1e400",
    b"-1",
    b"0",
    b"f 1 2 3 4 5\n",
    b"f 1 1 2\n",
    b"/",
    b"\xff\xfe",
    b"\n",
    b"[0,0,0]",
    b"{",
    b"null",
    b"property list uchar int x\n",
    b"element face 4000000000\n",
    b"\0\0\xc0\x7f",
    b"\xff\xff\xff\xff",
];

/// Cuts, repeats, overwrites, swaps in whole words, or puts another number where one was.
fn damage(random: &mut Random, bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(4) {
        if bytes.is_empty() {
            break;
        }
        let at = random.below(bytes.len());
        let to = at + random.below(40.min(bytes.len() - at) + 1);
        match random.below(8) {
            0 => bytes.truncate(at),
            1 => bytes[at] = random.below(256) as u8,
            2 => drop(bytes.drain(at..to)),
            3 => {
                let copy = bytes[at..to].to_vec();
                let into = random.below(bytes.len());
                bytes.splice(into..into, copy);
            }
            4 => bytes[at..to].iter_mut().for_each(|b| *b = random.below(256) as u8),
            5 => drop(bytes.splice(at..to, WORDS[random.below(WORDS.len())].iter().copied())),
            _ => {
                let is_digit = |b: &u8| b.is_ascii_digit();
                let Some(start) = bytes[at..].iter().position(is_digit).map(|i| at + i) else { continue };
                let end = bytes[start..].iter().position(|b| !is_digit(b)).map_or(bytes.len(), |i| start + i);
                bytes.splice(start..end, WORDS[random.below(10)].iter().copied());
            }
        }
    }
    bytes
}

type Parse = fn(&[u8]) -> Result<TriangleList, ParseError>;

fn gltf_alone(bytes: &[u8]) -> Result<TriangleList, ParseError> {
    parse_gltf(bytes, &|_| Err("there is nothing beside it".to_owned()))
}

fn corpus() -> Vec<(&'static str, Parse, Vec<u8>)> {
    let mesh = mesh_make::cuboid(Vec3::ONE).unwrap();
    vec![
        ("obj", parse_obj as Parse, obj(&mesh)),
        ("text stl", parse_stl, stl_text(&mesh)),
        ("binary stl", parse_stl, stl_binary(&mesh)),
        ("text ply", parse_ply, ply(&mesh, Ply::Text)),
        ("little ply", parse_ply, ply(&mesh, Ply::LittleEndian)),
        ("big ply", parse_ply, ply(&mesh, Ply::BigEndian)),
        ("gltf", gltf_alone, embedded(gltf(&mesh))),
        ("glb", gltf_alone, glb(gltf(&mesh))),
    ]
}

#[test]
fn damaged_files_give_a_mesh_or_a_message() {
    for (name, parse, good) in corpus() {
        let mut random = Random(41);
        let (mut parsed, mut meshes, mut refused) = (0, 0, 0);
        for round in 0..4000 {
            let bytes = damage(&mut random, &good);
            LARGEST.set(0);
            let result = parse(&bytes);
            // Vectors double as they grow; an error text may be a little longer than a tiny file.
            let largest = LARGEST.get();
            assert!(
                largest <= 16 * bytes.len() + 4096,
                "{name} {round}: {largest} for {} bytes",
                bytes.len()
            );
            match result {
                Ok(list) => {
                    assert!(list.vertices.iter().all(|v| v.is_finite()), "{name} {round}");
                    parsed += 1;
                    // Not baked: that takes long.
                    let draft = MeshDraft::new(list.vertices, list.triangles, MeshOptions::default());
                    meshes += usize::from(draft.is_ok());
                }
                Err(error) => {
                    refused += 1;
                    let text = error.to_string();
                    assert!(!error.place.is_empty() && text.len() < 300, "{name} {round}: {text}");
                }
            }
        }
        assert!(
            parsed > 50 && meshes > 10 && refused > 500,
            "{name}: {parsed} read, {meshes} meshes, {refused} refused"
        );
    }
}

/// A document with one mesh of many parts, all alike, that many nodes use.
fn copies(nodes: usize, parts: usize, strip: usize) -> Vec<u8> {
    let (mut document, mut buffer) = gltf(&mesh_make::cuboid(Vec3::ONE).unwrap());
    document["nodes"] = vec![json!({ "mesh": 0 }); nodes].into();
    document["scenes"][0]["nodes"] = (0..nodes).collect();
    let mut part = document["meshes"][0]["primitives"][0].clone();
    if strip > 0 {
        // One corner again and again makes no triangle.
        let views = document["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": buffer.len(), "byteLength": strip }));
        buffer.extend(vec![0; strip]);
        let accessors = document["accessors"].as_array_mut().unwrap();
        accessors.push(json!({ "bufferView": 2, "componentType": 5121, "count": strip, "type": "SCALAR" }));
        document["buffers"][0]["byteLength"] = json!(buffer.len());
        part["indices"] = json!(2);
        part["mode"] = json!(5);
    }
    document["meshes"][0]["primitives"] = vec![part; parts].into();
    glb((document, buffer))
}

#[test]
fn what_nodes_copy_is_counted() {
    let bytes = copies(200, 20, 0);
    LARGEST.set(0);
    let list = gltf_alone(&bytes).unwrap();
    assert_eq!((list.vertices.len(), list.triangles.len()), (4000 * 8, 4000 * 12));
    // Vectors double as they grow.
    let largest = LARGEST.get();
    assert!(largest <= 16 * bytes.len() + 2 * size_of_val(&*list.triangles), "{largest}");
    // A megabyte, read again and again for nothing.
    let refused = gltf_alone(&copies(100, 20, 1 << 20)).unwrap_err().to_string();
    assert!(refused.contains("vertices and corners with all its copies"), "{refused}");
}

#[test]
fn every_cut_is_noticed_and_every_byte_may_be_anything() {
    for (name, parse, good) in corpus() {
        assert!(parse(&good).is_ok(), "{name}");
        for length in 0..good.len() {
            // A cut behind the last number goes unnoticed in formats that have no end.
            if let Ok(list) = parse(&good[..length]) {
                assert!(
                    name == "obj" || length + 16 > good.len(),
                    "{name} cut at {length}: {}",
                    list.triangles.len()
                );
            }
        }
        let mut random = Random(7);
        for at in 0..good.len() {
            let mut bytes = good.clone();
            bytes[at] = random.below(256) as u8;
            let _ = parse(&bytes);
        }
        let noise: Vec<u8> = (0..2000).map(|_| random.below(256) as u8).collect();
        assert!(parse(&noise).is_err() && parse(&[]).is_err(), "{name}");
    }
}

#[test]
fn bad_surfaces_of_good_files_are_mended_or_refused_by_name() {
    let cube = mesh_make::cuboid(Vec3::ONE).unwrap();
    let make = |change: &dyn Fn(&mut TriangleList)| {
        let mut list = TriangleList { vertices: cube.vertices.clone(), triangles: cube.triangles.clone() };
        change(&mut list);
        Mesh::new(list.vertices, list.triangles)
    };
    // All faces turned, doubled corners, a face that is a line.
    let turned = make(&|list| list.triangles.iter_mut().for_each(|t| t.swap(1, 2))).unwrap();
    assert!(turned.repairs.turned);
    let with_line = make(&|list| list.triangles.push([0, 0, 1])).unwrap();
    assert_eq!(with_line.repairs.dropped_triangles, 1);
    for (index, expected) in [(u32::MAX, "names vertex 4294967295"), (8, "names vertex 8")] {
        let error = make(&|list| list.triangles[3][1] = index).unwrap_err().to_string();
        assert!(error.contains("triangle 3") && error.contains(expected), "{error}");
    }
    for bad in [f32::NAN, f32::INFINITY] {
        let error = make(&|list| list.vertices[5].y = bad).unwrap_err().to_string();
        assert!(error.contains("vertex 5") && error.contains("finite"), "{error}");
    }
    // Far out, but finite: no panic, no endless grid.
    for huge in [1e19, f32::MAX] {
        let _ = make(&|list| list.vertices[5].y = huge);
        let _ = make(&|list| list.vertices.iter_mut().for_each(|v| *v *= huge));
        let _ = make(&|list| list.vertices.iter_mut().for_each(|v| *v /= huge));
    }
    let empty = make(&|list| list.triangles.clear()).unwrap_err().to_string();
    assert!(empty.contains("no triangles"), "{empty}");
}
