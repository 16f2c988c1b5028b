//! Paints: colours, and gradients and patterns by their names.

use super::css::top_level;
use crate::drawing::Rgb;
use color::{Srgb, parse_color};
use std::cell::RefCell;
use std::collections::HashMap;

/// Opacity below which nothing is seen: half of the smallest step of a screen.
pub(super) const SEEN: f64 = 0.5 / 255.0;

/// Colour with its opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Colour {
    pub(super) rgb: Rgb,
    pub(super) alpha: f64,
}

/// Black, the first colour of all.
pub(super) const BLACK: Colour = Colour {
    rgb: [0; 3],
    alpha: 1.0,
};

/// Paint of a fill or a stroke, before it is known of which shape.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Paint {
    None,
    Colour(Colour),
    /// The `color` of the element.
    Current,
    /// Fill of the shape that has the marker, or of the `use`.
    ContextFill,
    /// Its stroke.
    ContextStroke,
    /// A gradient or a pattern, and the paint where there is none.
    Server(String, Box<Paint>),
}

impl Paint {
    /// Reads a paint. None: it is not known.
    pub(super) fn read(text: &str) -> Option<Self> {
        let text = text.trim();
        if text
            .get(..4)
            .is_some_and(|head| head.eq_ignore_ascii_case("url("))
        {
            let end = top_level(&text[4..], &[')'])?;
            let name = text[4..4 + end].trim().trim_matches(['"', '\'']);
            let id = name.strip_prefix('#')?;
            let fallback = match text[end + 5..].trim() {
                "" => Self::None,
                other => Self::read(other)?,
            };
            return Some(Self::Server(id.to_owned(), Box::new(fallback)));
        }
        Some(match text.to_ascii_lowercase().as_str() {
            "none" => Self::None,
            "currentcolor" => Self::Current,
            "context-fill" => Self::ContextFill,
            "context-stroke" => Self::ContextStroke,
            _ => Self::Colour(Colour::read(text)?),
        })
    }
}

impl Colour {
    /// Reads a colour. None: it is not known.
    pub(super) fn read(text: &str) -> Option<Self> {
        let text = text.trim().to_ascii_lowercase();
        // Colours of printers follow the colour that stands for them.
        let text = match text
            .find(" icc-color(")
            .or_else(|| text.find(" device-cmyk("))
        {
            Some(end) => &text[..end],
            None => &text,
        };
        let text = match text {
            "canvastext" | "windowtext" | "buttontext" | "linktext" => "black",
            "canvas" | "window" | "field" | "background" => "white",
            other => other,
        };
        let found = parse_color(text).ok()?.to_alpha_color::<Srgb>();
        let [red, green, blue, alpha] = found.components;
        let byte = |part: f32| (255.0 * part.clamp(0.0, 1.0)).round() as u8;
        Some(Self {
            rgb: [byte(red), byte(green), byte(blue)],
            alpha: f64::from(alpha).clamp(0.0, 1.0),
        })
    }
}

/// Gradient or pattern.
#[derive(Clone, Copy, Debug)]
pub(super) struct Server {
    /// Greatest opacity.
    pub(super) alpha: f64,
    /// Its lengths are parts of the box of the shape.
    pub(super) of_box: bool,
}

/// Gradients and patterns that are known already.
#[derive(Default)]
pub(super) struct Servers(pub(super) RefCell<HashMap<String, Option<Server>>>);
