//! Commands that a host sends to a machine.

use super::board::NAME_CAPACITY;
use super::scene::{Section, SectionName};
use super::{
    AnyMove, LevelPiece, ListedMove, Move, MoveBatch, OutputSwitch, PathPiece, QuinticMove,
    TelemetryFields, Transmit, UpdateStep,
};
use core::fmt;
use postcard_schema::Schema;
use serde::de::{DeserializeOwned, Deserializer, Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;

/// A command with its sequence number.
///
/// # Type parameters
/// `S` is what a part of the scene in it is read as: a [`Section`], or [`Unread`](super::Unread) by a machine that takes none. `C` is
/// the same for quintic moves and for batches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound(
    serialize = "N: Transmit, S: Serialize, C::Quintic: Serialize, C::Goal: Serialize, C::Piece: Serialize, C::Batch: Serialize, C::Levels: Serialize, C::Listed: Serialize, C::Update: Serialize",
    deserialize = "N: Transmit, S: DeserializeOwned, C::Quintic: DeserializeOwned, C::Goal: DeserializeOwned, C::Piece: DeserializeOwned, C::Batch: DeserializeOwned, C::Levels: DeserializeOwned, C::Listed: DeserializeOwned, C::Update: DeserializeOwned"
))]
#[postcard(
    bound = "N: Transmit, S: Schema, C: MoveContents, C::Quintic: Schema, C::Goal: Schema, C::Piece: Schema, C::Batch: Schema, C::Levels: Schema, C::Listed: Schema, C::Update: Schema"
)]
pub struct Request<N: Number, S = Section, C: MoveContents = AllMoves<N>> {
    /// Counts the requests, one by one, modulo 2^32; the first is `next_sequence` of the
    /// [`Identity`](super::Identity). A repeated one is answered again and not executed again. That of a hello is sent
    /// back and otherwise ignored.
    pub sequence: u32,
    /// The command.
    pub command: Command<N, S, C>,
}

/// An instruction or a question to the machine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound(
    serialize = "N: Transmit, S: Serialize, C::Quintic: Serialize, C::Goal: Serialize, C::Piece: Serialize, C::Batch: Serialize, C::Levels: Serialize, C::Listed: Serialize, C::Update: Serialize",
    deserialize = "N: Transmit, S: DeserializeOwned, C::Quintic: DeserializeOwned, C::Goal: DeserializeOwned, C::Piece: DeserializeOwned, C::Batch: DeserializeOwned, C::Levels: DeserializeOwned, C::Listed: DeserializeOwned, C::Update: DeserializeOwned"
))]
#[postcard(
    bound = "N: Transmit, S: Schema, C: MoveContents, C::Quintic: Schema, C::Goal: Schema, C::Piece: Schema, C::Batch: Schema, C::Levels: Schema, C::Listed: Schema, C::Update: Schema"
)]
pub enum Command<N: Number, S = Section, C: MoveContents = AllMoves<N>> {
    /// Opens the conversation; nothing else is heard before it. Answered by an identity.
    Hello(Hello),
    /// Asks for the [status](super::Status).
    Status,
    /// Asks for a part of the scene as it stands.
    Read(SectionName),
    /// Replaces a part of the scene; only in idle with nothing queued.
    Replace(S),
    /// Offers a move, to be admitted and queued behind the last.
    Move(Move<N>),
    /// Plays what is queued.
    Start,
    /// Comes to rest on the path, to be resumed.
    Hold,
    /// Goes on where it holds.
    Resume,
    /// Comes to rest on the path and drops the rest of the job.
    Stop,
    /// Acknowledges the latched fault and clears the errors of the drives. They stay off until `Enable`.
    ClearFault,
    /// Moves the motors, each by itself, to their angles at a pose.
    Recover(Recovery<N>),
    /// One telemetry sample every so many ticks; 0 for none.
    Telemetry {
        /// Ticks from one sample to the next.
        every: u16,
        /// Fields of a sample.
        fields: TelemetryFields,
    },
    /// Searches for the switches or hard stops of the motors, then moves to the scene's start pose.
    Home,
    /// Offers a quintic move, as `Move` does a cubic one.
    Quintic(C::Quintic),
    /// Changes the pace of all motion along a path, at once, as fast as the limits leave room.
    FeedOverride {
        /// 1 to 100 % of normal speed.
        percent: u8,
    },
    /// Asks for moves to a goal, in the least time that the machine can prove: in place of the motion under way, or behind the
    /// last move as if the host had offered them.
    Retarget(C::Goal),
    /// Gives a piece of a path, which the machine plans itself in the least time. Its moves are queued as if the host had offered
    /// them.
    Path(C::Piece),
    /// Switches the drives on, where the motors are.
    Enable,
    /// Comes to rest as `Stop` does, then switches the drives off.
    Disable,
    /// One [sample of the drives](super::DriveSample) every so many ticks; 0 for none.
    Drives {
        /// Ticks from one sample to the next.
        every: u16,
    },
    /// Offers several moves at once, as [`Command::Move`] and [`Command::Quintic`] do one: all of them, or none.
    Moves(C::Batch),
    /// Names the job whose moves come next; only in idle with nothing queued. Every [status](super::Status) has it from then on.
    Job(JobLabel),
    /// Gives levels of the tool's power for moves to come: see power lists.
    Levels(C::Levels),
    /// Offers a move whose levels were given, as `Moves` does one without.
    Listed(C::Listed),
    /// Plays what is queued as `Start` does, until the probe's contact changes: then it comes to rest on the path and
    /// drops the rest.
    Probe {
        /// `true`: until the probe touches no more. `false`: until it touches.
        away: bool,
    },
    /// Asks for the [state of an update](super::UpdateStatus) of the program.
    UpdateStatus,
    /// Replaces the program, step by step; only with the drives off.
    Update(C::Update),
    /// Switches a spare output at once.
    Output {
        /// The output, from 0 in the order of the scene.
        index: u8,
        /// `true`: on.
        on: bool,
    },
    /// Switches spare outputs with the motion: in the tick in which a move begins that is still to be offered.
    OutputsAt(OutputSwitch),
}

/// The machine that a host expects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Hello {
    /// Version of this protocol: [`PROTOCOL`](super::PROTOCOL).
    pub protocol: u16,
    /// Key of the messages' layout.
    pub schema: u64,
    /// Key of the scene, 0 for any.
    pub scene: u32,
}

/// A job, as its host calls it. The machine tells it to whoever asks, and does nothing else with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct JobLabel {
    /// Name: ASCII, cut where it is longer, zeros behind it.
    #[serde(deserialize_with = "bytes_in_turn")]
    pub name: [u8; NAME_CAPACITY],
    /// Number of its moves, or of its pieces of a path.
    pub items: u32,
    /// Checksum over all of them, by which a host knows its job again. The host chooses which.
    pub check: u32,
}

/// Reads an array byte by byte in a loop: serde's own way is one step after the other, each with its own test.
fn bytes_in_turn<'de, D: Deserializer<'de>, const BYTES: usize>(
    deserializer: D,
) -> Result<[u8; BYTES], D::Error> {
    deserializer.deserialize_tuple(BYTES, InTurn::<BYTES>)
}

/// Reader of bytes, see [`bytes_in_turn`].
struct InTurn<const BYTES: usize>;

impl<'de, const BYTES: usize> Visitor<'de> for InTurn<BYTES> {
    type Value = [u8; BYTES];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{BYTES} bytes")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<[u8; BYTES], A::Error> {
        let mut bytes = [0; BYTES];
        for (index, byte) in bytes.iter_mut().enumerate() {
            *byte = sequence
                .next_element()?
                .ok_or_else(|| A::Error::invalid_length(index, &self))?;
        }
        Ok(bytes)
    }
}

/// Where a machine that plays quintics is to go, by moves that it plans itself. An image without quintics answers
/// `NoQuintics`. `Done` means that the plan is begun, and until it ends each offer is refused with `Retargeting`; a
/// goal with `cut` takes the place of one whose cut is ahead. The moves are numbered from `Status.next` on, and each
/// gets its Verdict. Where there is no motion, a Verdict with the number `Status.next` has the violation, and nothing
/// changes. A goal that is the state itself gives no move. A machine in `Idle` waits for `Start`.
///
/// Without `cut` the motion starts in the state `Status.end`, and has as many moves as there was room for at most.
/// With `cut` it starts within the motion under way, as soon as it is planned. What is queued behind that place is
/// dropped, `done` leaps to the number of the first new move, and `Status.cut` has the [`Cut`](super::Cut). Offers are
/// refused until then. Where the plan comes too late, or nothing moves, the moves are queued behind the others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Goal<N: Number> {
    /// Pose there.
    pub to: Pose<N>,
    /// (vx, vy, alphadot) there.
    pub velocity: [N; 3],
    /// `true`: from the motion under way, which is cut as soon as the new one is planned. `false`: behind the moves
    /// that are queued. Where nothing moves, both are the same.
    pub cut: bool,
    /// Fewest ticks of the motion: a goal in motion is passed at this time, if that is possible. 0: as short as it is proven.
    pub least_ticks: u32,
}

/// A joint-space move, rest to rest, from the present motor angles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Recovery<N: Number> {
    /// The pose whose motor angles are the target.
    pub to: Pose<N>,
    /// Duration in ticks, positive.
    pub ticks: u32,
}

/// Types as which a machine reads what not every machine plays, or [`Unread`](super::Unread).
pub trait MoveContents {
    /// A [`QuinticMove`].
    type Quintic: Clone + Copy + core::fmt::Debug + PartialEq;
    /// A [`Goal`].
    type Goal: Clone + Copy + core::fmt::Debug + PartialEq;
    /// A [`PathPiece`].
    type Piece: Clone + Copy + core::fmt::Debug + PartialEq;
    /// A [`MoveBatch`].
    type Batch: Clone + Copy + core::fmt::Debug + PartialEq;
    /// A [`LevelPiece`].
    type Levels: Clone + Copy + core::fmt::Debug + PartialEq;
    /// A [`ListedMove`].
    type Listed: Clone + Copy + core::fmt::Debug + PartialEq;
    /// An [`UpdateStep`].
    type Update: Clone + Copy + core::fmt::Debug + PartialEq;
}

/// All of it is read.
pub type AllMoves<N> = (
    QuinticMove<N>,
    Goal<N>,
    PathPiece<N>,
    MoveBatch<N>,
    LevelPiece,
    ListedMove<N>,
    UpdateStep,
);

/// The types in their order.
impl<Q, G, P, B, L, M, U> MoveContents for (Q, G, P, B, L, M, U)
where
    Q: Clone + Copy + core::fmt::Debug + PartialEq,
    G: Clone + Copy + core::fmt::Debug + PartialEq,
    P: Clone + Copy + core::fmt::Debug + PartialEq,
    B: Clone + Copy + core::fmt::Debug + PartialEq,
    L: Clone + Copy + core::fmt::Debug + PartialEq,
    M: Clone + Copy + core::fmt::Debug + PartialEq,
    U: Clone + Copy + core::fmt::Debug + PartialEq,
{
    type Quintic = Q;
    type Goal = G;
    type Piece = P;
    type Batch = B;
    type Levels = L;
    type Listed = M;
    type Update = U;
}

/// Moves that a command offers, as they are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OfferedMoves {
    /// Number of the first.
    pub number: u32,
    /// Number of moves.
    pub count: u32,
    /// Duration of the last, in ticks.
    pub ticks: u32,
}

impl OfferedMoves {
    /// Number of the last; that before the first of none.
    pub fn last(&self) -> u32 {
        self.next().wrapping_sub(1)
    }

    /// Number of the move behind the last.
    pub fn next(&self) -> u32 {
        self.number.wrapping_add(self.count)
    }
}

impl<N: Number> AnyMove<N> {
    /// The command that offers it.
    pub fn command(&self) -> Command<N> {
        match *self {
            Self::Cubic(each) => Command::Move(each),
            Self::Quintic(each) => Command::Quintic(each),
        }
    }
}

impl<N: Number, S, C: MoveContents> Command<N, S, C> {
    /// Asks for a telemetry sample with all fields every `every` ticks.
    pub const fn telemetry(every: u16) -> Self {
        Self::Telemetry {
            every,
            fields: TelemetryFields::ALL,
        }
    }
}

impl<N: Number, S> Command<N, S> {
    /// Returns true for moves, and for levels and outputs of moves: several such requests may be in flight, and no order of the tick is among them.
    pub fn brings_moves(&self) -> bool {
        matches!(self, Self::Levels(_) | Self::OutputsAt(_)) || self.offered().is_some()
    }

    /// The moves that the command offers.
    pub fn offered(&self) -> Option<OfferedMoves> {
        match self {
            Self::Move(common) | Self::Quintic(QuinticMove { common, .. }) => Some(OfferedMoves {
                number: common.number,
                count: 1,
                ticks: common.ticks,
            }),
            Self::Moves(batch) => Some(OfferedMoves {
                number: batch.number,
                count: batch.steps().count() as u32,
                ticks: batch.steps().last().map_or(0, |step| step.ticks),
            }),
            Self::Listed(listed) => Some(OfferedMoves {
                number: listed.number,
                count: 1,
                ticks: listed.step.ticks,
            }),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_label_is_read_back_and_a_cut_one_is_an_error() {
        let label = JobLabel {
            name: core::array::from_fn(|index| 255 - index as u8),
            items: 7,
            check: 9,
        };
        let mut buffer = [0; 64];
        let bytes = postcard::to_slice(&label, &mut buffer).expect("there is room");
        assert_eq!(bytes.len(), NAME_CAPACITY + 2);
        assert_eq!(postcard::from_bytes::<JobLabel>(bytes), Ok(label));
        for length in 0..bytes.len() {
            let cut = postcard::from_bytes::<JobLabel>(&bytes[..length]);
            assert_eq!(cut, Err(postcard::Error::DeserializeUnexpectedEnd));
        }
    }
}
