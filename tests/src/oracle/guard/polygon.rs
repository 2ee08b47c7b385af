//! The half-spaces of a polygon, as section 7 of the page has them: one for each convex piece, from points and lines in the world.

use nalgebra::DVector;

use super::super::geometry::{length, plane_cross, turned_left, unit};
use super::super::obstacle::Body;
use super::super::shape::{Shape, turned_right};

/// By how much two choices may differ for rounding to decide between them, m.
const TIE: f64 = 1e-9;

/// n.delta >= -gap.
pub(super) struct Side {
    pub(super) normal: DVector<f64>,
    pub(super) gap: f64,
    /// False where rounding decides which it is.
    pub(super) clear: bool,
}

/// One edge in the world, with the normal to where a robot may be.
struct Edge {
    from: DVector<f64>,
    to: DVector<f64>,
    normal: DVector<f64>,
}

impl Edge {
    fn gap(&self, x: &DVector<f64>) -> f64 {
        self.normal.dot(&(x - &self.from))
    }
}

/// One half-space for each piece; `asked` is what the page takes the choice by: u dt, over alpha.
pub(super) fn sides(body: &Body, x: &DVector<f64>, asked: &DVector<f64>) -> Vec<Side> {
    let Shape::Star(star) = &body.shape else {
        return Vec::new();
    };
    let corners: Vec<DVector<f64>> =
        star.corners().iter().map(|corner| body.world(&corner.component_mul(&body.hard))).collect();
    let n = corners.len();
    let edges: Vec<Edge> = (0..n)
        .filter_map(|i| {
            let (from, to) = (corners[i].clone(), corners[(i + 1) % n].clone());
            let along = &to - &from;
            let normal = unit(&if body.wall { turned_left(&along) } else { turned_right(&along) })?;
            Some(Edge { from, to, normal })
        })
        .collect();
    pieces(body, &edges).iter().filter_map(|piece| side(body, &edges, piece, x, asked)).collect()
}

/// Whether both edges at the i-th corner, before the i-th edge, are lines with the other behind them.
fn sticks_out(edges: &[Edge], i: usize) -> bool {
    let before = &edges[(i + edges.len() - 1) % edges.len()];
    before.gap(&edges[i % edges.len()].to) <= TIE
}

fn pieces(body: &Body, edges: &[Edge]) -> Vec<Vec<usize>> {
    let n = edges.len();
    if body.wall {
        return (0..n).map(|i| vec![i]).collect();
    }
    let Some(notch) = (0..n).find(|i| !sticks_out(edges, *i)) else {
        return vec![(0..n).collect()];
    };
    let mut found: Vec<Vec<usize>> = Vec::new();
    for i in (notch..notch + n).map(|i| i % n) {
        let goes_on = |piece: &Vec<usize>| {
            let begin = &edges[piece[0]].from - &body.center;
            sticks_out(edges, i) && plane_cross(&begin, &(&edges[i].to - &body.center)) > 0.0
        };
        match found.last_mut() {
            Some(piece) if goes_on(piece) => piece.push(i),
            _ => found.push(vec![i]),
        }
    }
    found
}

/// The piece's edges, and those that go on from it as long as all of it is behind them.
fn outline(edges: &[Edge], piece: &[usize]) -> Vec<usize> {
    let n = edges.len();
    let holds =
        |i: usize| piece.iter().all(|k| edges[i].gap(&edges[*k].from) <= TIE && edges[i].gap(&edges[*k].to) <= TIE);
    let mut all = piece.to_vec();
    while all.len() < n {
        let next = (all[all.len() - 1] + 1) % n;
        if !(sticks_out(edges, next) && holds(next)) {
            break;
        }
        all.push(next);
    }
    while all.len() < n {
        let before = (all[0] + n - 1) % n;
        if !(sticks_out(edges, all[0]) && holds(before)) {
            break;
        }
        all.insert(0, before);
    }
    all
}

fn side(body: &Body, edges: &[Edge], piece: &[usize], x: &DVector<f64>, asked: &DVector<f64>) -> Option<Side> {
    let outline = outline(edges, piece);
    // Only a polygon of one piece goes round; the outline of another may have all edges and still ends at the two sides of a notch.
    let closed = piece.len() == edges.len();
    let inner = |k: usize, at_end: bool| closed || if at_end { k + 1 < outline.len() } else { k > 0 };
    // The nearest point of every edge, and the half-space there, if there is one.
    let mut feet: Vec<(f64, Option<DVector<f64>>)> = Vec::new();
    for (k, i) in outline.iter().enumerate() {
        let edge = &edges[*i];
        let along = &edge.to - &edge.from;
        let share = (x - &edge.from).dot(&along) / along.norm_squared();
        let foot = &edge.from + &along * share.clamp(0.0, 1.0);
        let way = x - &foot;
        let front = edge.gap(x) > 0.0;
        let normal = if (0.0..=1.0).contains(&share) {
            front.then(|| edge.normal.clone())
        } else if inner(k, share > 1.0) {
            unit(&way)
        } else {
            None
        };
        feet.push((length(&way), normal));
    }
    let least = |there: bool| feet.iter().filter(|foot| foot.1.is_some() == there).min_by(|a, b| a.0.total_cmp(&b.0));
    let (seen, unseen) = (least(true), least(false));
    let clear = match (seen, unseen) {
        (Some(seen), Some(unseen)) => (seen.0 - unseen.0).abs() > TIE,
        _ => true,
    };
    if let Some((gap, Some(normal))) = seen
        && unseen.is_none_or(|unseen| gap < &unseen.0)
    {
        return Some(Side { normal: normal.clone(), gap: *gap, clear });
    }
    let lines = outline.iter().map(|i| (edges[*i].normal.clone(), edges[*i].gap(x))).collect::<Vec<_>>();
    let mut beyond: Vec<(DVector<f64>, f64)> = lines.iter().filter(|line| line.1 > 0.0).cloned().collect();
    if !closed {
        let from = &edges[piece[0]].from - &body.center;
        let to = &edges[piece[piece.len() - 1]].to - &body.center;
        let own = x - &body.center;
        for normal in [unit(&turned_right(&from)), unit(&turned_left(&to))].into_iter().flatten() {
            let gap = normal.dot(&own);
            if gap > 0.0 {
                beyond.push((normal, gap));
            }
        }
        if from.dot(&own) <= 0.0
            && to.dot(&own) <= 0.0
            && let Some(out) = unit(&own)
        {
            beyond.push((out, length(&own)));
        }
    }
    let outside = !beyond.is_empty();
    let choice = if outside { beyond } else { lines };
    let by = |line: &(DVector<f64>, f64)| if outside { line.1 + line.0.dot(asked) } else { line.1 };
    let best = choice.iter().max_by(|a, b| by(a).total_cmp(&by(b)))?;
    // The same line twice is no tie.
    let tied = |line: &&(DVector<f64>, f64)| by(line) > by(best) - TIE && length(&(&line.0 - &best.0)) > TIE;
    let clear = clear && !choice.iter().any(|line| tied(&line)) && choice.iter().all(|line| line.1.abs() > TIE);
    Some(Side { normal: best.0.clone(), gap: best.1, clear })
}
