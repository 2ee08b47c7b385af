//! Distributions over runs.

use super::run::Passed;
use super::{QUANTITIES, values};
use crate::plot::Figure;
use crate::plot::chart::{Chart, Colour, Series, charts};
use crate::study::column::Column;
use crate::study::measure::quantile;

const COLOURS: [Colour; 3] = [Colour::Letter, Colour::Pliant, Colour::Original];

/// One chart a quantity, each with the share of runs that have no more of it; the outermost hundredths are cut off.
pub fn distributions(all: &[Passed]) -> Figure {
    let chart = |q: &super::Quantity| {
        let each: Vec<Vec<f64>> = (0..3).map(|c| values(all, |p| (q.of)(p, &p.runs[c]))).collect();
        let ends = |share: f64| each.iter().filter_map(move |v| quantile(v, share));
        let (low, high) = (ends(0.01).fold(f64::INFINITY, f64::min), ends(0.99).fold(f64::NEG_INFINITY, f64::max));
        let room = (high - low).max(1e-9) * 0.04;
        // What changes against the original does so by nothing for the original itself.
        let shown = if q.key.ends_with("change_percent") { 2 } else { 3 };
        let series = Column::ALL.into_iter().zip(COLOURS).zip(&each).take(shown);
        Chart {
            title: q.name.into(),
            x: q.unit.into(),
            y: "runs (%)".into(),
            series: series.map(|((column, colour), v)| Series::distribution(column.title(), colour, v)).collect(),
            // Without a value there is no range.
            x_range: (low <= high).then_some((low - room, high + room)),
            y_range: Some((0.0, 100.0)),
            ..Chart::default()
        }
    };
    let all: Vec<Chart> = QUANTITIES.iter().map(chart).collect();
    charts(&all, 2, 500.0)
}
