//! Requests: their order, and who may make them.

use super::super::handoff::count;
use super::Background;
use super::window::RequestPlace;
use crate::feature::{Feature, Optional};
use crate::levels::LevelStore;
use crate::number::ServiceNumber;
use crate::planner::PathPlanner;
use crate::scene::{CommandOf, CurvesOf, ImageSlot, Machine, PartOf, RequestOf, Scene};
use core::sync::atomic::Ordering;
use trirrr_core::setpoint::CurveKind;
use trirrr_protocol::message::{
    BATCH, Command, Content, Hello, PROTOCOL, QuinticMove, Refusal, Reply, State, UpdateStep,
};

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Takes a request. Executes it if it is the next one, keeps it if one before it is missing, and answers it again if it was
    /// executed already. Returns the reply, to be sent with the request's sequence number; ask for
    /// [those that were kept](Self::answer_kept) then. `checksum` is that of the request's frame
    /// ([`Decoder::checksum`](trirrr_protocol::wire::Decoder::checksum)). It tells a repeated request from
    /// another with the same number.
    #[inline(never)]
    pub fn answer(&mut self, request: &RequestOf<S>, checksum: u32) -> Reply<N, PartOf<S>> {
        // Whatever it is that comes, the host is there.
        count(&self.ends.shared.heard);
        self.drain_reports();
        if let Command::Hello(hello) = &request.command {
            return self.greet(request.sequence, hello);
        }
        if !self.greeted {
            return Reply::Refused(Refusal::HelloFirst);
        }
        let next = self.desk.window.next();
        match self.desk.window.place(request.sequence, checksum) {
            RequestPlace::Next => self.execute_next(&request.command, checksum),
            RequestPlace::Executed(result) => self.reply(&request.command, result),
            RequestPlace::Ahead => {
                self.desk.window.keep(request, checksum);
                Reply::Kept { missing: next }
            }
            RequestPlace::Reused => Reply::Refused(Refusal::SequenceReused),
            RequestPlace::Outside => Reply::Refused(Refusal::Sequence { expected: next }),
        }
    }

    /// Executes the next request if it was kept. Returns its number and the reply. To be called after each
    /// [request](Self::answer) until it returns none.
    pub fn answer_kept(&mut self) -> Option<(u32, Reply<N, PartOf<S>>)> {
        let (request, checksum) = self.desk.window.take_kept()?;
        let reply = self.execute_next(&request.command, checksum);
        Some((request.sequence, reply))
    }

    #[inline(never)]
    fn execute_next(&mut self, command: &CommandOf<S>, checksum: u32) -> Reply<N, PartOf<S>> {
        let result = self.execute(command);
        self.desk.window.count(checksum, result);
        self.reply(command, result)
    }

    fn reply(
        &mut self,
        command: &CommandOf<S>,
        result: Result<(), Refusal<N>>,
    ) -> Reply<N, PartOf<S>> {
        match result {
            Ok(()) => self.reply_to(command),
            Err(refusal) => Reply::Refused(refusal),
        }
    }

    /// Executes a command of the program that owns the service, which needs no hello and no sequence
    /// numbers.
    pub fn submit(&mut self, command: &CommandOf<S>) -> Reply<N, PartOf<S>> {
        count(&self.ends.shared.heard);
        self.drain_reports();
        let result = match command {
            Command::Hello(hello) => return self.greet(0, hello),
            _ => self.execute(command),
        };
        self.reply(command, result)
    }

    /// Makes the numbers of the conversations to come depend on `noise` too: whatever nobody can foretell.
    pub fn stir(&mut self, noise: u32) {
        self.desk.window.stir(noise);
    }

    #[cfg(test)]
    pub(crate) fn next_sequence_is(&mut self, sequence: u32) {
        self.desk.window.next_is(sequence);
    }

    #[inline(never)]
    fn greet(&mut self, sequence: u32, hello: &Hello) -> Reply<N, PartOf<S>> {
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
        // On a board the ticks so far, on a host what its owner has stirred in: nobody can tell both from afar.
        let tick = self.ends.shared.tick.load(Ordering::Relaxed);
        self.desk.window.stir(tick);
        self.desk.window.begin(sequence);
        let queue = u16::try_from(self.ends.moves.capacity()).unwrap_or(u16::MAX);
        let batch = if S::Batches::EXISTS { BATCH } else { 1 };
        let next = self.desk.window.next();
        let levels = self.features.levels.get().map_or(0, LevelStore::room);
        let capacity = (queue, batch as u8, levels);
        Reply::Hello(self.settings.identity(capacity, next))
    }

    /// The answer to a command that was executed. Questions are answered anew when repeated.
    fn reply_to(&mut self, command: &CommandOf<S>) -> Reply<N, PartOf<S>> {
        match command {
            Command::Status => Reply::Status(self.status()),
            Command::Read(name) => match self.machine.part(*name, &self.settings.scene.units()) {
                Some(part) => Reply::Section(part),
                None => Reply::Refused(Refusal::NoSuchLeg),
            },
            Command::UpdateStatus => match self.update.status() {
                Some(status) => Reply::Update(status),
                None => Reply::Refused(Refusal::NoUpdate),
            },
            _ => Reply::Done,
        }
    }

    #[inline(always)]
    fn offer_quintic(&mut self, offered: Option<&QuinticMove<N>>) -> Result<(), Refusal<N>> {
        let quintic = offered.ok_or(Refusal::NoQuintics)?;
        let accelerations = [quintic.start_acceleration, quintic.end_acceleration];
        let accelerations = CurvesOf::<S>::some(accelerations).ok_or(Refusal::NoQuintics)?;
        self.offer(&quintic.common, accelerations)
    }

    /// Takes a step of an update while the drives are off.
    #[inline(always)]
    fn update(&mut self, step: Option<&UpdateStep>) -> Result<(), Refusal<N>> {
        let step = step.ok_or(Refusal::NoUpdate)?;
        match self.status.state {
            // No state would help.
            _ if !S::Update::EXISTS => Err(Refusal::NoUpdate),
            State::Disabled => self.update.step(step).map_err(Refusal::Update),
            state => Err(Refusal::State(state)),
        }
    }

    #[inline(never)]
    fn execute(&mut self, command: &CommandOf<S>) -> Result<(), Refusal<N>> {
        match command {
            Command::Hello(_) | Command::Status | Command::Read(_) | Command::UpdateStatus => {
                Ok(())
            }
            Command::Replace(section) => self.change(section),
            Command::Move(_)
            | Command::Quintic(_)
            | Command::Moves(_)
            | Command::Listed(_)
            | Command::OutputsAt(_)
                if self.is_retargeting() =>
            {
                Err(Refusal::Retargeting)
            }
            Command::Move(_)
            | Command::Quintic(_)
            | Command::Moves(_)
            | Command::Listed(_)
            | Command::OutputsAt(_)
            | Command::Retarget(_)
                if self.desk.planner.is_active() =>
            {
                Err(Refusal::PathUnderWay)
            }
            Command::Move(offered) => self.offer(offered, CurvesOf::<S>::none()),
            Command::Quintic(offered) => self.offer_quintic(offered.content()),
            Command::Moves(batch) => self.offer_batch(batch.content()),
            Command::Levels(piece) => self.give_levels(piece.content()),
            Command::Listed(listed) => self.offer_listed(listed.content()),
            Command::Start => self.start(),
            Command::Probe { away } => self.start_probing(*away),
            Command::Output { index, on } => self.switch_output(*index, *on),
            Command::OutputsAt(switch) => self.switch_at(switch),
            Command::Hold => self.hold(),
            Command::Resume => self.resume(),
            Command::Stop => self.stop(),
            Command::ClearFault => self.clear_fault(),
            Command::Enable => self.enable(),
            Command::Disable => self.disable(),
            Command::Drives { every } => self.sample_drives(*every),
            Command::Recover(recovery) => self.recover(recovery),
            Command::Telemetry { every, fields } => self.set_telemetry(*every, *fields),
            Command::Job(label) => self.name_job(label),
            Command::Home => self.home(),
            Command::FeedOverride { percent } => self.override_feed(*percent),
            Command::Retarget(goal) => self.retarget(goal.content()),
            Command::Path(piece) => self.path(piece.content()),
            Command::Update(step) => self.update(step.content()),
        }
    }
}
