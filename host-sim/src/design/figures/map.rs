//! Page of a map: a window on the plane of D with the bases of the legs and the path of the job, and a legend below.

use crate::design::study::Study;
use trirrr_design::workspace::CellGrid;
use trirrr_figures::canvas::{CENTRED, Canvas, Draw, Drawn, RIGHT_OF, Size, page};
use trirrr_figures::plane::View;
use trirrr_figures::style::{INK, MOTORS, PATH, RGBColor, WHITE};

/// Left edge of the window, and of the legend.
pub(super) const LEFT: f64 = 84.0;
const TOP: f64 = 56.0;
const BOTTOM: f64 = 150.0;
const SIDE: f64 = 560.0;

/// Points that all maps show.
fn shown(study: &Study) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = study.path.clone();
    let bases = study.scene.parameters.legs.iter();
    points.extend(bases.map(|leg| <[f64; 2]>::from(leg.base_m)));
    let grid = &study.reach.grid;
    for row in 0..grid.size[1] {
        for column in 0..grid.size[0] {
            if study.reach.cells[row * grid.size[0] + column].within > 0.0 {
                points.push(grid.centre_m(column, row));
            }
        }
    }
    points
}

/// A page with a map, a legend below it, and the bases of the legs in it.
pub(super) fn map(
    study: &Study,
    title: &str,
    draw: impl FnOnce(&Canvas<'_>, &View) -> Draw,
    legend: impl FnOnce(&Canvas<'_>, f64) -> Draw,
) -> Drawn {
    let view = View::around(&shown(study), "m", (LEFT, TOP), SIDE);
    let title = format!("{}: {title}", study.scene.name);
    let width = (LEFT + view.width + 40.0)
        .max(Size::Title.width(&title) + 40.0)
        .max(680.0);
    page(width, TOP + view.height + BOTTOM, |canvas| {
        canvas.text(&title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        draw(canvas, &view)?;
        view.grid(canvas, ["x of D", "y of D"])?;
        for (index, leg) in study.scene.parameters.legs.iter().enumerate() {
            let (x, y) = view.at(leg.base_m.into());
            canvas.joint((x, y), 5.0, MOTORS[index])?;
            let name = format!("A{}", index + 1);
            canvas.text(&name, (x + 9.0, y - 9.0), Size::Tick, RIGHT_OF, INK)?;
        }
        let path: Vec<_> = study.path.iter().map(|point| view.at(*point)).collect();
        canvas.line(&path, WHITE, 3.2)?;
        canvas.line(&path, PATH, 1.8)?;
        legend(canvas, TOP + view.height + 66.0)
    })
}

/// Cells of `grid`, with colours by their number.
pub(super) fn cells(
    canvas: &Canvas<'_>,
    view: &View,
    grid: &CellGrid,
    colour: impl Fn(usize) -> Option<RGBColor>,
) -> Draw {
    view.cells(
        canvas,
        (grid.size, grid.cell_m),
        |column, row| grid.centre_m(column, row),
        |column, row| colour(row * grid.size[0] + column),
    )
}

/// A field of a colour from `(left, middle)` on, `width` wide.
pub(super) fn field(
    canvas: &Canvas<'_>,
    (left, middle): (f64, f64),
    width: f64,
    colour: RGBColor,
) -> Draw {
    let (right, top, bottom) = (left + width, middle - 6.0, middle + 6.0);
    let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
    canvas.polygon(&corners, colour)
}

/// Line of a legend: a colour and its meaning.
pub(super) fn entry(canvas: &Canvas<'_>, top: f64, row: f64, colour: RGBColor, text: &str) -> Draw {
    let y = top + 20.0 * row;
    field(canvas, (LEFT, y), 30.0, colour)?;
    canvas.text(text, (LEFT + 42.0, y), Size::Tick, RIGHT_OF, INK)
}
