//! Where a mesh comes from, and the table of a scene file that says so: a field for each source, of which exactly one is given.

use serde::{Deserialize, Serialize};

use super::formula::{
    BallEntry, BoltEntry, BowlEntry, ChairEntry, Formula, GearEntry, JackEntry, LetterEntry, LinkEntry,
    MugEntry, NutEntry, TerrainEntry, TorusEntry, TorusKnotEntry,
};
use super::{MeshEntry, UpEntry};
use crate::write::inline;

/// What to make of a source.
pub(super) enum Origin<'a> {
    File(&'a str),
    /// The field of the table, and the formula.
    Formula(&'static str, &'a dyn Formula),
}

/// The sources by formula: the enum, its field in the table, and the way from one to the other.
macro_rules! sources {
    ($($(#[$doc:meta])* $field:ident: $kind:ident($entry:ty),)+) => {
        /// Where a mesh comes from.
        #[derive(Clone, Debug, PartialEq)]
        pub enum MeshSource {
            /// An OBJ, STL, PLY or glTF file. A relative name starts at the folder of the scene file.
            File(String),
            $($(#[$doc])* $kind($entry),)+
        }

        $(impl From<$entry> for MeshSource {
            fn from(entry: $entry) -> MeshSource {
                MeshSource::$kind(entry)
            }
        })+

        impl MeshSource {
            pub(super) fn origin(&self) -> Origin<'_> {
                match self {
                    MeshSource::File(name) => Origin::File(name),
                    $(MeshSource::$kind(entry) => Origin::Formula(stringify!($field), entry),)+
                }
            }

            /// The field of the table and its value, as TOML has them.
            pub(crate) fn to_toml(&self) -> (&'static str, String) {
                match self {
                    MeshSource::File(name) => ("file", inline(name)),
                    $(MeshSource::$kind(entry) => (stringify!($field), inline(entry)),)+
                }
            }
        }

        /// A mesh as a scene file has it.
        #[derive(Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(super) struct MeshTable {
            #[serde(default, skip_serializing_if = "Option::is_none")]
            file: Option<String>,
            $(#[serde(default, skip_serializing_if = "Option::is_none")]
            $field: Option<$entry>,)+
            #[serde(default = "one", skip_serializing_if = "is_one")]
            scale: f32,
            #[serde(default, skip_serializing_if = "UpEntry::is_y")]
            up: UpEntry,
            #[serde(default, skip_serializing_if = "Option::is_none")]
            cell: Option<f32>,
            #[serde(default, skip_serializing_if = "is_false")]
            open: bool,
        }

        impl TryFrom<MeshTable> for MeshEntry {
            type Error = String;

            fn try_from(table: MeshTable) -> Result<MeshEntry, String> {
                let MeshTable { file, $($field,)+ scale, up, cell, open } = table;
                let given = [file.map(MeshSource::File), $($field.map(MeshSource::$kind),)+];
                let mut given = given.into_iter().flatten();
                match (given.next(), given.next()) {
                    (Some(source), None) => Ok(MeshEntry { source, scale, up, cell, open }),
                    _ => Err(format!("a mesh has exactly one of {}", ["file", $(stringify!($field),)+].join(", "))),
                }
            }
        }

        impl From<MeshEntry> for MeshTable {
            fn from(MeshEntry { source, scale, up, cell, open }: MeshEntry) -> MeshTable {
                let mut table = MeshTable { file: None, $($field: None,)+ scale, up, cell, open };
                match source {
                    MeshSource::File(name) => table.file = Some(name),
                    $(MeshSource::$kind(entry) => table.$field = Some(entry),)+
                }
                table
            }
        }
    };
}

sources! {
    /// A ring.
    torus: Torus(TorusEntry),
    /// A closed tube that winds round a torus.
    torus_knot: TorusKnot(TorusKnotEntry),
    /// A ball made of triangles.
    ball: Ball(BallEntry),
    /// A bowl that opens upwards.
    bowl: Bowl(BowlEntry),
    /// A mug with a handle.
    mug: Mug(MugEntry),
    /// A gear with involute teeth.
    gear: Gear(GearEntry),
    /// A capital letter.
    letter: Letter(LetterEntry),
    /// A chair.
    chair: Chair(ChairEntry),
    /// The toy with six knobs.
    jack: Jack(JackEntry),
    /// A link of a chain.
    link: Link(LinkEntry),
    /// A bolt with a thread.
    bolt: Bolt(BoltEntry),
    /// A nut with a thread.
    nut: Nut(NutEntry),
    /// Hills: an open mesh.
    terrain: Terrain(TerrainEntry),
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
