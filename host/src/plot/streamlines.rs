//! Evenly spaced streamlines, after Jobard & Lefer (1997): each new line starts at a set distance from one that is there, and ends
//! where it comes too near to another.

use std::collections::{HashMap, VecDeque};

use nalgebra::{Point2, Vector2};

use super::figure::Extent;

/// How near a line may come to another before it ends, over the distance they start at.
const CLOSEST: f64 = 0.5;
/// Step of integration over the distance.
const STEP: f64 = 0.06;
/// Shortest line worth drawing, over the distance.
const SHORTEST: f64 = 2.2;
/// Most points of one line, either way.
const LONGEST: usize = 4000;

/// Lines along `field` that fill `extent`, about `distance` apart. Where the field is `None` or zero there is no line.
pub fn streamlines(
    field: &dyn Fn(Point2<f64>) -> Option<Vector2<f64>>,
    extent: &Extent,
    distance: f64,
) -> Vec<Vec<Point2<f64>>> {
    let mut lines: Vec<Vec<Point2<f64>>> = Vec::new();
    let mut drawn = Drawn { cell: distance, cells: HashMap::new() };
    let mut seeds = grid(extent, distance);
    while let Some(seed) = seeds.pop_front() {
        if !extent.holds(&seed) || drawn.near(&seed, distance * 0.98) {
            continue;
        }
        let line = trace(field, extent, &drawn, seed, distance);
        if (line.len() as f64) * STEP < SHORTEST {
            continue;
        }
        for (i, pair) in line.windows(2).enumerate() {
            drawn.add(pair[0]);
            if i % 8 == 0 {
                let along = (pair[1] - pair[0]).normalize();
                let side = Vector2::new(-along.y, along.x) * distance;
                // The neighbours of what is there come before the rest of the grid, so that lines lie side by side.
                seeds.push_front(pair[0] + side);
                seeds.push_front(pair[0] - side);
            }
        }
        lines.push(line);
    }
    lines
}

/// Seeds that reach every part, the middle first.
fn grid(extent: &Extent, distance: f64) -> VecDeque<Point2<f64>> {
    let size = extent.size();
    let (nx, ny) = ((size.x / distance).ceil() as i32, (size.y / distance).ceil() as i32);
    let middle = nalgebra::center(&extent.low, &extent.high);
    let mut seeds: Vec<Point2<f64>> = (0..=nx)
        .flat_map(|i| (0..=ny).map(move |j| Vector2::new(f64::from(i), f64::from(j)) * distance))
        .map(|offset| extent.low + offset)
        .collect();
    seeds.sort_by(|a, b| (a - middle).norm().total_cmp(&(b - middle).norm()));
    seeds.into()
}

fn trace(
    field: &dyn Fn(Point2<f64>) -> Option<Vector2<f64>>,
    extent: &Extent,
    drawn: &Drawn,
    seed: Point2<f64>,
    distance: f64,
) -> Vec<Point2<f64>> {
    let half = |sign: f64| {
        let mut points = Vec::new();
        let mut own = Drawn { cell: distance, cells: HashMap::new() };
        let mut at = seed;
        while points.len() < LONGEST {
            let Some(next) = step(field, at, sign * STEP * distance) else {
                break;
            };
            if !extent.holds(&next) || drawn.near(&next, CLOSEST * distance) {
                break;
            }
            // A line that comes back to itself, as round a centre, ends; its last part does not count.
            let lag = (2.0 / STEP) as usize;
            if let Some(old) = points.len().checked_sub(lag).and_then(|i| points.get(i)) {
                own.add(*old);
            }
            if own.near(&next, CLOSEST * distance) {
                break;
            }
            points.push(next);
            at = next;
        }
        points
    };
    let mut line = half(-1.0);
    line.reverse();
    line.push(seed);
    line.extend(half(1.0));
    line
}

/// One step of fixed length along the direction of the field (midpoint rule).
fn step(field: &dyn Fn(Point2<f64>) -> Option<Vector2<f64>>, at: Point2<f64>, length: f64) -> Option<Point2<f64>> {
    let direction = |p| field(p)?.try_normalize(1e-9);
    let first = direction(at)?;
    let middle = direction(at + first * (length / 2.0))?;
    // The direction has turned right round within a step: this is the attractor.
    (first.dot(&middle) > 0.0).then(|| at + middle * length)
}

/// What has been drawn, by place.
struct Drawn {
    cell: f64,
    cells: HashMap<(i64, i64), Vec<Point2<f64>>>,
}

impl Drawn {
    fn key(&self, p: &Point2<f64>) -> (i64, i64) {
        ((p.x / self.cell).floor() as i64, (p.y / self.cell).floor() as i64)
    }

    fn add(&mut self, p: Point2<f64>) {
        let key = self.key(&p);
        self.cells.entry(key).or_default().push(p);
    }

    /// Is anything within `distance`, which is at most a cell?
    fn near(&self, p: &Point2<f64>, distance: f64) -> bool {
        let (i, j) = self.key(p);
        (i - 1..=i + 1).any(|i| {
            (j - 1..=j + 1)
                .any(|j| self.cells.get(&(i, j)).is_some_and(|points| points.iter().any(|q| (p - q).norm() < distance)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Extent {
        Extent { low: Point2::new(0.0, 0.0), high: Point2::new(1.0, 1.0) }
    }

    #[test]
    fn parallel_flow_gives_parallel_lines_from_side_to_side() {
        let lines = streamlines(&|_| Some(Vector2::new(1.0, 0.0)), &unit(), 0.1);
        assert!((9..=12).contains(&lines.len()), "{}", lines.len());
        for line in &lines {
            assert!(line.iter().all(|p| (p.y - line[0].y).abs() < 1e-9));
            assert!(line[line.len() - 1].x - line[0].x > 0.95);
        }
    }

    #[test]
    fn a_rotation_ends_its_circles_and_nothing_is_drawn_where_there_is_no_field() {
        let field = |p: Point2<f64>| {
            let r = p - Point2::new(0.5, 0.5);
            (r.norm() > 0.2).then(|| Vector2::new(-r.y, r.x))
        };
        let lines = streamlines(&field, &unit(), 0.08);
        assert!(!lines.is_empty());
        for p in lines.iter().flatten() {
            assert!((p - Point2::new(0.5, 0.5)).norm() > 0.19);
        }
    }

    #[test]
    fn no_field_no_lines() {
        assert!(streamlines(&|_| None, &unit(), 0.1).is_empty());
        assert!(streamlines(&|_| Some(Vector2::zeros()), &unit(), 0.1).is_empty());
    }
}
