//! Reason for which a command was not executed.

use super::Transmit;
use super::state::State;
use super::update::UpdateRefusal;
use super::violation::Violation;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::machine::Quantity;
use trirrr_core::number::Number;

/// Reason why a command was not executed. A refused command changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub enum Refusal<N: Number> {
    /// No hello was accepted since the machine was switched on.
    HelloFirst,
    /// Another version of the protocol.
    Protocol {
        /// The machine's own.
        expected: u16,
    },
    /// Another layout of the messages.
    Schema {
        /// The machine's own.
        expected: u64,
    },
    /// Another scene.
    Scene {
        /// The machine's own.
        expected: u32,
    },
    /// The sequence number is neither one of the next nor one of the last, as many as the window has.
    Sequence {
        /// The next.
        expected: u32,
    },
    /// The sequence number is that of a command that was executed or is kept, the command is another.
    SequenceReused,
    /// Not in this state.
    State(State),
    /// `Start` without an admitted move.
    NothingQueued,
    /// `Start` while the admission of a move is not decided yet.
    Undecided,
    /// `Start` with admitted moves that end with a velocity before the machine could come to rest.
    EndsMoving,
    /// No room for another move, or piece of a path. In `Idle` room comes by `Start`.
    QueueFull,
    /// The move's number is not the next.
    MoveNumber {
        /// The next.
        expected: u32,
    },
    /// A value is infinite or not a number.
    NotFinite,
    /// A duration of no tick, or longer than the machine counts.
    Duration {
        /// The longest, in ticks.
        longest: u32,
    },
    /// The move does not start where the last one ends, or where the machine stands.
    StartPose,
    /// The move does not start with the velocity with which the last one ends.
    StartVelocity,
    /// The tool's power is not between 0 and 1, or its speed is negative.
    Tool,
    /// The image holds no code to change its scene.
    NotAdjustable,
    /// There is no such leg.
    NoSuchLeg,
    /// The scene's part cannot be built.
    Parameter {
        /// Quantity that is wrong.
        quantity: Quantity,
        /// Leg that it belongs to, from 0.
        leg: Option<u8>,
    },
    /// The image holds no code for a load that the scene would then have: link or rotor inertia, gravity, a centre of
    /// mass off the reference point.
    NotInImage,
    /// With the new geometry, no pose near the last fits the motors' angles.
    NoPose,
    /// The recovery, or the homing, would break this limit, or end where this limit does not allow; or with the new part of the scene
    /// the machine would break it where it stands.
    Recovery(Violation<N>),
    /// The tick has not yet taken the commands before this one.
    Busy,
    /// The scene has no homing.
    NoHoming,
    /// The image holds no code for quintic moves.
    NoQuintics,
    /// The quintic move does not start with the acceleration with which the last one ends.
    StartAcceleration,
    /// A feed override is 1 to 100 %.
    FeedOverride,
    /// A retarget is being planned: no move is taken before its moves are.
    Retargeting,
    /// The image holds no planner of paths.
    NoPaths,
    /// A path is under way: no move and no goal is taken before its end.
    PathUnderWay,
    /// The feed of the piece is negative.
    Feed,
    /// The drives of the machine tell nothing.
    NoFeedback,
    /// The image holds no code for batches of moves.
    NoBatches,
    /// The moves of the batch do not start where the last move ends.
    Check {
        /// Checksum of the setpoint at which the last move ends.
        expected: u32,
    },
    /// The image holds no code for power lists.
    NoLevels,
    /// The levels do not follow those before, or those of the move were not given.
    LevelNumber {
        /// Number of the level behind the last one given.
        expected: u32,
    },
    /// No room for so many levels.
    LevelsFull,
    /// The levels do not cover the move, are too many for its ticks, or D turns back on its way along the chord.
    LevelRange,
    /// The emergency stop is pressed: it has to be released before the fault is acknowledged.
    EmergencyStop,
    /// The door is open: nothing moves before it is closed.
    DoorOpen,
    /// The scene names no probe.
    NoProbe,
    /// The probe touches before the run.
    ProbeTouches,
    /// The probe does not touch before the run, which is to lead away.
    ProbeOpen,
    /// A motor stands on its limit switch: only a recovery or homing moves the machine.
    LimitSwitch {
        /// The motor, from 0.
        motor: u8,
    },
    /// The image holds no code to be replaced over the line.
    NoUpdate,
    /// A step of an update is not taken.
    Update(UpdateRefusal),
    /// The scene names no such spare output.
    NoOutput {
        /// Number of those that the scene names.
        outputs: u8,
    },
    /// No room for another change of outputs with the motion, before one of those given is over.
    OutputsFull,
}
