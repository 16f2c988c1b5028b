//! Maps of where the machine works, with one angle of the platform and with all.

use super::map::{cells, map};
use crate::design::study::{Study, Surface};
use std::f64::consts::TAU;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::sketch::{SketchMark, Swatch};
use trirrr_figures::style::{AREA, INK, RGBColor, faded};

/// Reached, but near to a singularity or beyond one.
const REACHED: RGBColor = RGBColor(228, 228, 228);
/// Undecided.
const OPEN: RGBColor = RGBColor(120, 120, 120);

fn works() -> RGBColor {
    faded(AREA, 0.6)
}

fn apart() -> RGBColor {
    faded(AREA, 0.28)
}

/// Cells of `surface`, with its largest circle and rectangle.
fn surface(study: &Study, surface: &Surface) -> Vec<SketchMark> {
    let reached = cells(&study.reach.grid, |index| {
        (study.reach.cells[index].within > 0.5).then_some(REACHED)
    });
    let own = cells(&surface.map.grid, |index| {
        let share = surface.map.cells[index];
        match () {
            () if surface.connected[index] => Some(works()),
            () if share.within > 0.5 => Some(apart()),
            () if share.undecided > 0.1 => Some(OPEN),
            () => None,
        }
    });
    let disc = surface.disc.map(|disc| {
        let [x, y] = disc.centre_m;
        let points = (0..=96).map(|index| {
            let (sin, cos) = (f64::from(index) / 96.0 * TAU).sin_cos();
            [x + disc.radius_m * cos, y + disc.radius_m * sin]
        });
        points.collect()
    });
    let rectangle = surface.rectangle.map(|each| {
        let ([x, y], [width, height]) = (each.low_m, each.size_m);
        let (right, top) = (x + width, y + height);
        vec![[x, y], [right, y], [right, top], [x, top], [x, y]]
    });
    let lines = disc.into_iter().chain(rectangle);
    let lines = lines.map(|points| SketchMark::Line(points, INK, 1.4));
    [reached, own].into_iter().chain(lines).collect()
}

fn legend() -> Vec<Vec<(Swatch, String)>> {
    let entries = [
        (
            works(),
            "proven: reached from the start, distances kept; largest circle and rectangle in it",
        ),
        (apart(), "proven, but not connected with the start"),
        (OPEN, "undecided"),
        (
            REACHED,
            "the legs reach it at the map's angle; too near to a singularity, or beyond one",
        ),
    ];
    let rows = entries.map(|(colour, text)| vec![(Swatch::Fields(vec![colour]), text.into())]);
    rows.into()
}

/// Map with the angles that are asked for.
pub(super) fn draw(study: &Study) -> Drawn {
    let title = match study.turn_rad > 0.0 {
        false => format!(
            "workspace with the platform at {:.1}\u{b0}",
            study.alpha_rad.to_degrees()
        ),
        true => format!(
            "workspace with all angles of the platform from {:.1}\u{b0} to {:.1}\u{b0}",
            (study.alpha_rad - study.turn_rad).to_degrees(),
            (study.alpha_rad + study.turn_rad).to_degrees()
        ),
    };
    map(study, &title, surface(study, &study.work), legend())
}

/// Map with all angles.
pub(super) fn total(study: &Study) -> Drawn {
    let title = "total-orientation workspace: every angle of the platform";
    map(study, title, surface(study, &study.total), legend())
}
