//! Maps of values over the places that the machine works in.

use super::NamedFigure;
use super::map::{cells, map};
use crate::design::study::Study;
use trirrr_design::loads::PoseLoads;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::document::digits;
use trirrr_figures::sketch::Swatch;
use trirrr_figures::style::tone;

/// Shades of a map.
const LEVELS: usize = 8;

/// All maps of values.
pub(super) fn all(study: &Study) -> Vec<NamedFigure> {
    let by = |title: &str, unit: &str, of: &dyn Fn(&PoseLoads) -> f64| {
        let loads = study.loads.iter();
        let found: Vec<_> = loads.map(|each| each.as_ref().map(of)).collect();
        draw(study, &format!("{title} ({unit})"), &found)
    };
    let mut figures = vec![
        (
            "singularities",
            by(
                "least distance to a singularity",
                "scale-free",
                &|at: &PoseLoads| at.ratios.distances[0].min(at.ratios.distances[1]),
            ),
        ),
        (
            "rates",
            by("rate of the fastest motor at 1 m/s of D", "rad/s", &|at| {
                at.ratios.rate_per_speed()
            }),
        ),
        (
            "forces",
            by("largest torque for 1 N on D", "N m", &|at| {
                at.ratios.torque_per_force()
            }),
        ),
        (
            "torques",
            by(&study.case.title(), "N m", &|at| study.case.torque_nm(at)),
        ),
    ];
    if let Some(limits) = study.scene.limits.torque_nm {
        figures.push((
            "force_limit",
            by(
                "force on D that the limits of torque allow in every direction",
                "N",
                &|at| at.force_n(limits),
            ),
        ));
    }
    if let Some(stiffness) = study.stiffness_nm_rad {
        figures.push((
            "compliance",
            by(
                "displacement of D for 1 N in its softest direction",
                "\u{b5}m",
                &|at| 1e6 * at.compliance_m_n(stiffness),
            ),
        ));
    }
    figures.push((
        "accuracy",
        by("offset of D for 0.1 degrees of each motor", "mm", &|at| {
            1e3 * at.ratios.offset_per_error() * 0.1_f64.to_radians()
        }),
    ));
    if let Some(errors) = &study.errors_m {
        let found: Vec<_> = errors.iter().map(|error| error.map(|m| 1e3 * m)).collect();
        let title = "offset of D within the encoders' steps and the tolerances (mm, proven)";
        figures.push(("tolerances", draw(study, title, &found)));
    }
    figures
}

fn draw(study: &Study, title: &str, found: &[Option<f64>]) -> Drawn {
    let mut sorted: Vec<f64> = found.iter().flatten().copied().collect();
    sorted.sort_by(f64::total_cmp);
    // Levels that hold equally many cells each: ratios grow without bound towards singularities.
    let edge = |level: usize| {
        let index = (level * sorted.len() / LEVELS).min(sorted.len().saturating_sub(1));
        sorted.get(index).copied().unwrap_or(0.0)
    };
    let level = |value: f64| (1..LEVELS).filter(|level| value >= edge(*level)).count();
    let colour = |level: usize| tone(level as f64 / (LEVELS - 1) as f64);
    let under = cells(&study.coarse, |index| {
        found[index].map(|value| colour(level(value)))
    });
    let shade = |index: usize| {
        let text = format!("from {}", digits(edge(index)));
        (Swatch::Fields(vec![colour(index)]), text)
    };
    let text = match sorted.last() {
        Some(most) => format!("each shade has as many cells; up to {}", digits(*most)),
        None => "no cell is proven and connected with the start".into(),
    };
    let legend = vec![
        (0..LEVELS / 2).map(shade).collect(),
        (LEVELS / 2..LEVELS).map(shade).collect(),
        vec![(Swatch::None, text)],
    ];
    map(study, title, vec![under], legend)
}
