//! Which cores overlap is found piece by piece, and anything may happen between two pieces.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use pliant_core::{Ageing, Obstacle, ObstacleSpec, Table, Vector};

/// A row of balls, each overlapping the next.
fn row() -> Vec<Obstacle<f64, 2>> {
    let at = |i: usize| ObstacleSpec { center: Vector::<f64, 2>::new(0.08 * i as f64, 0.0), ..ObstacleSpec::default() };
    (0..12).map(|i| Obstacle::new(at(i)).unwrap()).collect()
}

fn references<const CAP: usize>(table: &Table<f64, 2, CAP>) -> Vec<(u16, Vector<f64, 2>)> {
    let mut all: Vec<_> = table.iter().map(|e| (e.id(), e.obstacle().reference())).collect();
    all.sort_by_key(|(id, _)| *id);
    all
}

#[test]
fn changes_may_come_between_two_pieces() {
    let ageing = Ageing::default();
    let (mut whole, mut pieces): (Table<f64, 2, 12>, Table<f64, 2, 12>) = (Table::new(), Table::new());
    // From the 60th change on all are there; some go and come back, at any stage of what is being done about others.
    let order = (0..200_u16).map(|n| if n < 60 { n * 7 % 12 } else { n * 5 % 12 });
    for (n, id) in order.enumerate() {
        let obstacle = row()[usize::from(id)].clone();
        if n % 3 == 2 {
            assert_eq!(whole.remove(id), pieces.take(id));
        } else {
            whole.upsert(id, obstacle.clone(), 0.0, &ageing).unwrap();
            pieces.put(id, obstacle, 0.0, &ageing).unwrap();
        }
        for _ in 0..n % 5 {
            pieces.settle();
        }
        if n % 20 == 19 {
            while pieces.settle() {}
            assert_eq!(references(&whole), references(&pieces), "after {n}");
            assert_eq!(whole.advance(0.0, &ageing), pieces.advance(0.0, &ageing));
        }
    }
}

#[test]
fn constant_change_does_not_keep_others_waiting() {
    let ageing = Ageing::default();
    let mut table: Table<f64, 2, 12> = Table::new();
    for (id, obstacle) in (0..).zip(row()) {
        table.put(id, obstacle, 0.0, &ageing).unwrap();
    }
    let own: Vec<_> = row().iter().map(|o| (0, o.spec().center)).collect();
    let shared = |t: &Table<f64, 2, 12>| {
        references(t).iter().zip(&own).filter(|((_, reference), (_, center))| reference != center).count()
    };
    // All are seen again within 24 pieces, less than a round takes. A new one has its own reference point until its cluster has been looked at.
    let mut often = 0;
    for n in 0..2000 {
        let id = n * 5 % 12;
        table.put(id, row()[usize::from(id)].clone(), 0.0, &ageing).unwrap();
        table.settle();
        table.settle();
        often += u32::from(shared(&table) > 0);
    }
    assert!(often > 200, "{often}");
}
