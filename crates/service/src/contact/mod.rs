//! Contact detection: forces at the tool, from what drives that tell their torque do besides the motion that is commanded.
//!
//! A machine under position control stays near its commanded motion, for which the tick knows the torques. The deviation has
//! the momentum `p = M (rate - commanded rate)` in the joints, and by the difference of the equations of motion
//!
//! ```text
//! dp/dt = (torque - commanded torque - friction) + external torque + terms of second order in the deviation
//! ```
//! The [observer](ContactObserver) takes the external torque from both sides, through a filter of first order. The platform
//! joints carry it to the tool: `w = K^T torque`, K the joint rates for each rate of the platform.
//!
//! | part | does |
//! |---|---|
//! | [tick](ContactWatch) | observes, compares with the thresholds, asks for a [model](ContactModel) of the pose now and then |
//! | [background](ContactReceiver) | takes M and K from the coefficients of the tick at that pose |
//!
//! The choice is a type, as that of [feedback](super::feedback) is: without contact detection an image holds nothing of it.

mod model;
mod observer;
mod parameters;
mod watch;

pub use model::ContactModel;
pub use observer::{ContactObserver, Deviation};
pub use parameters::{ContactCoefficients, ContactParameters, ContactThresholds};
pub use watch::ContactWatch;

use crate::number::ServiceNumber;
use crate::queue::{Receiver, Sender};
use crate::scene::Scene;
use crate::splice::{Optional, Present};
use heapless::spsc::Queue;
use trirrr_core::setpoint::Pose;

/// Memory of contact detection; `()` without.
pub trait ContactChannels<N: ServiceNumber>: Send + 'static {
    /// Nothing in it.
    const EMPTY: Self;

    /// End of the tick.
    type Tick<'q>: Optional<ContactWatch<'q, N>>;
    /// End of the background.
    type Background<'q>: Optional<ContactReceiver<'q, N>>;

    /// Returns both ends. Without `coefficients` nothing is detected.
    fn split(
        &mut self,
        coefficients: Option<&ContactCoefficients<N>>,
    ) -> (Self::Background<'_>, Self::Tick<'_>);
}

/// End at which the background takes poses, and answers with the model there.
pub struct ContactReceiver<'q, N: ServiceNumber> {
    pub(crate) poses: Receiver<'q, Pose<N>>,
    pub(crate) models: Sender<'q, ContactModel<N>>,
}

impl<N: ServiceNumber> ContactChannels<N> for () {
    const EMPTY: Self = ();
    type Tick<'q> = ();
    type Background<'q> = ();

    fn split(&mut self, _: Option<&ContactCoefficients<N>>) -> ((), ()) {
        ((), ())
    }
}

/// Memory of contact detection: one pose and one model on their ways.
pub struct ContactMemory<N: ServiceNumber> {
    poses: Queue<Pose<N>, 2>,
    models: Queue<ContactModel<N>, 2>,
}

impl<N: ServiceNumber> ContactChannels<N> for ContactMemory<N> {
    const EMPTY: Self = Self {
        poses: Queue::new(),
        models: Queue::new(),
    };
    type Tick<'q> = Present<ContactWatch<'q, N>>;
    type Background<'q> = Present<ContactReceiver<'q, N>>;

    fn split(
        &mut self,
        coefficients: Option<&ContactCoefficients<N>>,
    ) -> (
        Present<ContactReceiver<'_, N>>,
        Present<ContactWatch<'_, N>>,
    ) {
        let (put_pose, take_pose) = self.poses.split();
        let (put_model, take_model) = self.models.split();
        let receiver = ContactReceiver {
            poses: Receiver::new(take_pose),
            models: Sender::new(put_model),
        };
        let watch = ContactWatch::new(
            coefficients.copied(),
            Sender::new(put_pose),
            Receiver::new(take_model),
        );
        (Present(receiver), Present(watch))
    }
}

/// The tick's end of the contact detection of scene `S`.
pub(crate) type TickContact<'q, S> =
    <<S as Scene>::Contact as ContactChannels<<S as Scene>::N>>::Tick<'q>;

/// The background's end of it.
pub(crate) type BackgroundContact<'q, S> =
    <<S as Scene>::Contact as ContactChannels<<S as Scene>::N>>::Background<'q>;
