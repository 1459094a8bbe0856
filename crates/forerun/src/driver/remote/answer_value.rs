//! Answer value: questions and their answers as they are in a message, and back.

use forerun_geometry::{Aabb, Shape, Vec3};
use forerun_timeline::{Frame, FrameInspection, InspectedArea, Preview, Previewed, Trail};
use serde::{Deserialize, Serialize};

use super::refusal_value::{ErrorValue, error_of, error_value};
use crate::driver::inquiry::{Answer, Answered, InquiryError, Ticket};
use crate::recording::large_shapes::{PoseValue, Three, pose_of, pose_value};
use crate::recording::orders::{ChangeValue, ToFile, change_of};
use crate::{BodyId, InspectedBody, InspectedContact, InspectedIsland, InspectedPoint, Inspection};

/// Number, and frame.
pub(super) type AskedInspectionValue = (u64, u64);

/// As [`Preview`]; the first is the number of the question.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct AskedPreviewValue(u64, u64, Vec<ChangeValue>, u32, Vec<u32>);

pub(super) fn preview_value(ticket: Ticket, preview: &Preview, to: &mut ToFile) -> AskedPreviewValue {
    let changes = preview.changes.iter().map(|change| to.change(change)).collect();
    let bodies = preview.bodies.iter().map(|body| body.0).collect();
    AskedPreviewValue(ticket.0, preview.frame.0, changes, preview.frames, bodies)
}

pub(super) fn preview_of(value: AskedPreviewValue, shapes: &[Shape]) -> Result<(Ticket, Preview), String> {
    let AskedPreviewValue(ticket, frame, changes, frames, bodies) = value;
    let changes: Result<_, String> = changes.into_iter().map(|change| change_of(change, shapes)).collect();
    let bodies = bodies.into_iter().map(BodyId).collect();
    Ok((Ticket(ticket), Preview { frame: Frame(frame), changes: changes?, frames, bodies }))
}

/// As [`Answered`].
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct AnsweredValue(u64, AnswerValue);

#[derive(Debug, Serialize, Deserialize)]
enum AnswerValue {
    Inspect {
        frame: u64,
        bodies: Vec<BodyValue>,
        islands: Vec<IslandValue>,
        contacts: Vec<ContactValue>,
        areas: Vec<AreaValue>,
    },
    /// Frame, last frame, trails: body, first frame, poses.
    Preview(u64, u64, Vec<(u32, u64, Vec<PoseValue>)>),
    NotStored(u64, u64, u64),
    Command(ErrorValue),
}

/// Lowest and highest corner.
type BoundValue = (Three, Three);

/// Body, bound, level, island, slices, whether it rests.
type BodyValue = (u32, BoundValue, Option<u32>, Option<u32>, u32, bool);

/// Name, bodies, contacts, slices, whether it rests.
type IslandValue = (u32, u32, u32, u32, bool);

/// First and second body, slice, normal, friction, points.
type ContactValue = (u32, u32, u32, Three, Three, Vec<PointValue>);

/// Position, normal, separation, impulse.
type PointValue = (Three, Three, f32, f32);

/// Name, bounds, visitors, whether it is active, clock.
type AreaValue = ([i32; 3], BoundValue, u32, bool, u64);

pub(super) fn answered_value(answered: &Answered) -> AnsweredValue {
    let value = match &answered.answer {
        Ok(Answer::Inspect(inspection)) => inspection_value(inspection),
        Ok(Answer::Preview(previewed)) => {
            let poses = |trail: &Trail| trail.poses.iter().map(pose_value).collect();
            let trails = previewed.trails.iter().map(|trail| (trail.body.0, trail.from.0, poses(trail)));
            AnswerValue::Preview(previewed.frame.0, previewed.to.0, trails.collect())
        }
        Err(InquiryError::NotStored { frame, oldest, horizon }) => {
            AnswerValue::NotStored(frame.0, oldest.0, horizon.0)
        }
        Err(InquiryError::Command(error)) => AnswerValue::Command(error_value(error)),
    };
    AnsweredValue(answered.ticket.0, value)
}

pub(super) fn answered_of(AnsweredValue(ticket, value): AnsweredValue) -> Answered {
    let answer = match value {
        AnswerValue::Inspect { frame, bodies, islands, contacts, areas } => {
            let step = Inspection {
                bodies: bodies.into_iter().map(body_of).collect(),
                islands: islands.into_iter().map(island_of).collect(),
                contacts: contacts.into_iter().map(contact_of).collect(),
            };
            let areas = areas.into_iter().map(area_of).collect();
            Ok(Answer::Inspect(FrameInspection { frame: Frame(frame), step, areas }))
        }
        AnswerValue::Preview(frame, to, trails) => {
            let trail = |(body, from, poses): (u32, u64, Vec<PoseValue>)| Trail {
                body: BodyId(body),
                from: Frame(from),
                poses: poses.into_iter().map(pose_of).collect(),
            };
            let trails = trails.into_iter().map(trail).collect();
            Ok(Answer::Preview(Previewed { frame: Frame(frame), to: Frame(to), trails }))
        }
        AnswerValue::NotStored(frame, oldest, horizon) => Err(InquiryError::NotStored {
            frame: Frame(frame),
            oldest: Frame(oldest),
            horizon: Frame(horizon),
        }),
        AnswerValue::Command(error) => Err(InquiryError::Command(error_of(error))),
    };
    Answered { ticket: Ticket(ticket), answer }
}

fn inspection_value(inspection: &FrameInspection) -> AnswerValue {
    let body = |b: &InspectedBody| {
        (b.body.0, bound_value(&b.bound), b.level, b.island.map(|island| island.0), b.slices, b.resting)
    };
    let island = |i: &InspectedIsland| (i.island.0, i.bodies, i.contacts, i.slices, i.resting);
    let point = |p: &InspectedPoint| (p.position.to_array(), p.normal.to_array(), p.separation, p.impulse);
    let contact = |c: &InspectedContact| {
        let points = c.points().iter().map(point).collect();
        (c.first.0, c.second.0, c.slice, c.normal.to_array(), c.friction.to_array(), points)
    };
    let area = |a: &InspectedArea| (a.area, bound_value(&a.bounds), a.visitors, a.active, a.clock.0);
    AnswerValue::Inspect {
        frame: inspection.frame.0,
        bodies: inspection.step.bodies.iter().map(body).collect(),
        islands: inspection.step.islands.iter().map(island).collect(),
        contacts: inspection.step.contacts.iter().map(contact).collect(),
        areas: inspection.areas.iter().map(area).collect(),
    }
}

fn bound_value(bound: &Aabb) -> BoundValue {
    (bound.min.to_array(), bound.max.to_array())
}

fn bound_of((min, max): BoundValue) -> Aabb {
    Aabb { min: Vec3::from_array(min), max: Vec3::from_array(max) }
}

fn body_of((body, bound, level, island, slices, resting): BodyValue) -> InspectedBody {
    let (body, bound, island) = (BodyId(body), bound_of(bound), island.map(BodyId));
    InspectedBody { body, bound, level, island, slices, resting }
}

fn island_of((island, bodies, contacts, slices, resting): IslandValue) -> InspectedIsland {
    InspectedIsland { island: BodyId(island), bodies, contacts, slices, resting }
}

fn contact_of((first, second, slice, normal, friction, values): ContactValue) -> InspectedContact {
    let none = InspectedPoint { position: Vec3::ZERO, normal: Vec3::ZERO, separation: 0.0, impulse: 0.0 };
    let mut points = [none; 4];
    let mut count = 0;
    for (point, (position, normal, separation, impulse)) in points.iter_mut().zip(values) {
        let (position, normal) = (Vec3::from_array(position), Vec3::from_array(normal));
        *point = InspectedPoint { position, normal, separation, impulse };
        count += 1;
    }
    InspectedContact {
        first: BodyId(first),
        second: BodyId(second),
        slice,
        normal: Vec3::from_array(normal),
        friction: Vec3::from_array(friction),
        points,
        count,
    }
}

fn area_of((area, bounds, visitors, active, clock): AreaValue) -> InspectedArea {
    InspectedArea { area, bounds: bound_of(bounds), visitors, active, clock: Frame(clock) }
}
