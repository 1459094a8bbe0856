//! Manifolds: those of the eight contacts of a block side by side, with what they carry and what rubs there.

use super::batch::ContactList;
use super::blocks::{Detail, NO_CONTACT};
use super::load::Load;
use super::points::Kind;
use crate::lanes::{LANES, LaneMask, Lanes, V8, prefetch};

/// Where the rows come from.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) contacts: ContactList<'a>,
    /// By contact.
    pub(crate) loads: &'a [Load],
    /// By body.
    pub(crate) levels: &'a [u32],
}

impl Source<'_> {
    /// Asks for the memory of what a block will be made from: contacts of one colour are far from each other.
    #[inline(always)]
    pub(crate) fn prefetch(&self, contacts: &[u32; LANES]) {
        for &k in contacts {
            if k != NO_CONTACT {
                prefetch(self.contacts.manifold(k as usize));
                prefetch(&self.loads[k as usize]);
            }
        }
    }
}

/// Eight manifolds.
pub(crate) struct Manifolds<F> {
    pub(crate) normal: V8<F>,
    pub(crate) positions: [V8<F>; 4],
    /// Of the points, where they have normals of their own; else nothing.
    pub(crate) normals: [V8<F>; 4],
    pub(crate) separation: [F; 4],
    /// 1 for each point that there is.
    pub(crate) valid: [F; 4],
    /// Guessed impulses, and the part of them that is weight.
    pub(crate) total: [F; 4],
    pub(crate) weight: [F; 4],
    /// Which way friction pushes the second body, where the two slide; else zero.
    pub(crate) slide: V8<F>,
    /// Levels of the two bodies.
    pub(crate) levels: [F; 2],
}

type Column = [f32; LANES];

impl<F: Lanes> Manifolds<F> {
    /// Those of a block's contacts. A lane without a contact gets the first lane's, without points.
    #[inline(always)]
    pub(crate) fn gather<K: Kind>(detail: &Detail<F>, source: &Source) -> Self {
        let zero: Column = [0.0; LANES];
        let (mut normal, mut slide) = ([zero; 3], [zero; 3]);
        let (mut positions, mut normals) = ([[zero; 3]; 4], [[zero; 3]; 4]);
        let (mut separation, mut total, mut weight) = ([zero; 4], [zero; 4], [zero; 4]);
        let (mut count, mut levels) = (zero, [zero; 2]);
        for lane in 0..LANES {
            let padding = detail.source[lane] == NO_CONTACT;
            let k = if padding { detail.source[0] } else { detail.source[lane] } as usize;
            let (contact, load) = (&source.contacts.ends[k], &source.loads[k]);
            let manifold = source.contacts.manifold(k);
            for axis in 0..3 {
                normal[axis][lane] = manifold.normal[axis];
                slide[axis][lane] = load.slide[axis];
            }
            for q in 0..4 {
                let point = &manifold.points[q];
                for axis in 0..3 {
                    positions[q][axis][lane] = point.position[axis];
                    if K::NORMALS {
                        normals[q][axis][lane] = point.normal[axis];
                    }
                }
                separation[q][lane] = point.separation;
                total[q][lane] = load.total[q];
                weight[q][lane] = load.weight[q];
            }
            count[lane] = if padding { 0.0 } else { manifold.count as f32 };
            levels[0][lane] = source.levels[contact.first as usize] as f32;
            levels[1][lane] = source.levels[contact.second as usize] as f32;
        }
        let count = F::from_array(count);
        let mut valid = [F::zero(); 4];
        for q in 0..4 {
            valid[q] = F::splat(q as f32).lt(count).select(F::one(), F::zero());
        }
        Manifolds {
            normal: V8::from_arrays(normal),
            positions: vectors(&positions),
            normals: vectors(&normals),
            separation: columns(&separation),
            valid,
            total: times(&total, &valid),
            weight: times(&weight, &valid),
            slide: V8::from_arrays(slide),
            levels: [F::from_array(levels[0]), F::from_array(levels[1])],
        }
    }
}

#[inline(always)]
fn columns<F: Lanes>(of: &[Column; 4]) -> [F; 4] {
    [F::from_array(of[0]), F::from_array(of[1]), F::from_array(of[2]), F::from_array(of[3])]
}

#[inline(always)]
fn times<F: Lanes>(of: &[Column; 4], valid: &[F; 4]) -> [F; 4] {
    let [a, b, c, d] = columns::<F>(of);
    [a * valid[0], b * valid[1], c * valid[2], d * valid[3]]
}

#[inline(always)]
fn vectors<F: Lanes>(of: &[[Column; 3]; 4]) -> [V8<F>; 4] {
    [V8::from_arrays(of[0]), V8::from_arrays(of[1]), V8::from_arrays(of[2]), V8::from_arrays(of[3])]
}
