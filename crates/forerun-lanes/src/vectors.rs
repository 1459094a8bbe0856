//! Vectors: eight of them at a time, by component.

use std::cell::Cell;
use std::ops::{Add, Mul, Neg, Sub};

use super::{LANES, Lanes, Row};

/// Eight vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct V8<F> {
    /// First components.
    pub x: F,
    /// Second components.
    pub y: F,
    /// Third components.
    pub z: F,
}

/// Linear and angular parts of eight bodies.
#[derive(Clone, Copy, Debug)]
pub struct Twist8<F> {
    /// The first three numbers of a row.
    pub linear: V8<F>,
    /// The three after them.
    pub angular: V8<F>,
}

impl<F: Lanes> V8<F> {
    /// Zero vectors.
    #[inline(always)]
    pub fn zero() -> Self {
        V8 { x: F::zero(), y: F::zero(), z: F::zero() }
    }

    /// The same vector in all lanes.
    #[inline(always)]
    pub fn splat([x, y, z]: [f32; 3]) -> Self {
        V8 { x: F::splat(x), y: F::splat(y), z: F::splat(z) }
    }

    /// The vectors in another form.
    #[inline(always)]
    pub fn form<G: Lanes>(&self) -> V8<G> {
        V8 {
            x: G::from_array(self.x.to_array()),
            y: G::from_array(self.y.to_array()),
            z: G::from_array(self.z.to_array()),
        }
    }

    /// One vector per lane.
    #[inline(always)]
    pub fn from_arrays(lanes: [[f32; LANES]; 3]) -> Self {
        V8 { x: F::from_array(lanes[0]), y: F::from_array(lanes[1]), z: F::from_array(lanes[2]) }
    }

    /// Scalar products.
    #[inline(always)]
    pub fn dot(self, other: Self) -> F {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Vector products.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        V8 {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// Component by component.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        V8 { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }

    /// Lengths.
    #[inline(always)]
    pub fn length(self) -> F {
        self.dot(self).sqrt()
    }
}

impl<F: Lanes> Add for V8<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        V8 { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<F: Lanes> Sub for V8<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        V8 { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl<F: Lanes> Mul<F> for V8<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: F) -> Self {
        V8 { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<F: Lanes> Neg for V8<F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        V8 { x: -self.x, y: -self.y, z: -self.z }
    }
}

impl<F: Lanes> Twist8<F> {
    /// Of the rows of eight bodies.
    #[inline(always)]
    pub fn of([a, b, c, d, e, f, ..]: [F; LANES]) -> Self {
        Twist8 { linear: V8 { x: a, y: b, z: c }, angular: V8 { x: d, y: e, z: f } }
    }
}

/// Writes the parts back. Of lanes that share an index the last is kept: only a row that nobody reads may be shared.
#[inline(always)]
pub fn scatter_twist<F: Lanes>(rows: &[Cell<Row>], index: &[u32; LANES], twist: &Twist8<F>) {
    let (l, a) = (twist.linear, twist.angular);
    F::scatter(rows, index, [l.x, l.y, l.z, a.x, a.y, a.z, F::zero(), F::zero()]);
}
