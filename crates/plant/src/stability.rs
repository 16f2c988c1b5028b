//! Check of the gains before a run.

use crate::layout::{RATES, ROTOR_RATES, ROTORS};
use crate::model::{Control, Plant};
use crate::motor::MotorModel;
use crate::refusal::Refusal;
use nalgebra::{DMatrix, DVectorView};
use trirrr_integrate::{Spectrum, System};
use trirrr_scene::Controller;

/// Deviations that grow by more than this over a run are not a machine that is hard to control but
/// one that is not controlled: e^60 takes a rounding error to the size of the machine and beyond.
const GROWS: f64 = 60.0;

/// Eigenvalues are known to this part of the largest.
const ROUNDING: f64 = 1e-13;

/// Refuses gains with which the loop is unstable at the start of a run of `run_s`.
///
/// A controller that is continuous in time is part of the linearisation, `spectrum`. A sampled one
/// is not; there the map from one sample to the next is taken to first order, with the linearised
/// plant between the samples and the voltage or torque held.
///
/// # Errors
/// [`Refusal::Scene`] with the rate at which deviations grow.
pub(crate) fn check<const N: usize>(
    plant: &Plant<N>,
    y: &[f64; N],
    spectrum: &Spectrum,
    controller: Option<&Controller>,
    run_s: f64,
) -> Result<(), Refusal> {
    let growth = match &plant.control {
        // What rounding makes of an eigenvalue is no growth: sticking joints have very large ones.
        Control::Continuous(_) => spectrum.growth() - ROUNDING * spectrum.radius(),
        Control::Held => return Ok(()),
        Control::Sampled { rate_hz } => {
            let Some(controller) = controller else {
                return Ok(());
            };
            let gains = plant.gains_of(controller);
            let period = 1.0 / rate_hz;
            match sampled_radius(plant, y, &gains, period)? {
                Some(radius) => radius.ln() / period,
                None => return Ok(()),
            }
        }
    };
    if growth * run_s <= GROWS {
        return Ok(());
    }
    let rate = match &plant.control {
        Control::Sampled { rate_hz } => format!(" sampled at {rate_hz} Hz"),
        _ => String::new(),
    };
    Err(Refusal::Scene {
        key: "controller.kp_nm_rad, kd_nm_s_rad".into(),
        reason: format!(
            "the loop{rate} is unstable at the start: deviations grow by a factor e every {:.3e} s",
            1.0 / growth
        ),
    })
}

/// Gains of a sampled loop, from joint to what its motor is told.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LoopGains {
    /// By angle, 1/rad.
    angle: [f64; 3],
    /// By rate, s/rad.
    rate: [f64; 3],
}

impl<const N: usize> Plant<N> {
    /// Gains of `controller` from each joint to its motor's command.
    fn gains_of(&self, controller: &Controller) -> LoopGains {
        let mut gains = LoopGains {
            angle: [0.0; 3],
            rate: [0.0; 3],
        };
        for (leg, motor) in self.motors.iter().enumerate() {
            let (kp, kd) = (controller.kp_nm_rad[leg], controller.kd_nm_s_rad[leg]);
            (gains.angle[leg], gains.rate[leg]) = match motor {
                MotorModel::Ideal => (-kp, -kd),
                MotorModel::Bldc(winding) => {
                    let per_torque = winding.resistance / winding.torque_constant;
                    (-kp * per_torque, winding.back_emf - kd * per_torque)
                }
                MotorModel::Stepper(_) => (0.0, 0.0),
            };
        }
        gains
    }

    /// Derivatives of y' by what each motor is told.
    fn input_slopes(&self, y: &[f64; N]) -> Result<[[f64; N]; 3], Refusal> {
        let at = self.configuration(y)?;
        let mut without = [0.0; N];
        self.slope_under(&[0.0; 3], &at, y, &mut without)?;
        let mut slopes = [[0.0; N]; 3];
        for (motor, slope) in slopes.iter_mut().enumerate() {
            let mut told = [0.0; 3];
            told[motor] = 1.0;
            self.slope_under(&told, &at, y, slope)?;
            for (with, without) in slope.iter_mut().zip(&without) {
                *with -= without;
            }
        }
        Ok(slopes)
    }

    /// Derivatives by the state of the angle that each motor's controller sees, then of the rate,
    /// for a machine at rest.
    fn sensed_slopes(&self, y: &[f64; N]) -> Result<[[[f64; N]; 2]; 3], Refusal> {
        let legs = self.configuration(y)?.legs;
        let mut slopes = [[[0.0; N]; 2]; 3];
        for (leg, [angle, rate]) in slopes.iter_mut().enumerate() {
            if Self::ELASTIC {
                angle[ROTORS + leg] = 1.0;
                rate[ROTOR_RATES + leg] = 1.0;
            } else {
                angle[..3].copy_from_slice(&legs[leg].k1);
                rate[RATES..RATES + 3].copy_from_slice(&legs[leg].k1);
            }
        }
        Ok(slopes)
    }
}

/// Spectral radius of the map from sample to sample; `None` where it is not a number.
fn sampled_radius<const N: usize>(
    plant: &Plant<N>,
    y: &[f64; N],
    gains: &LoopGains,
    period: f64,
) -> Result<Option<f64>, Refusal> {
    // The two recorded energies are left out: nothing depends on them.
    let size = N - 2;
    let mut jacobian = [[0.0; N]; N];
    plant.jacobian(0.0, y, &mut jacobian)?;
    let inputs = plant.input_slopes(y)?;
    // exp([A, B; 0, 0] h) holds both exp(A h) and the integral that the held input is carried by.
    let mut whole = DMatrix::zeros(size + 3, size + 3);
    for row in 0..size {
        for column in 0..size {
            whole[(row, column)] = jacobian[row][column] * period;
        }
        for (motor, slope) in inputs.iter().enumerate() {
            whole[(row, size + motor)] = slope[row] * period;
        }
    }
    if !whole.iter().all(|entry: &f64| entry.is_finite()) {
        return Ok(None);
    }
    let step = exponential(whole);
    let sensed = plant.sensed_slopes(y)?;
    let mut map = step.view((0, 0), (size, size)).into_owned();
    let held = step.view((0, size), (size, 3));
    for motor in 0..3 {
        for column in 0..size {
            let [angle, rate] = &sensed[motor];
            let told = gains.angle[motor] * angle[column] + gains.rate[motor] * rate[column];
            for row in 0..size {
                map[(row, column)] += held[(row, motor)] * told;
            }
        }
    }
    if !map.iter().all(|entry| entry.is_finite()) {
        return Ok(Some(f64::INFINITY));
    }
    Ok(Some(spectral_radius(map)))
}

/// Terms of the series of the exponential: of a matrix whose columns add up to 1/2 at most, what is left out is below 1e-19.
const TERMS: i32 = 16;

/// Exponential of `matrix`, by its series on a part of it and squaring. Not finite where it is too large.
fn exponential(mut matrix: DMatrix<f64>) -> DMatrix<f64> {
    let column = |column: DVectorView<f64>| column.iter().map(|entry| entry.abs()).sum::<f64>();
    let size = matrix.column_iter().map(column).fold(0.0, f64::max);
    if !size.is_finite() {
        return matrix.map(|_| f64::INFINITY);
    }
    let squarings = (size.log2().ceil() + 1.0).max(0.0) as i32;
    matrix *= 0.5_f64.powi(squarings);
    let one = DMatrix::identity(matrix.nrows(), matrix.ncols());
    let mut sum = one.clone();
    for term in (1..=TERMS).rev() {
        sum = &matrix * sum / f64::from(term) + &one;
    }
    for _ in 0..squarings {
        sum = &sum * &sum;
    }
    sum
}

/// Squarings of a matrix after which its size tells its largest eigenvalue.
const SQUARINGS: i32 = 40;

/// Largest magnitude of an eigenvalue of `matrix`: limit of |M^k|^(1/k), by squaring. An iteration for
/// the eigenvalues themselves may have no end on a matrix such as that of a loop without gains.
fn spectral_radius(mut matrix: DMatrix<f64>) -> f64 {
    let mut logarithm = 0.0;
    for squarings in 0..SQUARINGS {
        let size = matrix.norm();
        if size == 0.0 || !size.is_finite() {
            return size;
        }
        logarithm += size.ln() * 0.5_f64.powi(squarings);
        matrix /= size;
        matrix = &matrix * &matrix;
    }
    logarithm.exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radius_of_matrices_with_known_eigenvalues() {
        for (entries, radius) in [
            ([0.5, 3e6, 0.0, -0.7], 0.7),
            ([0.0, 2.0, -2.0, 0.0], 2.0),
            ([1.0, 1.0, 0.0, 1.0], 1.0),
            ([0.0, 1.0, 0.0, 0.0], 0.0),
        ] {
            let found = spectral_radius(DMatrix::from_row_slice(2, 2, &entries));
            assert!((found - radius).abs() < 1e-10, "{found} for {radius}");
        }
    }

    #[test]
    fn exponentials_of_known_matrices() {
        let exponential = |entries: [f64; 4]| exponential(DMatrix::from_row_slice(2, 2, &entries));
        for angle in [0.0, 1e-9, 0.3, 2.0, 50.0, 400.0] {
            let (sine, cosine) = f64::sin_cos(angle);
            let turned = DMatrix::from_row_slice(2, 2, &[cosine, -sine, sine, cosine]);
            let off = (exponential([0.0, -angle, angle, 0.0]) - turned).amax();
            assert!(off < 1e-15 * (1.0 + angle), "{off} at {angle}");
        }
        // Two decays and their coupling: (e^a - e^b) / (a - b).
        let (slow, fast) = (-1.0_f64, -30.0_f64);
        let found = exponential([slow, 5.0, 0.0, fast]);
        let coupled = 5.0 * (slow.exp() - fast.exp()) / (slow - fast);
        assert!((found[(0, 1)] - coupled).abs() < 1e-15);
        assert!((found[(0, 0)] - slow.exp()).abs() < 1e-15);
        assert!((found[(1, 1)] / fast.exp() - 1.0).abs() < 1e-10);
        assert_eq!(exponential([0.0, 7.0, 0.0, 0.0])[(0, 1)], 7.0);
        assert!(!exponential([1e308, 1e308, 1e308, 1e308])[(0, 0)].is_finite());
        assert!(!exponential([2000.0, 0.0, 0.0, 0.0])[(0, 0)].is_finite());
    }
}
