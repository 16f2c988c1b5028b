//! Shapes: their outlines, and the paints that are seen.

use super::chain::CurveChain;
use super::css::DeclaredStyle;
use super::figure::SeenFigure;
use super::figure::Sink;
use super::paint::{Paint, SEEN, Server};
use super::path::{ellipse, path_data, points, rectangle};
use super::state::{DrawState, Mode};
use super::style::Ink;
use super::values::{PartAxis, number};
use super::walk::FileWalk;
use crate::PathFault;
use kurbo::Rect;
use std::rc::Rc;

/// Coordinates that are attributes alone.
const ATTRIBUTES: [&str; 4] = ["x1", "y1", "x2", "y2"];

impl<'d> FileWalk<'d> {
    /// Length of an element, in user units.
    pub(super) fn length(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
        (name, axis): (&str, PartAxis),
        initial: f64,
    ) -> Result<f64, PathFault> {
        let is_style = declared.style(name).is_some() && !ATTRIBUTES.contains(&name);
        let given = match is_style {
            true => self.value(declared, &state.style, name),
            false => declared.node.attribute(name).map(|text| text.trim().into()),
        };
        let Some(text) = given.filter(|text| !matches!(text.as_ref(), "auto" | "")) else {
            return Ok(initial);
        };
        // In style, a number needs a unit.
        let lacks_unit = is_style && matches!(number(&text), Some((value, "")) if value != 0.0);
        let length = state.style.frame(state.view).length(&text, axis);
        length
            .filter(|length| length.is_finite() && !lacks_unit)
            .ok_or_else(|| self.unknown(declared.node, name, &text))
    }

    /// Outlines of a shape, in user units.
    fn outlines(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
    ) -> Result<Vec<CurveChain>, PathFault> {
        let node = declared.node;
        let length = |name, axis| self.length(declared, state, (name, axis), 0.0);
        let pair = |x, y| Ok::<_, PathFault>([length(x, PartAxis::X)?, length(y, PartAxis::Y)?]);
        let is_positive = |sides: [f64; 2]| sides[0] > 0.0 && sides[1] > 0.0;
        // Radii that are not given are that of the other axis.
        let radii = || {
            let given = |name| declared.get(name).is_some_and(|value| value != "auto");
            let [rx, ry] = pair("rx", "ry")?;
            Ok::<_, PathFault>(match (given("rx"), given("ry")) {
                (true, false) => [rx, rx],
                (false, true) => [ry, ry],
                _ => [rx, ry],
            })
        };
        Ok(match node.tag_name().name() {
            "path" => return self.path(declared, state),
            "rect" => {
                let (corner, sides) = (pair("x", "y")?, pair("width", "height")?);
                let radii = radii()?;
                match is_positive(sides) {
                    true => vec![rectangle(corner, sides, radii)],
                    false => Vec::new(),
                }
            }
            "circle" => {
                let (centre, radius) = (pair("cx", "cy")?, length("r", PartAxis::Both)?);
                match radius > 0.0 {
                    true => vec![ellipse(centre, [radius; 2])],
                    false => Vec::new(),
                }
            }
            "ellipse" => {
                let (centre, radii) = (pair("cx", "cy")?, radii()?);
                match is_positive(radii) {
                    true => vec![ellipse(centre, radii)],
                    false => Vec::new(),
                }
            }
            "line" => {
                let mut chain = CurveChain::new(pair("x1", "y1")?);
                chain
                    .curves
                    .push(super::curve::PathCurve::Line(pair("x2", "y2")?));
                vec![chain]
            }
            name => {
                let text = node.attribute("points").unwrap_or_default();
                points(text, name == "polygon").ok_or_else(|| {
                    let reason = "points: they have to be pairs of numbers; a program that shows the file draws up to the mistake";
                    self.fault(node, reason.into())
                })?
            }
        })
    }

    fn path(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
    ) -> Result<Vec<CurveChain>, PathFault> {
        let node = declared.node;
        let style = declared
            .style("d")
            .and_then(|value| state.style.value(value));
        let text = match &style {
            None => node.attribute("d").unwrap_or_default(),
            Some(value) if value == "none" => "",
            Some(value) => {
                let inner = value
                    .strip_prefix("path(")
                    .and_then(|inner| inner.strip_suffix(')'));
                let inner = inner.ok_or_else(|| self.unknown(node, "d", value))?.trim();
                inner.trim_matches(['"', '\''])
            }
        };
        if text.trim() == "none" {
            return Ok(Vec::new());
        }
        path_data(text).map_err(|at| {
            let from = text.char_indices().nth(at.saturating_sub(1)).map_or(0, |(at, _)| at);
            let reason = format!(
                "d: no path data from letter {at} on: {:.20}; a program that shows the file draws up to there",
                text[from..].trim()
            );
            self.fault(node, reason)
        })
    }

    /// Fill and stroke of an element in its state, as far as they are seen, on a shape with this box.
    pub(super) fn inks(
        &self,
        state: &DrawState<'d>,
        bounds: Option<Rect>,
    ) -> Result<[Option<Ink>; 2], PathFault> {
        let style = &state.style;
        if !style.is_visible {
            return Ok([None; 2]);
        }
        let has_width = style.stroke_width > 0.0;
        let fill = self.ink(state, &style.fill, style.fill_opacity, bounds)?;
        let stroke = match has_width {
            true => self.ink(state, &style.stroke, style.stroke_opacity, bounds)?,
            false => None,
        };
        Ok([fill, stroke])
    }

    fn ink(
        &self,
        state: &DrawState<'d>,
        paint: &Paint,
        opacity: f64,
        bounds: Option<Rect>,
    ) -> Result<Option<Ink>, PathFault> {
        let style = &state.style;
        let opacity = opacity * state.alpha;
        let of_context = |index: usize| {
            let context = style.context.as_ref().and_then(|context| context[index]);
            context.map(|ink| (ink.rgb, ink.alpha))
        };
        let found = match paint {
            Paint::None => None,
            Paint::Colour(colour) => Some((Some(colour.rgb), colour.alpha)),
            Paint::Current => Some((Some(style.colour.rgb), style.colour.alpha)),
            Paint::ContextFill => of_context(0),
            Paint::ContextStroke => of_context(1),
            Paint::Server(id, fallback) => match self.server(id, state.view)? {
                Some(Server { of_box, .. })
                    if of_box
                        && bounds.is_some_and(|all| all.width() == 0.0 || all.height() == 0.0) =>
                {
                    // On a line, a gradient of its box has no size.
                    return self.ink(state, fallback, opacity / state.alpha, bounds);
                }
                Some(Server { alpha, .. }) => Some((None, alpha)),
                None => return self.ink(state, fallback, opacity / state.alpha, bounds),
            },
        };
        let ink = found.map(|(rgb, alpha)| Ink {
            rgb,
            alpha: alpha * opacity,
        });
        Ok(ink.filter(|ink| ink.alpha > SEEN))
    }

    /// Figure of a basic shape or a path.
    pub(super) fn shape(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
        sink: Sink,
    ) -> Result<(), PathFault> {
        let style = &state.style;
        let has_markers = style.markers.iter().any(Option::is_some);
        if state.mode == Mode::Draw && self.inks(state, None)? == [None; 2] && !has_markers {
            return Ok(());
        }
        if state.mode == Mode::Clip && !style.is_visible {
            return Ok(());
        }
        let chains = self.outlines(declared, state)?;
        let bounds = match (&style.fill, &style.stroke) {
            (Paint::Server(..), _) | (_, Paint::Server(..)) => {
                let points = chains.iter().flat_map(|chain| chain.points(1e-3));
                let boxes = points.map(|[x, y]| Rect::new(x, y, x, y));
                boxes.reduce(|all, point| all.union(point))
            }
            _ => None,
        };
        let [fill, stroke] = match state.mode {
            Mode::Draw => self.inks(state, bounds)?,
            Mode::Bounds | Mode::Clip => [None; 2],
        };
        sink(SeenFigure {
            node: declared.node,
            chains: chains.clone(),
            map: state.map,
            style: Rc::clone(style),
            fill,
            stroke,
            regions: state.regions(),
            layer: state.layer,
            keeps_dashes: declared
                .get("vector-effect")
                .is_some_and(|value| value.contains("non-scaling-stroke")),
            path_length: declared.node.attribute("pathLength"),
        })?;
        let is_marked = matches!(
            declared.node.tag_name().name(),
            "path" | "line" | "polyline" | "polygon"
        );
        match has_markers && is_marked && state.mode == Mode::Draw && style.is_visible {
            true => self.markers(declared, state, &chains, [fill, stroke], sink),
            false => Ok(()),
        }
    }
}
