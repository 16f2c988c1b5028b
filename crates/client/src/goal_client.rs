//! Sends a machine to goals: the newest goal that is wanted, as soon as the machine takes one.

use crate::conversation::Conversation;
use crate::describe::{self, Units};
use crate::dialogue::{Dialogue, Turn};
use crate::exchange::{Patience, status_interval};
use crate::user_commands::{UserCommand, UserCommands};
use std::time::Duration;
use trirrr_protocol::message::{
    Acting, Command, Event, Fault, Goal, Hello, Identity, Message, NotEnabled, Refusal, Reply,
    State, Status, Transmit, Violation,
};

/// Longest time from one status to the next.
const STATUS_EVERY: Duration = Duration::from_millis(20);

/// Time until a request is made again that the machine did not take yet.
const PAUSE: Duration = Duration::from_millis(5);

/// Reason why a machine goes to no goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GoalFailure<N: Transmit> {
    /// The machine has to be homed or recovered first.
    State(State),
    /// A command was refused.
    Refused(Refusal<N>),
    /// A fault is latched.
    Fault(Fault<N>),
    /// The drives were not switched on.
    NotEnabled(NotEnabled<N>),
    /// The machine stopped, and dropped the goal.
    Stopped(Acting),
}

/// Client that sends a machine to goals, without a port and a clock of its own.
#[derive(Clone, Debug)]
pub struct GoalClient<N: Transmit> {
    conversation: Conversation<N>,
    /// The newest goal that the machine has not taken.
    wanted: Option<Goal<N>>,
    orders: UserCommands,
    /// There is no other goal behind the one that is wanted.
    is_last: bool,
    /// A goal was taken since the machine stood.
    is_under_way: bool,
    /// The machine has taken a goal, and has not said that it refuses it. Each goal forgets the refusal of the one before: one that it names
    /// from now on is of this goal, also where it is the same as before.
    is_judging: bool,
    /// Violation by which the last goal was refused.
    refused: Option<Violation<N>>,
    /// Time from one status to the next.
    every: Duration,
    look: Duration,
    pause: Duration,
    /// The client has enabled the machine.
    is_enabled: bool,
    /// The machine is on its way to the rest that [`GoalClient::rest`] asks for.
    is_resting: bool,
    /// The moves that are queued are too few to start: the last of them ends in motion.
    ends_moving: bool,
    /// The last goal is in motion, and the machine came to rest before it.
    falls_short: bool,
    result: Option<Result<(), GoalFailure<N>>>,
}

impl<N: Transmit> GoalFailure<N> {
    /// Describes the failure in words and the machine's `units`.
    pub fn describe(&self, units: &Units) -> String {
        match self {
            Self::State(state) => format!(
                "the machine is not free: {}",
                describe::state(*state, Acting::Nothing)
            ),
            Self::Refused(refusal) => describe::refusal(refusal, 0, units),
            Self::Fault(fault) => describe::fault(fault, units),
            Self::NotEnabled(why) => format!("not enabled: {}", describe::not_enabled(why)),
            Self::Stopped(acting) => format!(
                "the machine has stopped: {}",
                describe::state(State::Idle, *acting)
            ),
        }
    }
}

impl<N: Transmit> Dialogue<N> for GoalClient<N> {
    /// The machine stands at the last goal, or the reason why not.
    type End = Result<(), GoalFailure<N>>;

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        loop {
            if let Some(result) = self.result {
                return Turn::Done(result);
            }
            match self.conversation.poll(now) {
                Turn::Done(()) => match self.next(now) {
                    Some(command) => self.conversation.ask(command, now),
                    None if self.result.is_some() => {}
                    None => return Turn::Wait(self.look),
                },
                turn => return turn.map(Ok),
            }
        }
    }

    fn receive(&mut self, message: &Message<N>, now: Duration) {
        if let Message::Event(Event::State { .. } | Event::Fault(_)) = message {
            self.look = self.look.min(now);
            return;
        }
        let Some((command, reply)) = self.conversation.receive(message) else {
            return;
        };
        match reply {
            Reply::Hello(identity) => {
                self.every = status_interval(STATUS_EVERY, &identity);
                self.orders.recall();
                self.look = now;
            }
            Reply::Status(status) => self.on_status(status, now),
            Reply::Done => {
                if let Command::Retarget(goal) = command {
                    self.ends_moving = false;
                    self.is_judging = true;
                    self.wanted = self.wanted.filter(|wanted| *wanted != goal);
                }
                self.orders.settle(&command);
                self.is_enabled |= command == Command::Enable;
                // What it changes, the next status says, once the tick has taken it.
                self.look = now;
                if let Command::Hold | Command::Resume = command {
                    self.pause = now + PAUSE;
                    self.look = self.pause;
                }
                if let (Command::Hold, Some(status)) = (command, self.conversation.status_mut()) {
                    status.acting = Acting::Hold;
                }
            }
            Reply::Refused(refusal) => self.on_refusal(&command, refusal, now),
            Reply::Section(_) | Reply::Kept { .. } | Reply::Update(_) => {}
        }
    }

    fn stop(&mut self) {
        self.command(UserCommand::Stop);
        self.finish();
    }

    fn reconnected(&mut self) {
        self.orders.recall();
        self.conversation.reconnected();
    }
}

impl<N: Transmit> GoalClient<N> {
    /// Creates the client of a machine that is what `hello` says. Another conversation with the machine should have another
    /// number `conversation`.
    pub fn new(hello: Hello, patience: Patience, conversation: u32) -> Self {
        Self {
            conversation: Conversation::new(hello, patience, conversation),
            wanted: None,
            orders: UserCommands::default(),
            is_last: false,
            is_under_way: false,
            is_judging: false,
            refused: None,
            every: STATUS_EVERY,
            look: Duration::ZERO,
            pause: Duration::ZERO,
            is_enabled: false,
            is_resting: false,
            ends_moving: false,
            falls_short: false,
            result: None,
        }
    }

    /// Wants a goal, in place of one that the machine has not taken.
    pub fn aim(&mut self, goal: Goal<N>) {
        self.wanted = Some(goal);
        self.is_under_way = true;
    }

    /// Says that no other goal follows: the client has finished once the machine stands.
    pub fn finish(&mut self) {
        self.is_last = true;
    }

    /// Brings the machine to rest on its path, and drops what is left of the motion: it is over, and no failure.
    pub fn rest(&mut self) {
        self.command(UserCommand::Stop);
        self.is_resting = true;
    }

    /// Returns true until the machine stands behind a [`GoalClient::rest`]: where it will stand is not known.
    pub fn is_resting(&self) -> bool {
        self.is_resting
    }

    /// Returns true if the last goal is in motion: the machine came to rest on its way there.
    pub fn falls_short(&self) -> bool {
        self.falls_short
    }

    /// Takes a command of the user. The command goes before the goal. A stop drops it.
    pub fn command(&mut self, command: UserCommand) {
        if matches!(command, UserCommand::Stop | UserCommand::Disable) {
            self.wanted = None;
        }
        self.orders.push(command);
    }

    /// Returns the identity of the machine that answered.
    pub fn identity(&self) -> Option<&Identity> {
        self.conversation.identity()
    }

    /// Returns the last status.
    pub fn status(&self) -> Option<&Status<N>> {
        self.conversation.status()
    }

    /// Returns true while the machine has not taken the goal that is wanted.
    pub fn is_wanting(&self) -> bool {
        self.wanted.is_some()
    }

    /// Takes the limit out that keeps the machine from the last goal.
    pub fn take_refused(&mut self) -> Option<Violation<N>> {
        self.refused.take()
    }

    /// The next command, if there is something to say at `now`.
    fn next(&mut self, now: Duration) -> Option<Command<N>> {
        let Some(status) = self.status().copied().filter(|_| now < self.look) else {
            return Some(Command::Status);
        };
        if now < self.pause {
            return None;
        }
        if let Some(order) = self.orders.ask() {
            return Some(order.into());
        }
        match status.state {
            State::Disabled if !self.is_enabled => return Some(Command::Enable),
            State::Disabled | State::Enabling | State::Disabling => return None,
            _ => {}
        }
        if status.waits_for_host() {
            return Some(Command::Resume);
        }
        let waits = status.state == State::Idle && status.next != status.done;
        let needs_more = self.ends_moving && (self.wanted.is_some() || self.is_last);
        if waits && !status.planning && status.admitted == status.next && !needs_more {
            return Some(Command::Start);
        }
        // A goal takes the place of one whose cut is ahead: where the machine holds before the cut that may be for long.
        let takes_goal = !status.planning || status.state == State::Holding;
        if let Some(goal) = self.wanted.filter(|_| takes_goal) {
            return Some(Command::Retarget(goal));
        }
        let is_dry = status.state == State::Holding && status.acting == Acting::QueueDry;
        if self.is_last && !status.planning && (is_dry || (waits && needs_more)) {
            self.falls_short = true;
            self.rest();
            return self.orders.ask().map(Command::from);
        }
        let stands = status.state == State::Idle && status.next == status.done;
        if stands && !status.planning && self.wanted.is_none() {
            self.is_under_way = false;
            if self.is_last {
                self.result = Some(Ok(()));
            }
        }
        None
    }

    fn on_status(&mut self, status: Status<N>, now: Duration) {
        self.look = now + self.every;
        let before = self.conversation.keep(status);
        if let Some(fault) = status.fault {
            self.result = Some(Err(GoalFailure::Fault(fault)));
            return;
        }
        let is_off = status.state == State::Disabled && self.is_enabled;
        let is_busy = matches!(
            status.state,
            State::Unhomed | State::Homing | State::Cleared | State::Recovering
        );
        if is_off || is_busy {
            let state = GoalFailure::State(status.state);
            let why = status.not_enabled.filter(|_| is_off);
            self.result = Some(Err(why.map_or(state, GoalFailure::NotEnabled)));
            return;
        }
        if let Some(verdict) = status.refused.filter(|_| self.is_judging) {
            self.is_judging = false;
            self.refused = verdict.violation;
        }
        let stopped = matches!(status.acting, Acting::Stop | Acting::Silence);
        let was_moving = before.is_some_and(|before| before.state != State::Idle);
        let is_idle = status.state == State::Idle;
        let was_asked = is_idle && self.orders.is_empty() && std::mem::take(&mut self.is_resting);
        if is_idle && stopped && was_moving && self.is_last && !was_asked {
            self.result = Some(Err(GoalFailure::Stopped(status.acting)));
        }
    }

    fn on_refusal(&mut self, command: &Command<N>, refusal: Refusal<N>, now: Duration) {
        self.ends_moving |= refusal == Refusal::EndsMoving;
        match refusal {
            Refusal::Busy => self.orders.recall(),
            _ => self.orders.settle(command),
        }
        match (command, refusal) {
            // Not yet.
            (
                _,
                Refusal::Busy
                | Refusal::Retargeting
                | Refusal::PathUnderWay
                | Refusal::QueueFull
                | Refusal::Undecided
                | Refusal::NothingQueued
                | Refusal::EndsMoving
                | Refusal::State(State::Stopping),
            ) => {
                self.pause = now + PAUSE;
                self.look = self.pause;
            }
            // The user's command came too late or too early.
            (
                Command::Hold | Command::Resume | Command::Start | Command::Enable,
                Refusal::State(_),
            )
            | (Command::Resume, Refusal::DoorOpen) => {
                // The status is older than what refuses it.
                self.pause = now + PAUSE;
                self.look = self.pause;
            }
            (_, refusal) => self.result = Some(Err(GoalFailure::Refused(refusal))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local;
    use crate::tick_line::TickLine;
    use trirrr_core::setpoint::Pose;
    use trirrr_scene::Scene;

    fn goal(x: f64, y: f64) -> Goal<f32> {
        Goal {
            to: Pose::from_f64(x, y, 0.15),
            velocity: [0.0; 3],
            cut: true,
            least_ticks: 0,
        }
    }

    /// The machine remembers a refusal until the next goal: it is of none of another client, and one like it is told again.
    #[test]
    fn a_refusal_is_of_the_goal_that_the_machine_has_taken() {
        let scene = Scene::read("../../scenes/thesis.toml").unwrap();
        let hello = local::hello::<f32>(&scene);
        local::with_machine::<f32, _>(&scene, |machine| {
            let mut line = TickLine::new(machine);
            let mut client = GoalClient::new(hello, Patience::default(), 1);
            for _ in 0..2 {
                client.aim(goal(0.9, 0.27));
                line.talk(&mut client, 400);
                assert!(client.take_refused().is_some(), "{:?}", client.status());
            }
            assert!(client.status().unwrap().refused.is_some());
            let mut client = GoalClient::new(hello, Patience::default(), 1 << 16);
            line.talk(&mut client, 400);
            assert_eq!(client.take_refused(), None, "no goal was given");
            client.aim(goal(0.23, 0.23));
            line.talk(&mut client, 400);
            assert_eq!(client.take_refused(), None);
            let end = client.status().unwrap().end.unwrap();
            assert_eq!(end.pose, goal(0.23, 0.23).to);
        })
        .unwrap();
    }

    /// A line that is lost, or a machine that was switched on anew, takes no command of the user away.
    #[test]
    fn a_stop_that_was_lost_is_asked_again() {
        let scene = Scene::read("../../scenes/thesis.toml").unwrap();
        let hello = local::hello::<f32>(&scene);
        let mut client = GoalClient::<f32>::new(hello, Patience::default(), 1);
        local::with_machine::<f32, _>(&scene, |machine| {
            let mut line = TickLine::new(machine);
            line.talk(&mut client, 400);
            client.aim(goal(0.28, 0.28));
            line.talk(&mut client, 400);
            client.command(UserCommand::Disable);
            // Sent, and never there.
            let sent = client.poll(line.now);
            assert!(matches!(sent, Turn::Send(_)), "{sent:?}");
            client.reconnected();
            line.talk(&mut client, 400);
            assert_eq!(line.machine.state(), State::Disabled);
        })
        .unwrap();
    }
}
