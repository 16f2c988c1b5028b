//! Way of a machine to readiness: faults acknowledged, drives on, motors found.

use crate::conversation::Conversation;
use crate::describe::{self, Units};
use crate::dialogue::{Dialogue, Turn};
use crate::exchange::Patience;
use std::time::Duration;
use trirrr_protocol::message::{
    Command, Fault, Hello, Message, NotEnabled, Recovery, Refusal, Reply, State, Status, Transmit,
};

/// Time from one status to the next.
const STATUS_EVERY: Duration = Duration::from_millis(20);

/// Time in which the tick and the drives hear of an acknowledged fault.
const CLEARING: Duration = Duration::from_millis(200);

/// Faults and errors of drives that are acknowledged on the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clears {
    /// None.
    Nothing,
    /// A latched fault, and errors by which the drives were not switched on.
    Hindrances,
    /// The same, and errors of drives that are off.
    Everything,
}

/// Steps of a machine to readiness. Each order is given once.
#[derive(Clone, Copy, Debug)]
pub struct Wake<N: Transmit> {
    pub(crate) clears: Clears,
    pub(crate) homes: bool,
    recovery: Option<Recovery<N>>,
    pub(crate) has_cleared: bool,
    has_enabled: bool,
    /// The machine has begun to look for its motors, or to move them to a known pose.
    has_homed: bool,
}

/// Next step of a machine to readiness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WakeStep<N: Transmit> {
    /// Give this order, and call [`Wake::ordered`] once the machine has taken it.
    Order(Command<N>),
    /// The machine is between two states.
    Wait,
    /// The drives are on, and the pose is known.
    Ready,
    /// The machine does not get there.
    Failed(WakeFailure<N>),
}

/// Reason why a machine does not become ready.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WakeFailure<N: Transmit> {
    /// A fault is latched, which is not to be acknowledged, or comes again.
    Fault(Option<Fault<N>>),
    /// The drives were not switched on, or went off again.
    NotEnabled(Option<NotEnabled<N>>),
    /// The machine has to be homed, and is not to be.
    Unhomed,
    /// The pose is not known after a fault, and there is no recovery.
    Cleared,
    /// An order, or the conversation, was refused.
    Refused(Refusal<N>),
    /// The user has stopped the way.
    Stopped,
}

impl<N: Transmit> WakeFailure<N> {
    /// Describes the failure in words and the machine's `units`.
    pub fn describe(&self, units: &Units) -> String {
        match self {
            Self::Fault(Some(fault)) => describe::fault(fault, units),
            Self::Fault(None) => "the fault does not go away".into(),
            Self::NotEnabled(Some(why)) => format!("not enabled: {}", describe::not_enabled(why)),
            Self::NotEnabled(None) => "the drives went off again".into(),
            Self::Unhomed => "the machine does not know where its motors are".into(),
            Self::Cleared => "the platform's pose is not known after the fault".into(),
            Self::Refused(refusal) => describe::refusal(refusal, 0, units),
            Self::Stopped => "ended by Ctrl-C".into(),
        }
    }
}

impl<N: Transmit> Wake<N> {
    /// Creates the way that acknowledges what `clears` says and switches the drives on. `homes`: a machine that is not homed is.
    /// `recovery`: move of a machine whose pose is not known after a fault.
    pub fn new(clears: Clears, homes: bool, recovery: Option<Recovery<N>>) -> Self {
        Self {
            clears,
            homes,
            recovery,
            has_cleared: false,
            has_enabled: false,
            has_homed: false,
        }
    }

    /// Lets the machine look for its motors once more: it was stopped meanwhile.
    pub fn home_again(&mut self) {
        self.has_homed = false;
    }

    /// Takes note of an order that the machine has taken.
    pub fn ordered(&mut self, command: &Command<N>) {
        match command {
            Command::ClearFault => self.has_cleared = true,
            Command::Enable => self.has_enabled = true,
            Command::Home | Command::Recover(_) => self.has_homed = true,
            _ => {}
        }
    }

    /// Returns the next step of a machine of this `status`.
    pub fn next(&self, status: &Status<N>) -> WakeStep<N> {
        let clears = |least: bool| least && !self.has_cleared;
        let is_wanted = match self.clears {
            Clears::Nothing => false,
            Clears::Hindrances => {
                let why = status.not_enabled.as_ref();
                why.is_some_and(NotEnabled::wants_acknowledgement)
            }
            Clears::Everything => true,
        };
        match status.state {
            State::Fault if clears(self.clears != Clears::Nothing) => {
                WakeStep::Order(Command::ClearFault)
            }
            State::Fault => WakeStep::Failed(WakeFailure::Fault(status.fault)),
            State::Disabled if self.has_enabled => {
                WakeStep::Failed(WakeFailure::NotEnabled(status.not_enabled))
            }
            State::Disabled if clears(is_wanted) => WakeStep::Order(Command::ClearFault),
            State::Disabled => WakeStep::Order(Command::Enable),
            State::Unhomed if self.homes && !self.has_homed => WakeStep::Order(Command::Home),
            State::Unhomed => WakeStep::Failed(WakeFailure::Unhomed),
            State::Cleared => match self.recovery.filter(|_| !self.has_homed) {
                Some(recovery) => WakeStep::Order(Command::Recover(recovery)),
                None => WakeStep::Failed(WakeFailure::Cleared),
            },
            State::Idle | State::Running | State::Slowing | State::Holding => WakeStep::Ready,
            State::Enabling
            | State::Disabling
            | State::Homing
            | State::Recovering
            | State::Stopping
            | State::Reacting => WakeStep::Wait,
        }
    }
}

/// Client that makes a machine ready, and does nothing else with it.
#[derive(Clone, Debug)]
pub struct WakeClient<N: Transmit> {
    conversation: Conversation<N>,
    wake: Wake<N>,
    /// Order that waits.
    order: Option<Command<N>>,
    look: Duration,
    result: Option<Result<(), WakeFailure<N>>>,
}

impl<N: Transmit> WakeClient<N> {
    /// Creates the client of a machine that is what `hello` says. Another conversation with the machine should have another
    /// number `conversation`.
    pub fn new(wake: Wake<N>, hello: Hello, patience: Patience, conversation: u32) -> Self {
        Self {
            conversation: Conversation::new(hello, patience, conversation),
            wake,
            order: None,
            look: Duration::ZERO,
            result: None,
        }
    }

    /// Returns the last status.
    pub fn status(&self) -> Option<&Status<N>> {
        self.conversation.status()
    }

    fn on_status(&mut self, status: Status<N>, now: Duration) {
        self.conversation.keep(status);
        // A machine that looks for its motors by another client's order is on.
        let moves = matches!(status.state, State::Homing | State::Recovering);
        match self.wake.next(&status) {
            WakeStep::Order(command) => (self.order, self.look) = (Some(command), now),
            WakeStep::Wait if !moves || self.wake.has_homed => self.look = now + STATUS_EVERY,
            WakeStep::Wait | WakeStep::Ready => self.result = Some(Ok(())),
            WakeStep::Failed(failure) => self.result = Some(Err(failure)),
        }
    }
}

impl<N: Transmit> Dialogue<N> for WakeClient<N> {
    /// The machine is ready, or the reason why not.
    type End = Result<(), WakeFailure<N>>;

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        loop {
            if let Some(result) = self.result {
                return Turn::Done(result);
            }
            match self.conversation.poll(now) {
                Turn::Done(()) if now < self.look => return Turn::Wait(self.look),
                Turn::Done(()) => {
                    let command = self.order.take().unwrap_or(Command::Status);
                    self.conversation.ask(command, now);
                }
                turn => return turn.map(Ok),
            }
        }
    }

    fn receive(&mut self, message: &Message<N>, now: Duration) {
        let Some((command, reply)) = self.conversation.receive(message) else {
            return;
        };
        match (command, reply) {
            (_, Reply::Status(status)) => self.on_status(status, now),
            (Command::ClearFault, Reply::Done) => {
                self.wake.ordered(&command);
                self.look = now + CLEARING;
            }
            (_, Reply::Done) => {
                self.wake.ordered(&command);
                self.look = now;
            }
            // The next status says what holds.
            (_, Reply::Refused(Refusal::Busy))
            | (Command::Enable, Reply::Refused(Refusal::State(_))) => {
                self.look = now + STATUS_EVERY;
            }
            (_, Reply::Refused(refusal)) => {
                self.result = Some(Err(WakeFailure::Refused(refusal)));
            }
            _ => {}
        }
    }

    fn stop(&mut self) {
        self.result = Some(Err(WakeFailure::Stopped));
    }

    fn reconnected(&mut self) {
        self.order = None;
        self.conversation.reconnected();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local;
    use crate::tick_line::TickLine;
    use trirrr_scene::Scene;

    #[test]
    fn a_machine_is_switched_on_and_ordered_nothing_once_it_is_on() {
        let scene = Scene::read("../../scenes/thesis.toml").unwrap();
        let hello = local::hello::<f32>(&scene);
        local::with_machine::<f32, _>(&scene, |machine| {
            let mut line = TickLine::new(machine);
            let wake = |line: &mut TickLine<'_>, clears, number| {
                line.sent.clear();
                let wake = Wake::new(clears, false, None);
                let mut client = WakeClient::new(wake, hello, Patience::default(), number);
                line.talk(&mut client, 200)
            };
            assert_eq!(wake(&mut line, Clears::Nothing, 1), Some(Ok(())));
            assert_eq!(line.machine.state(), State::Idle);
            assert!(line.sent.contains(&Command::Enable));
            // It is on: nothing is ordered.
            assert_eq!(wake(&mut line, Clears::Everything, 1 << 16), Some(Ok(())));
            let is_quiet =
                |sent: &Command<f32>| matches!(sent, Command::Hello(_) | Command::Status);
            assert!(line.sent.iter().all(is_quiet), "{:?}", line.sent);
        })
        .unwrap();
    }

    fn status(state: State) -> Status<f32> {
        let scene = Scene::read("../../scenes/thesis.toml").unwrap();
        local::with_machine::<f32, _>(&scene, |machine| {
            let request =
                |sequence, command| trirrr_protocol::message::Request { sequence, command };
            let hello = Command::Hello(local::hello::<f32>(&scene));
            let Reply::Hello(identity) = machine.answer(&request(7, hello)) else {
                panic!("a machine of this scene");
            };
            match machine.answer(&request(identity.next_sequence, Command::Status)) {
                Reply::Status(status) => Status { state, ..status },
                other => panic!("{other:?}"),
            }
        })
        .unwrap()
    }

    /// A machine that falls back into the state before is not ordered the same for ever.
    #[test]
    fn each_order_is_given_once() {
        let recovery = Recovery {
            to: trirrr_core::setpoint::Pose::from_f64(0.2, 0.2, 0.0),
            ticks: 100,
        };
        let whole = Wake::new(Clears::Everything, true, Some(recovery));
        let orders = [
            (State::Fault, Command::ClearFault),
            (State::Disabled, Command::ClearFault),
            (State::Unhomed, Command::Home),
            (State::Cleared, Command::Recover(recovery)),
        ];
        for (state, order) in orders {
            let mut wake = whole;
            assert_eq!(wake.next(&status(state)), WakeStep::Order(order));
            wake.ordered(&order);
            let next = wake.next(&status(state));
            match state {
                State::Disabled => {
                    assert_eq!(next, WakeStep::Order(Command::Enable));
                    wake.ordered(&Command::Enable);
                    let failure = WakeFailure::NotEnabled(None);
                    assert_eq!(wake.next(&status(state)), WakeStep::Failed(failure));
                }
                _ => assert!(matches!(next, WakeStep::Failed(_)), "{state:?}: {next:?}"),
            }
        }
        let least = Wake::new(Clears::Nothing, false, None);
        for state in [State::Fault, State::Unhomed, State::Cleared] {
            let next = least.next(&status(state));
            assert!(matches!(next, WakeStep::Failed(_)), "{state:?}: {next:?}");
        }
        assert_eq!(least.next(&status(State::Stopping)), WakeStep::Wait);
        assert_eq!(least.next(&status(State::Holding)), WakeStep::Ready);
    }
}
