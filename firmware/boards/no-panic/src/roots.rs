//! The functions that must not panic, for every input: each takes what it works on by reference, so nothing of it is known here.

use core::hint::black_box;
use pliant_core::ds::{CertificateError, ModelError};
use pliant_core::passive::{Interaction, Passive, PassiveError, Tank};
use pliant_core::scalar::Fixed;
use pliant_core::{
    Certified, Command, Component, Controller, LpvDs, Matrix, Obstacle, ObstacleError, ObstacleSpec, RobotState,
    Scalar, Scan, ScanError, Settings, SettingsError, Stages, TableFull, Vector,
};
use pliant_firmware::{Control, Device};
use pliant_protocol::FRAME_MAX;

/// Puts every function into the image.
pub fn keep() {
    controller::<f32, 2, 64>();
    controller::<f32, 3, 64>();
    controller::<Fixed, 2, 8>();
    controller::<Fixed, 3, 8>();
    passive::<f32, 3>();
    passive::<Fixed, 3>();
    black_box(control as fn(&mut Control, u32));
    black_box(device as fn(&mut Device, u32, &mut [u8; FRAME_MAX]) -> usize);
    black_box(frame as fn(&mut Device, &[u8], &mut [u8; FRAME_MAX]) -> usize);
    #[cfg(feature = "planted")]
    black_box(planted as fn(&[u8], usize) -> u8);
}

fn controller<S: Scalar, const D: usize, const CAP: usize>() {
    black_box(tick::<S, D, CAP> as fn(&mut Controller<S, D, CAP>, &RobotState<S, D>, S) -> Command<S, D>);
    black_box(tick_late::<S, D, CAP> as fn(&mut Controller<S, D, CAP>, &RobotState<S, D>, S) -> Command<S, D>);
    black_box(wait::<S, D, CAP> as fn(&mut Controller<S, D, CAP>, S));
    black_box(upsert::<S, D, CAP> as fn(&mut Controller<S, D, CAP>, u16, &Obstacle<S, D>, S) -> Result<(), TableFull>);
    black_box(remove::<S, D, CAP> as fn(&mut Controller<S, D, CAP>, u16) -> bool);
    black_box(set_scan::<S, D, CAP> as fn(&mut Controller<S, D, CAP>, &Scan<S, D>, S));
    black_box(aim::<S, D, CAP> as fn(&mut Controller<S, D, CAP>, &Vector<S, D>, &Vector<S, D>) -> bool);
    black_box(stages::<S, D, CAP> as fn(&Controller<S, D, CAP>, &RobotState<S, D>) -> Stages<S, D>);
    black_box(modulated::<S, D, CAP> as fn(&Controller<S, D, CAP>, &RobotState<S, D>) -> Vector<S, D>);
    black_box(check::<S> as fn(&Settings<S>) -> Result<(), SettingsError>);
    black_box(certify::<S, D> as fn(&LpvDs<S, D>) -> Result<Certified<LpvDs<S, D>>, CertificateError>);
    black_box(skill::<S, D> as fn(&Vector<S, D>, &Matrix<S, D>, &[Component<S, D>]) -> Result<LpvDs<S, D>, ModelError>);
    black_box(obstacle::<S, D> as fn(&ObstacleSpec<S, D>) -> Result<Obstacle<S, D>, ObstacleError>);
    black_box(scan::<S, D> as fn(&[Vector<S, D>], S) -> Result<Scan<S, D>, ScanError>);
}

fn passive<S: Scalar, const D: usize>() {
    black_box(
        step::<S, D>
            as fn(
                &Passive<S>,
                &mut Tank<S>,
                &Vector<S, D>,
                &Vector<S, D>,
                S,
            ) -> Result<Interaction<S, D>, PassiveError>,
    );
}

fn step<S: Scalar, const D: usize>(
    passive: &Passive<S>,
    tank: &mut Tank<S>,
    robot_velocity: &Vector<S, D>,
    wanted: &Vector<S, D>,
    dt: S,
) -> Result<Interaction<S, D>, PassiveError> {
    passive.step(tank, robot_velocity, wanted, dt)
}

fn tick<S: Scalar, const D: usize, const CAP: usize>(
    controller: &mut Controller<S, D, CAP>,
    state: &RobotState<S, D>,
    dt: S,
) -> Command<S, D> {
    controller.tick(state, dt)
}

fn tick_late<S: Scalar, const D: usize, const CAP: usize>(
    controller: &mut Controller<S, D, CAP>,
    state: &RobotState<S, D>,
    dt: S,
) -> Command<S, D> {
    controller.tick_late(state, dt)
}

fn wait<S: Scalar, const D: usize, const CAP: usize>(controller: &mut Controller<S, D, CAP>, dt: S) {
    controller.wait(dt);
}

fn upsert<S: Scalar, const D: usize, const CAP: usize>(
    controller: &mut Controller<S, D, CAP>,
    id: u16,
    obstacle: &Obstacle<S, D>,
    age: S,
) -> Result<(), TableFull> {
    controller.upsert(id, obstacle.clone(), age)
}

fn remove<S: Scalar, const D: usize, const CAP: usize>(controller: &mut Controller<S, D, CAP>, id: u16) -> bool {
    controller.table_mut().remove(id)
}

fn set_scan<S: Scalar, const D: usize, const CAP: usize>(
    controller: &mut Controller<S, D, CAP>,
    scan: &Scan<S, D>,
    age: S,
) {
    controller.set_scan(scan.clone(), age);
}

fn aim<S: Scalar, const D: usize, const CAP: usize>(
    controller: &mut Controller<S, D, CAP>,
    position: &Vector<S, D>,
    velocity: &Vector<S, D>,
) -> bool {
    controller.aim(position, velocity)
}

fn obstacle<S: Scalar, const D: usize>(spec: &ObstacleSpec<S, D>) -> Result<Obstacle<S, D>, ObstacleError> {
    Obstacle::new(spec.clone())
}

fn stages<S: Scalar, const D: usize, const CAP: usize>(
    controller: &Controller<S, D, CAP>,
    state: &RobotState<S, D>,
) -> Stages<S, D> {
    controller.evaluate(state)
}

fn modulated<S: Scalar, const D: usize, const CAP: usize>(
    controller: &Controller<S, D, CAP>,
    state: &RobotState<S, D>,
) -> Vector<S, D> {
    controller.modulated(state)
}

fn check<S: Scalar>(settings: &Settings<S>) -> Result<(), SettingsError> {
    settings.check()
}

fn skill<S: Scalar, const D: usize>(
    attractor: &Vector<S, D>,
    lyapunov: &Matrix<S, D>,
    components: &[Component<S, D>],
) -> Result<LpvDs<S, D>, ModelError> {
    LpvDs::new(*attractor, *lyapunov, components)
}

fn certify<S: Scalar, const D: usize>(model: &LpvDs<S, D>) -> Result<Certified<LpvDs<S, D>>, CertificateError> {
    model.clone().certify()
}

fn scan<S: Scalar, const D: usize>(points: &[Vector<S, D>], radius: S) -> Result<Scan<S, D>, ScanError> {
    Scan::new(points, radius)
}

fn control(control: &mut Control, overdue: u32) {
    control.tick(overdue);
}

fn device(device: &mut Device, overdue: u32, room: &mut [u8; FRAME_MAX]) -> usize {
    device.tick(overdue, room).map_or(0, <[u8]>::len)
}

fn frame(device: &mut Device, frame: &[u8], room: &mut [u8; FRAME_MAX]) -> usize {
    device.receive(frame, room).map_or(0, <[u8]>::len)
}

#[cfg(feature = "planted")]
fn planted(bytes: &[u8], at: usize) -> u8 {
    bytes[at]
}
