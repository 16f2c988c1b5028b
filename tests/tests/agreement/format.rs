//! The number types under comparison, and how far each may be from f64.

use crate::bounds::{coarse_functions, fixed_roundings, of_inputs};
use trirrr_core::machine::Parameters;
use trirrr_core::number::{Coarse, Fixed, Number};
use trirrr_core::setpoint::Setpoint;
use trirrr_core::units::Units;
use trirrr_scene::{JobPlayer, Scene};
use trirrr_tests::inputs::Input;
use trirrr_tests::motors::{Motors, in_si, motors, rounded};

/// Results, or why there are none.
pub(crate) type Results = Result<Motors, String>;

/// A number type under comparison.
pub(crate) trait Format: Number {
    /// Its name in messages.
    const NAME: &'static str;
    /// The least distances to the serial and the parallel singularity of machines that the bounds
    /// are for.
    const LEAST: [f64; 2];

    /// How far each result may be off for what this type, running in `units`, rounds, and when each
    /// input is besides off by what `other` says. `None` where the machine, off by as much, does
    /// not reach the pose any more.
    fn bounds(
        parameters: &Parameters,
        setpoint: &Setpoint<f64>,
        units: &Units,
        other: impl Fn(Input) -> f64,
    ) -> Option<Motors>;
}

/// The machine's results in `N`, the setpoint that they are of, which is the given one as the type
/// holds it, and the units that the type runs in.
pub(crate) fn results<N: Number>(
    parameters: &Parameters,
    setpoint: &Setpoint<f64>,
) -> (Results, Setpoint<f64>, Units) {
    let units = match N::PROPAGATES_NON_FINITE {
        true => Units::SI,
        false => match trirrr_scene::units_of_setpoints(parameters, [setpoint]) {
            Ok(units) => units,
            Err(error) => {
                let reason = format!("does not fit: {error}");
                return (Err(reason), *setpoint, Units::SI);
            }
        },
    };
    let held: Setpoint<N> = rounded(&units.setpoint(setpoint));
    let parameters = units.parameters(parameters);
    if let Err(error) = parameters.check::<N>() {
        return (Err(format!("does not fit: {error}")), *setpoint, units);
    }
    let found = motors(&parameters, &held)
        .map(|found| in_si(found, &units))
        .map_err(|status| status.to_string());
    (found, si_setpoint(&rounded(&held), &units), units)
}

/// A setpoint in `units` in SI units.
fn si_setpoint(setpoint: &Setpoint<f64>, units: &Units) -> Setpoint<f64> {
    let inverse = Units {
        length: -units.length,
        time: -units.time,
        mass: -units.mass,
    };
    inverse.setpoint(setpoint)
}

/// The results of every tick of the scene's job, from the scene's own numbers.
pub(crate) fn job<N: Number>(scene: &Scene) -> (Vec<Results>, Units) {
    let units =
        trirrr_scene::units::<N>(scene).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    let player = JobPlayer::<N>::new(&scene.job.in_units(&units), units.time(scene.period_s()));
    let parameters = units.parameters(&scene.parameters);
    let results = player.setpoints().map(|setpoint| {
        motors(&parameters, &setpoint)
            .map(|found| in_si(found, &units))
            .map_err(|status| status.to_string())
    });
    (results.collect(), units)
}

/// u, half a unit in the last place of 1.
const U: f64 = f32::EPSILON as f64 / 2.0;

impl Format for f32 {
    const NAME: &'static str = "f32";
    const LEAST: [f64; 2] = [0.0, 0.0];

    /// A backward stable computation is the exact one for inputs that are off by a rounding or
    /// two: 2 u times the size of each, of a vector's components its length. What f64 does itself
    /// is 2^-29 of that.
    fn bounds(
        parameters: &Parameters,
        setpoint: &Setpoint<f64>,
        _: &Units,
        other: impl Fn(Input) -> f64,
    ) -> Option<Motors> {
        let off = |input: Input| 2.0 * U * input.length + other(input);
        Some(of_inputs(parameters, setpoint, off))
    }
}

impl Format for Fixed {
    const NAME: &'static str = "fixed";
    const LEAST: [f64; 2] = [0.0, 0.0];

    /// What it rounds on the way.
    fn bounds(
        parameters: &Parameters,
        setpoint: &Setpoint<f64>,
        units: &Units,
        other: impl Fn(Input) -> f64,
    ) -> Option<Motors> {
        let roundings = fixed_roundings(parameters, setpoint, units)?;
        Some(sum(&roundings, &of_inputs(parameters, setpoint, other)))
    }
}

impl Format for Coarse {
    const NAME: &'static str = "micromath";
    // The square root alone moves the rows of A by 6 %.
    const LEAST: [f64; 2] = [0.0, 0.25];

    /// What its functions do, and the roundings of f32.
    fn bounds(
        parameters: &Parameters,
        setpoint: &Setpoint<f64>,
        units: &Units,
        other: impl Fn(Input) -> f64,
    ) -> Option<Motors> {
        let functions = coarse_functions(parameters, setpoint)?;
        let roundings = <f32 as Format>::bounds(parameters, setpoint, units, other)?;
        Some(sum(&functions, &roundings))
    }
}

fn sum(a: &Motors, b: &Motors) -> Motors {
    std::array::from_fn(|leg| std::array::from_fn(|stage| a[leg][stage] + b[leg][stage]))
}
