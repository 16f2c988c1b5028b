//! Error of the path in the plane: where D should be, and the error from there, magnified.

use trirrr_figures::canvas::Drawn;
use trirrr_figures::plane::View;
use trirrr_figures::sketch::{SAMPLE, Sketch, SketchMark, Swatch};
use trirrr_figures::style::{FRAME, INK, PATH};

const SIDE: f64 = 560.0;
/// Lengths of the path from one error that is drawn to the next, in logical pixels.
const APART: f64 = 14.0;
/// Size of the largest error in the figure, as a part of the path's extent.
const SHOWN: f64 = 0.12;

/// Time; x and y of the setpoint and of D.
type PathInstant = (f64, [f64; 4]);

/// Draws the error along `points`: time; x and y of the setpoint and of D, m.
pub(super) fn draw(heading: &str, points: &[PathInstant]) -> Drawn {
    let wanted = |(_, [x, y, ..]): &PathInstant| [*x, *y];
    let factor = factor(points);
    let magnified = |point: &PathInstant| {
        let ([x, y], [dx, dy]) = (wanted(point), error(point));
        [x + factor * dx, y + factor * dy]
    };
    let pairs = points.iter().map(|point| [wanted(point), magnified(point)]);
    let shown: Vec<[f64; 2]> = pairs.clone().flatten().collect();
    let apart = APART * View::around(&shown, "m", (0.0, 0.0), SIDE).pixel();
    let mut last: Option<[f64; 2]> = None;
    let errors = pairs.filter(|[from, _]| {
        let is_drawn =
            last.is_none_or(|last| size([last[0] - from[0], last[1] - from[1]]) >= apart);
        last = if is_drawn { Some(*from) } else { last };
        is_drawn
    });
    let mut over: Vec<SketchMark> = errors
        .map(|pair| SketchMark::Line(pair.into(), FRAME, 1.0))
        .collect();
    over.push(SketchMark::Line(
        points.iter().map(magnified).collect(),
        PATH,
        1.8,
    ));
    over.push(SketchMark::Dashes(
        points.iter().map(wanted).collect(),
        INK,
        1.6,
    ));
    let most = points
        .iter()
        .map(|point| size(error(point)))
        .fold(0.0, f64::max);
    let most = trirrr_figures::document::digits(1e3 * most);
    let legend = [
        (Swatch::Dashes(INK, 1.6), "setpoint of D".into()),
        (
            Swatch::Line(PATH, 1.8, SAMPLE),
            "D in the plant, with its error magnified".into(),
        ),
        (
            Swatch::Line(FRAME, 1.0, SAMPLE),
            format!("error, at most {most} mm"),
        ),
    ];
    let sketch = Sketch {
        title: format!("{heading}: error of D along its path, {factor} times as large"),
        axes: ["x of D", "y of D"],
        side: SIDE,
        shown,
        under: Vec::new(),
        over,
        legend: legend.map(|entry| vec![entry]).into(),
    };
    sketch.draw()
}

fn error((_, [xd, yd, x, y]): &PathInstant) -> [f64; 2] {
    [x - xd, y - yd]
}

fn size([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

/// Factor of 1, 2 or 5 times a power of ten that shows the largest error; 1 without an error.
fn factor(points: &[PathInstant]) -> f64 {
    let sizes = points.iter().map(|point| size(error(point)));
    let most = sizes.fold(0.0, f64::max);
    let extent = |index: usize| {
        let (low, high) =
            trirrr_figures::panel::range(points.iter().map(|(_, values)| values[index]));
        high - low
    };
    let wanted = SHOWN * f64::max(extent(0), extent(1)) / most;
    if !wanted.is_finite() || wanted <= 1.0 {
        return 1.0;
    }
    let power = 10f64.powi(wanted.log10().floor() as i32);
    let mantissa = [5.0, 2.0, 1.0]
        .into_iter()
        .find(|mantissa| mantissa * power <= wanted);
    mantissa.unwrap_or(1.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_is_round_and_said() {
        let path = |error: f64| -> Vec<(f64, [f64; 4])> {
            (0..50)
                .map(|index| {
                    let x = 0.01 * f64::from(index);
                    (x, [x, 0.1, x, 0.1 + error])
                })
                .collect()
        };
        // 0.12 of 0.49 m is 588 times 0.1 mm.
        assert_eq!(factor(&path(1e-4)), 500.0);
        assert_eq!(
            [factor(&path(0.0)), factor(&path(1.0)), factor(&[])],
            [1.0; 3]
        );
        let drawn = draw("job", &path(1e-4)).unwrap();
        assert!(drawn.contains("500 times as large") && drawn.contains("at most 0.1000 mm"));
        assert!(draw("job", &[]).unwrap().ends_with("</svg>\n"));
    }
}
