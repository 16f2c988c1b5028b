//! Choice of the method of integration.

use trirrr_integrate::{self as integrate, Method, Spectrum};
use trirrr_scene::{self as scene, Scene};

/// Tolerance of the implicit method under a sampled controller, where none is chosen. Every sample
/// excites the windings, and to follow that to the method's own tolerance takes several steps a sample;
/// the motion, which integrates currents twice, gains nothing.
const SAMPLED_TOLERANCE: f64 = 1e-7;

/// The method that the scene chooses, or that its stiffness does. Results are asked for at `rate_hz`
/// or, without samples, every `record_s`.
pub(crate) fn choose(
    scene: &Scene,
    spectrum: &Spectrum,
    rate_hz: Option<f64>,
    record_s: f64,
) -> (Method, Option<String>) {
    let chosen = scene
        .plant
        .as_ref()
        .map_or(scene::Method::Auto { tolerance: None }, |plant| {
            plant.method
        });
    let implicit = match rate_hz {
        Some(_) => SAMPLED_TOLERANCE,
        None => Method::RADAU_IIA_TOLERANCE,
    };
    let method = match chosen {
        scene::Method::SemiImplicitEuler { step_s } => Method::SemiImplicitEuler { step_s },
        scene::Method::Rk4 { step_s } => Method::Rk4 { step_s },
        scene::Method::DormandPrince { tolerance } => Method::DormandPrince {
            tolerance: tolerance.unwrap_or(Method::DORMAND_PRINCE_TOLERANCE),
        },
        scene::Method::RadauIia { tolerance } => Method::RadauIia {
            tolerance: tolerance.unwrap_or(implicit),
        },
        scene::Method::Auto { tolerance } => {
            let resolution_s = rate_hz.map_or(record_s, |rate| 1.0 / rate);
            let mut choice = integrate::stability::choose(spectrum, resolution_s, tolerance);
            if let (Method::RadauIia { tolerance: own }, None) = (&mut choice.method, tolerance) {
                *own = implicit;
            }
            return (choice.method, Some(choice.to_string()));
        }
    };
    (method, None)
}
