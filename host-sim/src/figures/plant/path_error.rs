//! Error of the path in the plane: where D should be, and the error from there, magnified.

use trirrr_figures::canvas::{CENTRED, Drawn, RIGHT_OF, Size, page};
use trirrr_figures::plane::View;
use trirrr_figures::style::{FRAME, INK, PATH};

const LEFT: f64 = 84.0;
const TOP: f64 = 56.0;
const BOTTOM: f64 = 136.0;
const SIDE: f64 = 560.0;
/// Lengths of the path from one error that is drawn to the next, in logical pixels.
const APART: f64 = 14.0;
/// Size of the largest error in the figure, as a part of the path's extent.
const SHOWN: f64 = 0.12;

/// Time; x and y of the setpoint and of D.
type PathInstant = (f64, [f64; 4]);

/// Draws the error along `points`: time; x and y of the setpoint and of D, m.
pub(super) fn draw(heading: &str, points: &[(f64, [f64; 4])]) -> Drawn {
    let wanted = |(_, [x, y, ..]): &(f64, [f64; 4])| [*x, *y];
    let error = |(_, [xd, yd, x, y]): &(f64, [f64; 4])| [x - xd, y - yd];
    let factor = factor(points);
    let magnified = |point: &(f64, [f64; 4])| {
        let ([x, y], [dx, dy]) = (wanted(point), error(point));
        [x + factor * dx, y + factor * dy]
    };
    let shown: Vec<[f64; 2]> = points
        .iter()
        .flat_map(|point| [wanted(point), magnified(point)])
        .collect();
    let view = View::around(&shown, "m", (LEFT, TOP), SIDE);
    let title = format!("{heading}: error of D along its path, {factor} times as large");
    let width = (LEFT + view.width + 40.0)
        .max(Size::Title.width(&title) + 40.0)
        .max(560.0);
    page(width, TOP + view.height + BOTTOM, |canvas| {
        canvas.text(&title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        view.grid(canvas, ["x of D", "y of D"])?;
        let mut last: Option<(f64, f64)> = None;
        for point in points {
            let [from, to] = [wanted(point), magnified(point)].map(|place| view.at(place));
            if last.is_none_or(|last| (last.0 - from.0).hypot(last.1 - from.1) >= APART) {
                canvas.line(&[from, to], FRAME, 1.0)?;
                last = Some(from);
            }
        }
        let line = |place: &dyn Fn(&PathInstant) -> [f64; 2]| -> Vec<(f64, f64)> {
            points.iter().map(|point| view.at(place(point))).collect()
        };
        canvas.line(&line(&magnified), PATH, 1.8)?;
        canvas.dashes(&line(&wanted), INK, 1.6)?;
        let top = TOP + view.height + 68.0;
        let text = |row: f64, text: &str| {
            let at = (LEFT + 42.0, top + 20.0 * row);
            canvas.text(text, at, Size::Tick, RIGHT_OF, INK)
        };
        canvas.dashes(&[(LEFT, top), (LEFT + 32.0, top)], INK, 1.6)?;
        text(0.0, "setpoint of D")?;
        let y = top + 20.0;
        canvas.line(&[(LEFT, y), (LEFT + 32.0, y)], PATH, 1.8)?;
        text(1.0, "D in the plant, with its error magnified")?;
        let y = top + 40.0;
        canvas.line(&[(LEFT, y), (LEFT + 32.0, y)], FRAME, 1.0)?;
        let most = points
            .iter()
            .map(|point| size(error(point)))
            .fold(0.0, f64::max);
        let most = trirrr_figures::document::digits(1e3 * most);
        text(2.0, &format!("error, at most {most} mm"))
    })
}

fn size([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

/// Factor of 1, 2 or 5 times a power of ten that shows the largest error; 1 without an error.
fn factor(points: &[(f64, [f64; 4])]) -> f64 {
    let most = points
        .iter()
        .map(|(_, [xd, yd, x, y])| size([x - xd, y - yd]))
        .fold(0.0, f64::max);
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
