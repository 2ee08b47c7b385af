//! Numbers on the command line: out of their range, they get the sentence that says what is allowed.

use std::fmt::Display;
use std::ops::RangeInclusive;

/// A number of a kind within a range; the sentence says which.
pub(super) fn within<N: std::str::FromStr + PartialOrd>(
    text: &str,
    range: RangeInclusive<N>,
    allowed: impl Display,
) -> Result<N, String> {
    // What is not a number is in no range.
    text.parse().ok().filter(|x| range.contains(x)).ok_or_else(|| format!("allowed is {allowed}"))
}

/// The seed of random choices.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    within(text, 0..=u64::MAX, "a whole number from 0 to 18446744073709551615")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_in_range_is_a_number() {
        let rate = |text: &str| within(text, 0.0..=10.0, "0 to 10 1/s");
        assert_eq!((rate("0"), rate("1e1")), (Ok(0.0), Ok(10.0)));
        for bad in ["-1", "10.1", "nan", "inf", "", "1/s"] {
            assert_eq!(rate(bad), Err("allowed is 0 to 10 1/s".into()), "{bad}");
        }
        assert_eq!(seed("18446744073709551615"), Ok(u64::MAX));
        assert!(seed("-1").is_err() && seed("1.5").is_err());
    }
}
