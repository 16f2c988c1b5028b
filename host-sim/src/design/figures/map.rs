//! Map of the plane of D with the bases of the legs and the path of the job, and a legend below.

use crate::design::study::Study;
use trirrr_design::workspace::CellGrid;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::sketch::{Cells, Sketch, SketchMark, Swatch};
use trirrr_figures::style::{MOTORS, PATH, RGBColor, WHITE};

/// Places that all maps show.
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

/// Draws the map with the marks `under` its grid.
pub(super) fn map(
    study: &Study,
    title: &str,
    under: Vec<SketchMark>,
    legend: Vec<Vec<(Swatch, String)>>,
) -> Drawn {
    let legs = study.scene.parameters.legs.iter().zip(MOTORS).zip(1..);
    let bases = legs.flat_map(|((leg, colour), number): (_, u32)| {
        let at = leg.base_m.into();
        [
            SketchMark::Joint(at, 5.0, colour),
            SketchMark::Name(at, (9.0, -9.0), format!("A{number}")),
        ]
    });
    let path = [(WHITE, 3.2), (PATH, 1.8)];
    let path = path.map(|(colour, width)| SketchMark::Line(study.path.clone(), colour, width));
    let sketch = Sketch {
        title: format!("{}: {title}", study.scene.name),
        axes: ["x of D", "y of D"],
        side: 560.0,
        shown: shown(study),
        under,
        over: bases.chain(path).collect(),
        legend,
    };
    sketch.draw()
}

/// Cells of `grid`, with colours by their number.
pub(super) fn cells(grid: &CellGrid, colour: impl Fn(usize) -> Option<RGBColor>) -> SketchMark {
    SketchMark::Cells(Cells {
        first: grid.centre_m(0, 0),
        side: grid.cell_m,
        size: grid.size,
        colours: (0..grid.size[0] * grid.size[1]).map(colour).collect(),
    })
}
