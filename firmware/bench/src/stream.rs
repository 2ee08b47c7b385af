//! What happens to a controller from tick to tick.

use crate::scene::{self, Kind};
use crate::{Number, Plan, Random, TICK_UNITS};
use pliant_core::{Command, Controller, Obstacle, RobotState, Vector};

/// Robot positions, half of them where it is hard: on surfaces and just off them, at centres and reference points, in soft layers and between
/// cores. In between obstacles come anew, rush in or go, the attractor and the scan move.
#[derive(Clone, Debug)]
pub struct Stream<S: Number, const D: usize> {
    plan: Plan,
    random: Random,
    position: Vector<S, D>,
    /// Ticks left during which the robot drives what it is told.
    driving: u32,
}

impl<S: Number, const D: usize> Stream<S, D> {
    /// The scene of a plan, and what happens in it.
    pub fn new<const CAP: usize>(plan: Plan) -> (Controller<S, D, CAP>, Self) {
        let mut random = Random::new(plan.seed);
        let controller = scene::controller(&plan, &mut random);
        (controller, Self { plan, random, position: Vector::zeros(), driving: 0 })
    }

    /// Time step of a tick, s.
    pub fn dt() -> S {
        S::units(TICK_UNITS)
    }

    /// Changes the controller's surroundings now and then, and gives the next position (none where it is out of range); `last` is the command
    /// since the one before.
    pub fn next<const CAP: usize>(
        &mut self,
        controller: &mut Controller<S, D, CAP>,
        last: &Vector<S, D>,
    ) -> Option<RobotState<S, D>> {
        if self.driving > 0 {
            self.driving -= 1;
            self.position += last * Self::dt();
        } else {
            self.position = self.place(controller);
        }
        if self.random.one_in(16) {
            self.event(controller);
        }
        RobotState::new(self.position)
    }

    fn place<const CAP: usize>(&mut self, controller: &Controller<S, D, CAP>) -> Vector<S, D> {
        let random = &mut self.random;
        if random.one_in(8) {
            self.driving = random.below(32);
        }
        if self.plan.kind == Kind::Crowd && random.one_in(2) {
            return scene::meeting::<S, D>() + random.vector::<S, D>(-1, 1);
        }
        let anywhere = random.vector(-1200, 1200);
        let count = controller.table().len() as u32;
        let mut pick = || {
            let index = random.below(count.max(1)) as usize;
            controller.table().iter().nth(index).map(|e| e.obstacle())
        };
        let (Some(one), Some(other)) = (pick(), pick()) else { return anywhere };
        let direction = random.direction();
        let surface = one.surface(&direction);
        match random.below(16) {
            0 => surface,
            // Just off it, in and out.
            1 | 2 => surface + random.vector::<S, D>(-1, 1),
            3 => one.spec().center + (surface - one.spec().center) * random.between::<S>(0, 1300),
            4 => one.spec().center,
            5 => one.reference(),
            6 => one.soft_surface(&direction),
            // In the soft layer, if there is one.
            7 | 8 => (surface + one.soft_surface(&direction)) * half::<S>(),
            // Between two cores, on the way from one to the other.
            9 | 10 => {
                let way = other.spec().center - one.spec().center;
                (one.surface(&way) + other.surface(&-way)) * half::<S>()
            }
            11 => controller.motion().attractor(),
            12 => {
                let points = controller.table().scan().points();
                let point = points.get(random.below(points.len() as u32) as usize);
                point.map_or(anywhere, |p| p + random.vector::<S, D>(-70, 70))
            }
            _ => anywhere,
        }
    }

    fn event<const CAP: usize>(&mut self, controller: &mut Controller<S, D, CAP>) {
        let random = &mut self.random;
        let kind = self.plan.kind;
        if self.plan.obstacles == 0 && self.plan.points == 0 || random.one_in(6) {
            let (position, velocity) = (random.vector::<S, D>(-300, 300), random.vector::<S, D>(-100, 100));
            controller.aim(&position, &velocity);
            return;
        }
        if self.plan.points > 0 && random.one_in(3) {
            let (scan, age) = (scene::scan(self.plan.points, random), scene::age(kind, random));
            controller.set_scan(scan, age);
            return;
        }
        if self.plan.obstacles == 0 {
            return;
        }
        let id = random.below(u32::from(self.plan.obstacles)) as u16;
        match random.below(4) {
            // Seen again, as it was thought to be.
            0 => {
                let known = controller.table().iter().find(|e| e.id() == id).map(|e| e.obstacle().spec().clone());
                if let Some(spec) = known {
                    let _ = controller.upsert(id, scene::checked(spec), S::zero());
                }
            }
            1 => {
                let new = scene::obstacle(kind, random);
                let rushing = self.rushing(new);
                let _ = controller.upsert(id, rushing, S::zero());
            }
            2 => {
                controller.table_mut().remove(id);
                let (new, age) = (scene::obstacle(kind, random), scene::age(kind, random));
                let _ = controller.upsert(id, new, age);
            }
            _ => {
                let (new, age) = (scene::obstacle(kind, random), scene::age(kind, random));
                let _ = controller.upsert(id, new, age);
            }
        }
    }

    /// The obstacle a little before the robot, and coming at 1 to 3 m/s.
    fn rushing(&mut self, obstacle: Obstacle<S, D>) -> Obstacle<S, D> {
        let random = &mut self.random;
        let towards: Vector<S, D> = random.direction();
        let mut spec = obstacle.spec().clone();
        let ahead = obstacle.surface(&towards) - spec.center;
        spec.center = self.position - ahead - towards * random.between::<S>(0, 30);
        spec.velocity = towards * random.between::<S>(1000, 3000);
        scene::checked(spec)
    }
}

fn half<S: Number>() -> S {
    S::from_f64(0.5)
}

/// Runs a plan's stream for `ticks` ticks, and hands each state to `each`, which gives the command.
pub fn run<S: Number, const D: usize, const CAP: usize>(
    plan: Plan,
    ticks: u32,
    mut each: impl FnMut(&mut Controller<S, D, CAP>, &RobotState<S, D>) -> Command<S, D>,
) {
    let (mut controller, mut stream) = Stream::new(plan);
    let mut last = Vector::zeros();
    for _ in 0..ticks {
        let Some(state) = stream.next(&mut controller, &last) else { continue };
        last = each(&mut controller, &state).velocity;
    }
}
