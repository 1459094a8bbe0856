//! Crowds: many bodies at once, those of one look in one call of the graphics card.
//!
//! Promise: a picture in which nothing changed sends nothing; one in which bodies moved sends 32 bytes for each body of the looks that moved.

use std::collections::BTreeMap;

use forerun::{Pose, Shape};
use three_d::{Context, InstanceBuffer, Program, RenderStates, Viewport};

use super::surface::{Look, Surfaces, look_of, scale_of};

/// A body as it is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn<'a> {
    pub(super) shape: &'a Shape,
    pub(super) pose: &'a Pose,
    /// Red, green, blue, opacity.
    pub(super) ink: [u8; 4],
    pub(super) mark: Mark,
}

/// How a body is marked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Mark {
    #[default]
    None = 0,
    /// A click would pick it.
    Pointed = 1,
    /// Cut open.
    Cut = 3,
}

/// One row a body.
#[derive(Clone, Debug, Default, PartialEq)]
struct Rows {
    places: Vec<[f32; 4]>,
    turns: Vec<[f32; 4]>,
    sizes: Vec<[f32; 4]>,
    inks: Vec<[u8; 4]>,
}

/// Bodies of one look.
struct Batch {
    look: Look,
    /// What was sent to the graphics card, and what is to be.
    sent: Rows,
    next: Rows,
    places: InstanceBuffer<[f32; 4]>,
    turns: InstanceBuffer<[f32; 4]>,
    sizes: InstanceBuffer<[f32; 4]>,
    inks: InstanceBuffer<[u8; 4]>,
}

/// Where bodies of a look are in their crowd.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Seat(u32);

/// Bodies that are drawn together. Keeps its memory from picture to picture.
#[derive(Default)]
pub(super) struct Crowd {
    seats: BTreeMap<Look, Seat>,
    batches: Vec<Batch>,
}

impl Crowd {
    /// Nobody is here yet.
    pub(super) fn begin(&mut self) {
        for batch in &mut self.batches {
            let Rows { places, turns, sizes, inks } = &mut batch.next;
            places.clear();
            turns.clear();
            sizes.clear();
            inks.clear();
        }
    }

    /// The seat of a shape's look; none for half-spaces.
    pub(super) fn seat(&mut self, context: &Context, surfaces: &mut Surfaces, shape: &Shape) -> Option<Seat> {
        let look = look_of(shape)?;
        let next = Seat(self.batches.len() as u32);
        let seat = *self.seats.entry(look).or_insert(next);
        if seat == next {
            surfaces.prepare(context, look, shape);
            self.batches.push(Batch {
                look,
                sent: Rows::default(),
                next: Rows::default(),
                places: InstanceBuffer::new(context),
                turns: InstanceBuffer::new(context),
                sizes: InstanceBuffer::new(context),
                inks: InstanceBuffer::new(context),
            });
        }
        Some(seat)
    }

    /// Adds a body at the seat of its look.
    pub(super) fn add(&mut self, seat: Seat, drawn: &Drawn<'_>) {
        let Some(Batch { next, .. }) = self.batches.get_mut(seat.0 as usize) else { return };
        let (p, scale) = (drawn.pose.position, scale_of(drawn.shape));
        next.places.push([p.x, p.y, p.z, drawn.mark as u8 as f32]);
        next.turns.push(drawn.pose.rotation.to_array());
        next.sizes.push([scale.x, scale.y, scale.z, 0.0]);
        next.inks.push(drawn.ink);
    }

    /// Sends what changed. Whether somebody stands elsewhere, or has come or gone.
    pub(super) fn send(&mut self) -> bool {
        let mut moved = false;
        for batch in &mut self.batches {
            let Batch { sent, next, places, turns, sizes, inks, .. } = batch;
            moved |= send(places, &mut sent.places, &mut next.places);
            moved |= send(turns, &mut sent.turns, &mut next.turns);
            moved |= send(sizes, &mut sent.sizes, &mut next.sizes);
            send(inks, &mut sent.inks, &mut next.inks);
        }
        moved
    }

    /// Whether nobody is here.
    pub(super) fn is_empty(&self) -> bool {
        self.batches.iter().all(|batch| batch.sent.places.is_empty())
    }

    /// Draws everybody.
    pub(super) fn draw(
        &self,
        program: &Program,
        states: RenderStates,
        viewport: Viewport,
        surfaces: &Surfaces,
    ) {
        for batch in self.batches.iter().filter(|batch| !batch.sent.places.is_empty()) {
            let Some(surface) = surfaces.get(batch.look) else { continue };
            let count = batch.sent.places.len();
            let triangles = surface.triangles(count);
            program.use_vertex_attribute("position", &triangles.positions);
            if program.requires_attribute("normal") {
                program.use_vertex_attribute("normal", &triangles.normals);
            }
            program.use_instance_attribute("place", &batch.places);
            program.use_instance_attribute("turn", &batch.turns);
            program.use_instance_attribute("size", &batch.sizes);
            if program.requires_attribute("ink") {
                program.use_instance_attribute("ink", &batch.inks);
            }
            program.draw_elements_instanced(states, viewport, &triangles.corners, count as u32);
        }
    }
}

/// Sends one column if it changed.
fn send<T: three_d::BufferDataType + PartialEq>(
    buffer: &mut InstanceBuffer<T>,
    sent: &mut Vec<T>,
    next: &mut Vec<T>,
) -> bool {
    let changed = sent != next;
    if changed {
        std::mem::swap(sent, next);
        if !sent.is_empty() {
            buffer.fill(sent);
        }
    }
    changed
}
