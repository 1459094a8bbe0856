//! Kept: baked fields as bytes, to be stored from run to run.
//!
//! Promise: reading never panics and never takes more memory than a few times the bytes; what is damaged, of another
//! version or of another mesh is refused.

use std::fmt;

use super::Field;
use crate::Vec3;
use crate::shape::{Enclosure, Inside, MeshOptions, MeshRepairs};

/// Counts up whenever the baker gives other fields or the layout of the bytes changes.
const VERSION: u32 = 6;
/// The first bytes.
const MAGIC: [u8; 8] = *b"forerunF";

/// What a baked field depends on, as 128 bits: triangles, options, and the version of the baker. Displayed as 32 digits,
/// fit for a file name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BakeKey([u8; 16]);

impl BakeKey {
    pub(crate) fn of(vertices: &[Vec3], triangles: &[[u32; 3]], options: &MeshOptions) -> BakeKey {
        let mut hash = Fnv::new();
        hash.word(VERSION);
        hash.word(u32::from(options.inside == Inside::Needed));
        // 0 is no size that can be wished for.
        hash.word(options.cell.unwrap_or(0.0).to_bits());
        hash.word(vertices.len() as u32);
        vertices.iter().flat_map(Vec3::to_array).for_each(|x| hash.word(x.to_bits()));
        triangles.iter().flatten().for_each(|i| hash.word(*i));
        BakeKey(hash.0.to_le_bytes())
    }
}

impl fmt::Display for BakeKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// FNV-1a with 128 bits (Fowler, Noll, Vo), fed by words instead of bytes.
struct Fnv(u128);

impl Fnv {
    fn new() -> Fnv {
        Fnv(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }

    fn word(&mut self, word: u32) {
        self.0 = (self.0 ^ u128::from(word)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
    }
}

/// Why bytes give no field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptError {
    /// They were written by another version, or are something else.
    OtherVersion,
    /// They belong to other triangles or options.
    OtherMesh,
    /// They are cut or changed.
    Damaged,
}

impl fmt::Display for KeptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            KeptError::OtherVersion => "is no distance field of this version; bake it again",
            KeptError::OtherMesh => "is the distance field of another mesh; bake it again",
            KeptError::Damaged => "is a damaged distance field; bake it again",
        })
    }
}

impl std::error::Error for KeptError {}

/// What baking found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Kept {
    pub(crate) enclosure: Enclosure,
    pub(crate) found: Found,
    pub(crate) field: Option<Field>,
}

/// The part of [`MeshRepairs`] that only baking finds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Found {
    pub(crate) cover_area: f32,
    pub(crate) inner_triangles: u32,
    pub(crate) sheet_triangles: u32,
}

impl Found {
    pub(crate) fn of(repairs: &MeshRepairs) -> Found {
        Found {
            cover_area: repairs.cover_area,
            inner_triangles: repairs.inner_triangles,
            sheet_triangles: repairs.sheet_triangles,
        }
    }

    pub(crate) fn note_in(&self, repairs: &mut MeshRepairs) {
        repairs.cover_area = self.cover_area;
        repairs.inner_triangles = self.inner_triangles;
        repairs.sheet_triangles = self.sheet_triangles;
    }
}

impl Kept {
    /// Magic, version, key, enclosure, what was found, field; at the end the CRC-32 of all before.
    pub(crate) fn write(key: BakeKey, enclosure: Enclosure, found: &Found, field: Option<&Field>) -> Vec<u8> {
        let mut out = MAGIC.to_vec();
        out.extend(VERSION.to_le_bytes());
        out.extend(key.0);
        out.push(match enclosure {
            Enclosure::Closed => 0,
            Enclosure::Mended => 1,
            Enclosure::Open => 2,
        });
        out.extend(found.cover_area.to_le_bytes());
        out.extend(found.inner_triangles.to_le_bytes());
        out.extend(found.sheet_triangles.to_le_bytes());
        if let Some(field) = field {
            field.write(&mut out);
        }
        let sum = crc32fast::hash(&out);
        out.extend(sum.to_le_bytes());
        out
    }

    /// What [`Kept::write`] wrote for this key.
    pub(crate) fn read(bytes: &[u8], key: BakeKey) -> Result<Kept, KeptError> {
        let mut head = Reader(bytes);
        if head.array() != Some(MAGIC) || head.u32() != Some(VERSION) {
            return Err(KeptError::OtherVersion);
        }
        if head.array() != Some(key.0) {
            return Err(KeptError::OtherMesh);
        }
        let (body, sum) = bytes.split_last_chunk::<4>().ok_or(KeptError::Damaged)?;
        if crc32fast::hash(body) != u32::from_le_bytes(*sum) {
            return Err(KeptError::Damaged);
        }
        let rest = body.get(bytes.len() - head.0.len()..).ok_or(KeptError::Damaged)?;
        Kept::read_body(&mut Reader(rest)).ok_or(KeptError::Damaged)
    }

    fn read_body(reader: &mut Reader<'_>) -> Option<Kept> {
        let enclosure = match reader.array()? {
            [0] => Enclosure::Closed,
            [1] => Enclosure::Mended,
            [2] => Enclosure::Open,
            _ => return None,
        };
        let found = Found {
            cover_area: reader.f32()?,
            inner_triangles: reader.u32()?,
            sheet_triangles: reader.u32()?,
        };
        let field = if enclosure.has_inside() { Some(Field::read(reader)?) } else { None };
        reader.0.is_empty().then_some(Kept { enclosure, found, field })
    }
}

/// Takes numbers off the front of bytes; none where there are too few.
pub(crate) struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    pub(crate) fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (array, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*array)
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(crate) fn f32(&mut self) -> Option<f32> {
        self.array().map(f32::from_le_bytes)
    }

    pub(crate) fn vec3(&mut self) -> Option<Vec3> {
        Some(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    /// `count` numbers of 16 bits.
    pub(crate) fn i16s(&mut self, count: usize) -> Option<Vec<i16>> {
        let (taken, rest) = self.0.split_at_checked(count.checked_mul(2)?)?;
        self.0 = rest;
        Some(taken.chunks_exact(2).map(|b| i16::from_le_bytes([b[0], b[1]])).collect())
    }
}
