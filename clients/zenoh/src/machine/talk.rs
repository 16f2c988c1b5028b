//! Conversation with the machine: requests, answers, and silence where no client leads it.

use super::commands::Order;
use super::{PAUSE, STATUS_EVERY, Worker};
use crate::answer::CommandOutcome;
use crate::error::ZenohError;
use std::time::Duration;
use trirrr_client::{Dialogue, Turn, describe};
use trirrr_line::LostLine;
use trirrr_protocol::message::{
    Acting, Command, Event, Message, Refusal, Reply, State, TelemetryFields,
};
use trirrr_service::ServiceNumber;

impl<N: ServiceNumber> Worker<'_, N> {
    /// Returns true if the machine may hear this program: it rests, or a client has control and is there. Otherwise its own host timeout
    /// holds it, as if the line of its host were cut.
    fn may_speak(&mut self) -> bool {
        let rests = self.state.is_none_or(|(state, _)| state.is_at_rest());
        let is_led = self.control.present(self.now()).is_some();
        if rests || is_led {
            self.is_told_to_hold = false;
            return true;
        }
        let never = (self.identity.as_ref()).is_some_and(|identity| identity.silence_ticks == 0);
        if never && !self.is_told_to_hold {
            // A machine that never times out is told.
            self.is_told_to_hold = true;
            let command = match self.state {
                Some((State::Running, _)) => Command::Hold,
                _ => Command::Stop,
            };
            self.orders.push_back(Order::own(command));
        }
        !self.orders.is_empty() || self.asked.is_some()
    }

    /// Gives the conversation to the task, or takes it back for orders. Returns true if the task has it.
    fn chooses_task(&mut self, now: Duration) -> bool {
        let Some(task) = &mut self.task else {
            return false;
        };
        let is_led = self.control.present(now) == Some(&task.owner) && !task.is_held;
        let is_free = self.orders.is_empty() && self.asked.is_none();
        let wants = is_led && is_free;
        if wants != self.is_task_on {
            self.is_task_on = wants;
            // Each begins with a hello of its own.
            self.exchange.forget();
            self.is_greeted = false;
            task.reconnected();
        }
        wants
    }

    fn poll_task(&mut self, now: Duration) -> Turn<N, Result<(), ZenohError>> {
        let listen = Turn::Wait(Duration::MAX);
        let Some(task) = &mut self.task else {
            return listen;
        };
        let turn = task.poll(now, &self.units);
        if let Some(status) = task.status() {
            self.status = Some(*status);
        }
        if task.asked.is_some()
            && let Some(outcome) = task.decided(&self.units)
            && let Some(number) = task.asked.take()
        {
            let owner = task.owner.clone();
            self.executed += u64::from(outcome == CommandOutcome::Accepted);
            self.complete(&owner, number, outcome);
        }
        match turn {
            Turn::Send(request) => Turn::Send(request),
            Turn::Wait(_) => listen,
            Turn::Reconnect => Turn::Reconnect,
            Turn::Done(end) => {
                self.finish_task(end);
                listen
            }
        }
    }

    /// Next act of the conversation without a task.
    fn poll_own(&mut self, now: Duration) -> Turn<N, Result<(), ZenohError>> {
        loop {
            match self.exchange.poll(now) {
                Turn::Done(()) if !self.is_greeted => self.exchange.greet(self.hello, now),
                Turn::Done(()) => match self.next(now) {
                    Some(command) => self.exchange.ask(command, now),
                    None => return Turn::Wait(Duration::MAX),
                },
                turn => return turn.map(Ok),
            }
        }
    }

    fn next(&mut self, now: Duration) -> Option<Command<N>> {
        if !self.is_subscribed {
            return Some(Command::Telemetry {
                every: self.setup.telemetry,
                fields: TelemetryFields::ALL,
            });
        }
        if now >= self.pause
            && self.status.is_some()
            && let Some(command) = self.next_order()
        {
            return Some(command);
        }
        (now >= self.look).then_some(Command::Status)
    }

    fn hear_event(&mut self, event: &Event<N>, now: Duration) {
        if let Event::State { state, acting, .. } = event {
            self.found((*state, *acting));
        }
        self.look = self.look.min(now);
        if let Some(text) = describe::event(event, 0, &self.units) {
            self.event("machine", &text);
        }
    }

    /// Takes note of the state that the machine is in.
    pub(super) fn found(&mut self, found: (State, Acting)) {
        self.state = Some(found);
        self.host_was_silent(found.1);
    }

    fn hear_reply(&mut self, command: &Command<N>, reply: Reply<N>, now: Duration) {
        match reply {
            Reply::Hello(identity) => {
                self.is_greeted = true;
                self.look = now;
                self.outlet.alive(true);
                let is_new = self.identity.as_ref().is_none_or(|before| {
                    (before.scene, &before.name) != (identity.scene, &identity.name)
                });
                self.identity = Some(identity);
                if is_new {
                    let text = self.identity_text();
                    self.outlet.identity(&text);
                }
            }
            Reply::Status(status) => {
                self.look = now + STATUS_EVERY;
                self.found((status.state, status.acting));
                self.status = Some(status);
                self.surveyed();
                if status.state == State::Idle && self.control.has_ended(now) {
                    self.leave_task(&status);
                }
            }
            Reply::Refused(
                refusal @ (Refusal::Protocol { .. }
                | Refusal::Schema { .. }
                | Refusal::Scene { .. }),
            ) => {
                let why = describe::refusal(&refusal, 0, &self.units);
                self.refused = Some(format!("{}: {why}", self.setup.name));
            }
            Reply::Refused(
                Refusal::HelloFirst | Refusal::Sequence { .. } | Refusal::SequenceReused,
            ) => {
                // A machine that was switched on anew sends no samples until it is asked.
                (self.is_greeted, self.is_subscribed) = (false, false);
                self.lose_order();
            }
            Reply::Refused(Refusal::Busy) => {
                self.pause = now + PAUSE;
                self.repeat_order();
            }
            reply => match command {
                Command::Telemetry { .. } => self.is_subscribed = true,
                _ => {
                    self.look = now;
                    self.order_answered(reply);
                }
            },
        }
    }
}

impl<N: ServiceNumber> Dialogue<N> for Worker<'_, N> {
    /// Refused: the machine was built from another scene.
    type End = Result<(), ZenohError>;
    /// A command of a client waits as long at most.
    const LOOK: Duration = Duration::from_millis(10);

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        // Another machine in the place of one that was here ends nothing: the others go on.
        if self.refused.is_some() && self.identity.is_some() {
            return Turn::Reconnect;
        }
        if let Some(why) = self.refused.take() {
            return Turn::Done(Err(ZenohError::Refused(why)));
        }
        if !self.may_speak() {
            return Turn::Wait(Duration::MAX);
        }
        match self.chooses_task(now) {
            true => self.poll_task(now),
            false => self.poll_own(now),
        }
    }

    fn receive(&mut self, message: &Message<N>, now: Duration) {
        self.now = now;
        match message {
            Message::Telemetry(sample) => self.sample(sample),
            Message::Event(event) => self.hear_event(event, now),
            Message::Reply { .. } | Message::Drives(_) => {}
        }
        match &mut self.task {
            Some(task) if self.is_task_on => task.receive(message, now),
            _ => {
                if let Some((request, reply)) = self.exchange.receive(message) {
                    self.hear_reply(&request.command, reply, now);
                }
            }
        }
    }

    fn stop(&mut self) {
        self.is_stopped = true;
    }

    fn reconnected(&mut self) {
        self.is_connected = true;
        if self.lost.take().is_some() {
            self.event("line", "the line is open again");
        }
        // What was asked is asked again under its number: the machine executes it once.
        self.exchange.reopened(self.now);
        if let Some(task) = &mut self.task {
            task.reconnected();
        }
        self.look = self.now;
    }

    fn lost(&mut self, why: &LostLine, _: bool) {
        self.is_connected = false;
        self.outlet.alive(false);
        let why = self.refused.take().unwrap_or_else(|| why.to_string());
        if self.lost.as_ref() != Some(&why) {
            self.event("line", &format!("the line is lost: {why}"));
            self.lost = Some(why);
        }
    }

    /// Looks at clients and their commands, and publishes what there is to publish.
    fn attend(&mut self, now: Duration) -> Option<Self::End> {
        self.now = now;
        self.publish();
        self.take_incoming();
        if self.is_stopped {
            self.outlet.alive(false);
            return Some(Ok(()));
        }
        if self.is_connected {
            self.drop_orders_without_control();
        }
        None
    }
}
