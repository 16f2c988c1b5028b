//! The scene that a service is built from: its machine, and the features that it has.
//!
//! A [`Machine`] is [`Compiled`], which cannot change: an image with it holds coefficients and no code to build any. Or it is
//! [`Adjustable`] and takes overrides of geometry, loads and limits while it is idle. Its types choose the kinds of moves and the
//! planner of paths.
//!
//! A [`Scene`] is a machine with [features](Feature); [`scene!`](crate::scene!) declares one. [`SceneParts`] are its values.

mod adjustable;
mod compiled;
mod declare;
mod parts;
mod update;
mod values;

pub use adjustable::Adjustable;
pub use compiled::{Compiled, Parts};
pub use parts::SceneParts;
pub use update::{ImageSlot, NoImage, check_image};
pub use values::{SceneValues, StepperValues, needs_of_model};

use crate::built::Coefficients;
use crate::curves::PlayedCurves;
use crate::feature::{ChannelMemory, Feature, Of};
use crate::number::ServiceNumber;
use crate::planner::PathPlanner;
use crate::queue::{Receiver, Sender};
use crate::settings::Settings;
use core::borrow::Borrow;
use heapless::spsc::Queue;
use nalgebra::Vector2;
use postcard_schema::Schema;
use serde::Serialize;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::{BuildError, Parameters};
use trirrr_core::model::{Model, ModelKind};
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::setpoint::Pose;
use trirrr_core::tick::Tick;
use trirrr_core::units::Units;
use trirrr_protocol::message::scene::{Section, SectionName};
use trirrr_protocol::message::{
    AnyMove, Command, Goal, LevelPiece, ListedMove, MoveBatch, PathPiece, QuinticMove, Refusal,
    Request,
};

/// Coefficients of the tick, built from a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Setup<M: Model> {
    /// Pipeline.
    pub(crate) tick: Tick<M>,
    /// Limits of the results.
    pub(crate) limits: Limits<M::N>,
    /// Pose of the platform.
    pub(crate) pose: Pose<M::N>,
    /// Angles that are added to those of the motors without a motion: changed encoder offsets.
    pub(crate) shift: Option<[<M::N as Arithmetic>::Angle; 3]>,
}

/// Scene with another part, in the units of its machine.
#[derive(Clone, Copy, Debug)]
pub struct Changed {
    /// The machine.
    pub parameters: Parameters,
    /// Kind of its model, where the type of the model holds several.
    pub kind: Option<ModelKind>,
    /// Its limits.
    pub limits: LimitParameters,
    /// Encoder offsets of its motors, rad.
    pub offsets_rad: [f64; 3],
    /// Those less the offsets before.
    pub shift_rad: [f64; 3],
    /// Way from the tool point before to that of the machine, in the frame of its platform.
    pub tool_way: Vector2<f64>,
}

/// Mailbox for a setup on its way to the tick.
pub(crate) struct SetupSlot<M: Model>(Queue<Setup<M>, 2>);

impl<M: Model> ChannelMemory for SetupSlot<M> {
    const EMPTY: Self = Self(Queue::new());
}

impl<M: Model> SetupSlot<M> {
    /// Returns both ends.
    pub(crate) fn split(&mut self) -> (Sender<'_, Setup<M>>, Receiver<'_, Setup<M>>) {
        let (put, take) = self.0.split();
        (Sender::new(put), Receiver::new(take))
    }
}

/// Machine of a scene, with its limits. The background keeps it.
pub trait Machine {
    /// Number type.
    type N: ServiceNumber;

    /// Model of the machine.
    type Model: Model<N = Self::N>;

    /// Kinds of moves that the machine plays.
    type Curves: PlayedCurves;

    /// Planner of paths; `()` without any.
    type Planner: PathPlanner<Self::N>;

    /// Changes at run time.
    type Changes: Feature;

    /// Part of the scene in a reply.
    type Part: Serialize + Schema;

    /// Coefficients as the background keeps them: a reference to constants, or the coefficients themselves.
    type Coefficients: Borrow<Coefficients<Self::Model>>;

    /// Returns the coefficients at the start.
    ///
    /// # Errors
    /// Machine or limit that cannot be built.
    fn coefficients(&self, settings: &Settings<Self::N>) -> Result<Self::Coefficients, BuildError>;

    /// Returns the part `name` in SI units; the machine is in `units`. `None` if there is no such leg.
    fn part(&self, name: SectionName, units: &Units) -> Option<Self::Part>;

    /// Returns the scene in `units` of the machine, with `section` in place of its own.
    ///
    /// # Errors
    /// Reason why there is no such scene.
    fn changed(&self, section: &Section, units: &Units) -> Result<Changed, Refusal<Self::N>>;

    /// Replaces the scene, and `kept` by the coefficients `built` from it.
    fn adopt(
        &mut self,
        changed: &Changed,
        built: Coefficients<Self::Model>,
        kept: &mut Self::Coefficients,
    );
}

/// Kind of scene: types of a machine and of its features. [`scene!`](crate::scene!) declares one.
pub trait Scene {
    /// Number type.
    type N: ServiceNumber;

    /// Machine.
    type Machine: Machine<N = Self::N>;

    /// Moves in batches.
    type Batches: Feature;

    /// Place where the machine puts a new image of its program; `()` without any.
    type Update: ImageSlot;

    /// Power lists.
    type Levels: Feature;

    /// Homing.
    type Homing: Feature;

    /// Feedback of the drives.
    type Feedback: Feature;

    /// Detection of contacts, of a machine with feedback and a model with torques.
    type Contact: Feature;

    /// Retreat after a contact.
    type Retreat: Feature;

    /// Emergency stop, door and limit switches: those of its [bits](crate::features::input_bits).
    type Interlocks: Feature;

    /// Probe, of a machine with interlocks.
    type Probe: Feature;

    /// Spare inputs and outputs.
    type Digital: Feature;
}

/// Model of the scene `S`.
pub type ModelOf<S> = <<S as Scene>::Machine as Machine>::Model;

/// Kinds of moves of the scene `S`.
pub type CurvesOf<S> = <<S as Scene>::Machine as Machine>::Curves;

/// Part of the scene `S` in a reply.
pub type PartOf<S> = <<S as Scene>::Machine as Machine>::Part;

/// Planner of the scene `S`.
pub(crate) type PlannerOf<S> = <<S as Scene>::Machine as Machine>::Planner;

/// Coefficients of the scene `S`.
pub(crate) type CoefficientsOf<S> = <<S as Scene>::Machine as Machine>::Coefficients;

/// Changes of the scene `S` at run time.
pub(crate) type ChangesOf<S> = <<S as Scene>::Machine as Machine>::Changes;

/// Quintics of the scene `S`.
pub(crate) type QuinticsOf<S> = <CurvesOf<S> as PlayedCurves>::QuinticMoves;

/// Encoder offsets of a scene that can be changed.
pub(crate) type OffsetsOf<S> =
    Of<ChangesOf<S>, Option<[<<S as Scene>::N as Arithmetic>::Angle; 3]>>;

/// Content of a request that a scene with the feature `F` reads.
type Read<F, T> = <F as Feature>::Read<T>;

/// Types as which a service of the scene `S` reads what not every machine plays.
type ContentsOf<S> = (
    Read<QuinticsOf<S>, QuinticMove<<S as Scene>::N>>,
    Read<QuinticsOf<S>, Goal<<S as Scene>::N>>,
    Read<QuinticsOf<S>, PathPiece<<S as Scene>::N>>,
    Read<<S as Scene>::Batches, MoveBatch<<S as Scene>::N>>,
    Read<<S as Scene>::Levels, LevelPiece>,
    Read<<S as Scene>::Levels, ListedMove<<S as Scene>::N>>,
    <<S as Scene>::Update as ImageSlot>::Step,
);

/// Command as a service of the scene `S` reads it.
pub type CommandOf<S> = Command<<S as Scene>::N, Read<ChangesOf<S>, Section>, ContentsOf<S>>;

/// Request as a service of the scene `S` reads it.
pub type RequestOf<S> = Request<<S as Scene>::N, Read<ChangesOf<S>, Section>, ContentsOf<S>>;

/// Offer of a move to a service of the scene `S`.
pub fn command_of<S: Scene>(offered: &AnyMove<S::N>) -> CommandOf<S> {
    match offered {
        AnyMove::Cubic(cubic) => Command::Move(*cubic),
        AnyMove::Quintic(quintic) => Command::Quintic(QuinticsOf::<S>::read(quintic)),
    }
}

/// Returns the refusal for a scene that cannot be built.
pub(crate) fn refusal<N: Number>(error: BuildError) -> Refusal<N> {
    Refusal::Parameter {
        quantity: error.quantity,
        leg: error.leg.map(|leg| leg as u8),
    }
}
