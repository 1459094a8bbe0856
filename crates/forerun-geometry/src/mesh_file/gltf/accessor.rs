//! Accessors of a glTF file: typed views of its buffers.

use super::document::{Accessor, Document, SparsePart};
use crate::mesh_file::ParseError;

/// A document and the bytes of its buffers.
pub(super) struct Data<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a [Vec<u8>],
}

/// Kinds of numbers by their codes, which are those of OpenGL.
const I8: u32 = 5120;
const U8: u32 = 5121;
const I16: u32 = 5122;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// Numbers in a row in a buffer: `count` times `width` of one kind.
#[derive(Clone, Copy)]
struct Run {
    count: u64,
    width: usize,
    component_type: u32,
}

impl Data<'_> {
    /// Positions: three numbers each.
    pub(super) fn positions(&self, accessor: usize) -> Result<Vec<[f32; 3]>, ParseError> {
        let entry = self.accessor(accessor, "VEC3")?;
        if !entry.normalized && entry.component_type != F32 && !self.quantised() {
            return Err(fail(accessor, "positions must be floating-point numbers"));
        }
        let numbers = if entry.normalized {
            // The smallest of the numbers with a sign is a little below what stands for -1.
            let one = largest(entry.component_type);
            self.read(accessor, entry, |number| (number / one).max(-1.0) as f32)?
        } else {
            self.read(accessor, entry, |number| number as f32)?
        };
        Ok(numbers.as_chunks::<3>().0.to_vec())
    }

    /// Numbers of vertices.
    pub(super) fn indices(&self, accessor: usize) -> Result<Vec<u32>, ParseError> {
        let entry = self.accessor(accessor, "SCALAR")?;
        if !counts(entry.component_type) {
            return Err(fail(accessor, "indices must be whole numbers without a sign"));
        }
        self.read(accessor, entry, |number| number as u32)
    }

    fn quantised(&self) -> bool {
        self.document.extensions_required.iter().any(|name| name == "KHR_mesh_quantization")
    }

    fn accessor(&self, accessor: usize, kind: &str) -> Result<&Accessor, ParseError> {
        let entry = self.document.accessors.get(accessor);
        let entry = entry.ok_or_else(|| fail(accessor, "does not exist"))?;
        if entry.kind != kind {
            return Err(fail(accessor, format!("must be of type {kind} here")));
        }
        Ok(entry)
    }

    fn read<T: Clone>(
        &self,
        accessor: usize,
        entry: &Accessor,
        convert: impl Fn(f64) -> T,
    ) -> Result<Vec<T>, ParseError> {
        let width = if entry.kind == "VEC3" { 3 } else { 1 };
        let run = Run { count: entry.count, width, component_type: entry.component_type };
        let mut numbers = match entry.buffer_view {
            Some(view) => {
                self.read_run(view, entry.byte_offset, run, &convert).map_err(|m| fail(accessor, m))?
            }
            None => {
                // Zeros take no room in the file: what it may ask for is bounded by its size all the same.
                let bytes: usize = self.buffers.iter().map(Vec::len).sum();
                if entry.count > bytes as u64 {
                    return Err(fail(accessor, format!("has {} elements without data", entry.count)));
                }
                vec![convert(0.0); entry.count as usize * width]
            }
        };
        if let Some(sparse) = &entry.sparse {
            let part = |part: &SparsePart, width, component_type| {
                let run = Run { count: sparse.count, width, component_type };
                self.read_run(part.buffer_view, part.byte_offset, run, &|number| number)
                    .map_err(|m| fail(accessor, format!("sparse: {m}")))
            };
            let kind = sparse.indices.component_type.unwrap_or_default();
            if !counts(kind) {
                return Err(fail(accessor, "sparse: indices must be whole numbers without a sign"));
            }
            let at = part(&sparse.indices, 1, kind)?;
            let values = part(&sparse.values, width, entry.component_type)?;
            for (at, value) in at.into_iter().zip(values.chunks_exact(width)) {
                // Whole and not negative, as their kind is.
                let start = (at as usize).saturating_mul(width);
                let Some(place) = numbers.get_mut(start..start.saturating_add(width)) else {
                    let message = format!("sparse: element {at} does not exist, there are {}", entry.count);
                    return Err(fail(accessor, message));
                };
                place.iter_mut().zip(value).for_each(|(old, new)| *old = convert(*new));
            }
        }
        Ok(numbers)
    }

    fn read_run<T>(
        &self,
        view: usize,
        offset: u64,
        run: Run,
        convert: &impl Fn(f64) -> T,
    ) -> Result<Vec<T>, String> {
        let size = size_of_number(run.component_type)?;
        let entry = self.document.buffer_views.get(view);
        let entry = entry.ok_or_else(|| format!("bufferViews[{view}] does not exist"))?;
        let buffer = self.buffers.get(entry.buffer);
        let buffer = buffer.ok_or_else(|| format!("buffers[{}] does not exist", entry.buffer))?;
        let end = entry.byte_offset.checked_add(entry.byte_length);
        let bytes = end.and_then(|end| buffer.get(entry.byte_offset as usize..usize::try_from(end).ok()?));
        let bytes = bytes.ok_or_else(|| format!("bufferViews[{view}] goes beyond the end of its buffer"))?;
        let packed = (run.width * size) as u64;
        let stride = entry.byte_stride.unwrap_or(packed);
        if stride < packed {
            return Err(format!("bufferViews[{view}] has elements of {stride} bytes, {packed} are needed"));
        }
        if run.count == 0 {
            return Ok(Vec::new());
        }
        let last =
            (run.count - 1).checked_mul(stride).and_then(|at| at.checked_add(offset)?.checked_add(packed));
        if last.is_none_or(|last| last > bytes.len() as u64) {
            return Err(format!("bufferViews[{view}] is too small for {} elements", run.count));
        }
        let mut numbers = Vec::with_capacity(run.count as usize * run.width);
        for element in 0..run.count {
            let start = (offset + element * stride) as usize;
            let number = |bytes: &[u8]| convert(number_of(run.component_type, bytes));
            numbers.extend(bytes[start..start + packed as usize].chunks_exact(size).map(number));
        }
        Ok(numbers)
    }
}

fn fail(accessor: usize, message: impl Into<String>) -> ParseError {
    ParseError::new(format!("accessors[{accessor}]"), message)
}

/// Whether numbers of a kind are whole and have no sign.
fn counts(component_type: u32) -> bool {
    matches!(component_type, U8 | U16 | U32)
}

fn size_of_number(component_type: u32) -> Result<usize, String> {
    match component_type {
        I8 | U8 => Ok(1),
        I16 | U16 => Ok(2),
        U32 | F32 => Ok(4),
        _ => Err(format!("componentType {component_type} is no kind of number in glTF")),
    }
}

/// The number in `bytes`, of which there are as many as the kind has.
fn number_of(component_type: u32, bytes: &[u8]) -> f64 {
    match (component_type, bytes) {
        (I8, &[a]) => f64::from(i8::from_le_bytes([a])),
        (U8, &[a]) => f64::from(a),
        (I16, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
        (U16, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
        (U32, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
        (_, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        _ => f64::NAN,
    }
}

/// The number that stands for 1 in normalised numbers of a kind.
fn largest(component_type: u32) -> f64 {
    match component_type {
        I8 => 127.0,
        U8 => 255.0,
        I16 => 32767.0,
        U16 => 65535.0,
        _ => 1.0,
    }
}
