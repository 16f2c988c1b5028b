//! Forces in the joints along the job as vectors in the axes of a link, for bearings and pins.

use crate::design::study::Study;
use std::f64::consts::TAU;
use trirrr_figures::canvas::{CENTRED, Canvas, Draw, Drawn, RIGHT_OF, Size, page};
use trirrr_figures::document::digits;
use trirrr_figures::scale::{Axis, Margin};
use trirrr_figures::style::{FRAME, GRID, INK, MOTORS};

const TOP: f64 = 96.0;
const RADIUS: f64 = 140.0;
const SLOT: f64 = 2.0 * RADIUS + 76.0;

/// Joints and the axes of their forces.
const JOINTS: [[&str; 2]; 3] = [
    ["A, on the proximal link", "along A to B"],
    ["B, on the distal link", "along A to B"],
    ["C, on the platform", "along B to C"],
];

/// Draws a polar plot for each joint, with a curve for each leg.
pub(super) fn draw(study: &Study) -> Drawn {
    let title = format!(
        "{}: forces in the joints along the job, in the axes of a link",
        study.scene.name
    );
    let width = (3.0 * SLOT + 20.0).max(Size::Title.width(&title) + 40.0);
    page(width, TOP + 2.0 * RADIUS + 90.0, |canvas| {
        canvas.text(&title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        for joint in 0..3 {
            let centre = (SLOT * (joint as f64 + 0.5) + 10.0, TOP + RADIUS);
            polar(canvas, study, joint, centre)?;
        }
        let y = TOP + 2.0 * RADIUS + 62.0;
        for (leg, colour) in MOTORS.into_iter().enumerate() {
            let x = 40.0 + 110.0 * leg as f64;
            canvas.line(&[(x, y), (x + 22.0, y)], colour, 2.5)?;
            let name = format!("leg {}", leg + 1);
            canvas.text(&name, (x + 30.0, y), Size::Label, RIGHT_OF, INK)?;
        }
        Ok(())
    })
}

fn polar(canvas: &Canvas<'_>, study: &Study, joint: usize, centre: (f64, f64)) -> Draw {
    let peak = |leg: usize| study.reactions.forces[leg][joint].peak_n;
    let most = (0..3).map(peak).fold(0.0, f64::max);
    let axis = Axis::new(0.0, most, "N", Margin::Exact, 4.0);
    let at = |along: f64, across: f64| {
        let scale = RADIUS / most.max(f64::MIN_POSITIVE);
        (centre.0 + scale * along, centre.1 - scale * across)
    };
    for (value, label) in axis.ticks.iter().filter(|(value, _)| *value > 0.0) {
        let ring: Vec<_> = (0..=72)
            .map(|step| {
                let (sin, cos) = (f64::from(step) / 72.0 * TAU).sin_cos();
                at(value * cos, value * sin)
            })
            .collect();
        canvas.line(&ring, GRID, 1.0)?;
        let (sin, cos) = (0.875 * TAU).sin_cos();
        canvas.text(
            label,
            at(value * cos, value * sin),
            Size::Tick,
            CENTRED,
            FRAME,
        )?;
    }
    let end = RADIUS + 10.0;
    let (x, y) = centre;
    canvas.arrow(&[(x - RADIUS, y), (x + end, y)], FRAME, 1.0)?;
    canvas.line(&[(x, y - RADIUS), (x, y + RADIUS)], GRID, 1.0)?;
    for (leg, colour) in MOTORS.into_iter().enumerate() {
        let vectors = study.reactions.vectors.iter();
        let points: Vec<_> = vectors
            .map(|vectors| {
                let [along, across] = vectors[leg][joint];
                at(along, across)
            })
            .collect();
        canvas.line(&points, colour, 1.8)?;
        if let Some(start) = points.first() {
            canvas.dot(*start, 3.4, colour)?;
        }
    }
    let [name, direction] = JOINTS[joint];
    let above = format!("{name} ({})", axis.unit);
    canvas.text(&above, (x, TOP - 34.0), Size::Label, CENTRED, INK)?;
    let below = format!("right: {direction}; largest {} N", digits(most));
    canvas.text(
        &below,
        (x, TOP + 2.0 * RADIUS + 20.0),
        Size::Tick,
        CENTRED,
        INK,
    )
}
