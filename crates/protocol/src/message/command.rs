//! Commands that a host sends to a machine.

use super::scene::{Section, SectionName};
use super::{Transmit, Unread};
use crate::wire::checksum;
use postcard_schema::Schema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};

/// A command in its frame. `S` is what a part of the scene in it is read as: a [`Section`], or
/// [`Unread`](super::Unread) by a machine that takes none. `C` is the same for quintic moves and for batches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound(
    serialize = "N: Transmit, S: Serialize, C::Quintic: Serialize, C::Goal: Serialize, C::Piece: Serialize, C::Batch: Serialize",
    deserialize = "N: Transmit, S: DeserializeOwned, C::Quintic: DeserializeOwned, C::Goal: DeserializeOwned, C::Piece: DeserializeOwned, C::Batch: DeserializeOwned"
))]
#[postcard(
    bound = "N: Transmit, S: Schema, C: MoveContents, C::Quintic: Schema, C::Goal: Schema, C::Piece: Schema, C::Batch: Schema"
)]
pub struct Request<N: Number, S = Section, C: MoveContents = AllMoves<N>> {
    /// Counts the requests, one by one, modulo 2^32; the first is the one that [`Identity`] names.
    /// A repeated one is answered again and not executed again. That of a [`Command::Hello`] is
    /// sent back and otherwise ignored.
    ///
    /// [`Identity`]: super::Identity
    pub sequence: u32,
    /// Command that the machine is to execute.
    pub command: Command<N, S, C>,
}

/// Order of a host to a machine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound(
    serialize = "N: Transmit, S: Serialize, C::Quintic: Serialize, C::Goal: Serialize, C::Piece: Serialize, C::Batch: Serialize",
    deserialize = "N: Transmit, S: DeserializeOwned, C::Quintic: DeserializeOwned, C::Goal: DeserializeOwned, C::Piece: DeserializeOwned, C::Batch: DeserializeOwned"
))]
#[postcard(
    bound = "N: Transmit, S: Schema, C: MoveContents, C::Quintic: Schema, C::Goal: Schema, C::Piece: Schema, C::Batch: Schema"
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
    /// Acknowledges the latched fault and clears the errors of the drives. They stay off until [`Command::Enable`].
    ClearFault,
    /// Moves the motors, each by itself, to where they are at a pose.
    Recover(Recovery<N>),
    /// One telemetry sample every so many ticks; 0 for none.
    Telemetry {
        /// Ticks from one sample to the next.
        every: u16,
    },
    /// Looks for the switches or stops of the motors, then moves to the scene's start pose.
    Home,
    /// Offers a quintic move, as [`Command::Move`] does a cubic one.
    Quintic(C::Quintic),
    /// Changes the pace of all motion along a path: at once, where the machine moves, as fast as its limits leave room.
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
    /// Comes to rest as [`Command::Stop`] does, then switches the drives off.
    Disable,
    /// One [sample of the drives](super::DriveSample) every so many ticks; 0 for none.
    Drives {
        /// Ticks from one sample to the next.
        every: u16,
    },
    /// Offers several moves at once, as [`Command::Move`] and [`Command::Quintic`] do one: all of them, or none.
    Moves(C::Batch),
}

/// Protocol, layout and scene that a host expects of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Hello {
    /// [`PROTOCOL`](super::PROTOCOL).
    pub protocol: u16,
    /// Key of the messages' layout.
    pub schema: u64,
    /// Key of the scene, 0 for any.
    pub scene: u32,
}

/// One cubic move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Move<N: Number> {
    /// Counts the moves one by one, modulo 2^32; [`Status`](super::Status) says which is expected.
    pub number: u32,
    /// Start pose: bit for bit the end of the last move, or the pose where the machine stands.
    pub from: Pose<N>,
    /// End pose of the move.
    pub to: Pose<N>,
    /// (vx, vy, alphadot) at its start: that at the end of the last one, in the bits.
    pub start_velocity: [N; 3],
    /// (vx, vy, alphadot) at its end.
    pub end_velocity: [N; 3],
    /// Duration in ticks, positive.
    pub ticks: u32,
    /// The tool's power at `tool_speed`, 0 to 1 of what it can give; 0 for none.
    pub tool_power: N,
    /// Speed of the tool along the path at which it has `tool_power`, positive. The power follows the true speed in
    /// proportion, up to 1. 0: the power is the same at every speed, and at rest.
    pub tool_speed: N,
}

/// One quintic move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct QuinticMove<N: Number> {
    /// All that it has in common with a cubic one.
    pub common: Move<N>,
    /// (ax, ay, alphaddot) at its start: that at the end of the last move, in the bits, if that was a quintic;
    /// otherwise 0.
    pub start_acceleration: [N; 3],
    /// (ax, ay, alphaddot) at its end.
    pub end_acceleration: [N; 3],
}

/// Most moves of a [`MoveBatch`].
pub const BATCH: usize = 4;

/// Several moves, each from where the last one ends, without what the machine knows already.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct MoveBatch<N: Number> {
    /// Number of the first move, as in a [`Move`]. The others are counted on from it.
    pub number: u32,
    /// Checksum of the setpoint from which the first move starts: the CRC-32 of the bytes of
    /// [`Status::end`](super::Status::end), without the byte that says that there is one.
    pub check: u32,
    /// The moves, from the first place on and without gaps.
    pub steps: [Option<MoveStep<N>>; BATCH],
}

/// One move of a [`MoveBatch`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct MoveStep<N: Number> {
    /// End pose of the move.
    pub to: Pose<N>,
    /// (vx, vy, alphadot) at its end.
    pub velocity: [N; 3],
    /// (ax, ay, alphaddot) at its end, of a quintic; none of a cubic.
    pub acceleration: Option<[N; 3]>,
    /// Duration in ticks, positive.
    pub ticks: u32,
    /// Setting of the tool; none for no power.
    pub tool: Option<ToolSetting<N>>,
}

/// Setting of the tool, as in a [`Move`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct ToolSetting<N: Number> {
    /// The tool's power.
    pub power: N,
    /// Speed at which it has that power.
    pub speed: N,
}

/// Goal of a machine that plays quintics, by moves that it plans itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Goal<N: Number> {
    /// Pose there.
    pub to: Pose<N>,
    /// (vx, vy, alphadot) there.
    pub velocity: [N; 3],
    /// True: from the motion under way, which is cut as soon as the new one is planned. False: behind the moves that are
    /// queued. Where nothing moves, both are the same.
    pub cut: bool,
    /// Fewest ticks of the motion: a goal in motion is passed at this time, if that is possible. 0: as short as it is proven.
    pub least_ticks: u32,
}

/// A piece of a path. It begins where the path ends so far: at the end of the last piece, or, for the first one, at rest
/// where all moves end. D follows the curve; alpha goes from one end to the other with the parameter of the curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct PathPiece<N: Number> {
    /// Counts the pieces one by one, modulo 2^32; [`Status`](super::Status) says which is expected.
    pub number: u32,
    /// The curve.
    pub curve: PathCurve<N>,
    /// Greatest speed of D, positive; 0 for none.
    pub feed: N,
    /// The tool's power, as in a [`Move`].
    pub tool_power: N,
    /// Speed of the tool at which it has that power, as in a [`Move`].
    pub tool_speed: N,
    /// True for the last piece of the path. The machine plans as soon as it has room for no more, or has the last one.
    pub last: bool,
}

/// Curve of a [`PathPiece`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub enum PathCurve<N: Number> {
    /// A straight line.
    Line {
        /// Its end.
        to: Pose<N>,
    },
    /// A circular arc.
    Arc {
        /// Centre of the circle, (x, y).
        centre: [N; 2],
        /// Angle about the centre, rad, counter-clockwise positive.
        turn: N,
        /// alpha at its end.
        to_angle: N::Angle,
    },
    /// A cubic Bezier curve, of alpha too.
    Bezier {
        /// The two control poses between its ends.
        controls: [Pose<N>; 2],
        /// Its end.
        to: Pose<N>,
    },
}

/// Types as which a machine reads what not every machine plays, or [`Unread`].
pub trait MoveContents {
    /// A [`QuinticMove`].
    type Quintic: Clone + Copy + core::fmt::Debug + PartialEq;
    /// A [`Goal`].
    type Goal: Clone + Copy + core::fmt::Debug + PartialEq;
    /// A [`PathPiece`].
    type Piece: Clone + Copy + core::fmt::Debug + PartialEq;
    /// A [`MoveBatch`].
    type Batch: Clone + Copy + core::fmt::Debug + PartialEq;
}

/// All of it is read.
pub type AllMoves<N> = (QuinticMove<N>, MoveBatch<N>);

/// As which a quintic move is read, and a batch.
impl<Q, B> MoveContents for (Q, B)
where
    Q: QuinticContent + Clone + Copy + core::fmt::Debug + PartialEq,
    B: Clone + Copy + core::fmt::Debug + PartialEq,
{
    type Quintic = Q;
    type Goal = Q::Goal;
    type Piece = Q::Piece;
    type Batch = B;
}

/// Type as which a quintic move is read, with those as which a [`Goal`] and a [`PathPiece`] are.
pub trait QuinticContent {
    /// A [`Goal`], read or not.
    type Goal: Clone + Copy + core::fmt::Debug + PartialEq;
    /// A [`PathPiece`], read or not.
    type Piece: Clone + Copy + core::fmt::Debug + PartialEq;
}

impl<N: Number> QuinticContent for QuinticMove<N> {
    type Goal = Goal<N>;
    type Piece = PathPiece<N>;
}

impl<N: Number> QuinticContent for Unread<QuinticMove<N>> {
    type Goal = Unread<Goal<N>>;
    type Piece = Unread<PathPiece<N>>;
}

/// A move of either kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyMove<N: Number> {
    /// A cubic.
    Cubic(Move<N>),
    /// A quintic.
    Quintic(QuinticMove<N>),
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

impl<N: Number, S> Command<N, S> {
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
            _ => None,
        }
    }
}

impl<N: Number> MoveBatch<N> {
    /// The moves.
    pub fn steps(&self) -> impl Iterator<Item = &MoveStep<N>> {
        self.steps.iter().map_while(Option::as_ref)
    }

    /// The moves as they are offered one by one, the first from `start`.
    pub fn moves(&self, start: &Setpoint<N>) -> impl Iterator<Item = AnyMove<N>> {
        let (mut start, mut number) = (*start, self.number);
        self.steps().map(move |step| {
            let each = step.from(&start, number);
            (start, number) = (each.end(), number.wrapping_add(1));
            each
        })
    }
}

impl<N: Transmit> MoveBatch<N> {
    /// Batch of as many of `moves` as follow on each other without a gap, the first behind `start`, from number `number` on.
    pub fn new(number: u32, start: &Setpoint<N>, moves: &[AnyMove<N>]) -> Self {
        let mut batch = Self {
            number,
            // A setpoint has a length that is known beforehand.
            check: checksum(start).unwrap_or_default(),
            steps: [None; BATCH],
        };
        let mut start = *start;
        for (place, each) in batch.steps.iter_mut().zip(moves) {
            let step = each.step();
            if step.from(&start, each.common().number) != *each {
                break;
            }
            start = each.end();
            *place = Some(step);
        }
        batch
    }
}

impl<N: Number> MoveStep<N> {
    /// The move of number `number` that starts at `start`: with the accelerations at both ends, if it is a quintic.
    pub fn from(&self, start: &Setpoint<N>, number: u32) -> AnyMove<N> {
        let tool = self.tool.unwrap_or(ToolSetting {
            power: N::ZERO,
            speed: N::ZERO,
        });
        let common = Move {
            number,
            from: start.pose,
            to: self.to,
            start_velocity: start.velocity.into(),
            end_velocity: self.velocity,
            ticks: self.ticks,
            tool_power: tool.power,
            tool_speed: tool.speed,
        };
        let accelerations = |end| [start.acceleration.into(), end];
        AnyMove::new(common, self.acceleration.map(accelerations))
    }
}

impl<N: Number> From<&Move<N>> for AnyMove<N> {
    fn from(cubic: &Move<N>) -> Self {
        Self::Cubic(*cubic)
    }
}

impl<N: Number> From<&AnyMove<N>> for AnyMove<N> {
    fn from(any: &AnyMove<N>) -> Self {
        *any
    }
}

impl<N: Number> AnyMove<N> {
    /// A move with these accelerations at its ends, or a cubic without any.
    pub fn new(common: Move<N>, accelerations: Option<[[N; 3]; 2]>) -> Self {
        match accelerations {
            None => Self::Cubic(common),
            Some([start_acceleration, end_acceleration]) => Self::Quintic(QuinticMove {
                common,
                start_acceleration,
                end_acceleration,
            }),
        }
    }

    /// All that both kinds have in common.
    pub fn common(&self) -> &Move<N> {
        match self {
            Self::Cubic(common) | Self::Quintic(QuinticMove { common, .. }) => common,
        }
    }

    /// The move with another number.
    pub fn numbered(mut self, number: u32) -> Self {
        match &mut self {
            Self::Cubic(common) | Self::Quintic(QuinticMove { common, .. }) => {
                common.number = number;
            }
        }
        self
    }

    /// The setpoint at its end. A cubic goes on without an acceleration.
    pub fn end(&self) -> Setpoint<N> {
        let Move {
            to, end_velocity, ..
        } = *self.common();
        let [_, acceleration] = self.accelerations().unwrap_or([[N::ZERO; 3]; 2]);
        Setpoint {
            pose: to,
            velocity: end_velocity.into(),
            acceleration: acceleration.into(),
        }
    }

    /// The move as one of a [`MoveBatch`].
    pub fn step(&self) -> MoveStep<N> {
        let common = self.common();
        let (power, speed) = (common.tool_power, common.tool_speed);
        MoveStep {
            to: common.to,
            velocity: common.end_velocity,
            acceleration: self.accelerations().map(|[_, end]| end),
            ticks: common.ticks,
            tool: (power != N::ZERO || speed != N::ZERO).then_some(ToolSetting { power, speed }),
        }
    }

    /// The accelerations at both ends of a quintic.
    pub fn accelerations(&self) -> Option<[[N; 3]; 2]> {
        match self {
            Self::Cubic(_) => None,
            Self::Quintic(each) => Some([each.start_acceleration, each.end_acceleration]),
        }
    }

    /// The command that offers it.
    pub fn command(&self) -> Command<N> {
        match *self {
            Self::Cubic(each) => Command::Move(each),
            Self::Quintic(each) => Command::Quintic(each),
        }
    }
}

/// A joint-space move, rest to rest, from wherever the motors stand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Recovery<N: Number> {
    /// The pose whose motor angles are the target.
    pub to: Pose<N>,
    /// Duration in ticks, positive.
    pub ticks: u32,
}

impl<N: Number> Move<N> {
    /// Returns move `number` from rest at `from` to rest at `to` in `ticks` ticks, with the tool off.
    pub fn rest_to_rest(number: u32, from: Pose<N>, to: Pose<N>, ticks: u32) -> Self {
        Self {
            number,
            from,
            to,
            start_velocity: [N::ZERO; 3],
            end_velocity: [N::ZERO; 3],
            ticks,
            tool_power: N::ZERO,
            tool_speed: N::ZERO,
        }
    }

    /// Returns true if the move is at rest at both ends.
    pub fn is_rest_to_rest(&self) -> bool {
        self.starts_at_rest() && self.ends_at_rest()
    }

    /// Returns true if the move starts at rest.
    pub fn starts_at_rest(&self) -> bool {
        self.start_velocity == [N::ZERO; 3]
    }

    /// Returns true if the move ends at rest.
    pub fn ends_at_rest(&self) -> bool {
        self.end_velocity == [N::ZERO; 3]
    }
}
