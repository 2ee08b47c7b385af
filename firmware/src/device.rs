//! Both halves in one place, for a host and for tests.

use pliant_protocol::FRAME_MAX;

use crate::{Control, Desk, Identity};

/// A whole device without a board: give it frames and ticks, send what it answers.
#[derive(Debug)]
pub struct Device {
    desk: Desk<()>,
    control: Control,
}

impl Device {
    /// A device that has just started.
    pub fn new(identity: Identity) -> Self {
        Self { desk: Desk::new(identity), control: Control::new() }
    }

    /// Takes one frame; the frame that answers it, if there is one.
    pub fn receive<'a>(&mut self, frame: &[u8], room: &'a mut [u8; FRAME_MAX]) -> Option<&'a [u8]> {
        let answer = self.desk.receive((), frame, &mut self.control);
        // No tick waits meanwhile.
        while self.control.settle() {}
        let answer = answer?;
        self.desk.frame(&answer, room)
    }

    /// The clock has come to a tick, after `overdue` ticks that had no chance to run; the frame that says what the robot should do.
    pub fn tick<'a>(&mut self, overdue: u32, room: &'a mut [u8; FRAME_MAX]) -> Option<&'a [u8]> {
        self.control.tick(overdue);
        let report = self.control.take_report()?;
        self.desk.frame(&report, room)
    }

    /// The half that faces the clock.
    pub fn control(&self) -> &Control {
        &self.control
    }
}
