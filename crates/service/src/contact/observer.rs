//! The observer of the momentum.

use super::model::ContactModel;
use super::parameters::ContactCoefficients;
use trirrr_core::number::{Arithmetic, Number};

/// Deviation of a joint from its command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation<N> {
    /// Commanded rate, rad/s.
    commanded_rate: N,
    /// Measured rate less the commanded one, rad/s.
    rate: N,
    /// Measured torque less the commanded one, N m.
    torque: N,
}

impl<N: Number> Deviation<N> {
    /// Joint that stands as it is told.
    pub const NONE: Self = Self {
        commanded_rate: N::ZERO,
        rate: N::ZERO,
        torque: N::ZERO,
    };
}

/// Command of a joint.
#[derive(Clone, Copy)]
pub(super) struct Commanded<N> {
    pub(super) rate: N,
    pub(super) torque: N,
}

impl<N: Number> Commanded<N> {
    pub(super) const NOTHING: Self = Self {
        rate: N::ZERO,
        torque: N::ZERO,
    };

    #[inline(always)]
    pub(super) fn deviation(&self, rate: N, torque: N) -> Deviation<N> {
        Deviation {
            commanded_rate: self.rate,
            rate: rate - self.rate,
            torque: torque - self.torque,
        }
    }
}

/// External torques of the joints, estimated from the momentum of the deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactObserver<N> {
    /// Momentum of the last tick; none before the first.
    momentum: Option<[N; 3]>,
    /// External torques behind the first pole of the filter, N m,
    first: [N; 3],
    /// and behind both.
    torques: [N; 3],
}

impl<N: Number> ContactObserver<N> {
    /// Observer of a machine on which nothing acts.
    pub const AT_REST: Self = Self {
        momentum: None,
        first: [N::ZERO; 3],
        torques: [N::ZERO; 3],
    };

    /// Takes the deviations of a tick. Returns the external torque of each joint, N m, as the surroundings exert it, less
    /// what friction explains.
    ///
    /// The filter has two equal poles of the gain g, implicit in the period T and so stable at any gain:
    /// `r' = (r + g (p' - p - T excess)) / (1 + g T)`, `s' = (s + g T r') / (1 + g T)`. The second pole takes away what the
    /// first leaves of the noise of the rates.
    ///
    /// A joint that slides has its Coulomb friction for certain, one that stands has any up to that: in between the
    /// known part grows with the rate, and the rest is a dead band.
    #[inline(always)]
    pub fn observe(
        &mut self,
        coefficients: &ContactCoefficients<N>,
        model: &ContactModel<N>,
        deviations: &[Deviation<N>; 3],
    ) -> [N; 3] {
        let [a, b, c] = deviations;
        let momentum = model.momentum(&[a.rate, b.rate, c.rate]);
        let before = self.momentum.unwrap_or(momentum);
        self.momentum = Some(momentum);
        let mut external = [N::ZERO; 3];
        let changes = momentum.iter().zip(&before);
        let friction = coefficients.coulomb.iter().zip(&coefficients.viscous);
        let filters = self.first.iter_mut().zip(&mut self.torques);
        let joints = filters.zip(deviations);
        for (((external, ((first, torque), deviation)), (coulomb, viscous)), (now, before)) in
            external.iter_mut().zip(joints).zip(friction).zip(changes)
        {
            let rate = deviation.commanded_rate;
            let sliding = within_one(rate * coefficients.per_sliding);
            let rubbing = *coulomb * sliding + *viscous * rate;
            let excess = deviation.torque - rubbing;
            let change = (*now - *before) - coefficients.period * excess;
            *first = (*first + coefficients.gain * change) * coefficients.decay;
            *torque = (*torque + coefficients.share * *first) * coefficients.decay;
            let band = *coulomb - *coulomb * sliding.abs();
            *external = beyond(*torque, band);
        }
        external
    }
}

#[inline(always)]
fn within_one<N: Arithmetic>(value: N) -> N {
    if value > N::ONE {
        N::ONE
    } else if value < -N::ONE {
        -N::ONE
    } else {
        value
    }
}

/// Part of `value` outside a dead band. Something that is no number is outside.
#[inline(always)]
fn beyond<N: Arithmetic>(value: N, band: N) -> N {
    if value.abs() <= band {
        N::ZERO
    } else if value > N::ZERO {
        value - band
    } else {
        value + band
    }
}
