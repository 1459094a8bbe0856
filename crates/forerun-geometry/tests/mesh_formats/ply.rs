//! PLY files of all three encodings.

use forerun_geometry::mesh_file::parse_ply;
use forerun_geometry::shape::mesh_make;

use crate::writers::{Ply, ply};

#[test]
fn all_encodings_give_the_same_triangles() {
    let torus = mesh_make::torus(0.4, 0.15, 20, 10).unwrap();
    for kind in [Ply::Text, Ply::LittleEndian, Ply::BigEndian] {
        let list = parse_ply(&ply(&torus, kind)).unwrap();
        assert_eq!(list.vertices, torus.vertices, "{kind:?}");
        assert_eq!(list.triangles, torus.triangles, "{kind:?}");
    }
}
