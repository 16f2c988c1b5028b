//! State in which an element is drawn: place, style, opacity, clips.

use super::XmlNode;
use super::css::Declared;
use super::paint::SEEN;
use super::region::Region;
use super::style::Style;
use super::values::part;
use super::walk::Walk;
use crate::PathFault;
use kurbo::{Affine, Rect};
use roxmltree::NodeId;
use std::borrow::Cow;
use std::rc::Rc;

/// Purpose of a walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// Figures that are seen.
    Draw,
    /// Sizes: all figures.
    Bounds,
    /// Shapes of a clip path: their paint has no effect.
    Clip,
}

/// State in which an element is drawn.
#[derive(Clone)]
pub(super) struct State<'d> {
    /// From user units to m on the page, upward.
    pub(super) map: Affine,
    pub(super) style: Rc<Style>,
    /// Sides of the viewport, in user units.
    pub(super) view: [f64; 2],
    /// Opacity of all groups around.
    pub(super) alpha: f64,
    pub(super) clips: Rc<Vec<Region>>,
    /// Clips around those.
    pub(super) outer: Option<Rc<State<'d>>>,
    pub(super) layer: &'d str,
    /// Elements that are being copied.
    pub(super) copies: Rc<Vec<NodeId>>,
    pub(super) depth: u32,
    pub(super) mode: Mode,
}

impl<'d> State<'d> {
    pub(super) fn first(map: Affine, view: [f64; 2]) -> Self {
        Self {
            map,
            style: Rc::default(),
            view,
            alpha: 1.0,
            clips: Rc::default(),
            outer: None,
            layer: "",
            copies: Rc::default(),
            depth: 0,
            mode: Mode::Draw,
        }
    }

    /// The state behind another clip.
    pub(super) fn clipped(self, regions: Vec<Region>) -> Self {
        if regions.is_empty() {
            return self;
        }
        Self {
            clips: Rc::new(regions),
            outer: Some(Rc::new(self.clone())),
            ..self
        }
    }

    /// Regions of all clips around.
    pub(super) fn regions(&self) -> Vec<&Region> {
        let mut found: Vec<&Region> = Vec::new();
        let mut state = Some(self);
        while let Some(inner) = state {
            if inner.outer.is_some() {
                found.extend(inner.clips.iter());
            }
            state = inner.outer.as_deref();
        }
        found
    }
}

impl<'d> Walk<'d> {
    /// State of an element in one of the state `above`. None: nothing of it is seen.
    pub(super) fn state(
        &self,
        declared: &Declared<'d>,
        above: &State<'d>,
    ) -> Result<Option<State<'d>>, PathFault> {
        let node = declared.node;
        let style = self.within(&above.style, declared, above.view)?;
        let mut state = State {
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
        declared: &Declared<'d>,
        style: &Style,
        name: &str,
    ) -> Option<Cow<'d, str>> {
        let value = style.value(declared.get(name)?)?;
        match value.trim() {
            "initial" | "unset" | "revert" | "" => None,
            _ => Some(value),
        }
    }

    pub(super) fn opacity(&self, declared: &Declared<'d>, style: &Style) -> Result<f64, PathFault> {
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
    fn transform(&self, declared: &Declared<'d>, state: &State<'d>) -> Result<Affine, PathFault> {
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
        declared: &Declared<'d>,
        state: &State<'d>,
    ) -> Result<Option<Rect>, PathFault> {
        let inner = State {
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
    fn refuse_effects(&self, declared: &Declared<'d>, state: &State<'d>) -> Result<(), PathFault> {
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
