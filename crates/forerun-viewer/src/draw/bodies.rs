//! Bodies: where all of them are drawn, and in which colours.

use std::sync::Arc;

use forerun::{Body, BodyId, Pose, Shape};
use three_d::Context;

use super::colours::Paint;
use super::crowd::{Crowd, Drawn, Mark, Seat};
use super::shadow::SunBox;
use super::surface::Surfaces;
use super::{Scenery, glass};

/// A body and where it sits in the crowd, as long as it is what it is.
struct Known {
    id: BodyId,
    body: Arc<Body>,
    seat: Option<Seat>,
}

/// All bodies of a scene. Keeps its memory from picture to picture.
#[derive(Default)]
pub(super) struct Bodies {
    pub(super) crowd: Crowd,
    /// Those that are seen through, because they hide what moves.
    pub(super) glass: Crowd,
    /// Those that are selected, once more: for their outline.
    pub(super) chosen: Crowd,
    pub(super) surfaces: Surfaces,
    /// The half-spaces.
    pub(super) planes: Vec<Pose>,
    /// What casts shadows.
    pub(super) casters: SunBox,
    /// How far from the target of the camera there are bodies. Metres.
    pub(super) reach: f32,
    /// Whether somebody stands elsewhere than in the picture before.
    pub(super) moved: bool,
    known: Vec<Known>,
    selected: Vec<BodyId>,
    hiding: Vec<BodyId>,
}

impl Default for SunBox {
    fn default() -> Self {
        SunBox::EMPTY
    }
}

impl Bodies {
    /// Another scene: nothing is known any more.
    pub(super) fn forget(&mut self) {
        *self = Bodies::default();
    }

    /// Places everybody for a picture. `cut`: who is drawn cut open.
    pub(super) fn place(&mut self, context: &Context, scenery: &Scenery<'_>, cut: Option<BodyId>) {
        let Scenery { play, camera, view, extras, .. } = *scenery;
        let paint = Paint::of(play, view.colour_by, scenery.inside);
        self.crowd.begin();
        self.chosen.begin();
        self.glass.begin();
        glass::hiding(play, camera.eye(), &mut self.hiding);
        self.planes.clear();
        (self.casters, self.reach) = (SunBox::EMPTY, 0.0);
        self.selected.clear();
        self.selected.extend(play.selection.bodies());
        self.selected.sort_unstable();
        let mut number = 0;
        for (id, sample) in &play.samples {
            let Some(body) = play.body(*id) else { continue };
            let pose = &sample.pose;
            if matches!(body.shape, Shape::HalfSpace) {
                self.planes.push(*pose);
                continue;
            }
            let Some(seat) = self.seat(context, number, *id, body) else { continue };
            number += 1;
            let [red, green, blue] = paint.colour(*id, body, sample);
            let mark = match *id {
                id if cut == Some(id) => Mark::Cut,
                id if extras.pointed == Some(id) => Mark::Pointed,
                _ => Mark::None,
            };
            let drawn = Drawn { shape: &body.shape, pose, ink: [red, green, blue, 255], mark };
            if self.hiding.binary_search(id).is_ok() {
                add(&mut self.glass, context, &mut self.surfaces, &drawn);
            } else {
                self.crowd.add(seat, &drawn);
            }
            let radius = reach_of(body);
            self.casters.add(pose.position, radius);
            self.reach = self.reach.max((pose.position - camera.target).length() + radius);
            if self.selected.binary_search(id).is_ok() {
                add(&mut self.chosen, context, &mut self.surfaces, &drawn);
            }
        }
        self.known.truncate(number);
        self.moved = self.crowd.send();
        self.chosen.send();
        self.glass.send();
    }

    /// The seat of the body that is drawn after so many others: mostly that of the picture before.
    fn seat(&mut self, context: &Context, number: usize, id: BodyId, body: &Arc<Body>) -> Option<Seat> {
        if let Some(known) = self.known.get(number)
            && known.id == id
            && Arc::ptr_eq(&known.body, body)
        {
            return known.seat;
        }
        let seat = self.crowd.seat(context, &mut self.surfaces, &body.shape);
        let now = Known { id, body: Arc::clone(body), seat };
        match self.known.get_mut(number) {
            Some(known) => *known = now,
            None => self.known.push(now),
        }
        seat
    }
}

/// Adds a body to a crowd of few.
fn add(crowd: &mut Crowd, context: &Context, surfaces: &mut Surfaces, drawn: &Drawn<'_>) {
    if let Some(seat) = crowd.seat(context, surfaces, drawn.shape) {
        crowd.add(seat, drawn);
    }
}

/// How far from where a body is its surface may be. Metres.
fn reach_of(body: &Body) -> f32 {
    let reach = body.radius + body.frame.position.length();
    if reach.is_finite() { reach } else { 0.0 }
}
