//! Peak torques of the working modes, side by side.

use crate::design::study::{Study, largest};
use trirrr_figures::canvas::{BELOW, CENTRED, Drawn, RIGHT_OF, Size, page};
use trirrr_figures::document::digits;
use trirrr_figures::style::{FRAME, INK, LIMIT, MOTORS};

const LEFT: f64 = 40.0;
const TOP: f64 = 82.0;

/// Draws a bar for each motor in each mode.
pub(super) fn draw(study: &Study) -> Drawn {
    let most = study
        .modes
        .iter()
        .filter(|row| row.is_feasible())
        .filter_map(|row| row.result.figures)
        .map(|figures| largest(figures.torque_peak_nm))
        .fold(1e-12, f64::max);
    let title = format!(
        "{}: peak torque of the eight working modes",
        study.scene.name
    );
    let (height, slot) = (220.0, 92.0);
    let width = (LEFT + 8.0 * slot + 30.0).max(Size::Title.width(&title) + 40.0);
    page(width, TOP + height + 70.0, |canvas| {
        canvas.text(&title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        for (motor, colour) in MOTORS.into_iter().enumerate() {
            let x = LEFT + 110.0 * motor as f64;
            canvas.line(&[(x, 54.0), (x + 22.0, 54.0)], colour, 6.0)?;
            let name = format!("motor {}", motor + 1);
            canvas.text(&name, (x + 30.0, 54.0), Size::Label, RIGHT_OF, INK)?;
        }
        let floor = TOP + height;
        let ends = [(LEFT - 10.0, floor), (LEFT + 8.0 * slot, floor)];
        canvas.line(&ends, FRAME, 1.2)?;
        for (index, row) in study.modes.iter().enumerate() {
            let left = LEFT + slot * index as f64;
            let text = |text: &str, y: f64, size, anchor, colour| {
                canvas.text(text, (left + 30.0, y), size, anchor, colour)
            };
            let name = row.result.name().replace('-', "\u{2212}");
            text(&name, floor + 8.0, Size::Label, BELOW, INK)?;
            let (Some(figures), true) = (row.result.figures, row.is_feasible()) else {
                text("refused", floor - 12.0, Size::Tick, CENTRED, LIMIT)?;
                continue;
            };
            for (motor, colour) in MOTORS.into_iter().enumerate() {
                let torque = figures.torque_peak_nm[motor];
                let (from, top) = (
                    left + 20.0 * motor as f64,
                    floor - (height - 30.0) * torque / most,
                );
                let corners = [
                    (from, floor),
                    (from + 16.0, floor),
                    (from + 16.0, top),
                    (from, top),
                ];
                canvas.polygon(&corners, colour)?;
            }
            let peak = digits(largest(figures.torque_peak_nm));
            let peak = format!("{peak} N m");
            text(&peak, floor + 30.0, Size::Tick, BELOW, INK)?;
        }
        Ok(())
    })
}
