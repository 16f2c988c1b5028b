//! Markers: drawings at the vertices of a shape.

use super::chain::CurveChain;
use super::css::DeclaredStyle;
use super::curve::PathCurve;
use super::figure::Sink;
use super::path::rectangle;
use super::region::{ClipRegion, RegionShape};
use super::state::DrawState;
use super::style::{Ink, Style};
use super::values::{PartAxis, angle_of};
use super::walk::FileWalk;
use crate::PathFault;
use kurbo::Affine;
use std::rc::Rc;

/// Vertex of a shape: its place, and the directions in which the outline comes and goes.
struct Vertex {
    place: [f64; 2],
    ways: [Option<[f64; 2]>; 2],
}

impl<'d> FileWalk<'d> {
    /// Draws the markers of a shape.
    pub(super) fn markers(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
        chains: &[CurveChain],
        inks: [Option<Ink>; 2],
        sink: Sink,
    ) -> Result<(), PathFault> {
        let vertices = vertices(chains);
        let last = vertices.len().saturating_sub(1);
        for (index, vertex) in vertices.iter().enumerate() {
            // A shape of one vertex has a start and an end.
            let kinds = [index == 0, index > 0 && index < last, index == last];
            for kind in (0..3).filter(|kind| kinds[*kind]) {
                let Some(id) = &state.style.markers[kind] else {
                    continue;
                };
                let marker = self
                    .named(id)
                    .filter(|node| node.tag_name().name() == "marker");
                if let Some(marker) = marker {
                    if state.copies.contains(&marker.id()) {
                        return Err(self.fault(marker, "a marker that holds itself".into()));
                    }
                    let own = self.sheet.of(marker);
                    self.marker(&own, state, (vertex, kind == 0), inks, sink)
                        .map_err(|fault| PathFault {
                            reason: format!(
                                "{} (in the marker of {})",
                                fault.reason,
                                declared.node.tag_name().name()
                            ),
                            ..fault
                        })?;
                }
            }
        }
        Ok(())
    }

    fn marker(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
        (vertex, is_start): (&Vertex, bool),
        inks: [Option<Ink>; 2],
        sink: Sink,
    ) -> Result<(), PathFault> {
        let node = declared.node;
        let mut copies = Vec::clone(&state.copies);
        copies.push(node.id());
        let style = Style {
            context: Some(Rc::new(inks)),
            ..self.style_of(node, state.view)?
        };
        let mut inner = DrawState {
            style: Rc::new(style),
            copies: Rc::new(copies),
            depth: state.depth + 1,
            ..state.clone()
        };
        let length = |name, axis, initial| self.length(declared, &inner, (name, axis), initial);
        let sides = [
            length("markerWidth", PartAxis::X, 3.0)?,
            length("markerHeight", PartAxis::Y, 3.0)?,
        ];
        if sides.iter().any(|side| *side <= 0.0) {
            return Ok(());
        }
        let at_edge = |name: &str, axis| {
            let text = match (node.attribute(name).unwrap_or("0"), axis) {
                ("left", PartAxis::X) | ("top", PartAxis::Y) => "0",
                ("center", _) => "50%",
                ("right", PartAxis::X) | ("bottom", PartAxis::Y) => "100%",
                (other, _) => other,
            };
            let frame = inner.style.frame(sides);
            frame
                .length(text, axis)
                .ok_or_else(|| self.unknown(node, name, text))
        };
        let [x, y] = [at_edge("refX", PartAxis::X)?, at_edge("refY", PartAxis::Y)?];
        let turn = match node.attribute("orient").map(str::trim) {
            Some("auto") => vertex.angle(),
            Some("auto-start-reverse") if is_start => vertex.angle() + std::f64::consts::PI,
            Some("auto-start-reverse") => vertex.angle(),
            Some(text) => angle_of(text).ok_or_else(|| self.unknown(node, "orient", text))?,
            None => 0.0,
        };
        let scale = match node.attribute("markerUnits") {
            Some("userSpaceOnUse") => 1.0,
            _ => state.style.stroke_width,
        };
        if scale <= 0.0 {
            return Ok(());
        }
        let [px, py] = vertex.place;
        let place =
            inner.map * Affine::translate((px, py)) * Affine::rotate(turn) * Affine::scale(scale);
        let fit = self.view_map(node, sides)?;
        // The reference point is in the units of the view box.
        let reference = super::curve::map_point(&fit, [x, y]);
        let place = place * Affine::translate((-reference[0], -reference[1]));
        inner.map = place * fit;
        let overflow = self.value(declared, &inner.style, "overflow");
        if !matches!(overflow.as_deref(), Some("visible" | "auto")) {
            let edge = rectangle([0.0; 2], sides, [0.0; 2]).mapped(&place);
            let shapes = vec![RegionShape::new(vec![edge], true, true)];
            inner = inner.clipped(vec![ClipRegion { shapes }]);
        }
        self.children(node, &inner, sink)
    }
}

impl Vertex {
    /// Direction of a marker, rad: between those of the outline before and behind.
    fn angle(&self) -> f64 {
        let angle = |way: [f64; 2]| libm::atan2(way[1], way[0]);
        match self.ways.map(|way| way.map(angle)) {
            [Some(before), Some(behind)] => {
                let turn =
                    (behind - before + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU);
                before + 0.5 * (turn - std::f64::consts::PI)
            }
            [Some(angle), None] | [None, Some(angle)] => angle,
            [None, None] => 0.0,
        }
    }
}

/// Vertices of all outlines, in their order.
fn vertices(chains: &[CurveChain]) -> Vec<Vertex> {
    let mut found = Vec::new();
    for chain in chains {
        let first = found.len();
        found.push(Vertex {
            place: chain.start,
            ways: [None, None],
        });
        for (from, curve) in chain.curves() {
            let ways = ways(from, curve);
            if let Some(last) = found.last_mut() {
                last.ways[1] = ways[0];
            }
            found.push(Vertex {
                place: curve.end(),
                ways: [ways[1], None],
            });
        }
        if chain.closed && found.len() > first + 1 {
            let end = found.len() - 1;
            let (goes, comes) = (found[first].ways[1], found[end].ways[0]);
            found[first].ways[0] = comes;
            found[end].ways[1] = goes;
        }
    }
    found
}

/// Directions at the start and the end of a curve.
fn ways(from: [f64; 2], curve: &PathCurve) -> [Option<[f64; 2]>; 2] {
    let way = |a: [f64; 2], b: [f64; 2]| (a != b).then(|| [b[0] - a[0], b[1] - a[1]]);
    match *curve {
        PathCurve::Line(to) => [way(from, to); 2],
        PathCurve::Bezier([b, c, d]) => [
            way(from, b).or(way(from, c)).or(way(from, d)),
            way(c, d).or(way(b, d)).or(way(from, d)),
        ],
        PathCurve::Arc { axes, ends, .. } => ends.map(|angle| {
            let (sin, cos) = libm::sincos(angle);
            let sense = (ends[1] - ends[0]).signum();
            Some([0, 1].map(|i| sense * (cos * axes[1][i] - sin * axes[0][i])))
        }),
    }
}
