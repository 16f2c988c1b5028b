//! DXF files, as CAD programs write them.

mod colour;
mod courses;
mod curves;
mod fit;
mod names;
mod place;
mod reader;
mod spline;
mod text;

use super::doubles::take_doubles;
use super::join::join;
use super::{Area, Drawing, Stroke};
use crate::{PathFault, PathRemark, short, six};
use colour::layer_look;
use encoding_rs::UTF_8;
use names::Names;
use place::Affine;
use reader::{Frame, Reader, ToldEntities};
use std::collections::HashMap;
use std::io::Cursor;
use text::{text_of, with_heights};

/// Distance of two ends, m, that are one place.
const MEETING_M: f64 = 1e-6;

/// Choices that a DXF file leaves to its user.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DxfChoices {
    /// Layers that are left out.
    pub layers: Vec<String>,
    /// Kinds of entities that are left out, by their names in the file (`TEXT`), in letters of any case.
    pub kinds: Vec<String>,
    /// Length of a unit, m, in place of the one that the file names.
    pub unit_m: Option<f64>,
}

impl DxfChoices {
    fn leaves_out(&self, layer: &str, kind: &str) -> bool {
        self.layers.iter().any(|name| name == layer)
            || self
                .kinds
                .iter()
                .any(|name| name.eq_ignore_ascii_case(kind))
    }
}

/// Largest side of a drawing, and distance from its zero point, m.
const LARGEST_M: f64 = 1e3;

/// Reads a DXF file with text in ASCII, Latin, UTF-8 or UTF-16. Lengths are in the unit of the user's choice, or in that of the file, or
/// else in millimetres, and the zero point is that of the file. Lines, polylines, arcs, circles, ellipses, splines, solids and
/// inserted blocks are drawn as they look from above; lines and arcs that meet become one stroke. Left out are
/// the layers and kinds of the user's choice, layers that are off, frozen or not plotted, what is invisible, and the paper space; and with a
/// remark what is no line: text, dimensions, hatches, points, surfaces.
///
/// # Errors
/// No DXF file, a damaged one, a drawing beyond workshops, nothing to draw, or an entity that cannot be drawn, with its
/// line: what is tilted out of the plane, or of a kind that is not known.
pub fn read_dxf(bytes: &[u8], choices: &DxfChoices) -> Result<Drawing, PathFault> {
    if bytes.starts_with(b"AutoCAD Binary DXF") || bytes.starts_with(b"AC10") {
        return Err(fault(
            0,
            "",
            "a binary drawing; save it as DXF with text (ASCII)",
        ));
    }
    let text = text_of(bytes);
    let names = Names::read(&text)?;
    let padded = with_heights(&text);
    let file = dxf::Drawing::load_with_encoding(&mut Cursor::new(padded.as_bytes()), UTF_8)
        .map_err(|error| {
            // The library may quote the file.
            let error: String = error.to_string().chars().take(120).collect();
            fault(0, "", &format!("no DXF file: {error}"))
        })?;
    let unit = match choices.unit_m {
        Some(length_m) => FileUnit {
            length_m,
            origin: "by --unit",
        },
        None => unit_of(file.header.default_drawing_units)?,
    };
    let layers = file.layers().map(|layer| layer_look(layer, &names));
    let mut reader = Reader {
        file: &file,
        names: &names,
        layers: layers.collect(),
        choices,
        drawing: Drawing::default(),
        told: ToldEntities::default(),
    };
    let whole = Frame::whole(Affine::scale(unit.length_m));
    reader.add(file.entities(), &names.entities, &whole)?;
    let Reader {
        mut drawing, told, ..
    } = reader;
    if drawing.strokes.is_empty() {
        return Err(told.nothing());
    }
    check_size(&drawing, &unit)?;
    told.say(&mut drawing);
    let shapes = std::mem::take(&mut drawing.shapes);
    let layer = |stroke: &Stroke| shapes[stroke.shape].layer.as_str();
    // A double would be joined to the stroke that it lies on.
    let doubles = take_doubles(&mut drawing.strokes, layer);
    let [strokes, doubles] = [std::mem::take(&mut drawing.strokes), doubles]
        .map(|strokes| join(strokes, MEETING_M, |stroke| (stroke.colour, layer(stroke))));
    drawing.shapes = shapes;
    drawing.strokes = strokes;
    drawing.areas = areas(&drawing);
    drawing.strokes.extend(doubles);
    Ok(drawing)
}

/// Refuses a drawing that no workshop has room for: its unit is another one.
fn check_size(drawing: &Drawing, unit: &FileUnit) -> Result<(), PathFault> {
    let Some([low, high]) = drawing.bounds_m() else {
        return Ok(());
    };
    let size = [high[0] - low[0], high[1] - low[1]];
    let sides = |factor: f64, name: &str| {
        let [width, height] = size.map(|side| side * factor);
        format!("{} by {} {name}", six(width), six(height))
    };
    if size[0].max(size[1]) > LARGEST_M {
        let reason = format!(
            "the drawing is {} large, with {} a unit {}; if its numbers are millimetres, --unit mm makes it {}",
            sides(1.0, "m"),
            length(unit.length_m),
            unit.origin,
            sides(1.0 / unit.length_m, "mm")
        );
        return Err(fault(0, "", &reason));
    }
    let far = [low, high]
        .iter()
        .flatten()
        .fold(0.0_f64, |far, value| far.max(value.abs()));
    if far > LARGEST_M {
        let reason = format!(
            "the drawing is {} large and lies {} m from its zero point; move it there in the CAD program",
            sides(1e3, "mm"),
            six(far)
        );
        return Err(fault(0, "", &reason));
    }
    Ok(())
}

fn length(metres: f64) -> String {
    match metres < 1.0 {
        true => format!("{} mm", six(1e3 * metres)),
        false => format!("{} m", six(metres)),
    }
}

impl ToldEntities {
    /// Refusal of a file in which nothing is drawn: the first entity that is no line.
    fn nothing(&self) -> PathFault {
        let first = self.left_out.iter().min_by_key(|(_, (_, line, _))| *line);
        match first {
            Some((kind, (_, line, reason))) => fault(*line, kind, reason),
            None => fault(0, "", "nothing in the file is drawn"),
        }
    }

    /// Remarks about what was left out, or is drawn otherwise.
    fn say(&self, drawing: &mut Drawing) {
        let mut say = |line: u32, text: String| drawing.remarks.push(PathRemark::new(line, text));
        for (kind, (count, line, reason)) in &self.left_out {
            let small = kind.to_lowercase();
            say(
                *line,
                format!(
                    "{} left out: {reason}; --leave-out {small} leaves it out without a word",
                    times(*count, ["entity", "entities"], &format!(" {kind}"))
                ),
            );
        }
        for (kind, (count, line)) in &self.dashed {
            say(
                *line,
                format!(
                    "the gaps of line type {kind} are not drawn: {} drawn as whole lines",
                    times(*count, ["stroke", "strokes"], "")
                ),
            );
        }
        if let (count @ 1.., line) = self.points {
            say(
                line,
                format!(
                    "{} left out",
                    times(count, ["line", "lines"], " of no length")
                ),
            );
        }
    }
}

/// Number of things, their name behind it, and the verb.
fn times(count: usize, thing: [&str; 2], name: &str) -> String {
    match count {
        1 => format!("1 {}{name} is", thing[0]),
        count => format!("{count} {}{name} are", thing[1]),
    }
}

pub(super) fn fault(line: u32, word: &str, reason: &str) -> PathFault {
    PathFault {
        line,
        word: short(word),
        reason: reason.to_owned(),
    }
}

/// FileUnit of a drawing.
struct FileUnit {
    length_m: f64,
    /// Words for where it is from.
    origin: &'static str,
}

/// FileUnit that the file names.
fn unit_of(unit: dxf::enums::Units) -> Result<FileUnit, PathFault> {
    use dxf::enums::Units as U;
    let length_m = match unit {
        U::Unitless => {
            return Ok(FileUnit {
                length_m: 1e-3,
                origin: "as the file names none",
            });
        }
        U::Millimeters => 1e-3,
        U::Inches => 0.0254,
        U::Feet => 0.3048,
        U::Yards => 0.9144,
        U::Miles => 1609.344,
        U::Mils => 2.54e-5,
        U::Microinches => 2.54e-8,
        U::Angstroms => 1e-10,
        U::Nanometers => 1e-9,
        U::Microns => 1e-6,
        U::Centimeters => 1e-2,
        U::Decimeters => 0.1,
        U::Meters => 1.0,
        U::Decameters => 10.0,
        U::Hectometers => 100.0,
        U::Kilometers => 1e3,
        other => {
            let reason = format!("a drawing in {other:?}; name its unit: --unit mm, for example");
            return Err(fault(0, "$INSUNITS", &reason));
        }
    };
    Ok(FileUnit {
        length_m,
        origin: "by $INSUNITS of the file",
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
