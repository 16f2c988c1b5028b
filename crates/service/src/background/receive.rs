//! Requests: their order, and who may make them.

use super::super::handoff::count;
use super::super::scene::Scene;
use super::{Background, Last};
use crate::number::ServiceNumber;
use crate::offered::{CommandOf, RequestOf};
use crate::planner::PathPlanner;
use trirrr_core::setpoint::CurveKind;
use trirrr_protocol::message::{Command, Content, Hello, PROTOCOL, QuinticMove, Refusal, Reply};

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Executes a request, unless it was executed already. Returns the reply, to be sent with the request's
    /// sequence number. `checksum` is that of the request's frame
    /// ([`Decoder::checksum`](trirrr_protocol::wire::Decoder::checksum)). It tells a repeated request from
    /// another with the same number.
    #[inline(never)]
    pub fn receive(&mut self, request: &RequestOf<S>, checksum: u32) -> Reply<N, S::Part> {
        // Whatever it is that comes, the host is there.
        count(&self.shared.heard);
        self.drain_reports();
        if let Command::Hello(hello) = &request.command {
            return self.greet(hello);
        }
        if !self.greeted {
            return Reply::Refused(Refusal::HelloFirst);
        }
        if let Some(last) = &self.last
            && last.sequence == request.sequence
        {
            if last.checksum != checksum {
                return Reply::Refused(Refusal::SequenceReused);
            }
            return match last.refusal {
                Some(refusal) => Reply::Refused(refusal),
                None => self.answer(&request.command),
            };
        }
        if request.sequence != self.next_sequence {
            return Reply::Refused(Refusal::Sequence {
                expected: self.next_sequence,
            });
        }
        let result = self.execute(&request.command);
        self.last = Some(Last {
            sequence: request.sequence,
            checksum,
            refusal: result.err(),
        });
        self.next_sequence = request.sequence.wrapping_add(1);
        match result {
            Ok(()) => self.answer(&request.command),
            Err(refusal) => Reply::Refused(refusal),
        }
    }

    /// Executes a command of the program that owns the service, which needs no hello and no sequence
    /// numbers.
    pub fn submit(&mut self, command: &CommandOf<S>) -> Reply<N, S::Part> {
        count(&self.shared.heard);
        self.drain_reports();
        let result = match command {
            Command::Hello(hello) => return self.greet(hello),
            _ => self.execute(command),
        };
        match result {
            Ok(()) => self.answer(command),
            Err(refusal) => Reply::Refused(refusal),
        }
    }

    #[cfg(test)]
    pub(crate) fn next_sequence_is(&mut self, sequence: u32) {
        self.next_sequence = sequence;
    }

    #[inline(never)]
    fn greet(&mut self, hello: &Hello) -> Reply<N, S::Part> {
        let scene = &self.settings.scene;
        if hello.protocol != PROTOCOL {
            return Reply::Refused(Refusal::Protocol { expected: PROTOCOL });
        }
        if hello.schema != scene.schema {
            return Reply::Refused(Refusal::Schema {
                expected: scene.schema,
            });
        }
        if hello.scene != 0 && hello.scene != scene.key {
            return Reply::Refused(Refusal::Scene {
                expected: scene.key,
            });
        }
        self.greeted = true;
        let queue = self.moves.capacity().min(255) as u8;
        Reply::Hello(self.settings.identity(queue, self.next_sequence))
    }

    /// The answer to a command that was executed. Questions are answered anew when repeated.
    fn answer(&mut self, command: &CommandOf<S>) -> Reply<N, S::Part> {
        match command {
            Command::Status => Reply::Status(self.status()),
            Command::Read(name) => match self.scene.part(*name, &self.settings.scene.units()) {
                Some(part) => Reply::Section(part),
                None => Reply::Refused(Refusal::NoSuchLeg),
            },
            _ => Reply::Done,
        }
    }

    #[inline(always)]
    fn offer_quintic(&mut self, offered: Option<&QuinticMove<N>>) -> Result<(), Refusal<N>> {
        let quintic = offered.ok_or(Refusal::NoQuintics)?;
        let accelerations = [quintic.start_acceleration, quintic.end_acceleration];
        let accelerations = S::Curves::some(accelerations).ok_or(Refusal::NoQuintics)?;
        self.offer(&quintic.common, accelerations)
    }

    #[inline(never)]
    fn execute(&mut self, command: &CommandOf<S>) -> Result<(), Refusal<N>> {
        match command {
            Command::Hello(_) | Command::Status | Command::Read(_) => Ok(()),
            Command::Override(section) => self.change(section),
            Command::Move(_) | Command::Quintic(_) | Command::Retarget(_)
                if self.is_retargeting() =>
            {
                Err(Refusal::Retargeting)
            }
            Command::Move(_) | Command::Quintic(_) | Command::Retarget(_)
                if self.planner.is_active() =>
            {
                Err(Refusal::PathUnderWay)
            }
            Command::Move(offered) => self.offer(offered, S::Curves::none()),
            Command::Quintic(offered) => self.offer_quintic(offered.content()),
            Command::Start => self.start(),
            Command::Hold => self.hold(),
            Command::Resume => self.resume(),
            Command::Stop => self.stop(),
            Command::ClearFault => self.clear_fault(),
            Command::Enable => self.enable(),
            Command::Disable => self.disable(),
            Command::Drives { every } => self.sample_drives(*every),
            Command::Recover(recovery) => self.recover(recovery),
            Command::Telemetry { every } => self.set_telemetry(*every),
            Command::Home => self.home(),
            Command::FeedOverride { percent } => self.override_feed(*percent),
            Command::Retarget(goal) => self.retarget(goal.content()),
            Command::Path(piece) => self.path(piece.content()),
        }
    }
}
