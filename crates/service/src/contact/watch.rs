//! The tick's part of contact detection.

use super::model::ContactModel;
use super::observer::{Commanded, ContactObserver, Deviation};
use super::parameters::{ContactCoefficients, ContactThresholds};
use crate::feedback::Readings;
use crate::guard::LimitBreach;
use crate::number::ServiceNumber;
use crate::queue::{Receiver, Sender};
use crate::settings::StopCategory;
use trirrr_core::setpoint::Pose;
use trirrr_core::tick::Motor;
use trirrr_protocol::message::FaultCode;

/// Ticks for which commands are kept, to compare an older reading with.
const KEPT: usize = 16;

/// Watch for contacts, tick by tick. Without coefficients there is none.
pub struct ContactWatch<'q, N: ServiceNumber> {
    coefficients: Option<ContactCoefficients<N>>,
    observer: ContactObserver<N>,
    /// Model of a pose near this one, once the background has sent one.
    model: Option<ContactModel<N>>,
    /// Rates and torques commanded in the last ticks, a ring with its newest place.
    commanded: [[Commanded<N>; 3]; KEPT],
    newest: usize,
    /// The ring holds what was commanded.
    observes: bool,
    /// Ticks in a row beyond a threshold.
    beyond: u16,
    /// Ticks until the next model is asked for.
    countdown: u16,
    poses: Sender<'q, Pose<N>>,
    models: Receiver<'q, ContactModel<N>>,
}

impl<'q, N: ServiceNumber> ContactWatch<'q, N> {
    pub(super) fn new(
        coefficients: Option<ContactCoefficients<N>>,
        poses: Sender<'q, Pose<N>>,
        models: Receiver<'q, ContactModel<N>>,
    ) -> Self {
        Self {
            coefficients,
            observer: ContactObserver::AT_REST,
            model: None,
            commanded: [[Commanded::NOTHING; 3]; KEPT],
            newest: 0,
            observes: false,
            beyond: 0,
            countdown: 0,
            poses,
            models,
        }
    }

    /// Stop at a contact.
    pub(crate) fn reaction(&self) -> StopCategory {
        self.coefficients
            .as_ref()
            .map_or(StopCategory::Off, |coefficients| {
                coefficients.thresholds.reaction
            })
    }

    /// A tick in which nothing is known of the torques: the next one begins anew.
    #[inline]
    pub(crate) fn pause(&mut self) {
        self.observes = false;
    }

    /// Watches a machine whose drives told `readings`, before the next command; `motors` were commanded last, for the
    /// platform at `pose`.
    #[inline]
    pub(crate) fn check(
        &mut self,
        readings: &Readings<N>,
        motors: &[Motor<N>; 3],
        pose: &Pose<N>,
    ) -> Result<(), LimitBreach<N>> {
        let Some(coefficients) = &self.coefficients else {
            return Ok(());
        };
        if let Some(model) = self.models.receive() {
            self.model = Some(model);
        }
        match self.countdown.checked_sub(1) {
            Some(left) => self.countdown = left,
            None => {
                // While the background is busy the last pose waits: the model comes later.
                self.poses.send(*pose);
                self.countdown = coefficients.thresholds.model_ticks;
            }
        }
        let Some(model) = &self.model else {
            return Ok(());
        };
        let commands = motors.each_ref().map(|motor| coefficients.commanded(motor));
        if !self.observes {
            self.observes = true;
            self.observer = ContactObserver::AT_REST;
            self.beyond = 0;
            self.commanded = [commands; KEPT];
        }
        self.newest = (self.newest + 1) % KEPT;
        if let Some(newest) = self.commanded.get_mut(self.newest) {
            *newest = commands;
        }
        let mut deviations = [Deviation::NONE; 3];
        for (index, (deviation, reading)) in deviations.iter_mut().zip(readings).enumerate() {
            let age = usize::from(reading.age) + usize::from(coefficients.thresholds.late_ticks);
            // A drive that is silent for so long tells nothing: the observer begins anew once it speaks.
            if age >= KEPT {
                self.observes = false;
                return Ok(());
            }
            let place = self.commanded.get((self.newest + KEPT - age) % KEPT);
            if let Some(commanded) = place.and_then(|each| each.get(index)) {
                *deviation = commanded.deviation(reading.rate, reading.torque);
            }
        }
        let external = self.observer.observe(coefficients, model, &deviations);
        let wrench = model.at_tool(&external);
        let thresholds = &coefficients.thresholds;
        if thresholds.keep(&wrench) {
            self.beyond = 0;
            return Ok(());
        }
        self.beyond = self.beyond.saturating_add(1);
        match self.beyond >= thresholds.confirm_ticks {
            true => Err(thresholds.breach(&wrench)),
            false => Ok(()),
        }
    }
}

impl<N: ServiceNumber> ContactThresholds<N> {
    /// Returns false for a contact, and for what is no number.
    #[inline(always)]
    fn keep(&self, [x, y, moment]: &[N; 3]) -> bool {
        let square = *x * *x + *y * *y;
        square <= self.force * self.force && moment.abs() <= self.moment
    }

    #[cold]
    #[inline(never)]
    fn breach(&self, [x, y, moment]: &[N; 3]) -> LimitBreach<N> {
        let force = (*x * *x + *y * *y).sqrt();
        let (code, value, limit) = match force <= self.force {
            true => (FaultCode::ContactMoment, *moment, self.moment),
            false => (FaultCode::Contact, force, self.force),
        };
        LimitBreach {
            code,
            index: None,
            value,
            limit,
        }
    }
}
