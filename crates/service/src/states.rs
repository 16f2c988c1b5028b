//! The states of a machine, and what leads from one to another: the one place that decides it.
//!
//! The tick asks [`next`] at each trigger, the background at each command before it is accepted. What has to hold besides (moves that are
//! queued, a door that is closed) stands where the trigger comes from. The table and the diagram of docs/service.md are this function,
//! and the exploration of all states takes each of its rows.

use State::{
    Cleared, Disabled, Disabling, Enabling, Fault, Holding, Homing, Idle, Reacting, Recovering,
    Running, Slowing, Stopping, Unhomed,
};
use Transition::{Kept, Refused, To};
use trirrr_protocol::message::State;

/// Knowledge of a machine about the place where it stands: the state in which it stands there with its drives on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Known(State);

/// An event that may change the state of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Trigger {
    /// The job is to begin, with the probe or without.
    Start,
    Hold,
    Resume,
    Stop,
    Enable,
    /// The drives are to go off. After a fault they may be on.
    Disable,
    /// The fault is acknowledged; behind a stop that kept the drives on, with what is known then.
    ClearFault(Option<Known>),
    Recover,
    Home,
    /// The path goes on: after a resume, or with moves that came.
    GoesOn,
    /// The pace is that which the host asks for.
    AtPace,
    /// The moves that are queued end with a velocity.
    RunsDry,
    /// They do, and the machine stands at the end of one.
    StandsDry,
    /// The host is silent.
    Silence,
    /// The door is open.
    Door,
    /// The probe touches, or lets go.
    Touch,
    /// The path is left at rest, to be gone on with.
    Rests,
    /// The motion is over.
    Ends(Known),
    /// The motion is over, and the drives are to go off.
    EndsOff,
    /// Homing has found every motor.
    Found,
    /// The board has measured other angles of the motors.
    Measured,
    /// The drives are on, and the brake has let go.
    DrivesOn(Known),
    /// The drives are off, and the brake holds.
    DrivesOff,
    /// A fault that the machine comes to rest from.
    FaultOnPath,
    /// A fault at which the drives go off at once.
    FaultAtOnce,
    /// The machine stands after a fault, and its drives hold it.
    Reacted,
}

/// Effect of a trigger in a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Transition {
    /// This state follows. It may be the same, for another reason.
    To(State),
    /// Nothing: the machine is, or does, what is asked for.
    Kept,
    /// Nothing: it does not fit the state.
    Refused,
}

impl Known {
    /// Its pose.
    pub(crate) const POSE: Self = Self(Idle);
    /// The angles of its motors alone.
    pub(crate) const ANGLES: Self = Self(Cleared);
    /// Nothing: it has to be homed.
    pub(crate) const NOTHING: Self = Self(Unhomed);
}

impl Transition {
    /// State that follows, if one does.
    #[inline(always)]
    pub(crate) fn state(self) -> Option<State> {
        match self {
            To(state) => Some(state),
            Kept | Refused => None,
        }
    }
}

/// Effect of `trigger` on a machine in `state`.
#[inline(always)]
pub(crate) const fn next(state: State, trigger: Trigger) -> Transition {
    match (trigger, state) {
        (Trigger::Start, Idle) => To(Running),

        // What a machine waits for changes, too: it does not go on by itself any more.
        (Trigger::Hold, Running | Slowing) => To(Slowing),
        (Trigger::Hold, Holding) => To(Holding),

        // On the way to rest it goes on once it has come to rest.
        (Trigger::Resume, Slowing | Holding) => To(state),

        (Trigger::Stop, Running | Slowing | Holding | Stopping | Recovering | Homing) => {
            To(Stopping)
        }
        // The queue is dropped.
        (Trigger::Stop, Idle) => To(Idle),
        // A retreat is ended.
        (Trigger::Stop, Reacting) => To(Reacting),
        (Trigger::Stop, _) => Kept,

        (Trigger::Enable, Disabled) => To(Enabling),

        (Trigger::Disable, Idle | Cleared | Unhomed | Enabling) => To(Disabling),
        (Trigger::Disable, Running | Slowing | Holding | Stopping | Recovering | Homing) => {
            To(Stopping)
        }
        (Trigger::Disable, Fault) => To(Reacting),
        (Trigger::Disable, _) => Kept,

        (Trigger::ClearFault(Some(known)), Fault) => To(known.0),
        (Trigger::ClearFault(None), Fault | Disabled) => To(Disabled),

        (Trigger::Recover, Idle | Cleared) => To(Recovering),
        (Trigger::Home, Idle | Cleared | Unhomed) => To(Homing),
        (Trigger::Found, Homing) => To(Recovering),

        (Trigger::GoesOn, Holding) => To(Running),
        (Trigger::AtPace, Running) => To(Running),
        (Trigger::RunsDry, Running) => To(Slowing),
        (Trigger::RunsDry, Holding) => To(Holding),
        (Trigger::StandsDry, Running | Slowing | Holding) => To(Holding),

        // A job waits on its path. Other motion ends.
        (Trigger::Silence, Running) => To(Slowing),
        (Trigger::Silence | Trigger::Door, Recovering | Homing) => To(Stopping),
        (Trigger::Door, Running | Slowing) => To(Slowing),
        (Trigger::Door, Holding) => To(Holding),
        (Trigger::Touch, Running | Slowing | Holding) => To(Stopping),

        (Trigger::Rests, Slowing) => To(Holding),
        (Trigger::Ends(Known::POSE), Running | Slowing | Holding | Recovering) => To(Idle),
        (Trigger::Ends(known), Stopping) => To(known.0),
        (Trigger::EndsOff, Stopping) => To(Disabling),

        (Trigger::Measured, Idle | Unhomed) => To(Cleared),
        (Trigger::Measured, Fault | Cleared | Disabled) => Kept,

        (Trigger::DrivesOn(known), Enabling) => To(known.0),
        (Trigger::DrivesOff, Enabling | Disabling) => To(Disabled),
        (Trigger::DrivesOff, Reacting) => To(Fault),

        (Trigger::FaultOnPath, Fault | Reacting | Enabling | Disabled) => Refused,
        (Trigger::FaultOnPath, _) => To(Reacting),
        (Trigger::FaultAtOnce, Fault) => Kept,
        (Trigger::FaultAtOnce, _) => To(Fault),
        (Trigger::Reacted, Reacting) => To(Fault),

        _ => Refused,
    }
}
