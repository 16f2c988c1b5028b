//! Entry into an element: from the state around to its own.

use super::XmlNode;
use super::css::DeclaredStyle;
use super::paint::SEEN;
use super::state::{DrawState, Mode};
use super::style::Style;
use super::values::part;
use super::walk::FileWalk;
use crate::PathFault;
use kurbo::{Affine, Rect};
use std::borrow::Cow;
use std::rc::Rc;

impl<'d> FileWalk<'d> {
    /// State of an element in one of the state `above`. None: nothing of it is seen.
    pub(super) fn state(
        &self,
        declared: &DeclaredStyle<'d>,
        above: &DrawState<'d>,
    ) -> Result<Option<DrawState<'d>>, PathFault> {
        let node = declared.node;
        let style = self.within(&above.style, declared, above.view)?;
        let mut state = DrawState {
            depth: above.depth + 1,
            ..above.clone()
        };
        if state.mode != Mode::Bounds {
            state.alpha *= self.opacity(declared, &style)?;
        }
        state.style = Rc::new(style);
        if state.mode == Mode::Draw && state.alpha <= SEEN {
            return Ok(None);
        }
        state.map *= self.transform(declared, &state)?;
        // Where a map has no area, nothing is seen.
        let det = state.map.determinant();
        if det == 0.0 || !det.is_finite() {
            return Ok(None);
        }
        match state.mode {
            Mode::Bounds => Ok(Some(state)),
            Mode::Clip | Mode::Draw => {
                self.refuse_effects(declared, &state)?;
                let regions = self.clips_of(declared, &state)?;
                if regions.iter().any(|region| region.shapes.is_empty()) {
                    return Ok(None);
                }
                if state.mode == Mode::Clip && !regions.is_empty() {
                    let reason =
                        "a clip within a clip path is not read; apply it in the drawing program";
                    return Err(self.fault(node, reason.into()));
                }
                Ok(Some(state.clipped(regions)))
            }
        }
    }

    /// Value of a property that is not handed down.
    pub(super) fn value(
        &self,
        declared: &DeclaredStyle<'d>,
        style: &Style,
        name: &str,
    ) -> Option<Cow<'d, str>> {
        let value = style.value(declared.get(name)?)?;
        match value.trim() {
            "initial" | "unset" | "revert" | "" => None,
            _ => Some(value),
        }
    }

    pub(super) fn opacity(
        &self,
        declared: &DeclaredStyle<'d>,
        style: &Style,
    ) -> Result<f64, PathFault> {
        let Some(value) = self.value(declared, style, "opacity") else {
            return Ok(1.0);
        };
        part(&value).ok_or_else(|| self.unknown(declared.node, "opacity", &value))
    }

    pub(super) fn unknown(&self, node: XmlNode, name: &str, value: &str) -> PathFault {
        let reason =
            format!("{name}: {value:.60}: the value is not known; write it in another way");
        self.fault(node, reason)
    }

    /// Map of an element's transforms.
    fn transform(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
    ) -> Result<Affine, PathFault> {
        let style = &state.style;
        let frame = style.frame(state.view);
        for name in ["offset-path", "offset", "zoom"] {
            let given = declared
                .style(name)
                .filter(|value| !matches!(*value, "none" | "1" | "normal" | "100%"));
            if let Some(value) = given {
                return Err(self.unknown(declared.node, name, value));
            }
        }
        let mut map = Affine::IDENTITY;
        let mut is_moved = false;
        for name in ["translate", "rotate", "scale"] {
            let Some(value) = declared.style(name).and_then(|value| style.value(value)) else {
                continue;
            };
            if value == "none" {
                continue;
            }
            let words = value.split_whitespace().collect::<Vec<_>>().join(",");
            let step = frame.transform(&format!("{name}({words})"), true);
            map *= step.ok_or_else(|| self.unknown(declared.node, name, &value))?;
            is_moved = true;
        }
        if let Some(value) = self.value(declared, style, "transform") {
            let is_style = declared.style("transform").is_some();
            let step = frame.transform(&value, is_style);
            map *= step.ok_or_else(|| self.unknown(declared.node, "transform", &value))?;
            is_moved = true;
        }
        if !is_moved {
            return Ok(map);
        }
        let own_box = matches!(
            declared.get("transform-box"),
            Some("fill-box" | "content-box" | "stroke-box" | "border-box")
        );
        let origin = self.value(declared, style, "transform-origin");
        let Some(origin) = origin.or(own_box.then_some("0 0".into())) else {
            return Ok(map);
        };
        let (corner, sides) = match own_box {
            true => {
                let bounds = self.bounds(declared, state)?.unwrap_or(Rect::ZERO);
                ([bounds.x0, bounds.y0], [bounds.width(), bounds.height()])
            }
            false => ([0.0; 2], state.view),
        };
        let point = frame.origin(&origin, corner, sides);
        let [x, y] =
            point.ok_or_else(|| self.unknown(declared.node, "transform-origin", &origin))?;
        Ok(Affine::translate((x, y)) * map * Affine::translate((-x, -y)))
    }

    /// Box around all that an element holds, in its own units. None: it holds nothing.
    pub(super) fn bounds(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
    ) -> Result<Option<Rect>, PathFault> {
        let inner = DrawState {
            map: Affine::IDENTITY,
            mode: Mode::Bounds,
            ..state.clone()
        };
        let mut found: Option<Rect> = None;
        self.content(declared, &inner, &mut |figure| {
            for chain in &figure.chains {
                let chain = chain.mapped(&figure.map);
                for [x, y] in chain.points(1e-3) {
                    let point = Rect::new(x, y, x, y);
                    found = Some(found.map_or(point, |all| all.union(point)));
                }
            }
            Ok(())
        })?;
        Ok(found)
    }

    /// Refuses filters that move what they show.
    fn refuse_effects(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
    ) -> Result<(), PathFault> {
        let Some(value) = self.value(declared, &state.style, "filter") else {
            return Ok(());
        };
        let refused =
            |reason: &str| Err(self.fault(declared.node, format!("filter: {value:.60}: {reason}")));
        let Some(id) = super::style::reference(&value) else {
            return match value.contains("opacity(") {
                true => refused("a filter that hides is not read; use opacity"),
                false => Ok(()),
            };
        };
        let filter = id.and_then(|id| self.named(id));
        let Some(filter) = filter else { return Ok(()) };
        let steps = || filter.children().filter(|step| step.is_element());
        let moves = |step: &XmlNode| {
            let name = step.tag_name().name();
            matches!(
                name,
                "feOffset" | "feImage" | "feTile" | "feDisplacementMap" | "feTurbulence"
            )
        };
        // A shadow behind the shape leaves the shape.
        let shows_source = steps().any(|step| {
            let inputs = ["in", "in2"].map(|name| step.attribute(name));
            let merges = step.children().filter_map(|node| node.attribute("in"));
            let joins = matches!(
                step.tag_name().name(),
                "feBlend" | "feComposite" | "feMerge"
            );
            joins
                && inputs
                    .into_iter()
                    .flatten()
                    .chain(merges)
                    .any(|name| name == "SourceGraphic")
        });
        match steps().any(|step| moves(&step)) && !shows_source {
            true => refused(
                "a filter that moves its shape is not read; apply it in the drawing program",
            ),
            false => Ok(()),
        }
    }
}
