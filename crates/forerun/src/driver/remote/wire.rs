//! Wire: the two kinds of messages as bytes, with a checksum, and the shapes that they refer to.

use forerun_geometry::Shape;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::answer_value::{AnsweredValue, AskedInspectionValue, AskedPreviewValue};
use super::delta_value::{DeltaValue, StatsValue};
use super::refusal_value::RefusalValue;
use super::{MESSAGE_BYTES_MAX, RemoteError};
use crate::recording::large_shapes::{LargeShape, StoredShapes, large_shape_with};
use crate::recording::orders::OrderValue;

/// Begins every message: who speaks another version is not understood by chance.
const VERSION: [u8; 4] = *b"fre2";

/// From the display to the physics.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Letter {
    /// 1, 2, 3, ...
    pub(super) number: u64,
    /// The last report that was taken.
    pub(super) acknowledged: u64,
    /// The frame that is shown.
    pub(super) shown: u64,
    /// Pictures asked for so far.
    pub(super) pictures: u64,
    /// Names of bodies given so far.
    pub(super) names: u32,
    /// What was ordered before that picture, and possibly after it.
    pub(super) orders: Vec<OrderValue>,
    pub(super) inspection: Option<AskedInspectionValue>,
    pub(super) preview: Option<AskedPreviewValue>,
}

/// From the physics to the display.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Report {
    /// 1, 2, 3, ...
    pub(super) number: u64,
    /// The last letter that was taken.
    pub(super) heard: u64,
    /// In the first.
    pub(super) start: Option<Start>,
    /// From the last snapshot that was sent to the newest, unless that is the same.
    pub(super) delta: Option<DeltaValue>,
    pub(super) stats: StatsValue,
    /// Frame, most slices, active areas.
    pub(super) notes: Vec<(u64, u8, Option<u32>)>,
    /// How far back commands threw the physics since the last report.
    pub(super) dropped_to: Option<u64>,
    /// Whether all is done that may be for what the display last told.
    pub(super) done: bool,
    pub(super) refusals: Vec<RefusalValue>,
    pub(super) answers: Vec<AnsweredValue>,
    pub(super) stage_times: Vec<StageTimesValue>,
}

/// Frame, whether it is a new one, bodies recomputed and affected, time of the stages and of the rest.
pub(super) type StageTimesValue = (u64, bool, u32, u32, [f32; 6], f32);

/// What a display has to know once.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Start {
    pub(super) lookahead: u32,
    pub(super) past: u32,
    pub(super) display: u64,
    pub(super) command_capacity: u32,
    /// The next name of a body.
    pub(super) body: u32,
    /// The sequence number of the next local command.
    pub(super) sequence: u64,
}

/// A shape that is sent once, and the distance field of a mesh.
#[derive(Debug, Serialize, Deserialize)]
struct SentShape(LargeShape, Option<Vec<u8>>);

/// Writes the messages of one direction. Large shapes go before the first message that needs them.
#[derive(Debug, Default)]
pub(super) struct Writer {
    stored: StoredShapes,
}

/// Reads the messages of one direction.
#[derive(Debug, Default)]
pub(super) struct Reader {
    shapes: Vec<Shape>,
}

/// A message that was read, and the shapes that it may refer to; nothing is learned of it yet.
pub(super) struct Opened<T> {
    pub(super) message: T,
    /// Those of the messages before it, and its own.
    pub(super) shapes: Vec<Shape>,
}

impl Writer {
    /// The bytes of a message that `compose` makes; it puts new shapes into the list.
    pub(super) fn write<T: Serialize>(
        &mut self,
        compose: impl FnOnce(&mut StoredShapes, &mut Vec<LargeShape>) -> T,
    ) -> Vec<u8> {
        let mut new = Vec::new();
        let message = compose(&mut self.stored, &mut new);
        let first = self.stored.shapes().len() - new.len();
        let sent: Vec<SentShape> = (new.into_iter().zip(&self.stored.shapes()[first..]))
            .map(|(large, shape)| SentShape(large, baked(shape)))
            .collect();
        // Writing plain values to memory does not fail; were it to, the reader would say that the message is damaged.
        let mut bytes = postcard::to_extend(&(sent, message), VERSION.to_vec()).unwrap_or_default();
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        bytes
    }
}

fn baked(shape: &Shape) -> Option<Vec<u8>> {
    match shape {
        Shape::Mesh(mesh) => Some(mesh.baked_bytes()),
        _ => None,
    }
}

impl Reader {
    pub(super) fn open<T: DeserializeOwned>(&self, bytes: &[u8]) -> Result<Opened<T>, RemoteError> {
        let damaged = |what: &str| RemoteError::Damaged(what.to_owned());
        if bytes.len() > MESSAGE_BYTES_MAX {
            return Err(damaged("it is longer than any message may be"));
        }
        let (content, sum) = bytes.split_last_chunk::<4>().ok_or_else(|| damaged("it is too short"))?;
        if crc32fast::hash(content) != u32::from_le_bytes(*sum) {
            return Err(damaged("its checksum is wrong"));
        }
        let content = content.strip_prefix(&VERSION).ok_or_else(|| damaged("it begins otherwise"))?;
        self.open_content(content)
    }

    fn open_content<T: DeserializeOwned>(&self, content: &[u8]) -> Result<Opened<T>, RemoteError> {
        let (sent, message): (Vec<SentShape>, T) =
            postcard::from_bytes(content).map_err(|error| RemoteError::Damaged(error.to_string()))?;
        let mut shapes = self.shapes.clone();
        for SentShape(large, baked) in sent {
            let shape =
                large_shape_with(large, &shapes, baked.as_deref()).map_err(RemoteError::Impossible)?;
            shapes.push(shape);
        }
        Ok(Opened { message, shapes })
    }

    /// Keeps the shapes of a message that was taken.
    pub(super) fn keep(&mut self, shapes: Vec<Shape>) {
        self.shapes = shapes;
    }
}
