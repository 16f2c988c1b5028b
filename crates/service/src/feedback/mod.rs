//! Feedback: drives that tell where their motors are, and how they are.
//!
//! | phase | drives | the tick | the background |
//! |---|---|---|---|
//! | check | asked, off | waits until each tells its angle and is ready | |
//! | place | the same | stands at these angles | finds the pose by forward kinematics |
//! | close | on | commands these angles, until each drive is on | |
//! | on | on | watches: silence, state, errors, following error | |
//!
//! The choice is a type, as that of [homing](super::homing) is: without feedback an image holds nothing of it.

mod find_pose;
mod parameters;
mod watch;

pub(crate) use find_pose::{PoseSearch, pose_near};
pub use parameters::{FeedbackCoefficients, FeedbackParameters, WatchLimits};
pub use watch::DriveWatch;
pub(crate) use watch::EnableProgress;

use crate::number::ServiceNumber;
use crate::queue::{Receiver, Sender};
use crate::scene::Scene;
use crate::splice::{Optional, Present};
use core::fmt::Debug;
use heapless::spsc::Queue;
use trirrr_core::number::Number;
use trirrr_protocol::message::{DriveReading, DriveSample, NotEnabled};

/// Readings of all drives in a tick.
pub type Readings<N> = [DriveReading<N>; 3];

/// Places for samples of drives; one stays empty.
const SAMPLES: usize = 8;

/// Memory of feedback; `()` for drives that tell nothing.
pub trait Feedback<N: ServiceNumber>: Send + 'static {
    /// Nothing in it.
    const EMPTY: Self;

    /// Content of what the drives tell in a tick.
    type Readings: Copy;
    /// Report of the tick about it.
    type Report: Optional<FeedbackReport<N>> + Copy + Debug + PartialEq;
    /// End of the tick.
    type Tick<'q>: Optional<DriveWatch<'q, N>>;
    /// End of the background.
    type Background<'q>: Optional<FeedbackReceiver<'q, N>>;

    /// Returns both ends. Without `coefficients` the drives tell nothing.
    fn split(
        &mut self,
        coefficients: Option<&FeedbackCoefficients<N>>,
    ) -> (Self::Background<'_>, Self::Tick<'_>);

    /// Takes what the drives tell in this tick.
    fn hear(tick: &mut Self::Tick<'_>, readings: Self::Readings);

    /// Returns the report of the tick.
    fn report(tick: &Self::Tick<'_>) -> Self::Report;
}

/// Report of the tick about feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedbackReport<N: Number> {
    /// The drives tell where the motors are: their pose is to be found. Counts how often that was so.
    pub(crate) asked: u8,
    /// Reason why the last attempt to enable the machine was given up.
    pub(crate) refused: Option<NotEnabled<N>>,
}

/// End at which the background takes samples, and finds poses.
pub struct FeedbackReceiver<'q, N: ServiceNumber> {
    pub(crate) samples: Receiver<'q, DriveSample<N>>,
    pub(crate) search: Option<PoseSearch<N>>,
    /// Questions for a pose that were answered, modulo 256.
    pub(crate) answered: u8,
}

impl<N: ServiceNumber> Feedback<N> for () {
    const EMPTY: Self = ();
    type Readings = ();
    type Report = ();
    type Tick<'q> = ();
    type Background<'q> = ();

    fn split(&mut self, _: Option<&FeedbackCoefficients<N>>) -> ((), ()) {
        ((), ())
    }

    #[inline(always)]
    fn hear((): &mut (), (): ()) {}

    #[inline(always)]
    fn report((): &()) {}
}

/// Memory of drives that tell something.
pub struct DriveFeedback<N: ServiceNumber> {
    samples: Queue<DriveSample<N>, SAMPLES>,
}

impl<N: ServiceNumber> Feedback<N> for DriveFeedback<N> {
    const EMPTY: Self = Self {
        samples: Queue::new(),
    };
    type Readings = Readings<N>;
    type Report = Present<FeedbackReport<N>>;
    type Tick<'q> = Present<DriveWatch<'q, N>>;
    type Background<'q> = Present<FeedbackReceiver<'q, N>>;

    fn split(
        &mut self,
        coefficients: Option<&FeedbackCoefficients<N>>,
    ) -> (Present<FeedbackReceiver<'_, N>>, Present<DriveWatch<'_, N>>) {
        let (put, take) = self.samples.split();
        let receiver = FeedbackReceiver {
            samples: Receiver::new(take),
            search: None,
            answered: 0,
        };
        let limits = coefficients.map(|each| each.watch);
        (
            Present(receiver),
            Present(DriveWatch::new(limits, Sender::new(put))),
        )
    }

    #[inline]
    fn hear(tick: &mut Present<DriveWatch<'_, N>>, readings: Readings<N>) {
        tick.0.hear(readings);
    }

    #[inline]
    fn report(tick: &Present<DriveWatch<'_, N>>) -> Present<FeedbackReport<N>> {
        Present(tick.0.report())
    }
}

/// The tick's end of the feedback of scene `S`.
pub(crate) type TickFeedback<'q, S> =
    <<S as Scene>::Feedback as Feedback<<S as Scene>::N>>::Tick<'q>;

/// The background's end of it.
pub(crate) type BackgroundFeedback<'q, S> =
    <<S as Scene>::Feedback as Feedback<<S as Scene>::N>>::Background<'q>;

/// Report of the tick about it.
pub(crate) type FeedbackReportOf<S> = <<S as Scene>::Feedback as Feedback<<S as Scene>::N>>::Report;

/// Content of what the drives of scene `S` tell in a tick.
pub type ReadingsOf<S> = <<S as Scene>::Feedback as Feedback<<S as Scene>::N>>::Readings;
