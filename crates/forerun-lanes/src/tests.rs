//! Lanes, tested: every form gives the bits of plain arrays.

use super::*;

/// A little of everything, on awkward numbers.
#[inline(always)]
fn mix<F: Lanes>(a: [f32; LANES], b: [f32; LANES]) -> [[f32; LANES]; 10] {
    let (x, y) = (F::from_array(a), F::from_array(b));
    let rows: Vec<Row> = (0..9).map(|i| Row(std::array::from_fn(|k| a[k] + i as f32 * b[k]))).collect();
    let g = F::gather(&rows, &[8, 3, 1, 0, 2, 7, 5, 4]);
    let mut out = rows.clone();
    F::scatter(cells(&mut out), &[0, 1, 2, 3, 4, 5, 6, 7], [g[5], g[4], g[3], g[2], g[1], g[0], g[7], g[6]]);
    let whole = (x.lt(y).select(F::splat(3.0), F::splat(8_388_607.0))).to_whole();
    let pairs = F::gather_pairs(&[-7, 300, i16::MIN, i16::MAX, -1, 0, 12], &whole.map(|i| i & 3), &[0, 1, 2]);
    [
        (x * y + x / y - (x * x + y * y).sqrt()).to_array(),
        x.lt(y).select(x.max(y), -x.abs().min(y)).to_array(),
        (x.le(y) & y.gt(F::zero()) | x.lt(F::splat(-2.0))).select(g[6], g[7]).to_array(),
        g[2].to_array(),
        out[3].0,
        out[6].0,
        pairs[0][1].to_array(),
        pairs[2][0].to_array(),
        whole.map(|i| i as f32),
        F::Mask::from_bits(x.lt(y).bits() ^ 0xa5).select(x, y).to_array(),
    ]
}

#[target_feature(enable = "avx2")]
fn with_avx2(a: [f32; LANES], b: [f32; LANES]) -> [[f32; LANES]; 10] {
    mix::<Avx2>(a, b)
}

#[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq")]
fn with_avx512(a: [f32; LANES], b: [f32; LANES]) -> [[f32; LANES]; 10] {
    mix::<Avx2>(a, b)
}

#[test]
fn every_instruction_set_gives_the_bits_of_plain_arrays() {
    let a = [1.0, -0.0, 3.7e-39, -5.5, 1e30, f32::MIN_POSITIVE, -2.25, 0.1];
    let b = [3.0, 0.0, -7.1, -5.5, 1e-30, f32::NAN, 0.7, -1e20];
    let bits = |x: [[f32; LANES]; 10]| x.map(|r| r.map(|v| if v.is_nan() { 0 } else { v.to_bits() }));
    for turn in 0..LANES {
        let mut c = b;
        c.rotate_left(turn);
        for (a, b) in [(a, c), (c, a)] {
            let expected = bits(mix::<Portable>(a, b));
            assert_eq!(bits(mix::<Sse2>(a, b)), expected);
            // SAFETY: the processor has what is called for.
            #[allow(unsafe_code, reason = "calls functions that need processor features, checked first")]
            unsafe {
                if InstructionSet::Avx2.is_available() {
                    assert_eq!(bits(with_avx2(a, b)), expected);
                }
                if InstructionSet::Avx512.is_available() {
                    assert_eq!(bits(with_avx512(a, b)), expected);
                }
            }
        }
    }
}

#[test]
fn pairs_are_read_to_the_end_of_a_list_and_no_further() {
    let list = [5, -6, 7, -8];
    let [[a, b], [c, d]] = Portable::gather_pairs(&list, &[0, 1, 0, 1, 0, 1, 0, 1], &[0, 1]);
    let read = [a, b, c, d].map(|v| v.to_array()[1] as i32);
    assert_eq!(read, [-6, 7, 7, -8]);
    let beyond = |length: usize, index: u32| {
        let list = &list[..length];
        let read = std::panic::catch_unwind(|| {
            let _ = Portable::gather_pairs(list, &[0, 0, 0, index, 0, 0, 0, 0], &[0, 1]);
        });
        let sse2 = std::panic::catch_unwind(|| {
            let _ = Sse2::gather_pairs(list, &[0, 0, 0, index, 0, 0, 0, 0], &[0, 1]);
        });
        // SAFETY: the processor has what is called for.
        #[allow(unsafe_code, reason = "calls a function that needs processor features, checked first")]
        let avx2 = std::panic::catch_unwind(|| unsafe {
            if InstructionSet::Avx2.is_available() {
                pairs_with_avx2(list, index);
            } else {
                panic!("as it should");
            }
        });
        assert!(read.is_err() && sse2.is_err() && avx2.is_err(), "{index} of {length}");
    };
    for (length, index) in [(4, 2), (4, u32::MAX), (4, 1 << 31), (2, 0), (1, 0), (0, 0)] {
        beyond(length, index);
    }
}

#[target_feature(enable = "avx2")]
fn pairs_with_avx2(list: &[i16], index: u32) {
    let _ = Avx2::gather_pairs(list, &[0, 0, 0, index, 0, 0, 0, 0], &[0, 1]);
}

#[test]
fn the_process_uses_what_it_is_limited_to() {
    for most in InstructionSet::ALL {
        let chosen = limit_to(most);
        assert_eq!(chosen, most.min(InstructionSet::fastest_available()));
        assert!(chosen.is_available());
    }
    assert_eq!(in_use(), InstructionSet::fastest_available());
}
