//! Drawings as numbers and names: to hand one from a program to another, as WebAssembly modules do.

use super::{Area, AreaClip, Drawing, Rgb, Shape, Stroke, StrokeCurve};
use crate::PathRemark;

/// Number in place of no colour.
const NO_COLOUR: f64 = -1.0;

/// A drawing as numbers and names. See [`Drawing::flat`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlatDrawing {
    /// Strokes, then areas, then lines of remarks, each list behind its length.
    pub numbers: Vec<f64>,
    /// Text of each remark, then name and layer of each shape.
    pub names: Vec<String>,
}

impl Drawing {
    /// Writes the drawing as numbers and names.
    pub fn flat(&self) -> FlatDrawing {
        let mut numbers = Vec::new();
        put_strokes(&mut numbers, &self.strokes);
        numbers.push(self.areas.len() as f64);
        for area in &self.areas {
            let flags = [area.non_zero, area.stroked].map(|flag| f64::from(u8::from(flag)));
            numbers.extend([area.shape as f64, number_of(area.colour)]);
            numbers.extend(flags);
            put_strokes(&mut numbers, &area.outlines);
            numbers.push(area.clips.len() as f64);
            for clip in &area.clips {
                let flags = [clip.non_zero, clip.adds, clip.is_last];
                numbers.extend(flags.map(|flag| f64::from(u8::from(flag))));
                put_strokes(&mut numbers, &clip.outlines);
            }
        }
        numbers.push(self.remarks.len() as f64);
        numbers.extend(self.remarks.iter().map(|remark| f64::from(remark.line)));
        let texts = self.remarks.iter().map(|remark| remark.text.clone());
        let shapes = self.shapes.iter();
        let names = shapes.flat_map(|shape| [shape.name.clone(), shape.layer.clone()]);
        FlatDrawing {
            numbers,
            names: texts.chain(names).collect(),
        }
    }
}

impl FlatDrawing {
    /// Reads the drawing back; nothing of numbers and names that are none.
    pub fn drawing(&self) -> Option<Drawing> {
        let mut numbers = Numbers(self.numbers.iter());
        let strokes = numbers.strokes()?;
        let areas = (0..numbers.count()?).map(|_| {
            Some(Area {
                shape: numbers.count()?,
                colour: numbers.colour()?,
                non_zero: numbers.next()? == 1.0,
                stroked: numbers.next()? == 1.0,
                outlines: numbers.strokes()?,
                clips: numbers.clips()?,
            })
        });
        let areas = areas.collect::<Option<_>>()?;
        let lines = (0..numbers.count()?).map(|_| Some(numbers.count()? as u32));
        let lines = lines.collect::<Option<Vec<_>>>()?;
        let (texts, names) = self.names.split_at_checked(lines.len())?;
        let remarks = lines.into_iter().zip(texts);
        let shapes = names.chunks_exact(2).map(|names| Shape {
            name: names[0].clone(),
            layer: names[1].clone(),
        });
        Some(Drawing {
            strokes,
            areas,
            shapes: shapes.collect(),
            remarks: remarks
                .map(|(line, text)| PathRemark::new(line, text))
                .collect(),
        })
    }
}

fn number_of(colour: Option<Rgb>) -> f64 {
    match colour {
        Some([red, green, blue]) => f64::from(u32::from_be_bytes([0, red, green, blue])),
        None => NO_COLOUR,
    }
}

fn put_strokes(numbers: &mut Vec<f64>, strokes: &[Stroke]) {
    numbers.push(strokes.len() as f64);
    for stroke in strokes {
        numbers.extend([stroke.shape as f64, number_of(stroke.colour)]);
        numbers.extend(stroke.start);
        numbers.push(stroke.curves.len() as f64);
        for curve in &stroke.curves {
            match curve {
                StrokeCurve::Line(to) => numbers.extend([0.0, to[0], to[1]]),
                StrokeCurve::Arc { centre, turn, to } => {
                    numbers.extend([1.0, centre[0], centre[1], *turn, to[0], to[1]]);
                }
                StrokeCurve::Bezier(points) => {
                    numbers.push(2.0);
                    numbers.extend(points.as_flattened());
                }
            }
        }
    }
}

/// Reader of numbers.
struct Numbers<'a>(std::slice::Iter<'a, f64>);

impl Numbers<'_> {
    fn next(&mut self) -> Option<f64> {
        self.0.next().copied()
    }

    /// A whole number.
    fn count(&mut self) -> Option<usize> {
        let number = self.next()?;
        (number >= 0.0 && number.fract() == 0.0).then_some(number as usize)
    }

    fn point(&mut self) -> Option<[f64; 2]> {
        Some([self.next()?, self.next()?])
    }

    fn colour(&mut self) -> Option<Option<Rgb>> {
        let number = self.next()?;
        if number == NO_COLOUR {
            return Some(None);
        }
        let [_, red, green, blue] = (number as u32).to_be_bytes();
        Some(Some([red, green, blue]))
    }

    fn clips(&mut self) -> Option<Vec<AreaClip>> {
        let count = self.count()?;
        let clips = (0..count).map(|_| {
            Some(AreaClip {
                non_zero: self.next()? == 1.0,
                adds: self.next()? == 1.0,
                is_last: self.next()? == 1.0,
                outlines: self.strokes()?,
            })
        });
        clips.collect()
    }

    fn strokes(&mut self) -> Option<Vec<Stroke>> {
        let count = self.count()?;
        (0..count).map(|_| self.stroke()).collect()
    }

    fn stroke(&mut self) -> Option<Stroke> {
        let (shape, colour, start) = (self.count()?, self.colour()?, self.point()?);
        let count = self.count()?;
        let curves = (0..count).map(|_| self.curve()).collect::<Option<_>>()?;
        Some(Stroke {
            shape,
            colour,
            start,
            curves,
        })
    }

    fn curve(&mut self) -> Option<StrokeCurve> {
        Some(match self.count()? {
            0 => StrokeCurve::Line(self.point()?),
            1 => StrokeCurve::Arc {
                centre: self.point()?,
                turn: self.next()?,
                to: self.point()?,
            },
            2 => StrokeCurve::Bezier([self.point()?, self.point()?, self.point()?]),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::read_svg;

    #[test]
    fn a_drawing_comes_back_from_its_numbers() {
        let text = include_str!("../../../../scenes/jobs/badge.svg");
        let mut drawing = read_svg(text).expect("a drawing");
        // SVG gives no arcs, and every shape of the badge has a colour.
        drawing.strokes[0].colour = None;
        drawing.strokes[0].curves.push(StrokeCurve::Arc {
            centre: [0.1, 0.2],
            turn: -1.5,
            to: [0.3, 0.4],
        });
        let outlines = drawing.areas[0].outlines.clone();
        drawing.areas[0].clips.push(AreaClip {
            outlines,
            non_zero: true,
            adds: false,
            is_last: true,
        });
        drawing.remarks.push(PathRemark::new(3, "hardly meant"));
        let flat = drawing.flat();
        assert_eq!(flat.drawing(), Some(drawing));
        for length in 0..flat.numbers.len() {
            let numbers = flat.numbers[..length].to_vec();
            let cut = FlatDrawing {
                numbers,
                ..flat.clone()
            };
            assert_eq!(cut.drawing(), None, "{length}");
        }
    }
}
