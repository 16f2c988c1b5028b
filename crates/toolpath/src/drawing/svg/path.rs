//! Path data, lists of points, and basic shapes: to chains of curves in user units.

use super::chain::CurveChain;
use super::curve::PathCurve;
use kurbo::{Arc, Point, SvgArc, Vec2};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use svgtypes::{PathParser, PathSegment, PointsParser};

/// Reads path data.
///
/// # Errors
/// The place of the first mistake, in letters from 1.
pub(super) fn path_data(text: &str) -> Result<Vec<CurveChain>, usize> {
    let mut walk = PathWalk::default();
    for segment in PathParser::from(text) {
        // The place is told by the error, if at all.
        let segment = segment.map_err(|error| place_of(&error, text))?;
        walk.segment(segment).ok_or(text.chars().count())?;
    }
    Ok(walk.chains)
}

fn place_of(error: &svgtypes::Error, text: &str) -> usize {
    use svgtypes::Error;
    match error {
        Error::UnexpectedData(at)
        | Error::InvalidChar(_, at)
        | Error::InvalidString(_, at)
        | Error::InvalidNumber(at) => *at,
        _ => text.chars().count(),
    }
}

#[derive(Default)]
struct PathWalk {
    chains: Vec<CurveChain>,
    at: [f64; 2],
    /// Start of the current chain, to which it closes.
    start: [f64; 2],
    is_open: bool,
    /// Last control point of the curve before: cubic, quadratic.
    controls: [Option<[f64; 2]>; 2],
}

impl PathWalk {
    /// Adds a segment. None: its numbers are beyond counting.
    fn segment(&mut self, segment: PathSegment) -> Option<()> {
        let [ox, oy] = match is_absolute(&segment) {
            true => [0.0; 2],
            false => self.at,
        };
        let before = std::mem::take(&mut self.controls);
        let at = self.at;
        let mirrored = |control: Option<[f64; 2]>| match control {
            Some(point) => [0, 1].map(|i| 2.0 * at[i] - point[i]),
            None => at,
        };
        let curve = match segment {
            PathSegment::MoveTo { x, y, .. } => {
                self.at = [ox + x, oy + y];
                self.start = self.at;
                self.is_open = false;
                return self.at.iter().all(|value| value.is_finite()).then_some(());
            }
            PathSegment::ClosePath { .. } => {
                self.open().close();
                self.is_open = false;
                self.at = self.start;
                return Some(());
            }
            PathSegment::LineTo { x, y, .. } => PathCurve::Line([ox + x, oy + y]),
            PathSegment::HorizontalLineTo { x, .. } => PathCurve::Line([ox + x, at[1]]),
            PathSegment::VerticalLineTo { y, .. } => PathCurve::Line([at[0], oy + y]),
            PathSegment::CurveTo {
                x1,
                y1,
                x2,
                y2,
                x,
                y,
                ..
            } => {
                let second = [ox + x2, oy + y2];
                self.controls[0] = Some(second);
                PathCurve::Bezier([[ox + x1, oy + y1], second, [ox + x, oy + y]])
            }
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => {
                let second = [ox + x2, oy + y2];
                self.controls[0] = Some(second);
                PathCurve::Bezier([mirrored(before[0]), second, [ox + x, oy + y]])
            }
            PathSegment::Quadratic { x1, y1, x, y, .. } => {
                self.controls[1] = Some([ox + x1, oy + y1]);
                quadratic(at, [ox + x1, oy + y1], [ox + x, oy + y])
            }
            PathSegment::SmoothQuadratic { x, y, .. } => {
                let control = mirrored(before[1]);
                self.controls[1] = Some(control);
                quadratic(at, control, [ox + x, oy + y])
            }
            PathSegment::EllipticalArc {
                rx,
                ry,
                x_axis_rotation,
                large_arc,
                sweep,
                x,
                y,
                ..
            } => {
                let arc = SvgArc {
                    from: Point::new(at[0], at[1]),
                    to: Point::new(ox + x, oy + y),
                    radii: Vec2::new(rx.abs(), ry.abs()),
                    x_rotation: x_axis_rotation.to_radians(),
                    large_arc,
                    sweep,
                };
                match Arc::from_svg_arc(&arc) {
                    Some(arc) => elliptical(&arc),
                    None => PathCurve::Line([ox + x, oy + y]),
                }
            }
        };
        // The end is that of the file, to the bit.
        let end = match segment {
            PathSegment::EllipticalArc { x, y, .. } => [ox + x, oy + y],
            _ => curve.end(),
        };
        self.open().curves.push(curve);
        self.at = end;
        let hull = self.chains.last()?.curves.last()?;
        let finite = match hull {
            PathCurve::Line(to) => to.iter().all(|value| value.is_finite()),
            PathCurve::Bezier(points) => {
                points.as_flattened().iter().all(|value| value.is_finite())
            }
            PathCurve::Arc { centre, axes, ends } => {
                let parts = [*centre, axes[0], axes[1], *ends];
                parts.as_flattened().iter().all(|value| value.is_finite())
            }
        };
        finite.then_some(())
    }

    /// Chain that is drawn: another one after a move or a close.
    fn open(&mut self) -> &mut CurveChain {
        if !self.is_open {
            self.chains.push(CurveChain::new(self.at));
            self.is_open = true;
        }
        let last = self.chains.len() - 1;
        &mut self.chains[last]
    }
}

fn is_absolute(segment: &PathSegment) -> bool {
    segment.is_abs()
}

fn quadratic(from: [f64; 2], control: [f64; 2], to: [f64; 2]) -> PathCurve {
    let third = |end: [f64; 2]| [0, 1].map(|i| (end[i] + 2.0 * control[i]) / 3.0);
    PathCurve::Bezier([third(from), third(to), to])
}

fn elliptical(arc: &Arc) -> PathCurve {
    let (sin, cos) = libm::sincos(arc.x_rotation);
    let Vec2 { x: rx, y: ry } = arc.radii;
    PathCurve::Arc {
        centre: [arc.center.x, arc.center.y],
        axes: [[rx * cos, rx * sin], [-ry * sin, ry * cos]],
        ends: [arc.start_angle, arc.start_angle + arc.sweep_angle],
    }
}

/// Reads points. None: they are an odd number of coordinates, or no numbers.
pub(super) fn points(text: &str, closed: bool) -> Option<Vec<CurveChain>> {
    let mut numbers = svgtypes::NumberListParser::from(text);
    let count = numbers.try_fold(0_usize, |count, number| number.is_ok().then_some(count + 1))?;
    if count % 2 == 1 {
        return None;
    }
    let mut points = PointsParser::from(text).map(|(x, y)| [x, y]);
    let Some(start) = points.next() else {
        return Some(Vec::new());
    };
    let mut chain = CurveChain::new(start);
    chain.curves.extend(points.map(PathCurve::Line));
    // Two points of a polygon are a line to and fro.
    if closed && !chain.curves.is_empty() {
        chain.close();
    }
    Some(vec![chain])
}

/// Circle or ellipse, from its right end on.
pub(super) fn ellipse(centre: [f64; 2], [rx, ry]: [f64; 2]) -> CurveChain {
    let [x, y] = centre;
    CurveChain {
        start: [x + rx, y],
        curves: vec![PathCurve::Arc {
            centre,
            axes: [[rx, 0.0], [0.0, ry]],
            ends: [0.0, TAU],
        }],
        closed: true,
    }
}

/// Rectangle with corners of the radii `rx` and `ry`.
pub(super) fn rectangle(
    [x, y]: [f64; 2],
    [width, height]: [f64; 2],
    [rx, ry]: [f64; 2],
) -> CurveChain {
    let (rx, ry) = (rx.min(0.5 * width), ry.min(0.5 * height));
    if rx <= 0.0 || ry <= 0.0 {
        let mut chain = CurveChain::new([x, y]);
        for corner in [[x + width, y], [x + width, y + height], [x, y + height]] {
            chain.line(corner);
        }
        chain.close();
        return chain;
    }
    let mut chain = CurveChain::new([x + rx, y]);
    let sides = [
        ([x + width - rx, y], [x + width - rx, y + ry], -FRAC_PI_2),
        (
            [x + width, y + height - ry],
            [x + width - rx, y + height - ry],
            0.0,
        ),
        ([x + rx, y + height], [x + rx, y + height - ry], FRAC_PI_2),
        ([x, y + ry], [x + rx, y + ry], PI),
    ];
    for (to, centre, start) in sides {
        if super::curve::distance(chain.end(), to) > 1e-12 * (width + height) {
            chain.line(to);
        }
        chain.curves.push(PathCurve::Arc {
            centre,
            axes: [[rx, 0.0], [0.0, ry]],
            ends: [start, start + FRAC_PI_2],
        });
    }
    chain.closed = true;
    chain
}
