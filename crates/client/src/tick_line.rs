//! Line of tests: to a machine in the same program, in virtual time.

use crate::dialogue::{Dialogue, drive};
use crate::local::LocalService;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use trirrr_line::{Line, LostLine, Reopening};
use trirrr_protocol::message::{Command, Message, Request};

/// Time from one tick to the next.
const TICK: Duration = Duration::from_millis(10);

/// Line to a machine that answers at once, and ticks where it has nothing to say.
pub(crate) struct TickLine<'a> {
    pub(crate) machine: &'a mut dyn LocalService<f32>,
    pub(crate) now: Duration,
    /// Commands that were sent.
    pub(crate) sent: Vec<Command<f32>>,
    inbox: Vec<Message<f32>>,
    /// Ticks until the line is lost.
    left: u32,
}

impl<'a> TickLine<'a> {
    pub(crate) fn new(machine: &'a mut dyn LocalService<f32>) -> Self {
        Self {
            machine,
            now: Duration::ZERO,
            sent: Vec::new(),
            inbox: Vec::new(),
            left: 0,
        }
    }

    /// Carries `dialogue` for so many ticks. Returns its end if it has ended.
    pub(crate) fn talk<D: Dialogue<f32>>(
        &mut self,
        dialogue: &mut D,
        ticks: u32,
    ) -> Option<D::End> {
        self.talk_until(&AtomicBool::new(false), dialogue, ticks)
    }

    /// The same, with the user's signal to `stop`.
    pub(crate) fn talk_until<D: Dialogue<f32>>(
        &mut self,
        stop: &AtomicBool,
        dialogue: &mut D,
        ticks: u32,
    ) -> Option<D::End> {
        self.left = ticks;
        drive(dialogue, self, stop).ok()
    }
}

impl Line<f32> for TickLine<'_> {
    fn now(&self) -> Duration {
        self.now
    }

    fn send(&mut self, request: &Request<f32>) -> Result<(), LostLine> {
        self.sent.push(request.command);
        let reply = self.machine.answer(request);
        let sequence = request.sequence;
        self.inbox.push(Message::Reply { sequence, reply });
        Ok(())
    }

    fn receive(&mut self, _: Duration) -> Result<Vec<Message<f32>>, LostLine> {
        if !self.inbox.is_empty() {
            return Ok(std::mem::take(&mut self.inbox));
        }
        let left = self.left.checked_sub(1);
        self.left = left.ok_or(LostLine::Silent)?;
        self.machine.tick();
        while self.machine.step() {}
        self.now += TICK;
        Ok(std::iter::from_fn(|| self.machine.outgoing()).collect())
    }

    fn reopen(&mut self, _: &LostLine, _: bool) -> Reopening {
        Reopening::GivenUp(LostLine::Silent)
    }
}
