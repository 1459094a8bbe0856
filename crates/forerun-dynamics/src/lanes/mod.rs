//! Lanes: eight numbers at a time, with the same bits on every processor.
//!
//! Kernels are written once over [`Lanes`] and compiled for plain arrays and, on x86-64, for AVX2; [`dispatched!`] chooses at run time. Only
//! + - * / sqrt and comparisons, no fused multiply-add, so that all forms give equal bits.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Sub, SubAssign};

#[cfg(target_arch = "x86_64")]
mod avx2;
mod portable;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::{Avx2, as_avx2};
pub(crate) use portable::Portable;

/// How many contacts are solved side by side. Eight was measured to beat four and sixteen.
pub(crate) const LANES: usize = 8;

/// Eight numbers.
pub(crate) trait Lanes:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// Eight truth values.
    type Mask: LaneMask<Self>;

    fn splat(x: f32) -> Self;
    fn from_array(lanes: [f32; LANES]) -> Self;
    fn to_array(self) -> [f32; LANES];
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;

    /// Rows of eight bodies, turned so that each number of the record is one value.
    fn gather(rows: &[Row], index: &[u32; LANES]) -> [Self; LANES];

    /// Writes six numbers of eight bodies. Lanes that share an index must hold equal values.
    fn scatter(rows: &mut [Row], index: &[u32; LANES], values: [Self; 6]);

    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }

    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }

    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    // By comparison: the processors' own max and min differ for NaN and -0.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.gt(other).select(self, other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.lt(other).select(self, other)
    }
}

/// Eight truth values.
pub(crate) trait LaneMask<F: Lanes<Mask = Self>>:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self>
{
    /// Per lane: `yes` where set, else `no`.
    fn select(self, yes: F, no: F) -> F;

    /// Bit `i` is lane `i`.
    fn bits(self) -> u32;

    /// Whether any lane is set.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }

    /// Per lane: `yes` where set, else `no`.
    #[inline(always)]
    fn select_v(self, yes: V8<F>, no: V8<F>) -> V8<F> {
        V8 { x: self.select(yes.x, no.x), y: self.select(yes.y, no.y), z: self.select(yes.z, no.z) }
    }
}

/// One body's linear and angular part, padded to a lane's width: velocities and displacements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct Row(pub(crate) [f32; LANES]);

/// Eight vectors.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct V8<F> {
    pub(crate) x: F,
    pub(crate) y: F,
    pub(crate) z: F,
}

/// Linear and angular parts of eight bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Twist8<F> {
    pub(crate) linear: V8<F>,
    pub(crate) angular: V8<F>,
}

impl<F: Lanes> V8<F> {
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        V8 { x: F::zero(), y: F::zero(), z: F::zero() }
    }

    /// One vector per lane.
    #[inline(always)]
    pub(crate) fn from_arrays(lanes: [[f32; LANES]; 3]) -> Self {
        V8 { x: F::from_array(lanes[0]), y: F::from_array(lanes[1]), z: F::from_array(lanes[2]) }
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> F {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        V8 {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// Component by component.
    #[inline(always)]
    pub(crate) fn times(self, other: Self) -> Self {
        V8 { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }

    #[inline(always)]
    pub(crate) fn length(self) -> F {
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

/// Linear and angular parts of eight bodies.
#[inline(always)]
pub(crate) fn gather_twist<F: Lanes>(rows: &[Row], index: &[u32; LANES]) -> Twist8<F> {
    let [a, b, c, d, e, f, ..] = F::gather(rows, index);
    Twist8 { linear: V8 { x: a, y: b, z: c }, angular: V8 { x: d, y: e, z: f } }
}

/// Writes the parts back. Lanes that share an index must hold equal values.
#[inline(always)]
pub(crate) fn scatter_twist<F: Lanes>(rows: &mut [Row], index: &[u32; LANES], twist: &Twist8<F>) {
    let (l, a) = (twist.linear, twist.angular);
    F::scatter(rows, index, [l.x, l.y, l.z, a.x, a.y, a.z]);
}

/// Defines a function over blocks (or over plain data) that runs the given kernel in the fastest form the processor has.
macro_rules! dispatched {
    ($(#[$meta:meta])* $vis:vis fn $name:ident($blocks:ident: &mut [Block] $(, $arg:ident: $type:ty)* $(,)?) => $kernel:ident) => {
        $(#[$meta])*
        $vis fn $name($blocks: &mut [$crate::solver::Block<$crate::lanes::Portable>] $(, $arg: $type)*) {
            #[cfg(target_arch = "x86_64")]
            if std::arch::is_x86_feature_detected!("avx2") {
                #[target_feature(enable = "avx2")]
                fn avx2($blocks: &mut [$crate::solver::Block<$crate::lanes::Avx2>] $(, $arg: $type)*) {
                    $kernel($blocks $(, $arg)*);
                }
                // SAFETY: the processor has AVX2, which is all that the function needs.
                #[allow(unsafe_code, reason = "the one call that needs a processor feature, checked above")]
                return unsafe { avx2($crate::lanes::as_avx2($blocks) $(, $arg)*) };
            }
            $kernel($blocks $(, $arg)*);
        }
    };
    ($(#[$meta:meta])* $vis:vis fn $name:ident($($arg:ident: $type:ty),* $(,)?) => $kernel:ident) => {
        $(#[$meta])*
        $vis fn $name($($arg: $type),*) {
            #[cfg(target_arch = "x86_64")]
            if std::arch::is_x86_feature_detected!("avx2") {
                #[target_feature(enable = "avx2")]
                fn avx2($($arg: $type),*) {
                    $kernel::<$crate::lanes::Avx2>($($arg),*);
                }
                // SAFETY: the processor has AVX2, which is all that the function needs.
                #[allow(unsafe_code, reason = "the one call that needs a processor feature, checked above")]
                return unsafe { avx2($($arg),*) };
            }
            $kernel::<$crate::lanes::Portable>($($arg),*);
        }
    };
}
pub(crate) use dispatched;

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    /// A little of everything, on awkward numbers.
    #[inline(always)]
    fn mix<F: Lanes>(a: [f32; LANES], b: [f32; LANES]) -> [[f32; LANES]; 6] {
        let (x, y) = (F::from_array(a), F::from_array(b));
        let rows: Vec<Row> = (0..9).map(|i| Row(std::array::from_fn(|k| a[k] + i as f32 * b[k]))).collect();
        let g = F::gather(&rows, &[8, 3, 1, 0, 2, 7, 5, 4]);
        let mut out = rows.clone();
        F::scatter(&mut out, &[0, 1, 2, 3, 4, 5, 6, 7], [g[5], g[4], g[3], g[2], g[1], g[0]]);
        [
            (x * y + x / y - (x * x + y * y).sqrt()).to_array(),
            x.lt(y).select(x.max(y), -x.abs().min(y)).to_array(),
            (x.le(y) & y.gt(F::zero()) | x.lt(F::splat(-2.0))).select(g[6], g[7]).to_array(),
            g[2].to_array(),
            out[3].0,
            out[6].0,
        ]
    }

    #[test]
    fn avx2_gives_the_bits_of_plain_arrays() {
        #[target_feature(enable = "avx2")]
        fn with_avx2(a: [f32; LANES], b: [f32; LANES]) -> [[f32; LANES]; 6] {
            mix::<Avx2>(a, b)
        }
        if !std::arch::is_x86_feature_detected!("avx2") {
            return;
        }
        let a = [1.0, -0.0, 3.7e-39, -5.5, 1e30, f32::MIN_POSITIVE, -2.25, 0.1];
        let b = [3.0, 0.0, -7.1, -5.5, 1e-30, 0.3, 0.7, -1e20];
        for turn in 0..LANES {
            let mut c = b;
            c.rotate_left(turn);
            // SAFETY: AVX2 was detected.
            #[allow(unsafe_code, reason = "calls a function that needs AVX2, checked above")]
            let fast = unsafe { with_avx2(a, c) };
            let bits = |x: [[f32; LANES]; 6]| x.map(|r| r.map(|v| if v.is_nan() { 0 } else { v.to_bits() }));
            assert_eq!(bits(fast), bits(mix::<Portable>(a, c)));
        }
    }
}
