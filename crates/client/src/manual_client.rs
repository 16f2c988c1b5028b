//! Keeps an eye on a machine, and sends the commands that a person gives by hand.

use crate::conversation::Conversation;
use crate::dialogue::{Dialogue, Turn};
use crate::exchange::Patience;
use std::collections::VecDeque;
use std::time::Duration;
use trirrr_protocol::message::{
    Command, Event, Hello, Identity, Message, Refusal, Reply, Status, TelemetryFields, Transmit,
};

/// Time until a command is asked again that the machine did not take yet.
const PAUSE: Duration = Duration::from_millis(5);

/// Time from one status to the next.
const STATUS_EVERY: Duration = Duration::from_millis(100);

/// Client of a machine that is commanded by hand, without a port and a clock of its own.
///
/// It gives no command by itself, but for samples: no machine is switched on or moved before a person asks for it.
#[derive(Clone, Debug)]
pub struct ManualClient<N: Transmit> {
    conversation: Conversation<N>,
    /// Ticks from one sample to the next, of the motors and of the drives.
    samples: u16,
    /// Commands that wait.
    commands: VecDeque<Command<N>>,
    /// Refusals of commands that the owner has not taken.
    refused: VecDeque<Refusal<N>>,
    look: Duration,
    /// Time before which no command is asked: the machine had no room for the one before.
    pause: Duration,
    /// Reason for which the machine does not talk.
    closed: Option<Refusal<N>>,
}

impl<N: Transmit> ManualClient<N> {
    /// Creates the client of a machine that is what `hello` says, with a sample of the motors and of the drives every `samples` ticks.
    /// Another conversation with the machine should have another number `conversation`.
    pub fn new(hello: Hello, samples: u16, patience: Patience, conversation: u32) -> Self {
        Self {
            conversation: Conversation::new(hello, patience, conversation),
            samples,
            commands: VecDeque::new(),
            refused: VecDeque::new(),
            look: Duration::ZERO,
            pause: Duration::ZERO,
            closed: None,
        }
    }

    /// Takes a command of the user.
    pub fn command(&mut self, command: Command<N>) {
        self.commands.push_back(command);
    }

    /// Returns the identity of the machine that answered.
    pub fn identity(&self) -> Option<&Identity> {
        self.conversation.identity()
    }

    /// Returns the last status.
    pub fn status(&self) -> Option<&Status<N>> {
        self.conversation.status()
    }

    /// Takes the reason out for which the oldest of the commands was refused.
    pub fn take_refused(&mut self) -> Option<Refusal<N>> {
        self.refused.pop_front()
    }
}

impl<N: Transmit> Dialogue<N> for ManualClient<N> {
    /// The machine refuses the conversation.
    type End = Refusal<N>;

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        loop {
            if let Some(refusal) = self.closed {
                return Turn::Done(refusal);
            }
            let (is_free, look) = match self.conversation.poll(now) {
                Turn::Send(request) => return Turn::Send(request),
                Turn::Reconnect => return Turn::Reconnect,
                // A stop does not wait for the answer to a question.
                Turn::Wait(until) => (false, until),
                Turn::Done(()) => (true, self.look),
            };
            let has_room = is_free || self.conversation.has_room();
            let waits = now < self.pause && !self.commands.is_empty();
            match (has_room && !waits)
                .then(|| self.commands.pop_front())
                .flatten()
            {
                Some(command) => self.conversation.ask(command, now),
                None if is_free && now >= look => self.conversation.ask(Command::Status, now),
                None if waits => return Turn::Wait(look.min(self.pause)),
                None => return Turn::Wait(look),
            }
        }
    }

    fn receive(&mut self, message: &Message<N>, now: Duration) {
        if let Message::Event(event) = message {
            // An event is a hint: the status says what holds.
            if let (Event::State { state, acting, .. }, Some(status)) =
                (event, self.conversation.status_mut())
            {
                (status.state, status.acting) = (*state, *acting);
            }
            self.look = self.look.min(now);
            return;
        }
        let Some((command, reply)) = self.conversation.receive(message) else {
            return;
        };
        match reply {
            Reply::Hello(_) => {
                self.look = now;
                // Before whatever waits: a command shows in the samples.
                self.commands.push_front(Command::Drives {
                    every: self.samples,
                });
                self.commands.push_front(Command::Telemetry {
                    every: self.samples,
                    fields: TelemetryFields::ALL,
                });
            }
            Reply::Status(status) => {
                self.look = now + STATUS_EVERY;
                self.conversation.keep(status);
            }
            // What it changes, the next status says.
            Reply::Done => self.look = now,
            Reply::Refused(refusal) => match (command, refusal) {
                (Command::Hello(_), refusal) => self.closed = Some(refusal),
                // Its image tells nothing of its drives.
                (Command::Drives { .. }, Refusal::NoFeedback) => {}
                // The tick takes one order at a time: no stop is lost.
                (command, Refusal::Busy) => {
                    self.commands.push_front(command);
                    self.pause = now + PAUSE;
                }
                (_, refusal) => {
                    self.refused.push_back(refusal);
                    self.look = now;
                }
            },
            Reply::Section(_) | Reply::Kept { .. } | Reply::Update(_) => {}
        }
    }

    /// Commands that wait are dropped.
    fn stop(&mut self) {
        self.commands.clear();
        self.command(Command::Stop);
    }

    /// Commands that wait are dropped: the user gave them to what was there before.
    fn reconnected(&mut self) {
        self.commands.clear();
        self.conversation.reconnected();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local;
    use crate::tick_line::TickLine;
    use trirrr_protocol::message::State;
    use trirrr_scene::Scene;

    fn scene() -> Scene {
        Scene::read("../../scenes/thesis.toml").unwrap()
    }

    #[test]
    fn no_machine_is_switched_on_before_a_person_asks_for_it() {
        let scene = scene();
        let hello = local::hello::<f32>(&scene);
        local::with_machine::<f32, _>(&scene, |machine| {
            let mut client = ManualClient::new(hello, 5, Patience::default(), 1);
            let mut line = TickLine::new(machine);
            line.talk(&mut client, 100);
            let sent = &line.sent;
            let is_quiet = |command: &Command<f32>| {
                matches!(
                    command,
                    Command::Hello(_)
                        | Command::Status
                        | Command::Telemetry { .. }
                        | Command::Drives { .. }
                )
            };
            assert!(sent.iter().all(is_quiet), "{sent:?}");
            assert_eq!(line.machine.state(), State::Disabled);
            assert_eq!(client.take_refused(), None);
            client.command(Command::Enable);
            line.talk(&mut client, 100);
            assert_eq!(line.machine.state(), State::Idle);
            assert_eq!(client.status().unwrap().state, State::Idle);
            // The machine has nothing to resume.
            client.command(Command::Resume);
            line.talk(&mut client, 2);
            assert_eq!(client.take_refused(), Some(Refusal::State(State::Idle)));
        })
        .unwrap();
    }

    #[test]
    fn a_machine_of_another_scene_ends_the_conversation() {
        let scene = scene();
        let mut hello = local::hello::<f32>(&scene);
        hello.scene ^= 1;
        local::with_machine::<f32, _>(&scene, |machine| {
            let mut client = ManualClient::new(hello, 5, Patience::default(), 1);
            let mut line = TickLine::new(machine);
            let refused = line.talk(&mut client, 2);
            let expected = Refusal::Scene {
                expected: scene.key,
            };
            assert_eq!(refused, Some(expected));
        })
        .unwrap();
    }

    #[test]
    fn commands_of_a_lost_line_are_not_given_to_the_next() {
        let scene = scene();
        let hello = local::hello::<f32>(&scene);
        local::with_machine::<f32, _>(&scene, |machine| {
            let mut client = ManualClient::new(hello, 5, Patience::default(), 1);
            let mut line = TickLine::new(machine);
            line.talk(&mut client, 10);
            client.command(Command::Enable);
            client.reconnected();
            line.talk(&mut client, 100);
            assert_eq!(line.machine.state(), State::Disabled);
        })
        .unwrap();
    }
}
