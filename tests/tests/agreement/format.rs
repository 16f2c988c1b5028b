//! The number types under comparison, and how far each may be from f64.

use crate::bounds::{coarse_functions, of_inputs};
use trirrr_core::machine::Parameters;
use trirrr_core::number::{Coarse, Number};
use trirrr_core::setpoint::Setpoint;
use trirrr_core::status::Status;
use trirrr_scene::{JobPlayer, Scene};
use trirrr_tests::inputs::Input;
use trirrr_tests::motors::{Motors, motors, rounded};

/// A number type under comparison.
pub(crate) trait Format {
    /// Its name in messages.
    const NAME: &'static str;
    /// The least distance to the parallel singularity of machines that the bounds are for.
    const LEAST_PARALLEL: f64;

    /// The machine's results in this type, and the setpoint that they are of, which is the given
    /// one as this type holds it.
    fn motors(
        parameters: &Parameters,
        setpoint: &Setpoint<f64>,
    ) -> (Result<Motors, Status>, Setpoint<f64>);

    /// The results of every tick of the scene's job, from the scene's own numbers.
    fn job(scene: &Scene) -> Vec<Result<Motors, Status>>;

    /// How far each result may be off when, besides what the format rounds in the tick, each input
    /// is off by what `other` says. None where the machine, off by as much, does not reach the
    /// pose any more.
    fn bounds(
        parameters: &Parameters,
        setpoint: &Setpoint<f64>,
        other: impl Fn(Input) -> f64,
    ) -> Option<Motors>;
}

/// The results of every tick of the scene's job.
pub(crate) fn job<N: Number>(scene: &Scene) -> Vec<Result<Motors, Status>> {
    JobPlayer::<N>::new(&scene.job, scene.period_s())
        .setpoints()
        .map(|setpoint| motors(&scene.parameters, &setpoint))
        .collect()
}

fn in_float<N: Number>(
    parameters: &Parameters,
    setpoint: &Setpoint<f64>,
) -> (Result<Motors, Status>, Setpoint<f64>) {
    let held: Setpoint<N> = rounded(setpoint);
    (motors(parameters, &held), rounded(&held))
}

/// u, half a unit in the last place of 1.
const U: f64 = f32::EPSILON as f64 / 2.0;

impl Format for f32 {
    const NAME: &'static str = "f32";
    const LEAST_PARALLEL: f64 = 0.0;

    fn motors(
        parameters: &Parameters,
        setpoint: &Setpoint<f64>,
    ) -> (Result<Motors, Status>, Setpoint<f64>) {
        in_float::<f32>(parameters, setpoint)
    }

    fn job(scene: &Scene) -> Vec<Result<Motors, Status>> {
        job::<f32>(scene)
    }

    /// A backward stable computation is the exact one for inputs that are off by a rounding or
    /// two: 2 u times the size of each, of a vector's components its length. What f64 does itself
    /// is 2^-29 of that.
    fn bounds(
        parameters: &Parameters,
        setpoint: &Setpoint<f64>,
        other: impl Fn(Input) -> f64,
    ) -> Option<Motors> {
        let off = |input: Input| 2.0 * U * input.length + other(input);
        Some(of_inputs(parameters, setpoint, off))
    }
}

impl Format for Coarse {
    const NAME: &'static str = "micromath";
    // The square root alone moves the rows of A by 6 %.
    const LEAST_PARALLEL: f64 = 0.25;

    fn motors(
        parameters: &Parameters,
        setpoint: &Setpoint<f64>,
    ) -> (Result<Motors, Status>, Setpoint<f64>) {
        in_float::<Coarse>(parameters, setpoint)
    }

    fn job(scene: &Scene) -> Vec<Result<Motors, Status>> {
        job::<Coarse>(scene)
    }

    /// What its functions do, and the roundings of f32.
    fn bounds(
        parameters: &Parameters,
        setpoint: &Setpoint<f64>,
        other: impl Fn(Input) -> f64,
    ) -> Option<Motors> {
        let functions = coarse_functions(parameters, setpoint)?;
        let roundings = <f32 as Format>::bounds(parameters, setpoint, other)?;
        Some(std::array::from_fn(|leg| {
            std::array::from_fn(|stage| functions[leg][stage] + roundings[leg][stage])
        }))
    }
}
