//! Drawings on a machine: pens, and the place.

use super::DrawingArgs;
use super::fit::{Fitted, fit};
use trirrr_scene::Scene;
use trirrr_toolpath::drawing::{Drawing, DrawingSetup};
use trirrr_toolpath::{PathFault, ToolPlace};

/// Drawing of a file, and its place on a machine.
pub(super) struct PlacedDrawing {
    pub(super) drawing: Drawing,
    pub(super) setup: DrawingSetup,
}

fn fault(reason: String) -> PathFault {
    PathFault {
        line: 0,
        word: String::new(),
        reason,
    }
}

/// Places `drawing` on the machine of `scene`, with its zero point at `origin_m`, or where it fits.
///
/// # Errors
/// The drawing is left out, has no feed, or the machine has no room for it.
pub(super) fn place(
    mut drawing: Drawing,
    scene: &Scene,
    origin_m: [f64; 2],
    args: &DrawingArgs,
) -> Result<PlacedDrawing, PathFault> {
    let feed_m_s = args.speed_m_s().ok_or_else(|| {
        fault("a drawing has no speed: add --speed MM_PER_MIN, the speed along its strokes".into())
    })?;
    let (pen, pens) = args.pens(feed_m_s);
    let start = &scene.job.start;
    let mut setup = DrawingSetup {
        origin: ToolPlace {
            position_m: origin_m,
            alpha_rad: start.angle,
        },
        scale: args.scale.unwrap_or(1.0),
        pen,
        pens,
    };
    drawing.leave_out(&setup);
    if drawing.strokes.is_empty() {
        return Err(fault("every stroke is left out".into()));
    }
    if args.fit {
        let bounds = drawing
            .bounds_m()
            .ok_or_else(|| fault("nothing is drawn".into()))?;
        let Fitted { scale, origin_m } = fit(bounds, 0.0, setup.scale, scene)?;
        (setup.scale, setup.origin.position_m) = (scale, origin_m);
    }
    // After the scale is known: lines have their distance on the machine.
    if let Some(pitch_mm) = args.hatch {
        drawing.fill(1e-3 * pitch_mm / setup.scale)?;
    }
    let [x, y] = setup.origin.position_m;
    let at = [start.position.x - x, start.position.y - y];
    drawing.order(at.map(|distance| distance / setup.scale));
    Ok(PlacedDrawing { drawing, setup })
}
