//! The observer of the momentum.

use super::model::ContactModel;
use super::parameters::ContactCoefficients;
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::tick::Motor;

/// Deviation of a joint from its command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation<N> {
    /// Measured rate less the commanded one, rad/s.
    rate: N,
    /// Measured torque less the commanded one and the friction that is certain, N m.
    excess: N,
    /// Friction that is possible beside it, N m.
    band: N,
}

impl<N: Number> ContactCoefficients<N> {
    /// Deviations of joints that told `[rate, torque]` from their commands `motors`.
    pub fn deviations(&self, told: &[[N; 2]; 3], motors: &[Motor<N>; 3]) -> [Deviation<N>; 3] {
        let joint = |index: usize| {
            let [rate, torque] = told[index];
            Commanded::of(self, index, &motors[index]).deviation(rate, torque)
        };
        [joint(0), joint(1), joint(2)]
    }
}

/// Command of a joint.
#[derive(Clone, Copy)]
pub(super) struct Commanded<N> {
    rate: N,
    /// Torque of the motion, with the friction that is certain.
    torque: N,
    /// Friction that is possible beside it.
    band: N,
}

impl<N: Number> Commanded<N> {
    pub(super) const NOTHING: Self = Self {
        rate: N::ZERO,
        torque: N::ZERO,
        band: N::ZERO,
    };

    /// Command `motor` of joint `index`, 0 to 2.
    ///
    /// A joint that slides has its Coulomb friction for certain, one that stands has any up to that: in between the
    /// known part grows with the rate, and the rest is a dead band.
    #[inline(always)]
    pub(super) fn of(
        coefficients: &ContactCoefficients<N>,
        index: usize,
        motor: &Motor<N>,
    ) -> Self {
        let rate = motor.rate + motor.acceleration * coefficients.told_after;
        let (coulomb, viscous) = (coefficients.coulomb[index], coefficients.viscous[index]);
        let sliding = within_one(rate * coefficients.per_sliding);
        Self {
            rate,
            torque: motor.torque + (coulomb * sliding + viscous * rate),
            band: coulomb - coulomb * sliding.abs(),
        }
    }

    #[inline(always)]
    pub(super) fn deviation(&self, rate: N, torque: N) -> Deviation<N> {
        Deviation {
            rate: rate - self.rate,
            excess: torque - self.torque,
            band: self.band,
        }
    }
}

/// External torques of the joints, estimated from the momentum of the deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactObserver<N> {
    /// Momentum of the last tick, weighted.
    momentum: [N; 3],
    /// External torques behind the first pole of the filter, N m,
    first: [N; 3],
    /// and behind both.
    torques: [N; 3],
}

impl<N: Number> ContactObserver<N> {
    /// Observer of a machine on which nothing acts and which follows its commands.
    pub const AT_REST: Self = Self {
        momentum: [N::ZERO; 3],
        first: [N::ZERO; 3],
        torques: [N::ZERO; 3],
    };

    /// Observer of a machine on which nothing acts, with these deviations.
    pub fn starting(model: &ContactModel<N>, deviations: &[Deviation<N>; 3]) -> Self {
        Self {
            momentum: model.momentum(&deviations.each_ref().map(|each| each.rate)),
            ..Self::AT_REST
        }
    }

    /// Takes the deviations of a tick. Returns the external torque of each joint, N m, as the surroundings exert it, less
    /// what friction explains.
    ///
    /// The filter has two equal poles of the gain g, implicit in the period T and so stable at any gain:
    /// `r' = (r + g (p' - p - T excess)) / (1 + g T)`, `s' = (s + g T r') / (1 + g T)`. The second pole takes away what the
    /// first leaves of the noise of the rates. The momentum comes with its weight g / (1 + g T).
    #[inline(always)]
    pub fn observe(
        &mut self,
        coefficients: &ContactCoefficients<N>,
        model: &ContactModel<N>,
        deviations: &[Deviation<N>; 3],
    ) -> [N; 3] {
        let momentum = model.momentum(&deviations.each_ref().map(|each| each.rate));
        let &ContactCoefficients { decay, share, .. } = coefficients;
        let mut joint = |index: usize| {
            let Deviation { excess, band, .. } = deviations[index];
            let change = momentum[index] - self.momentum[index];
            let first = decay * self.first[index] + (change - share * excess);
            let torque = decay * self.torques[index] + share * first;
            self.first[index] = first;
            self.torques[index] = torque;
            beyond(torque, band)
        };
        let external = [joint(0), joint(1), joint(2)];
        self.momentum = momentum;
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
