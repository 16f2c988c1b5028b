//! Drawings on a machine: pens, and the place.

use super::DrawingArgs;
use trirrr_core::setpoint::Pose;
use trirrr_scene::{ReachMap, Scene};
use trirrr_toolpath::drawing::{Drawing, DrawingSetup};
use trirrr_toolpath::{PathFault, ToolPlace};

/// Part of the room that a drawing takes: between the nodes of the map nothing is known.
const PART_OF_ROOM: f64 = 0.98;

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

/// Places `drawing` on the machine of `scene`, with its zero point at `origin_m` if that is given.
///
/// # Errors
/// The drawing is left out, has no feed, or the machine has no room for it.
pub(super) fn place(
    mut drawing: Drawing,
    scene: &Scene,
    origin_m: Option<[f64; 2]>,
    args: &DrawingArgs,
) -> Result<PlacedDrawing, PathFault> {
    let feed_m_s = args.speed_m_s().ok_or_else(|| {
        fault("a drawing has no speed: add --speed MM_PER_MIN, the speed along its strokes".into())
    })?;
    let (pen, pens) = args.pens(feed_m_s);
    let start = &scene.job.start;
    let mut setup = DrawingSetup {
        origin: ToolPlace {
            position_m: origin_m.unwrap_or_default(),
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
        fit(&drawing, &mut setup, scene, start)?;
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

/// Puts a drawing where the machine has the most room for its shape.
fn fit(
    drawing: &Drawing,
    setup: &mut DrawingSetup,
    scene: &Scene,
    start: &Pose<f64>,
) -> Result<(), PathFault> {
    let map = ReachMap::new(scene, start).map_err(|error| fault(error.to_string()))?;
    let no_room = || {
        fault(
            "--fit: the machine has no room for a thousandth of the drawing, or nothing is drawn"
                .into(),
        )
    };
    let [low, high] = drawing.bounds_m().ok_or_else(no_room)?;
    let size_m = [high[0] - low[0], high[1] - low[1]];
    let room = map.room(size_m).ok_or_else(no_room)?;
    // In the digits that the user is told: with these the same job comes again.
    let scale = setup.scale.min(PART_OF_ROOM * room.factor);
    setup.scale = (1e4 * scale).floor() / 1e4;
    if setup.scale < 1e-3 {
        return Err(no_room());
    }
    setup.origin.position_m = [0, 1].map(|axis| {
        let metres = room.centre_m[axis] - 0.5 * setup.scale * (low[axis] + high[axis]);
        1e-3 * ((1e6 * metres).round() / 1e3)
    });
    Ok(())
}
