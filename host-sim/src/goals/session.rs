//! Goals under way: client, port and what wants goals.

use super::args::MachineArgs;
use crate::dialogue::{Reported, carry};
use crate::failure::CliError;
use crate::numbers::refused;
use crate::stream::conversation;
use crate::terminal::say;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use trirrr_client::describe::{self, Units};
use trirrr_client::{Dialogue, GoalClient, GoalFailure, Turn, UserCommand, local};
use trirrr_core::setpoint::Pose;
use trirrr_line::Port;
use trirrr_protocol::message::{Goal, Message, State, Transmit};
use trirrr_scene::{Scene, offer};
use trirrr_service::ServiceNumber;

/// A goal in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GoalSi {
    /// x, y and alpha.
    pub(super) pose: [f64; 3],
    /// Its derivative by time there.
    pub(super) velocity: [f64; 3],
    /// Least duration, s.
    pub(super) least_s: f64,
}

/// Source of goals.
pub(super) trait Goals {
    /// Called every few milliseconds, with the time since the start.
    ///
    /// # Errors
    /// Refused: what the user gave.
    fn want<N: ServiceNumber>(
        &mut self,
        session: &mut GoalSession<'_, N>,
        now: Duration,
    ) -> Result<(), CliError>;

    /// Called where the machine has no motion to the last goal, after the user was told.
    fn refused<N: ServiceNumber>(&mut self, _: &mut GoalSession<'_, N>) {}

    /// Called at the end.
    ///
    /// # Errors
    /// Refused: input that was left out.
    fn verdict(&self) -> Result<(), CliError> {
        Ok(())
    }
}

/// Goals under way.
pub(super) struct GoalSession<'a, N: Transmit> {
    args: &'a MachineArgs,
    client: GoalClient<N>,
    units: trirrr_core::units::Units,
    words: Units,
    /// Ticks from normal speed to rest.
    ramp_s: f64,
    /// The pose at the end of all goals, SI.
    end: Option<[f64; 3]>,
}

impl<'a, N: ServiceNumber> GoalSession<'a, N> {
    /// Opens the port to the machine of `scene`, for goals over it.
    ///
    /// # Errors
    /// Refused: the scene in this number type. Failed: the port.
    pub(super) fn open(args: &'a MachineArgs, scene: &Scene) -> Result<(Self, Port), CliError> {
        let (port, units, patience) = args.open::<N>(scene)?;
        let hello = local::hello::<N>(scene);
        let mut client = GoalClient::new(hello, patience, conversation());
        if let Some(percent) = args.feed {
            client.command(UserCommand::FeedOverride(percent));
        }
        let session = Self {
            args,
            client,
            words: Units::of_scene(scene, &units),
            units,
            ramp_s: scene.service.hold_ramp_s,
            end: None,
        };
        Ok((session, port))
    }

    /// Pose where the last goal ends, or the machine's own moves; none before the first status, and while the machine comes to rest.
    pub(super) fn end(&self) -> Option<[f64; 3]> {
        if self.client.is_resting() {
            return None;
        }
        self.end.or_else(|| {
            let end = self.client.status()?.end?;
            let pose = end.pose;
            let metres = |value: N| value.to_f64() * self.units.length_m();
            let [x, y] = [pose.position.x, pose.position.y].map(metres);
            Some([x, y, N::angle_to_f64(pose.angle)])
        })
    }

    /// Time in which the machine comes to rest where its limits leave room, s.
    pub(super) fn ramp_s(&self) -> f64 {
        self.ramp_s
    }

    /// Returns true while the machine has not taken the last goal.
    pub(super) fn is_wanting(&self) -> bool {
        self.client.is_wanting()
    }

    /// Wants a goal.
    pub(super) fn aim(&mut self, goal: &GoalSi) {
        let units = &self.units;
        let pose = units.pose(&Pose::from_f64(goal.pose[0], goal.pose[1], goal.pose[2]));
        let velocity = units.velocity(&goal.velocity.into());
        self.end = Some(goal.pose);
        self.client.aim(Goal {
            to: offer::pose(&pose),
            velocity: <[f64; 3]>::from(velocity).map(N::from_f64),
            cut: true,
            // From float to integer the cast saturates.
            least_ticks: (goal.least_s * self.words.tick_rate_hz).round() as u32,
        });
    }

    /// Takes a command of the user.
    pub(super) fn command(&mut self, command: UserCommand) {
        self.client.command(command);
    }

    /// Brings the machine to rest on its path: the goals so far are over.
    pub(super) fn rest(&mut self) {
        self.end = None;
        self.client.rest();
    }

    /// Says that no other goal follows.
    pub(super) fn finish(&mut self) {
        self.client.finish();
    }

    /// Talks to the machine until it stands at the last goal. Returns the pose, SI; none where the user has stopped it.
    ///
    /// # Errors
    /// Refused: the board refuses the scene, or a goal where it is the only one. Failed: the machine has a fault, or the
    /// port or the board is lost.
    pub(super) fn run(
        &mut self,
        port: &mut Port,
        goals: &mut impl Goals,
        strict: bool,
        stop: &AtomicBool,
    ) -> Result<Option<[f64; 3]>, CliError> {
        let under_way = GoalsUnderWay {
            session: self,
            goals,
            strict,
            is_stopped: false,
        };
        carry(&mut Reported::new(under_way), port, stop)?
    }

    fn failure(&self, failure: &GoalFailure<N>) -> CliError {
        let text = failure.describe(&self.words);
        let text = match failure {
            GoalFailure::Fault(_) => {
                let command = self.args.command("enable", " --clear");
                format!("{text}; {command} acknowledges it")
            }
            GoalFailure::State(State::Unhomed) => {
                format!("{text}: {} homes it", self.args.command("park", ""))
            }
            GoalFailure::State(State::Cleared) => format!(
                "{text}: {} brings it to the start of its job",
                self.args.command("stream", " --recover 2")
            ),
            _ => text,
        };
        match failure {
            GoalFailure::Refused(refusal) => refused(refusal, text),
            _ => CliError::Failed(text),
        }
    }

    fn stands(&mut self, stopped: bool) -> Option<[f64; 3]> {
        if self.client.falls_short() && !stopped {
            say(
                "the last pose is in motion: the machine came to rest on its way there, and has dropped what was left",
            );
        }
        self.end = None;
        self.end().filter(|_| !stopped)
    }
}

/// Client and source of goals.
struct GoalsUnderWay<'s, 'a, N: Transmit, G> {
    session: &'s mut GoalSession<'a, N>,
    goals: &'s mut G,
    /// A goal that is refused is the end.
    strict: bool,
    is_stopped: bool,
}

impl<N: ServiceNumber, G: Goals> Dialogue<N> for GoalsUnderWay<'_, '_, N, G> {
    type End = Result<Option<[f64; 3]>, CliError>;

    const LOOK: Duration = Duration::from_millis(5);

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        let session = &mut *self.session;
        session.client.poll(now).map(|result| match result {
            Ok(()) => Ok(session.stands(self.is_stopped)),
            Err(GoalFailure::Stopped(_)) if self.is_stopped => Ok(None),
            Err(failure) => Err(session.failure(&failure)),
        })
    }

    fn attend(&mut self, now: Duration) -> Option<Self::End> {
        let session = &mut *self.session;
        // A board that computes in other numbers refuses the hello: the goals are for another conversation then.
        if !self.is_stopped
            && session.client.identity().is_some()
            && let Err(failure) = self.goals.want(session, now)
        {
            return Some(Err(failure));
        }
        if let Some(violation) = session.client.take_refused() {
            session.end = None;
            let why = describe::violation(&violation, 0, &session.words);
            let text = format!("no motion to the goal: {why}");
            if self.strict {
                return Some(Err(CliError::Refused(text)));
            }
            say(&text);
            self.goals.refused(session);
        }
        None
    }

    fn receive(&mut self, message: &Message<N>, now: Duration) {
        self.session.client.receive(message, now);
    }

    fn stop(&mut self) {
        self.is_stopped = true;
        self.session.client.stop();
    }

    fn reconnected(&mut self) {
        self.session.client.reconnected();
    }
}
