//! A page to draw on: plotters' SVG backend in logical pixels.

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::prelude::{
    Circle, DrawingArea, FontTransform, IntoDrawingArea, IntoFont, PathElement, Polygon, RGBColor,
    ShapeStyle, Text, WHITE,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, TextStyle};

/// The backend's coordinates are integers: a page drawn at eight times its size and shown at its
/// own has curves without steps.
const SUBPIXELS: f64 = 8.0;

/// Result of one drawing step. Drawing into memory fails only if plotters itself fails.
pub type Draw = Result<(), Box<dyn std::error::Error + Send + Sync>>;

/// Result of drawing a figure: the SVG document.
pub type Drawn = Result<String, Box<dyn std::error::Error + Send + Sync>>;

/// Place of a text relative to its point, across and down.
pub type Anchor = (HPos, VPos);

/// Text over the middle of its point.
pub const CENTRED: Anchor = (HPos::Center, VPos::Center);
/// Text to the right of its point.
pub const RIGHT_OF: Anchor = (HPos::Left, VPos::Center);
/// Text to the left of its point.
pub const LEFT_OF: Anchor = (HPos::Right, VPos::Center);
/// Text below its point.
pub const BELOW: Anchor = (HPos::Center, VPos::Top);

/// Size of a text in logical pixels.
#[derive(Clone, Copy)]
pub enum Size {
    /// Bold title of a figure.
    Title,
    /// Axis title or legend entry.
    Label,
    /// Value beside a tick.
    Tick,
}

impl Size {
    fn pixels(self) -> f64 {
        match self {
            Size::Title => 17.0,
            Size::Label => 14.0,
            Size::Tick => 12.5,
        }
    }

    /// Upper estimate of the width of `text` in logical pixels; the viewer chooses the font.
    pub fn width(self, text: &str) -> f64 {
        0.6 * self.pixels() * text.chars().count() as f64
    }
}

/// One figure while it is drawn. Positions are logical pixels from the upper left corner.
pub struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

/// Draws a figure of `width` x `height` logical pixels with `draw`.
pub fn page(width: f64, height: f64, draw: impl FnOnce(&Canvas<'_>) -> Draw) -> Drawn {
    let size = ((width * SUBPIXELS) as u32, (height * SUBPIXELS) as u32);
    let mut svg = String::new();
    {
        let canvas = Canvas {
            area: SVGBackend::with_string(&mut svg, size).into_drawing_area(),
        };
        canvas.area.fill(&WHITE)?;
        draw(&canvas)?;
        canvas.area.present()?;
    }
    // The view box stays in subpixels; what the page measures is logical pixels.
    let drawn = format!(r#"width="{}" height="{}""#, size.0, size.1);
    let shown = format!(
        r#"width="{width:.0}" height="{height:.0}" stroke-linejoin="round" stroke-linecap="round""#
    );
    Ok(svg.replacen(&drawn, &shown, 1))
}

impl Canvas<'_> {
    /// A line through `points`; a single point becomes a dot.
    pub fn line(&self, points: &[(f64, f64)], colour: RGBColor, width: f64) -> Draw {
        match points {
            [] => Ok(()),
            [point] => self.dot(*point, 1.5 * width, colour),
            _ => {
                let path: Vec<_> = points.iter().copied().map(subpixel).collect();
                Ok(self
                    .area
                    .draw(&PathElement::new(path, stroke(colour, width)))?)
            }
        }
    }

    /// A dashed straight line.
    pub fn dashed(&self, from: (f64, f64), to: (f64, f64), colour: RGBColor) -> Draw {
        const PERIOD: f64 = 9.0;
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let dashes = (dx.hypot(dy) / PERIOD).max(1.0);
        let along = |fraction: f64| (from.0 + dx * fraction, from.1 + dy * fraction);
        for dash in 0..dashes as u32 {
            let start = f64::from(dash) / dashes;
            self.line(&[along(start), along(start + 0.5 / dashes)], colour, 1.2)?;
        }
        Ok(())
    }

    /// A dashed line through `points`; the dashes go on round corners.
    pub fn dashes(&self, points: &[(f64, f64)], colour: RGBColor, width: f64) -> Draw {
        const DASH: f64 = 5.0;
        let mut dash: Vec<(f64, f64)> = points.first().copied().into_iter().collect();
        let (mut is_on, mut left) = (true, DASH);
        for pair in points.windows(2) {
            let [mut from, to] = [pair[0], pair[1]];
            loop {
                let way = (to.0 - from.0).hypot(to.1 - from.1);
                if way <= left {
                    left -= way;
                    dash.push(to);
                    break;
                }
                let part = left / way;
                from = (
                    from.0 + part * (to.0 - from.0),
                    from.1 + part * (to.1 - from.1),
                );
                dash.push(from);
                if is_on {
                    self.line(&dash, colour, width)?;
                }
                dash = vec![from];
                (is_on, left) = (!is_on, DASH);
            }
        }
        match is_on && dash.len() > 1 {
            true => self.line(&dash, colour, width),
            false => Ok(()),
        }
    }

    /// A line through `points` with an arrow head at its end.
    pub fn arrow(&self, points: &[(f64, f64)], colour: RGBColor, width: f64) -> Draw {
        self.line(points, colour, width)?;
        let &[.., before, tip] = points else {
            return Ok(());
        };
        let (dx, dy) = (tip.0 - before.0, tip.1 - before.1);
        let length = dx.hypot(dy);
        if length == 0.0 {
            return Ok(());
        }
        let (x, y) = (dx / length, dy / length);
        let size = 4.0 + 2.5 * width;
        let back = (tip.0 - size * x, tip.1 - size * y);
        let half = 0.4 * size;
        let corners = [
            tip,
            (back.0 - half * y, back.1 + half * x),
            (back.0 + half * y, back.1 - half * x),
        ];
        self.polygon(&corners, colour)
    }

    /// A cross, for a place that is wrong.
    pub fn cross(&self, (x, y): (f64, f64), colour: RGBColor) -> Draw {
        for turn in [-6.0, 6.0] {
            self.line(&[(x - 6.0, y - turn), (x + 6.0, y + turn)], colour, 3.0)?;
        }
        Ok(())
    }

    /// A filled polygon.
    pub fn polygon(&self, corners: &[(f64, f64)], colour: RGBColor) -> Draw {
        let corners: Vec<_> = corners.iter().copied().map(subpixel).collect();
        Ok(self.area.draw(&Polygon::new(corners, colour.filled()))?)
    }

    /// A filled disc.
    pub fn dot(&self, centre: (f64, f64), radius: f64, colour: RGBColor) -> Draw {
        let radius = (radius * SUBPIXELS).round() as i32;
        Ok(self
            .area
            .draw(&Circle::new(subpixel(centre), radius, colour.filled()))?)
    }

    /// A revolute joint: a white disc with a rim.
    pub fn joint(&self, centre: (f64, f64), radius: f64, rim: RGBColor) -> Draw {
        self.dot(centre, radius, rim)?;
        self.dot(centre, radius - 1.4, WHITE)
    }

    /// A horizontal text; titles are bold.
    pub fn text(
        &self,
        text: &str,
        at: (f64, f64),
        size: Size,
        anchor: Anchor,
        colour: RGBColor,
    ) -> Draw {
        self.styled(text, at, size, anchor, colour, FontTransform::None)
    }

    /// A text that reads upwards, centred on its point.
    pub fn upright(&self, text: &str, at: (f64, f64), size: Size, colour: RGBColor) -> Draw {
        self.styled(text, at, size, CENTRED, colour, FontTransform::Rotate270)
    }

    fn styled(
        &self,
        text: &str,
        at: (f64, f64),
        size: Size,
        anchor: Anchor,
        colour: RGBColor,
        transform: FontTransform,
    ) -> Draw {
        // plotters' SVG backend divides the size by 1.24 on its way to the document.
        let font = ("sans-serif", 1.24 * size.pixels() * SUBPIXELS)
            .into_font()
            .transform(transform)
            .style(match size {
                Size::Title => FontStyle::Bold,
                _ => FontStyle::Normal,
            });
        let style = TextStyle::from(font)
            .color(&colour)
            .pos(Pos::new(anchor.0, anchor.1));
        // XML has no place for control characters, not even escaped.
        let text: String = text
            .chars()
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect();
        Ok(self.area.draw(&Text::new(text, subpixel(at), style))?)
    }
}

fn subpixel((x, y): (f64, f64)) -> (i32, i32) {
    (
        (x * SUBPIXELS).round() as i32,
        (y * SUBPIXELS).round() as i32,
    )
}

fn stroke(colour: RGBColor, width: f64) -> ShapeStyle {
    colour.stroke_width((width * SUBPIXELS).round() as u32)
}
