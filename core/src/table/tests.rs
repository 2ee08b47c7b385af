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
fn one_long_step_is_as_many_short_ones() {
    let ageing = Ageing::default();
    for milliseconds in [150, 300, 999, 1000, 10_000] {
        let (mut here, mut there): (Table<f64, 2, 1>, Table<f64, 2, 1>) = (Table::new(), Table::new());
        for table in [&mut here, &mut there] {
            table.upsert(1, moving(), 0.0, &ageing).unwrap();
        }
        for _ in 0..milliseconds {
            here.advance(0.001, &ageing);
        }
        there.advance(f64::from(milliseconds) * 0.001, &ageing);
        let look = |t: &Table<f64, 2, 1>| {
            let o = t.iter().next().unwrap().obstacle();
            [o.spec().center.x, o.gamma(&Vector::<f64, 2>::new(0.3, 0.1))]
        };
        let ([x, gamma], [at, level]) = (look(&here), look(&there));
        // The growth begins, and the motion ends, up to a step later.
        assert!(
            (x - at).abs() < 2e-4 && (gamma - level).abs() < 1e-2 * gamma,
            "{milliseconds} ms: {x} {at}, {gamma} {level}"
        );
    }
}

#[test]
fn an_age_that_is_no_number_is_the_oldest() {
    let mut table: Table<f64, 2, 1> = Table::new();
    table.upsert(1, moving(), f64::NAN, &Ageing::default()).unwrap();
    assert_eq!(table.iter().next().unwrap().age(), Ageing::<f64>::default().hold);
    assert_eq!(table.advance(0.001, &Ageing::default()), Status::HELD);
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

#[test]
fn a_surface_comes_as_fast_as_it_says_when_the_rules_of_ageing_change() {
    let rules = [(0.1, 0.02), (0.1, 0.3), (0.1, 0.05), (0.9, 0.05), (0.2, 0.0), (0.2, 0.1)]
        .map(|(time_to_live, growth)| Ageing { time_to_live, growth, hold: 2.0 });
    let mut table: Table<f64, 2, 1> = Table::new();
    table.upsert(1, Obstacle::new(ObstacleSpec::default()).unwrap(), 0.0, &rules[0]).unwrap();
    let way = Vector::<f64, 2>::new(1.0, 0.0);
    let mut grew = 0;
    for step in 0..1200 {
        let now = &rules[step / 200];
        // As the controller does when it is given other settings.
        table.rules_changed(now);
        let before = table.at(0).unwrap().clone();
        let surface = before.surface(&way);
        let said = before.sample(&(surface + way * 1e-9)).surface_velocity.x;
        table.advance(0.001, now);
        let came = (table.at(0).unwrap().surface(&way) - surface).x / 0.001;
        assert!((came - said).abs() < 1e-6, "step {step}: {said} said, {came} came");
        grew += u32::from(came > 1e-6);
    }
    assert!(grew > 600, "{grew}");
}

#[test]
fn a_time_that_is_none_is_no_time() {
    let ageing = Ageing { time_to_live: 0.0, ..Ageing::default() };
    let mut table: Table<f64, 2, 1> = Table::new();
    let ball = ObstacleSpec { velocity: Vector::<f64, 2>::new(1.0, 0.0), ..ObstacleSpec::default() };
    table.upsert(1, Obstacle::new(ball).unwrap(), 0.0, &ageing).unwrap();
    let before = table.iter().next().unwrap().clone();
    for dt in [f64::NAN, -1.0, f64::NEG_INFINITY, 0.0] {
        table.advance(dt, &ageing);
        assert_eq!(table.iter().next().unwrap(), &before, "{dt}");
    }
}
