use super::*;
use crate::{ObstacleSpec, Shape};

fn moving() -> Obstacle<f64, 2> {
    let velocity = Vector::<f64, 2>::new(0.1, 0.0);
    Obstacle::new(ObstacleSpec { velocity, ..ObstacleSpec::default() }).unwrap()
}

#[test]
fn an_old_obstacle_moves_then_grows_then_is_held() {
    let ageing = Ageing::default();
    let mut table: Table<f64, 2, 2> = Table::new();
    table.upsert(1, moving(), 0.05, &ageing).unwrap();
    let x = |t: &Table<f64, 2, 2>| t.iter().next().unwrap().obstacle().spec().center.x;
    let gamma = |t: &Table<f64, 2, 2>| {
        let o = t.iter().next().unwrap().obstacle();
        o.gamma(&(o.spec().center + Vector::<f64, 2>::new(0.05, 0.0)))
    };
    assert!((x(&table) - 0.005).abs() < 1e-12, "carried on by its age");
    for _ in 0..100 {
        table.advance(0.001, &ageing);
    }
    assert!(table.advance(0.0, &ageing).is_empty() && (gamma(&table) - 1.0).abs() < 1e-9);
    for _ in 0..350 {
        table.advance(0.001, &ageing);
    }
    assert_eq!(table.advance(0.0, &ageing), Status::EXTRAPOLATED);
    assert!(gamma(&table) < 0.9, "grown: {}", gamma(&table));
    for _ in 0..2000 {
        table.advance(0.001, &ageing);
    }
    assert_eq!(table.advance(0.0, &ageing), Status::HELD);
    let held = x(&table);
    assert!((held - 0.1).abs() < 1e-3, "{held}");
    table.advance(0.001, &ageing);
    assert_eq!(x(&table), held);
}

#[test]
fn an_old_sighting_is_as_if_it_had_aged_here() {
    let ageing = Ageing::default();
    let spin = crate::rotation::planar_spin(5.0);
    let velocity = Vector::<f64, 2>::new(0.1, -0.2);
    let shape = || Shape::ellipsoid(Vector::<f64, 2>::new(0.08, 0.04));
    let turning = || Obstacle::new(ObstacleSpec { velocity, spin, shape: shape(), ..ObstacleSpec::default() }).unwrap();
    for milliseconds in [0, 50, 300, 999, 1000, 5000] {
        let (mut here, mut there): (Table<f64, 2, 1>, Table<f64, 2, 1>) = (Table::new(), Table::new());
        here.upsert(1, turning(), 0.0, &ageing).unwrap();
        for _ in 0..milliseconds {
            here.advance(0.001, &ageing);
        }
        there.upsert(1, turning(), f64::from(milliseconds) * 0.001, &ageing).unwrap();
        for table in [&mut here, &mut there] {
            table.advance(0.001, &ageing);
        }
        let x = Vector::<f64, 2>::new(0.3, 0.1);
        let look = |t: &Table<f64, 2, 1>| {
            let o = t.iter().next().unwrap().obstacle();
            [o.gamma(&x), o.surface_velocity(&x).x, o.surface_velocity(&x).y]
        };
        for (a, b) in look(&here).into_iter().zip(look(&there)) {
            assert!((a - b).abs() < 5e-3 * (1.0 + a.abs()), "{milliseconds} ms: {a} {b}");
        }
    }
}

#[test]
fn every_change_has_its_revision() {
    let mut table: Table<f64, 2, 2> = Table::new();
    table.upsert(1, moving(), 0.0, &Ageing::default()).unwrap();
    table.advance(0.001, &Ageing::default());
    assert_eq!(table.revision(), 1);
    assert!(!table.remove(2));
    assert_eq!(table.revision(), 1);
    assert!(table.remove(1));
    table.clear();
    assert_eq!(table.revision(), 3);
}

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
