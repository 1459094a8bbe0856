//! Lanes: eight numbers at a time, with the same bits on every processor.
//!
//! Plain arrays in functions that are always inlined; a kernel wrapped in [`dispatched!`] is compiled twice on x86-64, once
//! for AVX2, and chosen at run time. Only + - * / sqrt and comparisons, no fused multiply-add, so that both give equal bits.

use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Sub, SubAssign};

/// How many contacts are solved side by side. Eight was measured to beat four and sixteen.
pub(crate) const LANES: usize = 8;

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct F8(pub(crate) [f32; LANES]);

/// Eight truth values, each all ones or all zeros.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Mask8([u32; LANES]);

/// Eight vectors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct V8 {
    pub(crate) x: F8,
    pub(crate) y: F8,
    pub(crate) z: F8,
}

/// One body's linear and angular part, padded to a lane's width: velocities and displacements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct Row(pub(crate) [f32; LANES]);

/// Linear and angular parts of eight bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Twist8 {
    pub(crate) linear: V8,
    pub(crate) angular: V8,
}

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for F8 {
            type Output = F8;
            #[inline(always)]
            fn $method(self, other: F8) -> F8 {
                let mut out = [0.0; LANES];
                for i in 0..LANES {
                    out[i] = self.0[i] $op other.0[i];
                }
                F8(out)
            }
        }
    };
}
lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);
lanewise!(Div, div, /);

impl Neg for F8 {
    type Output = F8;
    #[inline(always)]
    fn neg(self) -> F8 {
        self.map(|x| -x)
    }
}

impl AddAssign for F8 {
    #[inline(always)]
    fn add_assign(&mut self, other: F8) {
        *self = *self + other;
    }
}

impl SubAssign for F8 {
    #[inline(always)]
    fn sub_assign(&mut self, other: F8) {
        *self = *self - other;
    }
}

impl F8 {
    pub(crate) const ZERO: F8 = F8([0.0; LANES]);
    pub(crate) const ONE: F8 = F8([1.0; LANES]);

    #[inline(always)]
    pub(crate) fn splat(x: f32) -> F8 {
        F8([x; LANES])
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f32) -> f32) -> F8 {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = f(self.0[i]);
        }
        F8(out)
    }

    #[inline(always)]
    fn compare(self, other: F8, f: impl Fn(f32, f32) -> bool) -> Mask8 {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = if f(self.0[i], other.0[i]) { !0 } else { 0 };
        }
        Mask8(out)
    }

    // Spelled out: f32::max treats NaN and -0 differently between targets.
    #[inline(always)]
    pub(crate) fn max(self, other: F8) -> F8 {
        self.gt(other).select(self, other)
    }

    #[inline(always)]
    pub(crate) fn min(self, other: F8) -> F8 {
        self.lt(other).select(self, other)
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> F8 {
        self.map(f32::sqrt)
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> F8 {
        self.map(f32::abs)
    }

    #[inline(always)]
    pub(crate) fn lt(self, other: F8) -> Mask8 {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    pub(crate) fn le(self, other: F8) -> Mask8 {
        self.compare(other, |a, b| a <= b)
    }

    #[inline(always)]
    pub(crate) fn gt(self, other: F8) -> Mask8 {
        self.compare(other, |a, b| a > b)
    }
}

impl Mask8 {
    /// Per lane: `yes` where set, else `no`.
    #[inline(always)]
    pub(crate) fn select(self, yes: F8, no: F8) -> F8 {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = f32::from_bits((yes.0[i].to_bits() & self.0[i]) | (no.0[i].to_bits() & !self.0[i]));
        }
        F8(out)
    }

    /// Per lane: `yes` where set, else the zero vector or `no`.
    #[inline(always)]
    pub(crate) fn select_v(self, yes: V8, no: V8) -> V8 {
        V8 { x: self.select(yes.x, no.x), y: self.select(yes.y, no.y), z: self.select(yes.z, no.z) }
    }

    /// Bit `i` is lane `i`.
    #[inline(always)]
    pub(crate) fn bits(self) -> u32 {
        let mut out = 0;
        for i in 0..LANES {
            out |= (self.0[i] & 1) << i;
        }
        out
    }

    /// Whether any lane is set.
    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        self.0.iter().fold(0, |all, lane| all | lane) != 0
    }
}

impl BitAnd for Mask8 {
    type Output = Mask8;
    #[inline(always)]
    fn bitand(self, other: Mask8) -> Mask8 {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = self.0[i] & other.0[i];
        }
        Mask8(out)
    }
}

impl BitOr for Mask8 {
    type Output = Mask8;
    #[inline(always)]
    fn bitor(self, other: Mask8) -> Mask8 {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = self.0[i] | other.0[i];
        }
        Mask8(out)
    }
}

impl V8 {
    pub(crate) const ZERO: V8 = V8 { x: F8::ZERO, y: F8::ZERO, z: F8::ZERO };

    /// One vector per lane.
    #[inline(always)]
    pub(crate) fn from_lanes(lanes: [[f32; LANES]; 3]) -> V8 {
        V8 { x: F8(lanes[0]), y: F8(lanes[1]), z: F8(lanes[2]) }
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: V8) -> F8 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: V8) -> V8 {
        V8 {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// Component by component.
    #[inline(always)]
    pub(crate) fn times(self, other: V8) -> V8 {
        V8 { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }

    #[inline(always)]
    pub(crate) fn length(self) -> F8 {
        self.dot(self).sqrt()
    }
}

impl Add for V8 {
    type Output = V8;
    #[inline(always)]
    fn add(self, other: V8) -> V8 {
        V8 { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for V8 {
    type Output = V8;
    #[inline(always)]
    fn sub(self, other: V8) -> V8 {
        V8 { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Mul<F8> for V8 {
    type Output = V8;
    #[inline(always)]
    fn mul(self, factor: F8) -> V8 {
        V8 { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl Neg for V8 {
    type Output = V8;
    #[inline(always)]
    fn neg(self) -> V8 {
        V8 { x: -self.x, y: -self.y, z: -self.z }
    }
}

/// Rows of eight bodies, turned so that each number of the record is one `F8`.
#[inline(always)]
pub(crate) fn gather(rows: &[Row], index: &[u32; LANES]) -> [F8; LANES] {
    let mut out = [[0.0; LANES]; LANES];
    for lane in 0..LANES {
        let row = &rows[index[lane] as usize].0;
        for k in 0..LANES {
            out[k][lane] = row[k];
        }
    }
    out.map(F8)
}

/// Linear and angular parts of eight bodies.
#[inline(always)]
pub(crate) fn gather_twist(rows: &[Row], index: &[u32; LANES]) -> Twist8 {
    let r = gather(rows, index);
    Twist8 { linear: V8 { x: r[0], y: r[1], z: r[2] }, angular: V8 { x: r[3], y: r[4], z: r[5] } }
}

/// Writes the parts back. Lanes that share an index must hold equal values.
#[inline(always)]
pub(crate) fn scatter_twist(rows: &mut [Row], index: &[u32; LANES], twist: &Twist8) {
    let (l, a) = (&twist.linear, &twist.angular);
    for lane in 0..LANES {
        rows[index[lane] as usize].0 =
            [l.x.0[lane], l.y.0[lane], l.z.0[lane], a.x.0[lane], a.y.0[lane], a.z.0[lane], 0.0, 0.0];
    }
}

/// Defines a function that is compiled for AVX2 too and picks the faster form at run time.
macro_rules! dispatched {
    ($(#[$meta:meta])* $vis:vis fn $name:ident($($arg:ident: $type:ty),* $(,)?) $(-> $ret:ty)? $body:block) => {
        $(#[$meta])*
        $vis fn $name($($arg: $type),*) $(-> $ret)? {
            #[inline(always)]
            fn kernel($($arg: $type),*) $(-> $ret)? $body

            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn kernel_avx2($($arg: $type),*) $(-> $ret)? {
                    kernel($($arg),*)
                }
                if std::arch::is_x86_feature_detected!("avx2") {
                    // SAFETY: the processor has AVX2, which is all that the function needs.
                    #[allow(unsafe_code, reason = "the one call that needs a processor feature, checked above")]
                    return unsafe { kernel_avx2($($arg),*) };
                }
            }
            kernel($($arg),*)
        }
    };
}
pub(crate) use dispatched;
