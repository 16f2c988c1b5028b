//! The scene that a service is built from. It says whether the host can change the machine.
//!
//! [`Compiled`] cannot change: an image with it holds coefficients and no code to build any.
//! [`Adjustable`] takes overrides of geometry, loads and limits while the machine is idle.
//! [`WithLevels`] adds power lists to either, [`WithHoming`] homing, [`WithFeedback`] drives that tell where they are, [`WithContact`] the detection of contacts to that,
//! [`WithInterlocks`] an emergency stop, a door, limit switches and a probe, [`WithDigital`] spare inputs and outputs,
//! [`WithUpdate`] a program that can be replaced over the line. The choice
//! is a type, so that a scene pays only for its own kind. Likewise the kinds of moves: cubics, or quintics beside them.

/// Items of a [`Scene`] that are those of its field `scene`, of type `S` in the number type `N`: always the machine and what is replaced of
/// it, and the named ones.
macro_rules! inner {
    ($($part:ident),*) => {
        type N = N;
        type Model = S::Model;
        type Slot = S::Slot;
        type Replacement = S::Replacement;
        type Batch = S::Batch;
        type Curves = S::Curves;
        type Planner = S::Planner;
        type Part = S::Part;
        type Coefficients = S::Coefficients;

        fn coefficients(
            &self,
            settings: &$crate::settings::Settings<N>,
        ) -> Result<S::Coefficients, trirrr_core::machine::BuildError> {
            self.scene.coefficients(settings)
        }

        fn part(
            &self,
            name: trirrr_protocol::message::scene::SectionName,
            units: &trirrr_core::units::Units,
        ) -> Option<S::Part> {
            self.scene.part(name, units)
        }

        #[inline(always)]
        fn changed(
            &self,
            section: &trirrr_protocol::message::scene::Section,
            units: &trirrr_core::units::Units,
        ) -> Result<$crate::scene::Changed, trirrr_protocol::message::Refusal<N>> {
            self.scene.changed(section, units)
        }

        fn adopt(
            &mut self,
            changed: &$crate::scene::Changed,
            built: $crate::coefficients::Coefficients<S::Model>,
            kept: &mut S::Coefficients,
        ) {
            self.scene.adopt(changed, built, kept);
        }

        $($crate::scene::inner!(@$part);)*
    };
    (@update) => {
        type Update = S::Update;

        #[inline(always)]
        fn update(
            &mut self,
            step: &trirrr_protocol::message::UpdateStep,
        ) -> Result<(), trirrr_protocol::message::Refusal<N>> {
            self.scene.update(step)
        }

        #[inline(always)]
        fn update_status(&self) -> Option<trirrr_protocol::message::UpdateStatus> {
            self.scene.update_status()
        }
    };
    (@digital) => {
        type Digital = S::Digital;

        #[inline(always)]
        fn digital(&self) -> $crate::digital::DigitalParameters {
            self.scene.digital()
        }
    };
    (@levels) => {
        type Levels = S::Levels;

        #[inline(always)]
        fn levels(&self) -> u16 {
            self.scene.levels()
        }
    };
    (@homing) => {
        type Homing = S::Homing;

        fn homing(&self) -> S::Homing {
            self.scene.homing()
        }

        #[inline(always)]
        fn plan(&self) -> Option<$crate::homing::Plan<N>> {
            self.scene.plan()
        }
    };
    (@feedback) => {
        type Feedback = S::Feedback;

        #[inline(always)]
        fn feedback(&self) -> Option<&$crate::feedback::FeedbackCoefficients<N>> {
            self.scene.feedback()
        }
    };
    (@contact) => {
        type Contact = S::Contact;
        type Retreat = S::Retreat;

        #[inline(always)]
        fn contact(&self) -> Option<&$crate::contact::ContactCoefficients<N>> {
            self.scene.contact()
        }
    };
    (@interlocks) => {
        type Interlocks = S::Interlocks;

        #[inline(always)]
        fn interlocks(&self) -> S::Interlocks {
            self.scene.interlocks()
        }
    };
}
use inner;

mod adjustable;
mod compiled;
mod contact;
mod digital;
mod homed;
mod interlocked;
mod levels;
mod measured;
mod slot;
mod updated;
mod values;

pub use adjustable::Adjustable;
pub use compiled::{Compiled, Parts};
pub use contact::WithContact;
pub use digital::WithDigital;
pub use homed::WithHoming;
pub use interlocked::WithInterlocks;
pub use levels::WithLevels;
pub use measured::WithFeedback;
pub use slot::{NoSlot, Put, Slot, Take};
pub use updated::{ImageSlot, WithUpdate, check_image};
pub use values::{SceneValues, StepperValues, needs_of_model};

use crate::coefficients::Coefficients;
use crate::contact::{ContactChannels, ContactCoefficients};
use crate::digital::{DigitalKind, DigitalParameters};
use crate::feedback::{Feedback, FeedbackCoefficients};
use crate::homing::{Homing, Plan};
use crate::interlock::InterlockKind;
use crate::levels::LevelKind;
use crate::number::ServiceNumber;
use crate::offered::PlayedCurves;
use crate::planner::PathPlanner;
use crate::retreat::RetreatKind;
use crate::settings::Settings;
use core::borrow::Borrow;
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
use trirrr_protocol::message::{Content, MoveBatch, Refusal, UpdateStatus, UpdateStep};

/// Coefficients of the tick, built from a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup<M: Model> {
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

/// Scene of a service. The background keeps it.
pub trait Scene {
    /// Number type.
    type N: ServiceNumber;

    /// Model of the machine.
    type Model: Model<N = Self::N>;

    /// Mailbox for a setup on its way to the tick.
    type Slot: Slot<Setup<Self::Model>>;

    /// Content of a part of the scene in a request. A scene that can be changed reads all of it.
    type Replacement: Content<Section>;

    /// Type as which a batch of moves in a request is read.
    type Batch: Content<MoveBatch<Self::N>>;

    /// Type as which a step of an update in a request is read.
    type Update: Content<UpdateStep>;

    /// Kinds of moves that the machine plays.
    type Curves: PlayedCurves;

    /// Power lists; `()` without any.
    type Levels: LevelKind<Self::N>;

    /// Planner of paths; `()` without any.
    type Planner: PathPlanner<Self::N>;

    /// Part of the scene in a reply.
    type Part: Serialize + Schema;

    /// Homing of the machine; [`NoHoming`](crate::NoHoming) without any.
    type Homing: Homing<Self::N>;

    /// Feedback of the drives; `()` for drives that tell nothing.
    type Feedback: Feedback<Self::N>;

    /// Detection of contacts; `()` without any.
    type Contact: ContactChannels<Self::N>;

    /// Retreat after a contact; [`NoRetreat`](crate::NoRetreat) without any.
    type Retreat: RetreatKind;

    /// Emergency stop, door, limit switches and probe; `()` without any.
    type Interlocks: InterlockKind<Self::N>;

    /// Spare inputs and outputs; `()` without any.
    type Digital: DigitalKind;

    /// Coefficients as the background keeps them: a reference to constants, or the coefficients themselves.
    type Coefficients: Borrow<Coefficients<Self::Model>>;

    /// Returns the coefficients at the start.
    ///
    /// # Errors
    /// Machine or limit that cannot be built.
    fn coefficients(&self, settings: &Settings<Self::N>) -> Result<Self::Coefficients, BuildError>;

    /// Returns the part `name` in SI units; the machine is in `units`. `None` if there is no such leg.
    fn part(&self, name: SectionName, units: &Units) -> Option<Self::Part>;

    /// Takes a step of an update of the program.
    ///
    /// # Errors
    /// Reason why the step is not taken.
    #[inline(always)]
    fn update(&mut self, _: &UpdateStep) -> Result<(), Refusal<Self::N>> {
        Err(Refusal::NoUpdate)
    }

    /// Returns the update as it stands; `None` of a program that cannot be replaced over the line.
    #[inline(always)]
    fn update_status(&self) -> Option<UpdateStatus> {
        None
    }

    /// Returns the levels of power for which there is room; 0 of a machine that plays no power lists.
    fn levels(&self) -> u16;

    /// Returns the homing, not begun.
    fn homing(&self) -> Self::Homing;

    /// Returns the plan of the homing; `None` if the machine needs no homing.
    fn plan(&self) -> Option<Plan<Self::N>>;

    /// Returns the interlocks, all clear.
    fn interlocks(&self) -> Self::Interlocks;

    /// Returns the spare inputs and outputs.
    fn digital(&self) -> DigitalParameters;

    /// Returns the coefficients of the feedback; `None` if the drives tell nothing.
    fn feedback(&self) -> Option<&FeedbackCoefficients<Self::N>>;

    /// Returns the coefficients of contact detection; `None` without any.
    fn contact(&self) -> Option<&ContactCoefficients<Self::N>>;

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

/// Returns the refusal for a scene that cannot be built.
pub(crate) fn refusal<N: Number>(error: BuildError) -> Refusal<N> {
    Refusal::Parameter {
        quantity: error.quantity,
        leg: error.leg.map(|leg| leg as u8),
    }
}
