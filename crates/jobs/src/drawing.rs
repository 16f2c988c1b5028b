//! Drawings on a machine: pens, and the place.

use crate::fit::{Fitted, fit};
use crate::options::DrawingOptions;
use trirrr_scene::Scene;
use trirrr_scene::words::six_digits;
use trirrr_toolpath::drawing::{Drawing, DrawingSetup, Kerf, OffTravel};
use trirrr_toolpath::{PathFault, PathRemark, ToolPlace};

/// Drawing of a file, and its place on a machine.
pub struct PlacedDrawing {
    /// Strokes, in the order in which they are drawn.
    pub drawing: Drawing,
    /// Pens and place.
    pub setup: DrawingSetup,
    /// Place that was found for it.
    pub fitted: Option<Fitted>,
    /// Ways with the tool off, m in the drawing.
    pub travel: OffTravel,
}

impl PlacedDrawing {
    /// Size and place of the drawing on the machine, in words.
    pub fn extent(&self) -> Option<String> {
        let [low, high] = self.drawing.bounds_m()?;
        let [x, y] = self.setup.origin.position_m;
        let scale = self.setup.scale;
        let on_machine = |[u, v]: [f64; 2]| [x + scale * u, y + scale * v];
        let mm = |metres: f64| six_digits(1e3 * metres);
        let [[left, lower], [right, upper]] = [on_machine(low), on_machine(high)];
        let hint = match self.fitted {
            Some(_) => "",
            None => "; --fit finds it a place and a size",
        };
        Some(format!(
            "the drawing is {} by {} mm on the machine, from {},{} to {},{}{hint}",
            mm(right - left),
            mm(upper - lower),
            mm(left),
            mm(lower),
            mm(right),
            mm(upper)
        ))
    }
}

fn counted(count: usize, one: &str, more: &str) -> String {
    let thing = if count == 1 { one } else { more };
    format!("{count} {thing}")
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
pub fn place(
    mut drawing: Drawing,
    scene: &Scene,
    origin_m: [f64; 2],
    options: &DrawingOptions,
) -> Result<PlacedDrawing, PathFault> {
    let feed_m_s = options.speed_m_s.ok_or_else(|| {
        fault("a drawing has no speed: add --speed MM_PER_MIN, the speed along its strokes".into())
    })?;
    let (pen, pens) = options.all_pens(feed_m_s);
    let start = &scene.job.start;
    let mut setup = DrawingSetup {
        origin: ToolPlace {
            position_m: origin_m,
            alpha_rad: start.angle,
        },
        scale: options.scale.unwrap_or(1.0),
        pen,
        pens,
    };
    drawing.leave_out(&setup);
    if drawing.strokes.is_empty() {
        return Err(fault("every stroke is left out".into()));
    }
    if let Some((count, place)) = drawing.doubles(options.drop_doubles) {
        let lines = counted(count, "line or curve", "lines and curves");
        let (verb, rest) = match (count, options.drop_doubles) {
            (1, false) => ("lies", "and is drawn again: --drop-doubles leaves it out"),
            (1, true) => ("lies", "and is left out"),
            (_, false) => ("lie", "and are drawn again: --drop-doubles leaves them out"),
            (_, true) => ("lie", "and are left out"),
        };
        let text = format!(
            "{lines} {verb} on others of the same layer and colour, the first of {place}, {rest}"
        );
        drawing.remarks.push(PathRemark::new(0, text));
    }
    let mut fitted = None;
    if options.fit {
        let bounds = drawing
            .bounds_m()
            .ok_or_else(|| fault("nothing is drawn".into()))?;
        let Fitted { scale, origin_m } = *fitted.insert(fit(bounds, 0.0, setup.scale, scene)?);
        (setup.scale, setup.origin.position_m) = (scale, origin_m);
    }
    if let Some(kerf) = &options.kerf {
        beside(&mut drawing, kerf, setup.scale)?;
    }
    // After the scale is known: lines have their distance on the machine.
    if let Some(pitch_m) = options.hatch_m {
        drawing.fill(pitch_m / setup.scale)?;
    }
    let [x, y] = setup.origin.position_m;
    let at = [start.position.x - x, start.position.y - y];
    let travel = drawing.order(at.map(|distance| distance / setup.scale));
    Ok(PlacedDrawing {
        drawing,
        setup,
        fitted,
        travel,
    })
}

/// Moves the closed outlines of a drawing; its lengths are `scale` times as long on the machine.
#[cfg(feature = "offset")]
fn beside(drawing: &mut Drawing, kerf: &Kerf, scale: f64) -> Result<(), PathFault> {
    drawing.offset(&Kerf {
        offset_m: kerf.offset_m / scale,
        lead_m: kerf.lead_m / scale,
    })?;
    match drawing.strokes.is_empty() {
        true => Err(fault(
            "--offset: nothing is left: every outline is narrower".into(),
        )),
        false => Ok(()),
    }
}

#[cfg(not(feature = "offset"))]
fn beside(_: &mut Drawing, _: &Kerf, _: f64) -> Result<(), PathFault> {
    Err(fault("--offset and --lead are in trirrr-full alone".into()))
}
