//! Figures as PNG, for programs that read no SVG.
//!
//! The texts of a figure become outlines of DejaVu Sans, whose glyphs are built in, and resvg draws the rest: every machine gives the same
//! picture, whatever fonts it has.

use rayon::prelude::*;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::roxmltree::{Document, Node};
use resvg::usvg::{Options, Tree};
use std::fmt::Write;
use std::io;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// Pixels of the picture for one of the figure: sharp on paper, too.
const SCALE: f32 = 2.0;

/// Reason for which a figure is no picture.
type NoPicture = Box<dyn std::error::Error + Send + Sync>;

/// PNG of each figure, drawn on all cores.
pub(super) fn drawn_pictures(figures: &[(String, Vec<u8>)]) -> Vec<io::Result<Vec<u8>>> {
    let draw = |(_, svg): &(String, Vec<u8>)| {
        let svg = std::str::from_utf8(svg).map_err(io::Error::other)?;
        png(svg).map_err(|error| io::Error::other(error.to_string()))
    };
    figures.par_iter().map(draw).collect()
}

/// Draws the figure `svg`, which `trirrr_figures` made, as PNG.
///
/// # Errors
/// The text is no SVG, or has no size that a picture can have.
fn png(svg: &str) -> Result<Vec<u8>, NoPicture> {
    let outlined = outlined(svg)?;
    let tree = Tree::from_str(&outlined, &Options::default())?;
    let size = tree.size();
    let pixels = |length: f32| (SCALE * length).ceil() as u32;
    let mut picture =
        Pixmap::new(pixels(size.width()), pixels(size.height())).ok_or("no size for a picture")?;
    resvg::render(
        &tree,
        Transform::from_scale(SCALE, SCALE),
        &mut picture.as_mut(),
    );
    Ok(picture.encode_png()?)
}

/// The document with paths in place of its texts.
fn outlined(svg: &str) -> Result<String, NoPicture> {
    let document = Document::parse(svg)?;
    let faces = Faces {
        regular: Face::parse(dejavu::sans::regular(), 0)?,
        bold: Face::parse(dejavu::sans::bold(), 0)?,
    };
    let mut outlined = String::with_capacity(2 * svg.len());
    let mut end = 0;
    for node in document
        .descendants()
        .filter(|node| node.has_tag_name("text"))
    {
        let range = node.range();
        outlined += &svg[end..range.start];
        faces.write(&node, &mut outlined)?;
        end = range.end;
    }
    outlined += &svg[end..];
    Ok(outlined)
}

struct Faces {
    regular: Face<'static>,
    bold: Face<'static>,
}

impl Faces {
    /// Writes the text of `node` as a path: place, anchor and turn as plotters gives them.
    fn write(&self, node: &Node<'_, '_>, to: &mut String) -> Result<(), NoPicture> {
        let attribute = |name: &str| node.attribute(name).unwrap_or_default();
        let number = |name: &str| attribute(name).parse::<f32>();
        let face = match attribute("font-weight") {
            "bold" => &self.bold,
            _ => &self.regular,
        };
        let text = node.text().unwrap_or_default().trim();
        let size = number("font-size")?;
        let scale = size / f32::from(face.units_per_em());
        let glyphs: Vec<GlyphId> = text
            .chars()
            // A character that the font does not have is its box.
            .map(|letter| face.glyph_index(letter).unwrap_or(GlyphId(0)))
            .collect();
        let advance = |glyph: &GlyphId| f32::from(face.glyph_hor_advance(*glyph).unwrap_or(0));
        let width: f32 = scale * glyphs.iter().map(advance).sum::<f32>();
        let shift = match attribute("text-anchor") {
            "middle" => -0.5 * width,
            "end" => -width,
            _ => 0.0,
        };
        let mut outline = Outline {
            path: String::new(),
            scale,
            x: number("x")? + shift,
            y: number("y")? + size * ems(attribute("dy"), face)?,
        };
        for glyph in &glyphs {
            face.outline_glyph(*glyph, &mut outline);
            outline.x += scale * advance(glyph);
        }
        let (fill, transform) = (attribute("fill"), attribute("transform"));
        let turned = match transform.is_empty() {
            true => String::new(),
            false => format!(r#" transform="{transform}""#),
        };
        write!(to, r#"<path fill="{fill}"{turned} d="{}"/>"#, outline.path)?;
        Ok(())
    }
}

/// Length that plotters gives in ems or in heights of an x, in ems.
fn ems(length: &str, face: &Face<'_>) -> Result<f32, NoPicture> {
    if let Some(ems) = length.strip_suffix("em") {
        return Ok(ems.parse()?);
    }
    let Some(heights) = length.strip_suffix("ex") else {
        return Ok(0.0);
    };
    // DejaVu does not tell its height of an x: that of the glyph.
    let drawn = || Some(face.glyph_bounding_box(face.glyph_index('x')?)?.y_max);
    let height = face.x_height().or_else(drawn).unwrap_or(0);
    Ok(f32::from(height) / f32::from(face.units_per_em()) * heights.parse::<f32>()?)
}

/// Outline of glyphs as the data of an SVG path.
struct Outline {
    path: String,
    scale: f32,
    /// Origin of the glyph.
    x: f32,
    y: f32,
}

impl Outline {
    fn add(&mut self, command: char, points: &[(f32, f32)]) {
        self.path.push(command);
        for (x, y) in points {
            let (x, y) = (self.x + self.scale * x, self.y - self.scale * y);
            // Writing to a String does not fail.
            let _ = write!(self.path, "{x:.2} {y:.2} ");
        }
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.add('M', &[(x, y)]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.add('L', &[(x, y)]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.add('Q', &[(x1, y1), (x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.add('C', &[(x1, y1), (x2, y2), (x, y)]);
    }

    fn close(&mut self) {
        self.path.push('Z');
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_figures::canvas::{BELOW, CENTRED, Size, page};
    use trirrr_figures::style::INK;

    /// Part of the pixels of a figure with one text that are not white.
    fn darkness(text: &str, size: Size) -> f64 {
        let svg = page(200.0, 60.0, |canvas| {
            canvas.text(text, (100.0, 30.0), size, CENTRED, INK)
        });
        let picture = Pixmap::decode_png(&png(&svg.unwrap()).unwrap()).unwrap();
        assert_eq!([picture.width(), picture.height()], [400, 120]);
        let dark = picture.pixels().iter().filter(|pixel| pixel.red() < 128);
        dark.count() as f64 / (400.0 * 120.0)
    }

    #[test]
    fn texts_are_drawn_in_their_weight_and_in_all_letters_of_figures() {
        let plain = darkness("torque", Size::Label);
        assert!(plain > 0.01 && plain < 0.1, "{plain}");
        assert!(darkness("torque", Size::Title) > 1.3 * plain);
        assert_eq!(darkness("", Size::Label), 0.0);
        let face = Face::parse(dejavu::sans::regular(), 0).unwrap();
        for letter in
            "\u{3b1}\u{3b8}\u{b5}\u{b2}\u{b1}\u{2212}\u{2081}\u{207b}\u{2076}\u{b0}".chars()
        {
            assert!(face.glyph_index(letter).is_some(), "{letter}");
        }
    }

    #[test]
    fn anchors_and_turns_are_kept() {
        let svg = page(60.0, 60.0, |canvas| {
            canvas.upright("mmmm", (30.0, 30.0), Size::Label, INK)?;
            canvas.text("i", (50.0, 4.0), Size::Label, BELOW, INK)
        });
        let picture = Pixmap::decode_png(&png(&svg.unwrap()).unwrap()).unwrap();
        let is_dark = |x: u32, y: u32| picture.pixel(x, y).is_some_and(|pixel| pixel.red() < 128);
        let dark = |xs: std::ops::Range<u32>, ys: std::ops::Range<u32>| {
            xs.flat_map(|x| ys.clone().map(move |y| (x, y)))
                .filter(|(x, y)| is_dark(*x, *y))
                .count()
        };
        // The upright text is a column about the middle, as far up as down, and as far to the left as to the right.
        let column = |x: u32| dark(x..x + 1, 20..100) > 0;
        let left = (0..120).find(|x| column(*x)).unwrap();
        // The other text begins at 90.
        let right = (0..85).rev().find(|x| column(*x)).unwrap();
        assert!((118..=122).contains(&(left + right)), "{left} {right}");
        assert!(dark(48..72, 20..60) > 50 && dark(48..72, 60..100) > 50);
        assert_eq!(dark(0..40, 30..120), 0);
        assert!(dark(90..110, 8..36) > 5);
    }

    #[test]
    fn what_is_no_figure_is_refused() {
        for text in [
            "",
            "<svg",
            "<svg xmlns='http://www.w3.org/2000/svg'><text>a</text></svg>",
        ] {
            assert!(png(text).is_err(), "{text}");
        }
    }
}
