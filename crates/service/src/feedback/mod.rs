//! Feedback: drives that tell where their motors are, and how they are.
//!
//! | phase | drives | the tick | the background |
//! |---|---|---|---|
//! | check | asked, off | waits until each tells its angle and is ready | |
//! | place | the same | stands at these angles | finds the pose by forward kinematics |
//! | close | on | commands these angles, until each drive is on | |
//! | on | on | watches: silence, state, errors, following error | |

mod find_pose;
mod parameters;
mod watch;

pub(crate) use find_pose::{PoseSearch, pose_near};
pub use parameters::{FeedbackCoefficients, FeedbackParameters, WatchLimits};
pub(crate) use watch::DriveWatch;
pub(crate) use watch::EnableProgress;

use crate::feature::ChannelMemory;
use crate::number::ServiceNumber;
use crate::queue::{Receiver, Sender};
use heapless::spsc::Queue;
use trirrr_core::number::Number;
use trirrr_protocol::message::{DriveReading, DriveSample, NotEnabled};

/// Readings of all drives in a tick.
pub type Readings<N> = [DriveReading<N>; 3];

/// Places for samples of drives; one stays empty.
const SAMPLES: usize = 8;

/// Report of the tick about feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FeedbackReport<N: Number> {
    /// The drives tell where the motors are: their pose is to be found. Counts how often that was so.
    pub(crate) asked: u8,
    /// Reason why the last attempt to enable the machine was given up.
    pub(crate) refused: Option<NotEnabled<N>>,
}

/// End at which the background takes samples, and finds poses.
pub(crate) struct FeedbackReceiver<'q, N: ServiceNumber> {
    pub(crate) coefficients: Option<&'q FeedbackCoefficients<N>>,
    pub(crate) samples: Receiver<'q, DriveSample<N>>,
    pub(crate) search: Option<PoseSearch<N>>,
    /// Questions for a pose that were answered, modulo 256.
    pub(crate) answered: u8,
}

/// Memory of drives that tell something.
pub(crate) struct DriveFeedback<N: ServiceNumber> {
    samples: Queue<DriveSample<N>, SAMPLES>,
}

impl<N: ServiceNumber> ChannelMemory for DriveFeedback<N> {
    const EMPTY: Self = Self {
        samples: Queue::new(),
    };
}

impl<N: ServiceNumber> DriveFeedback<N> {
    /// Returns both ends. Without `coefficients` the drives tell nothing.
    pub(crate) fn split<'q>(
        &'q mut self,
        coefficients: Option<&'q FeedbackCoefficients<N>>,
    ) -> (FeedbackReceiver<'q, N>, DriveWatch<'q, N>) {
        let (put, take) = self.samples.split();
        let receiver = FeedbackReceiver {
            coefficients,
            samples: Receiver::new(take),
            search: None,
            answered: 0,
        };
        let limits = coefficients.map(|each| each.watch);
        (receiver, DriveWatch::new(limits, Sender::new(put)))
    }
}
