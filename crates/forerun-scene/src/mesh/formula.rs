//! Meshes made by a formula: how a scene file writes the parameters of each maker.

use forerun_geometry::shape::mesh_make::{
    Ball, Bolt, Bowl, Chair, Gear, Grip, Jack, Letter, Link, Mug, Nut, Terrain, Thread, Torus, TorusKnot,
};
use forerun_geometry::shape::{ShapeError, TriangleList};
use serde::{Deserialize, Serialize};

/// A maker with its parameters. The ranges are the maker's own.
pub(super) trait Formula {
    fn check(&self) -> Result<(), ShapeError>;
    fn triangles(&self) -> Result<TriangleList, ShapeError>;
}

/// Entries with the fields of a maker, under the same names.
macro_rules! formulas {
    ($(
        $(#[$doc:meta])*
        $entry:ident is $maker:ident { $($(#[$field_doc:meta])* $field:ident: $kind:ty,)+ }
    )+) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $entry { $($(#[$field_doc])* pub $field: $kind,)+ }

        impl From<$entry> for $maker {
            fn from(entry: $entry) -> $maker {
                $maker { $($field: entry.$field.into(),)+ }
            }
        }

        impl Formula for $entry {
            fn check(&self) -> Result<(), ShapeError> {
                $maker::from(*self).check()
            }

            fn triangles(&self) -> Result<TriangleList, ShapeError> {
                $maker::from(*self).triangles()
            }
        }
    )+};
}

formulas! {
    /// A torus about the y axis.
    TorusEntry is Torus {
        /// From the axis to the middle of the tube. Metres, above `tube_radius`.
        radius: f32,
        /// Radius of the tube. Metres, above 0.
        tube_radius: f32,
        /// Points along the ring. 3 to 1024.
        segments: u32,
        /// Points round the tube. 3 to 1024.
        sides: u32,
    }

    /// A tube along a (p, q) torus knot about the y axis: p turns about the axis while it winds q times round the ring.
    TorusKnotEntry is TorusKnot {
        /// Turns about the axis. 1 to 12, without a common factor with `q`.
        p: u32,
        /// Windings round the ring. 1 to 12.
        q: u32,
        /// Radius of the ring that the tube winds round. Metres, above `winding_radius`.
        radius: f32,
        /// How far the middle of the tube is from the ring. Metres, above 0.
        winding_radius: f32,
        /// Radius of the tube. Metres, above 0 and so small that the tube does not cut itself.
        tube_radius: f32,
        /// Points along the tube. 16 to 4096.
        segments: u32,
        /// Points round the tube. 3 to 1024.
        sides: u32,
    }

    /// A ball of triangles about the origin: an icosahedron whose edges are cut into parts.
    BallEntry is Ball {
        /// Metres, above 0.
        radius: f32,
        /// 1 to 128: the ball has 20 times as many triangles as this squared.
        parts: u32,
    }

    /// A bowl about the y axis that stands on y = 0 and opens upwards.
    BowlEntry is Bowl {
        /// From the axis to the outside of the rim. Metres, above 0.
        radius: f32,
        /// Radius of the flat foot. Metres, above 0 and below `radius` by more than `thickness`.
        foot_radius: f32,
        /// From the foot to where the rounding of the rim begins. Metres, above `thickness`.
        height: f32,
        /// Of wall and bottom. Metres, above 0.
        thickness: f32,
        /// Points round the rim. 8 to 1024.
        segments: u32,
    }

    /// A mug about the y axis that stands on y = 0 and has its handle towards +x.
    MugEntry is Mug {
        /// Of the cup outside. Metres, above 0.
        radius: f32,
        /// From foot to rim. Metres, above 0.
        height: f32,
        /// Of wall and bottom. Metres, above 0 and below a third of `radius` and `height`.
        thickness: f32,
        /// Radius of the handle's section. Metres, above 0 and small enough for the handle to bend.
        handle_radius: f32,
        /// How far the middle of the handle stands out from the wall. Metres, above 0.
        handle_reach: f32,
        /// Points round the cup. 16 to 1024.
        segments: u32,
    }

    /// A gear about the y axis with involute teeth of 20 degrees.
    GearEntry is Gear {
        /// How many. 6 to 200.
        teeth: u32,
        /// Diameter of the pitch circle for each tooth. Metres, above 0.
        module: f32,
        /// Half the width along the axis. Metres, above 0.
        half_width: f32,
        /// Radius of the hole about the axis. Metres, above 0 and below nine tenths of the circle at the feet of the teeth.
        bore: f32,
    }

    /// A capital letter in the x-y plane, read from +z.
    LetterEntry is Letter {
        /// `A` to `Z`.
        letter: char,
        /// From foot to top. Metres, above 0.
        height: f32,
        /// Thickness along z. Metres, above 0 and at most 10 times `height`.
        depth: f32,
    }

    /// A chair that stands on y = 0 and faces +z.
    ChairEntry is Chair {
        /// Of seat and back, along x. Metres, above 3 `bar`.
        width: f32,
        /// Of the seat, along z. Metres, above 3 `bar`.
        depth: f32,
        /// From the floor to the top of the seat. Metres, above 2 `bar`.
        seat_height: f32,
        /// From the floor to the top of the back. Metres, above `seat_height` by more than 3 `bar`.
        height: f32,
        /// Thickness of legs, seat and posts. Metres, above 0.
        bar: f32,
    }

    /// A jack: the toy with six knobs.
    JackEntry is Jack {
        /// From the middle to the end of an arm. Metres, above 4 `knob_radius`.
        reach: f32,
        /// Radius of an arm. Metres, above 0 and at most `knob_radius`.
        arm_radius: f32,
        /// Radius of a knob. Metres, above 0.
        knob_radius: f32,
        /// Cells along the whole jack: the finer, the more triangles. 16 to 256.
        cells: u32,
    }

    /// A square of hills; an open mesh, to be used with `open = true`.
    TerrainEntry is Terrain {
        /// Half of a side of the square. Metres, above 0.
        half_width: f32,
        /// The highest possible place; the lowest is 0. Metres, above 0 and below `hill`.
        height: f32,
        /// From one large hill to the next. Metres, above 0 and below 2 `half_width`.
        hill: f32,
        /// Cells along a side. 1 to 1024.
        cells: u32,
        /// Another number, another terrain.
        seed: u32,
    }

    /// A link of a chain in the plane y = 0, long along x.
    LinkEntry is Link {
        /// Radius of the bends, to the middle of the tube. Metres, above `tube_radius`.
        radius: f32,
        /// Length of each straight. Metres, 0 or more.
        straight: f32,
        /// Radius of the tube. Metres, above 0.
        tube_radius: f32,
        /// Parts that each bend is cut into. 2 to 512.
        bend_parts: u32,
        /// Points round the tube. 3 to 1024.
        sides: u32,
    }

    /// A bolt about the y axis: its shank from y = -`length` to 0, then the head.
    BoltEntry is Bolt {
        /// The thread, all along the shank.
        thread: ThreadEntry,
        /// Length of the shank. Metres, at least a pitch.
        length: f32,
        /// From the axis to the flat of the head. Metres, above the radius of the thread.
        head_radius: f32,
        /// Height of the head. Metres, above 0.
        head_height: f32,
        /// What the head looks like from above.
        head: GripEntry,
        /// Columns of points round the axis: a multiple of 6 from 12 to 384.
        segments: u32,
    }

    /// A nut about the y axis, centred on the origin.
    NutEntry is Nut {
        /// The thread of the bolt that it is for.
        thread: ThreadEntry,
        /// How much larger the radius of its own thread is at every height. Metres, 0 or more.
        clearance: f32,
        /// Height. Metres, at least a pitch.
        height: f32,
        /// From the axis to the flat of the outside. Metres, above the radius of the thread with clearance and a tenth of the pitch.
        outer_radius: f32,
        /// What the outside looks like from above.
        outside: GripEntry,
        /// Columns of points round the axis: a multiple of 6 from 12 to 384.
        segments: u32,
    }
}

/// The thread of a bolt.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThreadEntry {
    /// From the axis to the crest. Metres.
    pub radius: f32,
    /// How far a full turn goes along the axis. Metres, above 0 and at most `radius`.
    pub pitch: f32,
}

impl From<ThreadEntry> for Thread {
    fn from(ThreadEntry { radius, pitch }: ThreadEntry) -> Thread {
        Thread { radius, pitch }
    }
}

/// What a spanner grips.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GripEntry {
    /// A regular hexagon.
    Hexagonal,
    /// A circle.
    Round,
}

impl From<GripEntry> for Grip {
    fn from(entry: GripEntry) -> Grip {
        match entry {
            GripEntry::Hexagonal => Grip::Hexagonal,
            GripEntry::Round => Grip::Round,
        }
    }
}
