//! Names and lines of the entities in a DXF file: what its library leaves out would be left out silently.

use super::fault;
use crate::{PathFault, short};
use std::collections::{HashMap, HashSet};

/// Entity of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Named {
    /// Line of its name, from 1.
    pub(super) line: u32,
    /// Name of its kind.
    pub(super) name: String,
    pub(super) layer: String,
    /// It is invisible, or in the paper space.
    pub(super) hidden: bool,
}

impl Named {
    /// EntityFate of an entity of this kind.
    pub(super) fn fate(&self) -> EntityFate {
        match self.name.as_str() {
            name if DRAWN.contains(&name) => EntityFate::Drawn,
            "TEXT" | "MTEXT" | "ATTRIB" | "ARCALIGNEDTEXT" | "RTEXT" => {
                EntityFate::LeftOut("text has no outline; explode it to lines")
            }
            "HATCH" | "MPOLYGON" => EntityFate::LeftOut(
                "a hatch is no outline; take its outline, and --hatch for the lines",
            ),
            "DIMENSION"
            | "ARC_DIMENSION"
            | "LARGE_RADIAL_DIMENSION"
            | "LEADER"
            | "MULTILEADER"
            | "MLEADER"
            | "TOLERANCE"
            | "ACAD_TABLE" => EntityFate::LeftOut("dimensions are not drawn; explode them"),
            "POINT" => EntityFate::LeftOut("a point has no length; draw a small circle"),
            "3DFACE" | "REGION" | "BODY" | "3DSOLID" | "SURFACE" | "PLANESURFACE"
            | "EXTRUDEDSURFACE" | "LOFTEDSURFACE" | "REVOLVEDSURFACE" | "SWEPTSURFACE" | "MESH"
            | "WIPEOUT" => {
                EntityFate::LeftOut("surfaces cannot be drawn; explode them to lines and arcs")
            }
            "XLINE" | "RAY" => EntityFate::LeftOut("a line without an end cannot be drawn"),
            "IMAGE" | "PDFUNDERLAY" | "DWFUNDERLAY" | "DGNUNDERLAY" | "OLEFRAME" | "OLE2FRAME"
            | "VIEWPORT" | "LIGHT" | "SUN" => EntityFate::LeftOut("images are not drawn"),
            _ => EntityFate::Refused(
                "entities of this kind cannot be drawn; explode them to lines and arcs",
            ),
        }
    }
}

/// EntityFate of a kind of entities, and its reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EntityFate {
    /// It is drawn.
    Drawn,
    /// It is no line, and is left out where lines are drawn. The user is told.
    LeftOut(&'static str),
    /// It may be a line: the file is refused, unless the user has it left out.
    Refused(&'static str),
}

/// Kinds of entities that are drawn.
const DRAWN: [&str; 10] = [
    "LINE",
    "LWPOLYLINE",
    "POLYLINE",
    "ARC",
    "CIRCLE",
    "ELLIPSE",
    "SPLINE",
    "INSERT",
    "SOLID",
    "TRACE",
];

/// Parts of the entity before them, and the templates of text in blocks.
const PARTS: [&str; 3] = ["VERTEX", "SEQEND", "ATTDEF"];

/// Entities of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Names {
    /// Those of the drawing itself.
    pub(super) entities: Vec<Named>,
    /// Those of blocks, by the names of the blocks.
    pub(super) blocks: HashMap<String, Vec<Named>>,
    /// Layers that are frozen, in small letters.
    pub(super) frozen: HashSet<String>,
}

/// Flag of a layer that is frozen.
const FROZEN: i64 = 1;

/// Place of the reading.
enum At {
    Elsewhere,
    Entities,
    /// Behind the name of a section that is still to come.
    Section,
    Blocks,
    /// In a block, whose name may still be to come.
    Block(Option<String>),
    Tables,
    /// In a layer of the tables: its name, and whether it is frozen.
    Layer(String, bool),
}

impl Names {
    /// Reads the pairs of `text`: a line with a code, and a line with a value.
    ///
    /// # Errors
    /// A code that is no number, or a file that ends within a pair.
    pub(super) fn read(text: &str) -> Result<Self, PathFault> {
        let mut names = Self::default();
        let mut at = At::Elsewhere;
        // In a header of a block, codes are the block's.
        let mut in_entity = false;
        let mut lines = (1..).zip(text.trim_start_matches('\u{feff}').lines());
        while let Some((line, code)) = lines.next() {
            if code.trim().is_empty() && lines.clone().all(|(_, rest)| rest.trim().is_empty()) {
                break;
            }
            let damaged = |reason: &str| fault(line, code.trim(), reason);
            let code: i32 = code.trim().parse().map_err(|_| {
                damaged("no DXF file: a line with the number of a code was expected")
            })?;
            let (line, value) = lines
                .next()
                .ok_or_else(|| damaged("no DXF file: it ends behind a code"))?;
            let value = value.trim();
            if in_entity && is_length(code) && value.contains(',') {
                return Err(decimal_comma(line, value));
            }
            if let (0, At::Layer(name, true)) = (code, &at) {
                names.frozen.insert(name.to_lowercase());
            }
            match (code, value, &mut at) {
                (0, "EOF", _) => break,
                (0, "SECTION", _) => at = At::Section,
                (0, "ENDSEC", _) => at = At::Elsewhere,
                (2, "ENTITIES", At::Section) => at = At::Entities,
                (2, "BLOCKS", At::Section) => at = At::Blocks,
                (2, "TABLES", At::Section) => at = At::Tables,
                (0, "LAYER", At::Tables | At::Layer(..)) => at = At::Layer(String::new(), false),
                (0, _, At::Layer(..)) => at = At::Tables,
                (2, _, At::Layer(name, _)) => *name = value.to_owned(),
                (70, _, At::Layer(_, frozen)) => {
                    *frozen = value.parse::<i64>().is_ok_and(|flags| flags & FROZEN != 0);
                }
                (2, _, At::Section) => at = At::Elsewhere,
                (0, "BLOCK", At::Blocks) => (at, in_entity) = (At::Block(None), false),
                (0, "ENDBLK", At::Block(_)) => at = At::Blocks,
                (2, _, At::Block(name @ None)) => *name = Some(value.to_owned()),
                (0, _, At::Entities | At::Block(_)) => {
                    in_entity = !PARTS.contains(&value);
                    if let Some(list) = names.list(&at).filter(|_| in_entity) {
                        list.push(Named {
                            line,
                            name: value.to_owned(),
                            ..Named::default()
                        });
                    }
                }
                (8 | 60 | 67, _, _) if in_entity => {
                    if let Some(entity) = names.list(&at).and_then(|list| list.last_mut()) {
                        match code {
                            8 => entity.layer = value.to_owned(),
                            _ => entity.hidden |= value == "1",
                        }
                    }
                }
                _ => {}
            }
        }
        Ok(names)
    }

    fn list(&mut self, at: &At) -> Option<&mut Vec<Named>> {
        match at {
            At::Entities => Some(&mut self.entities),
            At::Block(Some(name)) => Some(self.blocks.entry(name.clone()).or_default()),
            _ => None,
        }
    }
}

/// Returns true for the codes of coordinates, lengths, angles and factors.
fn is_length(code: i32) -> bool {
    matches!(code, 10..60 | 210..240)
}

/// Refusal of a number with a comma: it is told as it was meant.
fn decimal_comma(line: u32, value: &str) -> PathFault {
    let reason = match value.split_once(',') {
        Some((whole, part)) if !part.contains([',', '.']) && !whole.contains('.') => {
            format!(
                "the decimal sign is a point, not a comma: {}",
                short(&format!("{whole}.{part}"))
            )
        }
        _ => "a number has one decimal sign, a point, and nothing between its other digits".into(),
    };
    fault(line, value, &reason)
}
