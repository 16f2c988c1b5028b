//! Jacobians by finite differences.

/// Cube root of the unit roundoff: a central difference with this relative step has errors of
/// truncation and of rounding that are alike, about its square.
const STEP: f64 = 6.055_454_452_393_343e-6;

/// The Jacobian of `derivative`, which writes y' at a time and a state, by central differences, from 2 N derivatives: relative
/// error about 4e-11 where the equations are smooth over a part in 1e5 of a variable's magnitude. Where the equations
/// refuse the state on one side, the difference is taken on the other alone (error about 1e-5). `scales` are those of the
/// [system](crate::System::scales).
///
/// # Errors
/// The equations refuse both sides.
pub fn central<const N: usize, R>(
    derivative: impl Fn(f64, &[f64; N], &mut [f64; N]) -> Result<(), R>,
    scales: &[f64; N],
    t: f64,
    y: &[f64; N],
    jacobian: &mut [[f64; N]; N],
) -> Result<(), R> {
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
        let over = derivative(t, &at, &mut above);
        at[column] = low;
        let under = derivative(t, &at, &mut below);
        at[column] = y[column];
        match (over, under) {
            (Ok(()), Ok(())) => {}
            (Err(_), Ok(())) => {
                high = y[column];
                derivative(t, &at, &mut above)?;
            }
            (Ok(()), Err(_)) => {
                low = y[column];
                derivative(t, &at, &mut below)?;
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
