//! Styles that elements hand down to those within.

use super::css::{DeclaredStyle, with_variables};
use super::paint::{BLACK, Colour, Paint};
use super::values::{FONT_PX, PartAxis, UnitFrame, part};
use std::borrow::Cow;
use std::collections::HashMap;
use std::rc::Rc;

/// Style of an element, as far as it is handed down.
#[derive(Clone, Debug)]
pub(super) struct Style {
    pub(super) colour: Colour,
    pub(super) fill: Paint,
    pub(super) stroke: Paint,
    pub(super) fill_opacity: f64,
    pub(super) stroke_opacity: f64,
    pub(super) is_non_zero: bool,
    pub(super) clips_non_zero: bool,
    pub(super) is_visible: bool,
    pub(super) stroke_width: f64,
    /// Lengths with and without a line, in turn. Empty: one line.
    pub(super) dashes: Rc<[f64]>,
    pub(super) dash_offset: f64,
    /// Ends are round or square: a dash without a length is a dot.
    pub(super) has_caps: bool,
    /// Markers at the start, at inner vertices, at the end, by their names.
    pub(super) markers: [Option<Rc<str>>; 3],
    pub(super) font_px: f64,
    pub(super) variables: Rc<HashMap<String, String>>,
    /// Fill and stroke of the shape that has the marker, or of the `use`.
    pub(super) context: Option<Rc<[Option<Ink>; 2]>>,
}

/// Paint that is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ink {
    /// Colour. None: a gradient or a pattern.
    pub(super) rgb: Option<crate::drawing::Rgb>,
    pub(super) alpha: f64,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            colour: BLACK,
            fill: Paint::Colour(BLACK),
            stroke: Paint::None,
            fill_opacity: 1.0,
            stroke_opacity: 1.0,
            is_non_zero: true,
            clips_non_zero: true,
            is_visible: true,
            stroke_width: 1.0,
            dashes: Rc::new([]),
            dash_offset: 0.0,
            has_caps: false,
            markers: [None, None, None],
            font_px: FONT_PX,
            variables: Rc::default(),
            context: None,
        }
    }
}

/// Property, its value, and the values that would do.
pub(super) type Unknown = (&'static str, String);

/// Properties that are handed down.
const INHERITED: [&str; 18] = [
    "font-size",
    "color",
    "fill",
    "stroke",
    "fill-opacity",
    "stroke-opacity",
    "fill-rule",
    "clip-rule",
    "visibility",
    "stroke-width",
    "stroke-dasharray",
    "stroke-dashoffset",
    "stroke-linecap",
    "marker",
    "marker-start",
    "marker-mid",
    "marker-end",
    "font",
];

impl Style {
    /// Style of an element within one of this style, in a viewport with the sides `view`.
    ///
    /// # Errors
    /// The first property with a value that is not known.
    pub(super) fn within(&self, declared: &DeclaredStyle, view: [f64; 2]) -> Result<Self, Unknown> {
        let mut style = self.clone();
        let mut own = declared.variables().peekable();
        if own.peek().is_some() {
            let mut all = HashMap::clone(&style.variables);
            all.extend(own.map(|(name, value)| (name.to_owned(), value.to_owned())));
            style.variables = Rc::new(all);
        }
        for name in INHERITED {
            // Short forms are no attributes, but in style alone.
            let given = match name {
                "marker" | "font" => declared.style(name),
                _ => declared.get(name),
            };
            let Some(given) = given else { continue };
            let value = style.value(given).unwrap_or(Cow::Borrowed("inherit"));
            match value.trim() {
                "inherit" | "unset" | "revert" | "" => {}
                "initial" => style.set(name, initial(name), view).unwrap_or_default(),
                value => style
                    .set(name, &keyword(name, value), view)
                    .ok_or_else(|| (name, given.to_owned()))?,
            }
        }
        Ok(style)
    }

    /// Value with those of its variables. None: one of them has none.
    pub(super) fn value<'v>(&self, value: &'v str) -> Option<Cow<'v, str>> {
        match value.contains("var(") {
            false => Some(Cow::Borrowed(value)),
            true => with_variables(value, &|name| self.variables.get(name).cloned()),
        }
    }

    /// Lengths that units count by.
    pub(super) fn frame(&self, view: [f64; 2]) -> UnitFrame {
        UnitFrame {
            view,
            font_px: self.font_px,
        }
    }

    fn set(&mut self, name: &str, value: &str, view: [f64; 2]) -> Option<()> {
        let frame = self.frame(view);
        match name {
            "font-size" => self.font_px = font_size(value, self.font_px)?,
            "font" => {
                // The size is the first length of the short form.
                let words = value.split([' ', '/']);
                let mut sizes = words.filter_map(|word| {
                    match word.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
                        true => font_size(word, self.font_px),
                        false => None,
                    }
                });
                self.font_px = sizes.next().unwrap_or(self.font_px);
            }
            "color" => match Paint::read(value)? {
                Paint::Current => {}
                Paint::Colour(colour) => self.colour = colour,
                _ => return None,
            },
            "fill" => self.fill = Paint::read(value)?,
            "stroke" => self.stroke = Paint::read(value)?,
            "fill-opacity" => self.fill_opacity = part(value)?,
            "stroke-opacity" => self.stroke_opacity = part(value)?,
            "fill-rule" => self.is_non_zero = is_non_zero(value)?,
            "clip-rule" => self.clips_non_zero = is_non_zero(value)?,
            "visibility" => {
                self.is_visible = match value {
                    "visible" => true,
                    "hidden" | "collapse" => false,
                    _ => return None,
                }
            }
            "stroke-width" => self.stroke_width = frame.length(value, PartAxis::Both)?,
            "stroke-dasharray" => self.dashes = dash_lengths(value, &frame)?,
            "stroke-dashoffset" => self.dash_offset = frame.length(value, PartAxis::Both)?,
            "stroke-linecap" => self.has_caps = value != "butt",
            "marker" => {
                let marker = marker(value)?;
                self.markers = [marker.clone(), marker.clone(), marker];
            }
            "marker-start" => self.markers[0] = marker(value)?,
            "marker-mid" => self.markers[1] = marker(value)?,
            "marker-end" => self.markers[2] = marker(value)?,
            _ => return None,
        }
        Some(())
    }
}

/// Value with its words in small letters, where it has no names of its own.
fn keyword<'v>(name: &str, value: &'v str) -> Cow<'v, str> {
    match name.starts_with("marker") || name == "fill" || name == "stroke" {
        true => Cow::Borrowed(value),
        false => Cow::Owned(value.to_ascii_lowercase()),
    }
}

/// Value with which a property begins.
fn initial(name: &str) -> &'static str {
    match name {
        "font-size" => "medium",
        "color" | "fill" => "black",
        "fill-opacity" | "stroke-opacity" | "stroke-width" => "1",
        "fill-rule" | "clip-rule" => "nonzero",
        "visibility" => "visible",
        "stroke-dashoffset" => "0",
        "stroke-linecap" => "butt",
        _ => "none",
    }
}

fn is_non_zero(value: &str) -> Option<bool> {
    match value {
        "nonzero" => Some(true),
        "evenodd" => Some(false),
        _ => None,
    }
}

fn font_size(value: &str, above: f64) -> Option<f64> {
    let step = match value {
        "xx-small" => 0.5625,
        "x-small" => 0.625,
        "small" => 0.8125,
        "medium" => 1.0,
        "large" => 1.125,
        "x-large" => 1.5,
        "xx-large" => 2.0,
        "smaller" => return Some(above / 1.2),
        "larger" => return Some(above * 1.2),
        _ => {
            let frame = UnitFrame {
                view: [above; 2],
                font_px: above,
            };
            return frame.length(value, PartAxis::X).filter(|size| *size >= 0.0);
        }
    };
    Some(step * FONT_PX)
}

/// Lengths of dashes. An odd list counts twice; one without a length is none.
fn dash_lengths(value: &str, frame: &UnitFrame) -> Option<Rc<[f64]>> {
    if value == "none" {
        return Some(Rc::new([]));
    }
    let mut lengths = frame.lengths(value, PartAxis::Both)?;
    if lengths.iter().any(|length| *length < 0.0) {
        return None;
    }
    if lengths.iter().sum::<f64>() <= 0.0 {
        return Some(Rc::new([]));
    }
    if lengths.len() % 2 == 1 {
        lengths.extend_from_within(..);
    }
    Some(lengths.into())
}

/// Name in `url(#name)`; `none` for none.
pub(super) fn reference(value: &str) -> Option<Option<&str>> {
    let value = value.trim();
    if value == "none" {
        return Some(None);
    }
    let inner = value.strip_prefix("url(")?.strip_suffix(')')?;
    let name = inner.trim().trim_matches(['"', '\'']);
    name.strip_prefix('#').map(Some)
}

fn marker(value: &str) -> Option<Option<Rc<str>>> {
    Some(reference(value)?.map(Rc::from))
}
