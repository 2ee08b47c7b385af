//! Round values on a scale.

/// A tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Where it is.
    pub value: f64,
    /// What is written there.
    pub label: String,
}

/// About `wanted` ticks at round values between two ends.
fn ticks(low: f64, high: f64, wanted: f64) -> Vec<Tick> {
    let rough = (high - low) / wanted.max(1.0);
    if !(rough > 0.0 && rough.is_finite()) {
        return Vec::new();
    }
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= rough * 0.8).unwrap_or(10.0 * power);
    let decimals = usize::try_from(-(step * 1.001).log10().floor() as i64).unwrap_or(0);
    let (first, last) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
    (first..=last)
        .map(|i| {
            let value = i as f64 * step;
            // A true minus is as wide as a plus; a hyphen is not.
            let label = format!("{:.decimals$}", if i == 0 { 0.0 } else { value }).replace('-', "\u{2212}");
            Tick { value, label }
        })
        .collect()
}

/// As few ticks as make a scale: fewer do not tell how it goes on between and beyond them.
const LEAST_TICKS: usize = 3;

/// Ticks along a scale `length` px long, about `every` px apart; closer to each other where fewer than three would be there and there is room for their
/// labels, which are so long along the scale (px).
pub fn scale_ticks(low: f64, high: f64, length: f64, every: f64, label: fn(&str) -> f64) -> Vec<Tick> {
    const APART: f64 = 5.0;
    let usual = ticks(low, high, length / every);
    if usual.len() >= LEAST_TICKS {
        return usual;
    }
    let at = |t: &Tick| (t.value - low) / (high - low) * length;
    let apart = |w: &[Tick]| at(&w[1]) - at(&w[0]) >= (label(&w[0].label) + label(&w[1].label)) / 2.0 + APART;
    let mut closer = (1..8).map(|i| ticks(low, high, (length / every).max(1.0) * 1.3_f64.powi(i)));
    closer.find(|t| t.len() >= LEAST_TICKS && t.windows(2).all(apart)).unwrap_or(usual)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within() {
        let labels = |low, high, n| ticks(low, high, n).into_iter().map(|t| t.label).collect::<Vec<_>>();
        assert_eq!(labels(-0.05, 0.43, 5.0), ["0.0", "0.1", "0.2", "0.3", "0.4"]);
        assert_eq!(labels(-1.0, 1.0, 4.0), ["\u{2212}1.0", "\u{2212}0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(0.0, 100.0, 5.0), ["0", "20", "40", "60", "80", "100"]);
        assert!(ticks(1.0, 1.0, 5.0).is_empty() && ticks(f64::NAN, 1.0, 5.0).is_empty());
    }

    #[test]
    fn a_scale_has_three_ticks_at_least_where_they_have_room() {
        for (high, length) in [(0.45, 90.0), (0.9, 100.0), (0.86, 150.0), (1.1, 250.0), (2.0e-3, 75.0)] {
            let found = scale_ticks(0.0, high, length, 50.0, |_| 12.0);
            assert!((3..=7).contains(&found.len()), "{high} {length}: {found:?}");
            assert!(found.iter().all(|t| (0.0..=high * (1.0 + 1e-9)).contains(&t.value)));
        }
        // What has enough stays, and what has no room for more.
        assert_eq!(scale_ticks(-0.05, 0.43, 250.0, 50.0, |_| 12.0), ticks(-0.05, 0.43, 5.0));
        assert_eq!(scale_ticks(0.0, 0.9, 50.0, 50.0, |_| 12.0), ticks(0.0, 0.9, 1.0));
        assert_eq!(scale_ticks(-0.12, 0.39, 130.0, 40.0, |_| 26.0), ticks(-0.12, 0.39, 3.25));
        assert!(scale_ticks(1.0, 1.0, 100.0, 50.0, |_| 12.0).is_empty());
    }
}
