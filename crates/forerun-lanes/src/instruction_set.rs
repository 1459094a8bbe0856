//! Instruction set: which processor instructions the kernels use. All give equal bits; they differ in speed.

use std::fmt;
use std::sync::atomic::{AtomicU8, Ordering};

/// The forms that kernels are compiled in, the slower first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum InstructionSet {
    /// Plain arrays, for any processor.
    Portable = 1,
    /// Two registers of four numbers: any x86-64 processor.
    Sse2 = 2,
    /// One register of eight numbers.
    Avx2 = 3,
    /// One of 32 registers of eight numbers.
    Avx512 = 4,
}

/// What [`in_use`] answers; 0 until somebody asks.
static IN_USE: AtomicU8 = AtomicU8::new(0);

impl InstructionSet {
    /// All, the slower first.
    pub const ALL: [InstructionSet; 4] =
        [InstructionSet::Portable, InstructionSet::Sse2, InstructionSet::Avx2, InstructionSet::Avx512];

    /// The fastest that this processor has.
    #[must_use]
    pub fn fastest_available() -> InstructionSet {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            let avx512 = has!("avx512f") && has!("avx512vl") && has!("avx512bw") && has!("avx512dq");
            if has!("avx2") && avx512 {
                InstructionSet::Avx512
            } else if has!("avx2") {
                InstructionSet::Avx2
            } else {
                InstructionSet::Sse2
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        InstructionSet::Portable
    }

    /// Whether this processor has it.
    #[must_use]
    pub fn is_available(self) -> bool {
        self <= InstructionSet::fastest_available()
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            InstructionSet::Portable => "portable",
            InstructionSet::Sse2 => "SSE2",
            InstructionSet::Avx2 => "AVX2",
            InstructionSet::Avx512 => "AVX-512",
        })
    }
}

/// The instruction set that kernels use from here on, in the whole process.
#[must_use]
#[inline]
pub fn in_use() -> InstructionSet {
    match IN_USE.load(Ordering::Relaxed) {
        1 => InstructionSet::Portable,
        2 => InstructionSet::Sse2,
        3 => InstructionSet::Avx2,
        4 => InstructionSet::Avx512,
        _ => limit_to(InstructionSet::Avx512),
    }
}

/// Lets the whole process use `most` or, where the processor has less, what it has; returns which. For tests and benchmarks: the results
/// are the same, so that it may change while others step.
#[cold]
pub fn limit_to(most: InstructionSet) -> InstructionSet {
    let chosen = most.min(InstructionSet::fastest_available());
    IN_USE.store(chosen as u8, Ordering::Relaxed);
    chosen
}
