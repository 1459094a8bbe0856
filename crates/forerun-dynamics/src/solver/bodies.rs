//! Bodies of a batch in mass-scaled coordinates.
//!
//! A velocity is stored as `u = (v / sqrt(1/m), sqrt(I) Rᵀ ω)`, so that kinetic energy is `|u|² / 2`, and a contact row needs
//! neither masses nor inertia tensors: its Jacobian serves both to read velocities and to apply impulses.

use forerun_geometry::Vec3;

use crate::lanes::{LANES, Lanes, Row};
use crate::scratch::fill;

/// The moving quantities of a batch, one row a body. After the last body comes a dummy that pads the lanes, then the row that is written for what does
/// not move and that nobody reads, then rows that fill the last eight.
#[derive(Debug, Default)]
pub(crate) struct Bodies {
    /// Centre of mass where the contacts are looked at (3), square root of the inverse mass, of the inverse inertia (3), 1 if impulses move the body. Kinematic bodies have roots of 1, so
    /// that their velocity can be read; fixed ones of 0.
    pub(crate) centres: Vec<Row>,
    /// First and second principal axis in the world (3 + 3).
    pub(crate) axes: Vec<Row>,
    /// Static and kinetic friction, restitution, half thickness, inverse mass; how far the centre comes to where the contacts are looked at (3).
    pub(crate) surfaces: Vec<Row>,
    /// Mass-scaled change of velocity by gravity, forces and torques in a substep.
    pub(crate) kicks: Vec<Row>,
    /// Mass-scaled velocity.
    pub(crate) velocities: Vec<Row>,
    /// Velocities of the running substep before any impulse.
    pub(crate) free: Vec<Row>,
    /// What impulses did to the velocities in the last substep.
    pub(crate) pushes: Vec<Row>,
    /// Mass-scaled displacement since the start of the frame.
    pub(crate) displacements: Vec<Row>,
    /// By body: the angular velocity in the world that the contacts start from. rad/s
    pub(crate) spins: Vec<Vec3>,
    /// Bodies that a spring pulls.
    pub(crate) pulled: Vec<u32>,
}

impl Bodies {
    /// Makes room for so many bodies. Displacements and pushes are none yet.
    pub(crate) fn begin(&mut self, count: usize) {
        let rows = (count + 2).next_multiple_of(LANES);
        for list in [
            &mut self.centres,
            &mut self.axes,
            &mut self.surfaces,
            &mut self.kicks,
            &mut self.velocities,
            &mut self.free,
        ] {
            list.resize(rows, Row::default());
        }
        fill(&mut self.pushes, rows, Row::default());
        fill(&mut self.displacements, rows, Row::default());
        self.spins.resize(count, Vec3::ZERO);
        self.pulled.clear();
    }
}

impl Bodies {
    /// Makes room for so many rows that are written and not read, where there was one.
    pub(crate) fn add_unread(&mut self, count: usize) {
        let rows = self.kicks.len() - 1 + count;
        for list in
            [&mut self.velocities, &mut self.displacements, &mut self.kicks, &mut self.free, &mut self.pushes]
        {
            list.resize(rows, Row::default());
        }
    }
}

/// The indices of eight rows that follow each other.
#[inline(always)]
pub(crate) fn eight_from(start: usize) -> [u32; LANES] {
    let mut index = [0; LANES];
    for lane in 0..LANES {
        index[lane] = (start + lane) as u32;
    }
    index
}

/// A number of each of eight bodies.
pub(crate) type Column = [f32; LANES];

/// Whether lane `i` is bit `i` of the mask, as 1 or 0.
#[inline(always)]
pub(crate) fn flags<F: Lanes>(bits: u32) -> F {
    let mut column = [0.0; LANES];
    for lane in 0..LANES {
        column[lane] = (bits >> lane & 1) as f32;
    }
    F::from_array(column)
}
