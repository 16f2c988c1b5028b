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

mod model;
mod observer;
mod parameters;
mod watch;

pub use model::ContactModel;
pub use observer::{ContactObserver, Deviation};
pub use parameters::{ContactCoefficients, ContactParameters, ContactThresholds};
pub(crate) use watch::ContactWatch;

use crate::feature::ChannelMemory;
use crate::number::ServiceNumber;
use crate::queue::{Receiver, Sender};
use heapless::spsc::Queue;
use trirrr_core::setpoint::Pose;

/// End at which the background takes poses, and answers with the model there.
pub(crate) struct ContactReceiver<'q, N: ServiceNumber> {
    pub(crate) coefficients: Option<&'q ContactCoefficients<N>>,
    pub(crate) poses: Receiver<'q, Pose<N>>,
    pub(crate) models: Sender<'q, ContactModel<N>>,
}

/// Memory of contact detection: one pose and one model on their ways.
pub(crate) struct ContactMemory<N: ServiceNumber> {
    poses: Queue<Pose<N>, 2>,
    models: Queue<ContactModel<N>, 2>,
}

impl<N: ServiceNumber> ChannelMemory for ContactMemory<N> {
    const EMPTY: Self = Self {
        poses: Queue::new(),
        models: Queue::new(),
    };
}

impl<N: ServiceNumber> ContactMemory<N> {
    /// Returns both ends. Without `coefficients` nothing is detected.
    pub(crate) fn split<'q>(
        &'q mut self,
        coefficients: Option<&'q ContactCoefficients<N>>,
    ) -> (ContactReceiver<'q, N>, ContactWatch<'q, N>) {
        let (put_pose, take_pose) = self.poses.split();
        let (put_model, take_model) = self.models.split();
        let receiver = ContactReceiver {
            coefficients,
            poses: Receiver::new(take_pose),
            models: Sender::new(put_model),
        };
        let watch = ContactWatch::new(
            coefficients.copied(),
            Sender::new(put_pose),
            Receiver::new(take_model),
        );
        (receiver, watch)
    }
}
