//! What the programme's answer must be, by trying every set of constraints that could be active, in f64.

use pliant_core::Vector;

/// normal.u >= offset
pub type Side<const D: usize> = (Vector<f64, D>, f64);

/// What rounding may do here.
const SLACK: f64 = 1e-11;

pub fn worst<const D: usize>(sides: &[Side<D>], u: &Vector<f64, D>) -> f64 {
    sides.iter().map(|(n, b)| b - n.dot(u)).fold(0.0, f64::max)
}

/// The solution of equations a.u = b and t.u = c: as many as dimensions, by elimination with a complete choice of pivots.
fn meet<const D: usize>(mut rows: Vec<Side<D>>) -> Option<Vector<f64, D>> {
    let mut order: Vec<usize> = (0..D).collect();
    for k in 0..D {
        let (i, j) = (k..D)
            .flat_map(|i| (k..D).map(move |j| (i, j)))
            .max_by(|a, b| rows[a.0].0[order[a.1]].abs().total_cmp(&rows[b.0].0[order[b.1]].abs()))?;
        rows.swap(k, i);
        order.swap(k, j);
        let pivot = rows[k];
        let head = pivot.0[order[k]];
        if head.abs() < 1e-13 {
            return None;
        }
        for row in rows.iter_mut().skip(k + 1) {
            let factor = row.0[order[k]] / head;
            row.0 -= pivot.0 * factor;
            row.1 -= pivot.1 * factor;
        }
    }
    let mut u = Vector::zeros();
    for k in (0..D).rev() {
        let rest: f64 = (k + 1..D).map(|j| rows[k].0[order[j]] * u[order[j]]).sum();
        u[order[k]] = (rows[k].1 - rest) / rows[k].0[order[k]];
    }
    Some(u)
}

/// Unit vectors across all the given ones and each other.
fn tangents<const D: usize>(rows: &[Side<D>]) -> Option<Vec<Vector<f64, D>>> {
    let across = |mut v: Vector<f64, D>, set: &[Vector<f64, D>]| {
        for _ in 0..3 {
            for q in set {
                v -= q * q.dot(&v);
            }
        }
        v
    };
    let mut set = Vec::new();
    for (n, _) in rows {
        let mut v = *n;
        for _ in 0..2 {
            v = across(v, &set);
            let length = v.norm();
            if length < 1e-13 {
                return None;
            }
            v /= length;
        }
        set.push(v);
    }
    for _ in rows.len()..D {
        let v = (0..D)
            .map(|i| across(Vector::from_fn(|j, _| f64::from(u8::from(i == j))), &set))
            .max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
        set.push(across(v.normalize(), &set));
    }
    Some(set.split_off(rows.len()))
}

/// The subsets of 0..n with `least` to `most` members.
fn subsets(n: usize, least: usize, most: usize, mut visit: impl FnMut(&[usize])) {
    fn grow(n: usize, least: usize, most: usize, set: &mut Vec<usize>, visit: &mut impl FnMut(&[usize])) {
        if set.len() >= least {
            visit(set);
        }
        if set.len() < most {
            for i in set.last().map_or(0, |last| last + 1)..n {
                set.push(i);
                grow(n, least, most, set, visit);
                set.pop();
            }
        }
    }
    grow(n, least, most, &mut Vec::new(), &mut visit);
}

/// Where the flat of these equations comes nearest to zero, and its directions.
fn flat<const D: usize>(rows: &[Side<D>]) -> Option<(Vector<f64, D>, Vec<Vector<f64, D>>)> {
    let along = tangents(rows)?;
    let equations = rows.iter().copied().chain(along.iter().map(|t| (*t, 0.0))).collect();
    Some((meet(equations)?, along))
}

fn part<const D: usize>(v: &Vector<f64, D>, along: &[Vector<f64, D>]) -> Vector<f64, D> {
    along.iter().map(|t| t * t.dot(v)).sum()
}

/// The distance from `wanted` to the nearest velocity allowed, and that velocity, for a speed of one.
pub fn nearest<const D: usize>(wanted: &Vector<f64, D>, sides: &[Side<D>]) -> Option<(f64, Vector<f64, D>)> {
    let mut best: Option<(f64, Vector<f64, D>)> = None;
    let mut offer = |u: Vector<f64, D>| {
        let distance = (u - wanted).norm();
        if best.is_none_or(|(d, _)| distance < d) && u.norm() <= 1.0 + SLACK && worst(sides, &u) <= SLACK {
            best = Some((distance, u));
        }
    };
    subsets(sides.len(), 0, D, |set| {
        let rows: Vec<Side<D>> = set.iter().map(|i| sides[*i]).collect();
        let Some((centre, along)) = flat(&rows) else { return };
        if centre.norm() > 1.0 + SLACK {
            return;
        }
        let step = part(wanted, &along);
        offer(centre + step);
        let radius = (1.0 - centre.norm_squared()).max(0.0).sqrt();
        if step.norm() > 0.0 {
            offer(centre + step.normalize() * radius);
        }
    });
    best
}

/// The least t for which a velocity in the unit ball violates nothing by more than t.
pub fn least_violation<const D: usize>(sides: &[Side<D>]) -> f64 {
    let mut least = f64::MAX;
    subsets(sides.len(), 1, D + 1, |set| {
        let (first, others) = set.split_first().unwrap();
        let (n, b) = sides[*first];
        let rows: Option<Vec<Side<D>>> = others
            .iter()
            .map(|j| {
                let (m, c) = (sides[*j].0 - n, sides[*j].1 - b);
                (m.norm() > 1e-12).then(|| (m / m.norm(), c / m.norm()))
            })
            .collect();
        let Some((centre, along)) = rows.and_then(|rows| flat(&rows)) else { return };
        let radius = (1.0 - centre.norm_squared()).sqrt();
        if !(radius >= 0.0) && centre.norm() > 1.0 + SLACK {
            return;
        }
        let step = part(&n, &along);
        for u in [centre, centre + step * (radius.max(0.0) / step.norm().max(1e-300))] {
            let t = (b - n.dot(&u)).max(0.0);
            if t < least && worst(sides, &u) <= t + SLACK {
                least = t;
            }
        }
    });
    least
}
