//! Round: lengths of 1, 2 or 5 times a power of ten, near to a wished one.

/// Smallest length that is wished for. Metres.
const LEAST: f32 = 1e-30;

/// The largest round length that is no larger than wished. Metres.
pub(crate) fn round_below(wished: f32) -> f64 {
    let wished = f64::from(wished.max(LEAST));
    // A decimal less for what the logarithm may lose; 1 is then below what is wished, and found in any case.
    let power = wished.log10().floor() as i32 - 1;
    let lengths = (power..power + 3).flat_map(|power| [1, 2, 5].map(|factor| length(factor, power)));
    lengths.take_while(|length| *length <= wished).last().unwrap_or(wished)
}

/// The smallest round length that is no smaller than wished. Metres.
pub(crate) fn round_above(wished: f32) -> f64 {
    let below = round_below(wished);
    if below >= f64::from(wished) {
        return below;
    }
    // From one to the next it is at most two and a half times.
    round_below((below * 2.5001) as f32)
}

/// The number nearest to a factor times a power of ten, so that it is written without further digits.
fn length(factor: i32, power: i32) -> f64 {
    let tens = 10_f64.powi(power.abs());
    if power < 0 { f64::from(factor) / tens } else { f64::from(factor) * tens }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round_from_both_sides_however_small() {
        for (wished, below, above) in [
            (1.0, "1", "1"),
            (1.01, "1", "2"),
            (0.3, "0.2", "0.5"),
            (0.06, "0.05", "0.1"),
            (4.9e6, "2000000", "5000000"),
            (3e-8, "0.00000002", "0.00000005"),
        ] {
            let found = (round_below(wished).to_string(), round_above(wished).to_string());
            assert_eq!(found, (below.to_owned(), above.to_owned()), "{wished}");
        }
    }
}
