//! States: of each frame only what differs from the frame before, word by word.
//!
//! A frame is a list of bodies, in the order of their names. Each is how many names are skipped (variable length, seven bits a byte), a
//! mask (two bytes, the lowest bit first) and a word of four bytes for every bit set in the lower fourteen: position, rotation, velocity, angular
//! velocity, rest. The highest bit says that the body is there no more. So what rests costs nothing, and what counts to rest six bytes.

use forerun_dynamics::{BodyId, BodyState};
use forerun_geometry::{Quat, Vec3};

/// The bits of a state.
pub(crate) type Words = [u32; 14];

/// Says that the body is there no more.
const GONE: u16 = 1 << 15;

/// What is stored of a body at a frame.
type Entry = (BodyId, Option<BodyState>);

pub(crate) fn state_of(words: Words) -> BodyState {
    let f = |index: usize| f32::from_bits(words[index]);
    BodyState {
        position: Vec3::new(f(0), f(1), f(2)),
        rotation: Quat::from_xyzw(f(3), f(4), f(5), f(6)),
        velocity: Vec3::new(f(7), f(8), f(9)),
        angular_velocity: Vec3::new(f(10), f(11), f(12)),
        rest: words[13],
    }
}

/// The states of the last frame, by name.
#[derive(Debug, Default)]
pub(crate) struct LastStates {
    words: Vec<Option<Words>>,
}

impl LastStates {
    /// The states that the first frame is compared with.
    pub(crate) fn new(states: impl Iterator<Item = Option<BodyState>>) -> LastStates {
        LastStates { words: states.map(|state| state.map(|state| state.bits())).collect() }
    }

    /// The bytes of a frame.
    pub(crate) fn encode(&mut self, entries: &[Entry]) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(60 * entries.len());
        let mut next = 0;
        for (body, state) in entries {
            put_number(&mut bytes, body.0.wrapping_sub(next));
            next = body.0.wrapping_add(1);
            let index = body.0 as usize;
            if self.words.len() <= index {
                self.words.resize(index + 1, None);
            }
            let old = self.words[index].unwrap_or_default();
            self.words[index] = state.map(|state| state.bits());
            let Some(new) = self.words[index] else {
                bytes.extend(GONE.to_le_bytes());
                continue;
            };
            let differs = |i: &usize| new[*i] != old[*i];
            let mask = (0..14).filter(differs).fold(0_u16, |mask, i| mask | 1 << i);
            bytes.extend(mask.to_le_bytes());
            (0..14).filter(differs).for_each(|i| bytes.extend(new[i].to_le_bytes()));
        }
        bytes
    }

    /// The frame of some bytes. Names are below `names`.
    pub(crate) fn decode(&mut self, mut bytes: &[u8], names: usize) -> Option<Vec<Entry>> {
        let mut entries = Vec::new();
        let mut next = 0_u32;
        self.words.resize(names.max(self.words.len()), None);
        while !bytes.is_empty() {
            let name = next.checked_add(take_number(&mut bytes)?)?;
            next = name.checked_add(1)?;
            let slot = self.words.get_mut(name as usize).filter(|_| (name as usize) < names)?;
            let mask = u16::from_le_bytes(take(&mut bytes)?);
            if mask == GONE {
                *slot = None;
                entries.push((BodyId(name), None));
                continue;
            }
            let mut words = slot.unwrap_or_default();
            for (i, word) in words.iter_mut().enumerate() {
                if mask >> i & 1 == 1 {
                    *word = u32::from_le_bytes(take(&mut bytes)?);
                }
            }
            if mask >> 14 != 0 {
                return None;
            }
            *slot = Some(words);
            entries.push((BodyId(name), Some(state_of(words))));
        }
        Some(entries)
    }
}

fn put_number(bytes: &mut Vec<u8>, mut number: u32) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

fn take_number(bytes: &mut &[u8]) -> Option<u32> {
    let mut number = 0_u64;
    for shift in (0..35).step_by(7) {
        let [byte] = take(bytes)?;
        number |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return u32::try_from(number).ok();
        }
    }
    None
}

fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (taken, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(*taken)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(x: f32, rest: u32) -> BodyState {
        let mut words = [0; 14];
        (words[0], words[6], words[13]) = (x.to_bits(), 1.0_f32.to_bits(), rest);
        state_of(words)
    }

    fn frames() -> Vec<Vec<Entry>> {
        vec![
            vec![(BodyId(1), Some(state(0.5, 0))), (BodyId(300), Some(state(7.0, 0)))],
            vec![],
            vec![(BodyId(1), Some(state(0.5, 1)))],
            vec![(BodyId(0), None), (BodyId(1), Some(state(-0.5, 2))), (BodyId(200), Some(state(1.0, 0)))],
        ]
    }

    #[test]
    fn frames_come_back_and_cost_what_differs() {
        let first = || LastStates::new([Some(state(1.0, 0)), Some(state(0.0, 0))].into_iter());
        let (mut from, mut to) = (first(), first());
        let mut sizes = Vec::new();
        for frame in frames() {
            let bytes = from.encode(&frame);
            sizes.push(bytes.len());
            assert_eq!(to.decode(&bytes, 301), Some(frame));
        }
        // Name, mask, x; name of two bytes, mask, x and w. Nothing. Name, mask, rest.
        assert_eq!(sizes[..3], [7 + 12, 0, 7]);
    }

    #[test]
    fn bytes_that_are_no_frame_are_none() {
        let mut bytes = LastStates::default().encode(&frames()[3]);
        for length in 0..bytes.len() {
            // Between two bodies is a frame too, and another.
            let cut = LastStates::default().decode(&bytes[..length], 301);
            assert_ne!(cut, Some(frames()[3].clone()));
        }
        assert_eq!(LastStates::default().decode(&bytes, 200), None, "200 names: there is no body 200");
        assert_eq!(LastStates::default().decode(&[0xff; 12], 301), None);
        bytes[2] |= 0x40;
        assert_eq!(LastStates::default().decode(&bytes, 301), None, "a bit that has no meaning");
    }
}
