//! Maps of where the machine works, with one angle of the platform and with all.

use super::map::{cells, entry, map};
use crate::design::study::{Study, Surface};
use trirrr_figures::canvas::{Canvas, Draw, Drawn};
use trirrr_figures::plane::View;
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

/// Colours the cells of `surface`, with its largest circle and rectangle.
fn surface(study: &Study, surface: &Surface, canvas: &Canvas<'_>, view: &View) -> Draw {
    let grid = &surface.map.grid;
    cells(canvas, view, &study.reach.grid, |index| {
        (study.reach.cells[index].within > 0.5).then_some(REACHED)
    })?;
    cells(canvas, view, grid, |index| {
        let share = surface.map.cells[index];
        match () {
            () if surface.connected[index] => Some(works()),
            () if share.within > 0.5 => Some(apart()),
            () if share.undecided > 0.1 => Some(OPEN),
            () => None,
        }
    })?;
    if let Some(disc) = surface.disc {
        let points: Vec<_> = (0..=96)
            .map(|index| {
                let (sin, cos) = (f64::from(index) / 96.0 * std::f64::consts::TAU).sin_cos();
                let [x, y] = disc.centre_m;
                view.at([x + disc.radius_m * cos, y + disc.radius_m * sin])
            })
            .collect();
        canvas.line(&points, INK, 1.4)?;
    }
    if let Some(each) = surface.rectangle {
        let ([x, y], [width, height]) = (each.low_m, each.size_m);
        let corners = [
            [x, y],
            [x + width, y],
            [x + width, y + height],
            [x, y + height],
            [x, y],
        ];
        canvas.line(&corners.map(|corner| view.at(corner)), INK, 1.4)?;
    }
    Ok(())
}

fn legend(canvas: &Canvas<'_>, top: f64) -> Draw {
    for (row, colour, text) in [
        (
            0.0,
            works(),
            "proven: reached from the start, distances kept; largest circle and rectangle in it",
        ),
        (1.0, apart(), "proven, but not connected with the start"),
        (2.0, OPEN, "undecided"),
        (
            3.0,
            REACHED,
            "the legs reach it at the map's angle; too near to a singularity, or beyond one",
        ),
    ] {
        entry(canvas, top, row, colour, text)?;
    }
    Ok(())
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
    map(
        study,
        &title,
        |canvas, view| surface(study, &study.work, canvas, view),
        legend,
    )
}

/// Map with all angles.
pub(super) fn total(study: &Study) -> Drawn {
    map(
        study,
        "total-orientation workspace: every angle of the platform",
        |canvas, view| surface(study, &study.total, canvas, view),
        legend,
    )
}
