//! Messages that a machine sends.

use super::Transmit;
use super::board::{AngleReference, Board, Firmware, NAME_CAPACITY};
use super::command::JobLabel;
use super::digital::DigitalStates;
use super::drive::{DriveSample, NotEnabled};
use super::inputs::InputStates;
use super::probe::ProbeRun;
use super::refusal::Refusal;
use super::scene::Section;
use super::state::{Acting, State};
use super::telemetry::Telemetry;
use super::update::UpdateStatus;
use super::violation::{Fault, Violation};
use postcard_schema::Schema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;

/// Everything that a machine sends.
///
/// # Type parameters
/// `S` is what a part of the scene in it is: a [`Section`], or [`Written`](super::Written) by a machine that only
/// passes it on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound(
    serialize = "N: Transmit, S: Serialize",
    deserialize = "N: Transmit, S: DeserializeOwned"
))]
#[postcard(bound = "N: Transmit, S: Schema")]
// A telemetry sample is the largest and the most frequent: boxing it is not an option here.
#[allow(clippy::large_enum_variant)]
pub enum Message<N: Number, S = Section> {
    /// The answer to a request.
    Reply {
        /// The request's.
        sequence: u32,
        /// The answer.
        reply: Reply<N, S>,
    },
    /// Something happened. Everything that an event says is in the [`Status`] too.
    Event(Event<N>),
    /// A sample of one tick.
    Telemetry(Telemetry<N>),
    /// A sample of the drives in one tick.
    Drives(DriveSample<N>),
}

/// A [`Message`] around what lies elsewhere, with the same bytes on the line.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(bound = "N: Transmit, S: Serialize")]
pub enum MessageRef<'a, N: Number, S = Section> {
    /// As [`Message::Reply`].
    Reply {
        /// The request's.
        sequence: u32,
        /// The answer.
        reply: &'a Reply<N, S>,
    },
    /// As [`Message::Event`].
    Event(&'a Event<N>),
    /// As [`Message::Telemetry`].
    Telemetry(&'a Telemetry<N>),
    /// As [`Message::Drives`].
    Drives(&'a DriveSample<N>),
}

/// The answer to a request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound(
    serialize = "N: Transmit, S: Serialize",
    deserialize = "N: Transmit, S: DeserializeOwned"
))]
#[postcard(bound = "N: Transmit, S: Schema")]
#[allow(clippy::large_enum_variant)] // as above
pub enum Reply<N: Number, S = Section> {
    /// Done, or will be within the next ticks. For a move: offered, its verdict follows.
    Done,
    /// Not executed.
    Refused(Refusal<N>),
    /// Answer to a hello.
    Hello(Identity),
    /// Answer to a question for a part of the scene.
    Section(S),
    /// Answer to a question for the status.
    Status(Status<N>),
    /// The request came before one that is missing. It is kept, and executed and answered in its turn.
    Kept {
        /// Number of the request that the machine waits for.
        missing: u32,
    },
    /// To a question for the state of an update.
    Update(UpdateStatus),
}

/// Description of a machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Identity {
    /// Version of this protocol: [`PROTOCOL`](super::PROTOCOL).
    pub protocol: u16,
    /// Key of the messages' layout.
    pub schema: u64,
    /// Key of the scene.
    pub scene: u32,
    /// Name of the scene: ASCII, cut where it is longer, zeros behind it.
    pub name: [u8; NAME_CAPACITY],
    /// Ticks per second.
    pub tick_rate_hz: f64,
    /// One unit of length in m; 1 for floats.
    pub length_m: f64,
    /// One unit of time in s; 1 for floats.
    pub time_s: f64,
    /// One unit of mass in kg; 1 for floats.
    pub mass_kg: f64,
    /// Ticks from normal speed to rest where the limits leave room.
    pub ramp_ticks: u16,
    /// Host timeout: ticks without a request after which a running machine stops; 0 for never.
    pub silence_ticks: u32,
    /// Moves that the queue can hold, including those not yet admitted. The move under way is not among them: `room` +
    /// (`next` - `done`) is up to `queue` + 1.
    pub queue: u16,
    /// Requests that may be sent before the answer to the first of them has come.
    pub window: u8,
    /// Most moves of a [`MoveBatch`](super::MoveBatch); 1 from a machine that takes none.
    pub batch: u8,
    /// Sequence number of the next request. The machine draws it anew for each conversation: a sender that has not
    /// read it cannot ask for anything.
    pub next_sequence: u32,
    /// The way in which the machine knows where its motors are.
    pub reference: AngleReference,
    /// The electronics.
    pub board: Board,
    /// Levels of power for which there is room; 0 of a machine that plays no power lists.
    pub levels: u16,
    /// Build of the program that the machine runs.
    pub firmware: Firmware,
}

/// State of the machine, its queue and its counters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Status<N: Number> {
    /// Ticks since the machine was switched on, modulo 2^32.
    pub tick: u32,
    /// State of the service.
    pub state: State,
    /// Reason why the machine is not at normal speed.
    pub acting: Acting,
    /// The latched fault.
    pub fault: Option<Fault<N>>,
    /// Number of the next move to offer.
    pub next: u32,
    /// Moves admitted since the machine was switched on, modulo 2^32: number of the first move that is not admitted.
    pub admitted: u32,
    /// Moves that are over, counted the same way: passed to their end, or left on the way:
    /// [`interrupted`](Self::interrupted) and [`cut`](Self::cut) say where.
    pub done: u32,
    /// Number of the next piece of a path. A piece that is refused, and all behind it, are dropped: the next to
    /// give takes its place.
    pub piece: u32,
    /// True while the machine plans a path or a retarget, or the cut of one is ahead: more moves come.
    pub planning: bool,
    /// Moves for which there is room.
    pub room: u16,
    /// The last move that was not admitted, until the next one is offered.
    pub refused: Option<Verdict<N>>,
    /// Start of the next move: the end of the last one offered, or the pose in which the machine stands.
    pub end: Option<Setpoint<N>>,
    /// Telemetry samples that were dropped for lack of room, modulo 2^32.
    pub lost: u32,
    /// Longest latency of a tick so far, from its due time until its outputs were set, in counts of the board's timer.
    pub longest_tick: u32,
    /// Ticks in which the machine ran slower, or stood, because its queue was empty, modulo 2^32. Those of the present wait are
    /// counted when it ends.
    pub dry_ticks: u32,
    /// Ticks that came too late, modulo 2^32, on a machine that goes on then. A board stops at the first, with
    /// `Overrun`.
    pub late_ticks: u32,
    /// Ticks of the longest way to rest so far, of a hold, a stop or a fault.
    pub longest_stop: u32,
    /// Feed override: the pace that a host asked for last, in percent of normal speed.
    pub feed_percent: u8,
    /// The last cut by a retarget since the machine was switched on.
    pub cut: Option<Cut>,
    /// Place at which the last job that was not played to its end was left, since the machine was switched on.
    pub interrupted: Option<Interruption>,
    /// The job that was named last since the machine was switched on. One that was left is told until other moves are offered.
    pub job: Option<JobAccount>,
    /// Reason why the last [`Enable`](super::Command::Enable) ended in [`Disabled`](State::Disabled).
    pub not_enabled: Option<NotEnabled<N>>,
    /// Inputs of the machine, free of bounces.
    pub inputs: InputStates,
    /// The last run with a probe since the machine was switched on.
    pub probe: Option<ProbeRun<N>>,
    /// Spare inputs and outputs; none of a scene that names none.
    pub digital: Option<DigitalStates>,
}

impl<N: Number> Status<N> {
    /// Returns true if the machine holds its job, or is about to, because the host was silent: it waits to be
    /// [resumed](super::Command::Resume).
    pub fn waits_for_host(&self) -> bool {
        matches!(self.state, State::Slowing | State::Holding) && self.acting == Acting::Silence
    }
}

/// A job, and the numbers by which the machine calls its parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct JobAccount {
    /// The job as its host has named it.
    pub label: JobLabel,
    /// Number of its first move: [`Status::done`], less this, is its place.
    pub first_move: u32,
    /// Number of its first piece, where it is a path.
    pub first_piece: u32,
}

/// Cut of the motion by a [`Goal`](super::Goal).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Cut {
    /// Number of the move that was under way.
    pub number: u32,
    /// Tick of that move at which it was cut. The move is not played to its end.
    pub at: u32,
    /// Number of the first new move. Moves between the two were not begun.
    pub next: u32,
}

/// Place on the path at which a job lost its tool: at a stop, at a fault, or at an open door before them or before the
/// end. The machine came to rest on the path behind it, maybe moves later; [`Status::done`] counts those, too. A host
/// that goes on with the job begins here, not where the machine stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Interruption {
    /// Number of the move that was under way. The moves behind it were not played with the tool.
    pub number: u32,
    /// Its tick.
    pub at: u32,
}

/// Result of the admission of a move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Verdict<N: Number> {
    /// The move's number.
    pub number: u32,
    /// The limit that the move would break, or is not proven to keep; none where it is admitted.
    pub violation: Option<Violation<N>>,
}

/// Something happened.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub enum Event<N: Number> {
    /// The admission of a move ended. A refusal drops the moves behind it; the next move to offer has its number.
    Verdict(Verdict<N>),
    /// The state, or the reason in `acting`, changed.
    State {
        /// State of the service.
        state: State,
        /// Reason why the machine is not at normal speed.
        acting: Acting,
        /// Moves that are over.
        done: u32,
    },
    /// A fault was latched.
    Fault(Fault<N>),
    /// An input of the machine changed.
    Inputs(InputStates),
    /// A run with a probe has touched, or has ended without.
    Probe(ProbeRun<N>),
    /// A spare input or output changed.
    Digital(DigitalStates),
}
