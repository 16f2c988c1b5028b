//! Figures of a study.

mod curves;
mod map;
mod modes;
mod polar;
mod values;
mod workspace;

use super::study::Study;
use crate::figures::draw_geometry;
use trirrr_figures::canvas::Drawn;

/// A figure: its file's name without its ending, and the document.
pub(super) type NamedFigure = (&'static str, Drawn);

/// All figures of a study, in the order of the report. What the scene does not tell has none.
pub(super) fn all(study: &Study) -> Vec<NamedFigure> {
    let scene = &study.scene;
    let title = format!(
        "{}: joints, links, angles and signs, at the start",
        scene.name
    );
    let mut figures = vec![
        (
            "geometry",
            draw_geometry(&title, &scene.parameters, &study.start),
        ),
        ("modes", modes::draw(study)),
        ("workspace", workspace::draw(study)),
        ("total_orientation", workspace::total(study)),
        ("angles", curves::angles(study)),
    ];
    figures.extend(values::all(study));
    figures.push(("angle_loads", curves::angle_loads(study)));
    figures.push(("ratios", curves::velocity_ratios(study)));
    figures.push(("jacobian", curves::jacobian(study)));
    figures.push(("reactions", polar::draw(study)));
    figures.push(("durations", curves::durations(study)));
    figures
}
