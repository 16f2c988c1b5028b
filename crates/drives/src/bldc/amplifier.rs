//! From torque to the set value of an amplifier that controls its current.

/// Set value of an amplifier: the duty of a PWM signal. A low-pass filter makes an analogue voltage of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AmplifierParameters {
    /// Duty for the largest current backward, and forward; 0 to 1. Halfway between them the current is 0.
    pub duty: [f32; 2],
    /// Torque at the joint of the current at both ends, N m, positive: N Kt I.
    pub full_scale_nm: f32,
    /// The joint turns clockwise where the current is forward.
    pub reversed: bool,
}

/// The same in counts of a PWM output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Amplifier {
    /// Count of current 0, and
    centre: f32,
    /// counts per N m.
    slope: f32,
    /// Ends of the signal.
    least: f32,
    most: f32,
}

impl Amplifier {
    /// Set values for an output of `full` counts.
    pub(super) fn build(p: &AmplifierParameters, full: u16) -> Self {
        let [backward, forward] = p.duty.map(|duty| duty * f32::from(full));
        let half = 0.5 * (forward - backward);
        let slope = half / p.full_scale_nm;
        Self {
            centre: 0.5 * (backward + forward),
            slope: if p.reversed { -slope } else { slope },
            least: backward.min(forward),
            most: backward.max(forward),
        }
    }

    /// Counts for `torque` at the joint, N m, within the ends of the signal; for none where it is not a number.
    #[inline(always)]
    pub(super) fn counts(&self, torque: f32) -> u16 {
        let torque = if torque.is_nan() { 0.0 } else { torque };
        let counts = self.centre + self.slope * torque;
        // Both ends fit: the cast to the nearest saturates.
        (counts.max(self.least).min(self.most) + 0.5) as u16
    }
}

/// Torque at the joint, N m, that a set value of `counts` of an output of `full` counts asks for: for simulated amplifiers.
pub fn torque_of(p: &AmplifierParameters, counts: u16, full: u16) -> f64 {
    let amplifier = Amplifier::build(p, full);
    let counts = f64::from(counts) - f64::from(amplifier.centre);
    counts / f64::from(amplifier.slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ESCON: AmplifierParameters = AmplifierParameters {
        duty: [0.1, 0.9],
        full_scale_nm: 4.0,
        reversed: false,
    };

    #[test]
    fn ten_percent_is_all_backward_and_ninety_all_forward() {
        let amplifier = Amplifier::build(&ESCON, 10_000);
        for (torque, counts) in [
            (0.0, 5000),
            (4.0, 9000),
            (-4.0, 1000),
            (1.0, 6000),
            (9.0, 9000),
            (-9.0, 1000),
            (f32::NAN, 5000),
        ] {
            assert_eq!(amplifier.counts(torque), counts, "{torque}");
        }
        let reversed = AmplifierParameters {
            reversed: true,
            ..ESCON
        };
        assert_eq!(Amplifier::build(&reversed, 10_000).counts(1.0), 4000);
        assert!((torque_of(&reversed, 4000, 10_000) - 1.0).abs() < 1e-6);
        // Falling: all forward at the lower end.
        let falling = AmplifierParameters {
            duty: [1.0, 0.0],
            ..ESCON
        };
        assert_eq!(Amplifier::build(&falling, 65_535).counts(4.0), 0);
        assert_eq!(Amplifier::build(&falling, 65_535).counts(-4.0), 65_535);
    }
}
