//! DXF files, as CAD programs write them.

mod colour;
mod curves;
mod names;
mod place;
mod reader;
mod spline;

use super::join::join;
use super::{Area, Drawing, Stroke};
use crate::PathFault;
use colour::layer_look;
use encoding_rs::{UTF_8, WINDOWS_1252};
use names::Names;
use place::Affine;
use reader::{Frame, Reader};
use std::collections::HashMap;
use std::io::Cursor;

/// Distance of two ends, m, that are one place.
const MEETING_M: f64 = 1e-6;

/// Reads a DXF file with text in ASCII, Latin or UTF-8. Lengths are in the unit that the file names, or else in
/// millimetres, and the zero point is that of the file. Lines, polylines, arcs, circles, ellipses, splines, solids and
/// inserted blocks are drawn as they look from above; lines and arcs that meet become one stroke. Left out are
/// the layers of `left_out`, those that are off or not plotted, what is invisible, and the paper space.
///
/// # Errors
/// No DXF file, a damaged one, a unit beyond workshops, nothing to draw, or an entity that cannot be drawn, with its
/// line: text, dimensions, hatches, points, surfaces, what is tilted out of the plane.
pub fn read_dxf(bytes: &[u8], left_out: impl Fn(&str) -> bool) -> Result<Drawing, PathFault> {
    if bytes.starts_with(b"AutoCAD Binary DXF") || bytes.starts_with(b"AC10") {
        return Err(fault(
            0,
            "",
            "a binary drawing; save it as DXF with text (ASCII)",
        ));
    }
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => WINDOWS_1252.decode(bytes).0,
    };
    let names = Names::read(&text)?;
    let file = dxf::Drawing::load_with_encoding(&mut Cursor::new(text.as_bytes()), UTF_8)
        .map_err(|error| fault(0, "", &format!("no DXF file: {error}")))?;
    let unit_m = unit_m(file.header.default_drawing_units)?;
    let layers = file.layers().map(layer_look).collect();
    let mut reader = Reader {
        file: &file,
        names: &names,
        layers,
        left_out: &left_out,
        drawing: Drawing::default(),
    };
    reader.add(
        file.entities(),
        &names.entities,
        &Frame::whole(Affine::scale(unit_m)),
    )?;
    let mut drawing = reader.drawing;
    let shapes = std::mem::take(&mut drawing.shapes);
    drawing.strokes = join(drawing.strokes, MEETING_M, |stroke| {
        (stroke.colour, shapes[stroke.shape].layer.as_str())
    });
    drawing.shapes = shapes;
    drawing.areas = areas(&drawing);
    match drawing.strokes.is_empty() {
        true => Err(fault(0, "", "nothing in the file is drawn")),
        false => Ok(drawing),
    }
}

pub(super) fn fault(line: u32, word: &str, reason: &str) -> PathFault {
    PathFault {
        line,
        word: word.to_owned(),
        reason: reason.to_owned(),
    }
}

/// Length of a unit of the file, m.
fn unit_m(unit: dxf::enums::Units) -> Result<f64, PathFault> {
    use dxf::enums::Units as U;
    Ok(match unit {
        U::Unitless | U::Millimeters => 1e-3,
        U::Inches => 0.0254,
        U::Feet => 0.3048,
        U::Yards => 0.9144,
        U::Mils => 2.54e-5,
        U::Microns => 1e-6,
        U::Centimeters => 1e-2,
        U::Decimeters => 0.1,
        U::Meters => 1.0,
        other => {
            let reason = format!("a drawing in {other:?}; save it in millimetres or inches");
            return Err(fault(0, "$INSUNITS", &reason));
        }
    })
}

/// Area inside the closed strokes of each layer and colour: places that an odd number of them surround.
fn areas(drawing: &Drawing) -> Vec<Area> {
    let mut areas: Vec<Area> = Vec::new();
    let mut known = HashMap::new();
    for stroke in drawing.strokes.iter().filter(|stroke| is_closed(stroke)) {
        let layer = drawing.shapes[stroke.shape].layer.as_str();
        let index = *known.entry((stroke.colour, layer)).or_insert(areas.len());
        if index == areas.len() {
            areas.push(Area {
                shape: stroke.shape,
                colour: stroke.colour,
                non_zero: false,
                outlines: Vec::new(),
                clips: Vec::new(),
                stroked: true,
            });
        }
        areas[index].outlines.push(stroke.clone());
    }
    areas
}

fn is_closed(stroke: &Stroke) -> bool {
    let (from, to) = (stroke.start, stroke.end());
    libm::hypot(from[0] - to[0], from[1] - to[1]) <= MEETING_M
}
