//! Sides: the two bodies of eight contacts, read from their rows and written back.

use std::cell::Cell;

use super::blocks::Block;
use super::points::{Kind, Point, Push, Relative, Side};
use crate::lanes::{Lanes, Row, Twist8, V8, scatter_twist};

/// The two bodies of eight contacts, mass-scaled: velocities or displacements.
pub(crate) struct Sides<F> {
    pub(crate) first: Twist8<F>,
    pub(crate) second: Twist8<F>,
}

/// A row of the Jacobian: one direction at one point.
#[derive(Clone, Copy)]
pub(crate) struct Jacobian<F> {
    pub(crate) direction: V8<F>,
    pub(crate) first: V8<F>,
    pub(crate) second: V8<F>,
}

impl<F: Lanes> Sides<F> {
    #[inline(always)]
    pub(crate) fn gather<K: Kind>(block: &Block<F, K>, rows: &[Cell<Row>]) -> Self {
        let (first, second) =
            (F::gather_cells(rows, &block.first_row), F::gather_cells(rows, &block.second_row));
        Sides { first: Twist8::of(first), second: Twist8::of(second) }
    }

    /// As [`Sides::gather`], of rows that nobody writes.
    #[inline(always)]
    pub(crate) fn gather_still<K: Kind>(block: &Block<F, K>, rows: &[Row]) -> Self {
        let (first, second) = (F::gather(rows, &block.first_row), F::gather(rows, &block.second_row));
        Sides { first: Twist8::of(first), second: Twist8::of(second) }
    }

    #[inline(always)]
    pub(crate) fn scatter<K: Kind>(&self, block: &Block<F, K>, rows: &[Cell<Row>]) {
        scatter_twist(rows, &block.first_out, &self.first);
        scatter_twist(rows, &block.second_out, &self.second);
    }

    /// How the second side moves relative to the first at the contact's centre.
    #[inline(always)]
    pub(crate) fn relative<K: Kind>(&self, block: &Block<F, K>) -> Relative<F> {
        let (a, b) = (&block.first, &block.second);
        let linear = self.second.linear * b.scale - self.first.linear * a.scale;
        let [t1, t2, n] = block.axes();
        let along = V8 { x: t1.dot(linear), y: t2.dot(linear), z: n.dot(linear) };
        let (wa, wb) = (turning(a, self.first.angular), turning(b, self.second.angular));
        Relative { linear: along + wb.cross(b.offset) - wa.cross(a.offset), angular: wb - wa }
    }

    /// Pushes both sides, also one that does not yield: its row is written where nobody reads it.
    #[inline(always)]
    pub(crate) fn push<K: Kind>(&mut self, block: &Block<F, K>, push: &Push<F>) {
        let (a, b) = (&block.first, &block.second);
        let [t1, t2, n] = block.axes();
        let force = t1 * push.force.x + t2 * push.force.y + n * push.force.z;
        self.first.linear = self.first.linear - force * a.scale;
        self.first.angular = self.first.angular - a.arm(push);
        self.second.linear = self.second.linear + force * b.scale;
        self.second.angular = self.second.angular + b.arm(push);
    }

    /// How fast the second side moves away from the first along a row.
    #[inline(always)]
    pub(crate) fn along<K: Kind>(&self, block: &Block<F, K>, row: &Jacobian<F>) -> F {
        row.direction.dot(self.second.linear) * block.second.scale
            - row.direction.dot(self.first.linear) * block.first.scale
            + row.second.dot(self.second.angular)
            - row.first.dot(self.first.angular)
    }

    /// Applies impulses along a row, one to each side.
    #[inline(always)]
    pub(crate) fn apply<K: Kind>(
        &mut self,
        block: &Block<F, K>,
        row: &Jacobian<F>,
        (on_first, on_second): (F, F),
    ) {
        self.first.linear = self.first.linear - row.direction * (block.first.scale * on_first);
        self.first.angular = self.first.angular - row.first * on_first;
        self.second.linear = self.second.linear + row.direction * (block.second.scale * on_second);
        self.second.angular = self.second.angular + row.second * on_second;
    }
}

/// Angular velocity about the contact's axes.
#[inline(always)]
fn turning<F: Lanes>(side: &Side<F>, angular: V8<F>) -> V8<F> {
    V8 { x: side.turns[0].dot(angular), y: side.turns[1].dot(angular), z: side.turns[2].dot(angular) }
}

impl<F: Lanes, K: Kind> Block<F, K> {
    /// The contacts' axes in the world: two tangents and the normal.
    #[inline(always)]
    pub(crate) fn axes(&self) -> [V8<F>; 3] {
        [self.tangent, self.normal.cross(self.tangent), self.normal]
    }

    /// The row of a point.
    #[inline(always)]
    pub(crate) fn jacobian(&self, q: usize) -> Jacobian<F> {
        let point = &self.points[q];
        let direction = if K::NORMALS {
            let ([t1, t2, n], along) = (self.axes(), point.normal());
            t1 * along.x + t2 * along.y + n * along.z
        } else {
            self.normal
        };
        Jacobian { direction, first: point.arm(&self.first), second: point.arm(&self.second) }
    }
}
