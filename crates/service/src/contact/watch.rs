//! The tick's part of contact detection.

use super::model::ContactModel;
use super::observer::{Commanded, ContactObserver};
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
pub(crate) struct ContactWatch<'q, N: ServiceNumber> {
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

    /// Ticks of the path by which the machine goes back after the stop.
    pub(crate) fn retreat_ticks(&self) -> u32 {
        let coefficients = self.coefficients.as_ref();
        coefficients.map_or(0, |coefficients| coefficients.thresholds.retreat_ticks)
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
        if self.coefficients.is_none() {
            return Ok(());
        }
        match self.countdown.checked_sub(1) {
            Some(left) => self.countdown = left,
            None => self.exchange(pose),
        }
        let (Some(coefficients), Some(model)) = (&self.coefficients, &self.model) else {
            return Ok(());
        };
        let joint = |index: usize| Commanded::of(coefficients, index, &motors[index]);
        let commands = [joint(0), joint(1), joint(2)];
        self.newest = self.newest.wrapping_add(1) % KEPT;
        if let Some(newest) = self.commanded.get_mut(self.newest) {
            *newest = commands;
        }
        let begins = !self.observes;
        if begins {
            self.observes = true;
            self.beyond = 0;
            fill(&mut self.commanded, &commands);
        }
        let late = usize::from(coefficients.thresholds.late_ticks);
        let age = |index: usize| usize::from(readings[index].age) + late;
        // All of them at once: the places are a power of two.
        if (age(0) | age(1) | age(2)) >= KEPT {
            // A drive that is silent for so long tells nothing: the observer begins anew once it speaks.
            self.observes = false;
            return Ok(());
        }
        let deviation = |index: usize| {
            let place = self.newest.wrapping_sub(age(index)) % KEPT;
            let commands = self.commanded.get(place).unwrap_or(&commands);
            let reading = &readings[index];
            commands[index].deviation(reading.rate, reading.torque)
        };
        let deviations = [deviation(0), deviation(1), deviation(2)];
        if begins {
            self.observer = ContactObserver::starting(model, &deviations);
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

impl<N: ServiceNumber> ContactWatch<'_, N> {
    /// Takes the model that the background has sent, and asks for one of `pose`. Until there is a first one, in every tick.
    #[inline(never)] // size: docs/size.md, rule 3
    fn exchange(&mut self, pose: &Pose<N>) {
        if let Some(model) = self.models.peek() {
            self.model = Some(*model);
            self.models.discard();
        }
        // While the background is busy the last pose waits: the model comes later.
        self.poses.send(*pose);
        if let (Some(coefficients), Some(_)) = (&self.coefficients, &self.model) {
            self.countdown = coefficients.thresholds.model_ticks;
        }
    }
}

/// Fills the ring of a machine that has had these commands for a while.
#[cold]
#[inline(never)]
fn fill<N: ServiceNumber>(ring: &mut [[Commanded<N>; 3]; KEPT], commands: &[Commanded<N>; 3]) {
    for place in ring {
        *place = *commands;
    }
}

impl<N: ServiceNumber> ContactThresholds<N> {
    /// Returns false for a contact, and for what is no number.
    #[inline(always)]
    fn keep(&self, [x, y, moment]: &[N; 3]) -> bool {
        let square = *x * *x + *y * *y;
        square <= self.force_sq && moment.abs() <= self.moment
    }

    #[cold]
    #[inline(never)]
    fn breach(&self, [x, y, moment]: &[N; 3]) -> LimitBreach<N> {
        let square = *x * *x + *y * *y;
        let (code, value, limit) = match square <= self.force_sq {
            true => (FaultCode::ContactMoment, *moment, self.moment),
            false => (FaultCode::Contact, square.sqrt(), self.force_sq.sqrt()),
        };
        LimitBreach {
            code,
            index: None,
            value,
            limit,
        }
    }
}
