//! Jacobians by finite differences.

use crate::system::{Matrix, System};

/// Cube root of the unit roundoff: a central difference with this relative step has errors of
/// truncation and of rounding that are alike, about its square.
const STEP: f64 = 6.055_454_452_393_343e-6;

/// The Jacobian by central differences, from 2 N derivatives: relative error about 4e-11 where
/// the equations are smooth over a part in 1e5 of a variable's magnitude. Where the equations
/// refuse the state on one side, the difference is taken on the other alone (error about 1e-5).
pub fn central<const N: usize, S: System<N> + ?Sized>(
    system: &S,
    t: f64,
    y: &[f64; N],
    jacobian: &mut Matrix<N>,
) -> Result<(), S::Refusal> {
    let scales = system.scales();
    let mut at = *y;
    let (mut above, mut below) = ([0.0; N], [0.0; N]);
    for column in 0..N {
        let finite = if scales[column].is_finite() {
            scales[column]
        } else {
            1.0
        };
        let step = STEP * y[column].abs().max(finite);
        let (mut high, mut low) = (y[column] + step, y[column] - step);
        at[column] = high;
        let over = system.derivative(t, &at, &mut above);
        at[column] = low;
        let under = system.derivative(t, &at, &mut below);
        at[column] = y[column];
        match (over, under) {
            (Ok(()), Ok(())) => {}
            (Err(_), Ok(())) => {
                high = y[column];
                system.derivative(t, &at, &mut above)?;
            }
            (Ok(()), Err(_)) => {
                low = y[column];
                system.derivative(t, &at, &mut below)?;
            }
            (Err(refusal), Err(_)) => return Err(refusal),
        }
        // The step as it came out in binary64.
        let width = high - low;
        for row in 0..N {
            jacobian[row][column] = (above[row] - below[row]) / width;
        }
    }
    Ok(())
}
