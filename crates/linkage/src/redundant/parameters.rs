//! Description of a redundant machine.

use nalgebra::Vector2;
use trirrr_core::machine::{BuildError, LegParameters, Parameters, PlatformParameters, Quantity};
use trirrr_core::number::Number;

/// A driven slider that carries a leg's base joint and motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliderParameters {
    /// Direction in which the slider's position grows, rad, counter-clockwise from the fixed x axis.
    pub direction_rad: f64,
    /// Mass of carriage and motor, without the links, kg, not negative.
    pub mass_kg: f64,
}

/// A machine with `LEGS` legs, three or more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RedundantParameters<const LEGS: usize> {
    /// The legs. Base joints on sliders are given at slider position 0.
    pub legs: [LegParameters; LEGS],
    /// The slider of each leg, if it has one.
    pub sliders: [Option<SliderParameters>; LEGS],
    /// The platform.
    pub platform: PlatformParameters,
    /// Gravity in the plane, m/s^2.
    pub gravity_m_s2: Vector2<f64>,
    /// External force on the platform at D, in the fixed frame, N.
    pub wrench_force_n: Vector2<f64>,
    /// External moment on the platform, N m, counter-clockwise positive.
    pub wrench_torque_nm: f64,
}

impl<const LEGS: usize> RedundantParameters<LEGS> {
    /// Returns the 3-RRR of three of the legs, without sliders.
    pub fn three(&self, legs: [usize; 3]) -> Parameters {
        Parameters {
            legs: legs.map(|leg| self.legs[leg]),
            platform: self.platform,
            gravity_m_s2: self.gravity_m_s2,
            wrench_force_n: self.wrench_force_n,
            wrench_torque_nm: self.wrench_torque_nm,
        }
    }

    /// Refuses parameters of no machine in the number type `N`, as [`Parameters::check`] does.
    ///
    /// # Errors
    /// The first quantity that is refused.
    pub fn check<N: Number>(&self) -> Result<(), BuildError> {
        for leg in 0..LEGS {
            let three = [0, leg.min(1), leg];
            self.three(three).check::<N>().map_err(|error| BuildError {
                leg: error.leg.map(|index| three[index]),
                ..error
            })?;
        }
        for (leg, slider) in self.sliders.iter().enumerate() {
            let Some(slider) = slider else { continue };
            let (direction, mass) = (slider.direction_rad, slider.mass_kg);
            let refused = |quantity, value, expected| {
                Err(BuildError {
                    quantity,
                    leg: Some(leg),
                    value,
                    expected,
                })
            };
            if !N::from_f64(direction).is_finite() {
                return refused(Quantity::SliderDirection, direction, "a finite number");
            }
            if !(mass >= 0.0 && N::from_f64(mass).is_finite()) {
                return refused(
                    Quantity::SliderMass,
                    mass,
                    "a number that is not negative, within the range of the number type",
                );
            }
        }
        Ok(())
    }
}
