//! Walk through the elements of a file: each gives figures, is seen by nobody, or is refused.

use super::css::{Declared, Sheet};
use super::figure::Figure;
use super::server::Servers;
use super::state::{Mode, State};
use super::style::Style;
use super::{COPIES_MAX, SVG, XmlNode, layers};
use crate::PathFault;
use kurbo::Affine;
use roxmltree::Document;
use std::cell::Cell;
use std::collections::HashMap;
use std::rc::Rc;

/// Most elements within each other.
const DEPTH_MAX: u32 = 200;

/// Elements that are no drawing themselves: others draw by them, or nobody does.
const UNDRAWN: [&str; 37] = [
    "defs",
    "title",
    "desc",
    "metadata",
    "style",
    "script",
    "clipPath",
    "mask",
    "marker",
    "pattern",
    "linearGradient",
    "radialGradient",
    "filter",
    "symbol",
    "view",
    "animate",
    "animateColor",
    "animateMotion",
    "animateTransform",
    "set",
    "discard",
    "mpath",
    "font",
    "font-face",
    "glyph",
    "missing-glyph",
    "hkern",
    "vkern",
    "cursor",
    "color-profile",
    "solidColor",
    "solidcolor",
    "hatch",
    "meshgradient",
    "tref",
    "stop",
    "link",
];

/// Receiver of figures.
pub(super) type Sink<'s> = &'s mut dyn FnMut(Figure) -> Result<(), PathFault>;

/// A file, and what its elements are looked up in.
pub(super) struct Walk<'d> {
    pub(super) document: &'d Document<'d>,
    pub(super) sheet: &'d Sheet<'d>,
    ids: HashMap<&'d str, XmlNode<'d, 'd>>,
    layers: HashMap<&'d str, &'d str>,
    /// Elements that may yet be drawn as copies.
    left: Cell<u32>,
    pub(super) servers: Servers,
    /// Namespace of the elements that are drawn.
    namespace: Option<&'d str>,
}

impl<'d> Walk<'d> {
    pub(super) fn new(document: &'d Document<'d>, sheet: &'d Sheet<'d>) -> Result<Self, PathFault> {
        let mut ids = HashMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                ids.entry(id).or_insert(node);
            }
        }
        let root = document.root_element();
        let namespace = root.tag_name().namespace();
        let walk = Self {
            document,
            sheet,
            ids,
            layers: layers(document),
            left: Cell::new(COPIES_MAX),
            servers: Servers::default(),
            namespace,
        };
        if root.tag_name().name() != "svg" || !matches!(namespace, None | Some(SVG)) {
            return Err(walk.fault(root, "no SVG: its first element is not svg".into()));
        }
        Ok(walk)
    }

    /// Refusal of an element, by line, kind and id.
    pub(super) fn fault(&self, node: XmlNode, reason: String) -> PathFault {
        let name = node.tag_name().name();
        PathFault {
            line: self.document.text_pos_at(node.range().start).row,
            word: match node.attribute("id") {
                Some(id) if !id.is_empty() => format!("{name}#{id}"),
                _ => name.to_owned(),
            },
            reason,
        }
    }

    pub(super) fn named(&self, id: &str) -> Option<XmlNode<'d, 'd>> {
        self.ids.get(id).copied()
    }

    /// Returns true for an element of SVG.
    pub(super) fn is_svg(&self, node: XmlNode) -> bool {
        node.is_element() && node.tag_name().namespace() == self.namespace
    }

    /// Style of an element by those that hold it in the file.
    pub(super) fn style_of(
        &self,
        node: XmlNode<'d, 'd>,
        view: [f64; 2],
    ) -> Result<Style, PathFault> {
        let mut above: Vec<_> = node.ancestors().filter(|node| node.is_element()).collect();
        above.reverse();
        let mut style = Style::default();
        for node in above {
            style = self.within(&style, &self.sheet.of(node), view)?;
        }
        Ok(style)
    }

    pub(super) fn within(
        &self,
        above: &Style,
        declared: &Declared<'d>,
        view: [f64; 2],
    ) -> Result<Style, PathFault> {
        above.within(declared, view).map_err(|(name, value)| {
            let shown: String = value.chars().take(60).collect();
            let reason =
                format!("{name}: {shown}: the value is not known; write it in another way");
            self.fault(declared.node, reason)
        })
    }

    /// Draws the whole file.
    pub(super) fn draw(&self, map: Affine, sink: Sink) -> Result<(), PathFault> {
        let root = self.document.root_element();
        let declared = self.sheet.of(root);
        let first = State::first(map, self.root_view()?);
        if self.is_left_out(root, &declared) {
            return Ok(());
        }
        match self.state(&declared, &first)? {
            Some(state) => self.children(root, &state, sink),
            None => Ok(()),
        }
    }

    pub(super) fn children(
        &self,
        node: XmlNode<'d, 'd>,
        above: &State<'d>,
        sink: Sink,
    ) -> Result<(), PathFault> {
        for child in node.children() {
            self.element(child, above, sink)?;
        }
        Ok(())
    }

    /// Returns true for an element that is left out with all that is in it.
    fn is_left_out(&self, node: XmlNode<'d, 'd>, declared: &Declared<'d>) -> bool {
        declared.get("display") == Some("none") || !conditions(node)
    }

    /// Figures of an element in one of the state `above`.
    pub(super) fn element(
        &self,
        node: XmlNode<'d, 'd>,
        above: &State<'d>,
        sink: Sink,
    ) -> Result<(), PathFault> {
        // Elements of other kinds are not drawn, nor what is in them.
        if !self.is_svg(node) || UNDRAWN.contains(&node.tag_name().name()) {
            return Ok(());
        }
        let declared = self.sheet.of(node);
        if self.is_left_out(node, &declared) {
            return Ok(());
        }
        if !above.copies.is_empty() {
            let left = self.left.get().checked_sub(1);
            self.left.set(left.ok_or_else(|| {
                self.fault(
                    node,
                    format!("more than {COPIES_MAX} elements are drawn as copies"),
                )
            })?);
        }
        if above.depth > DEPTH_MAX {
            return Err(self.fault(
                node,
                format!("more than {DEPTH_MAX} elements within each other; ungroup them"),
            ));
        }
        match self.state(&declared, above)? {
            Some(state) => self.content(&declared, &state, sink),
            None => Ok(()),
        }
    }

    /// Figures of an element, in its own state.
    pub(super) fn content(
        &self,
        declared: &Declared<'d>,
        state: &State<'d>,
        sink: Sink,
    ) -> Result<(), PathFault> {
        let node = declared.node;
        let name = node.tag_name().name();
        if state.mode == Mode::Clip && matches!(name, "g" | "a" | "svg" | "switch") {
            return Err(self.fault(
                node,
                "a group has no effect in a clip path; ungroup it".into(),
            ));
        }
        match name {
            "g" | "a" => {
                let layer = node.attribute("id").and_then(|id| self.layers.get(id));
                match layer {
                    Some(layer) => self.children(
                        node,
                        &State {
                            layer,
                            ..state.clone()
                        },
                        sink,
                    ),
                    None => self.children(node, state, sink),
                }
            }
            "switch" => {
                let mut children = node.children().filter(|child| self.is_svg(*child));
                match children.find(|child| conditions(*child)) {
                    Some(child) => self.element(child, state, sink),
                    None => Ok(()),
                }
            }
            "svg" => self.inner_svg(declared, None, state, sink),
            "use" => self.copy(declared, state, sink),
            "path" | "rect" | "circle" | "ellipse" | "line" | "polyline" | "polygon" => {
                self.shape(declared, state, sink)
            }
            _ => self.refuse(declared, state),
        }
    }

    /// Figures of the element that a `use` names.
    fn copy(
        &self,
        declared: &Declared<'d>,
        state: &State<'d>,
        sink: Sink,
    ) -> Result<(), PathFault> {
        let node = declared.node;
        let Some(link) = link_of(node) else {
            return Ok(());
        };
        let Some(id) = link.strip_prefix('#') else {
            let reason =
                format!("it draws from another file, {link:.60}; put the shapes into this one");
            return Err(self.fault(node, reason));
        };
        let target = self.named(id).ok_or_else(|| {
            self.fault(
                node,
                format!("it draws #{id:.60}, which the file does not have; remove it"),
            )
        })?;
        // An element that holds itself is drawn by nobody.
        let holds_itself = node.ancestors().any(|above| above == target);
        if holds_itself || state.copies.contains(&target.id()) {
            return Ok(());
        }
        let at = [("x", super::values::Axis::X), ("y", super::values::Axis::Y)];
        let [x, y] = [
            self.length(declared, state, at[0], 0.0)?,
            self.length(declared, state, at[1], 0.0)?,
        ];
        let mut copies = Vec::clone(&state.copies);
        copies.push(target.id());
        let context = match state.mode {
            Mode::Draw => Some(Rc::new(self.inks(state, None)?)),
            _ => None,
        };
        let inner = State {
            map: state.map * Affine::translate((x, y)),
            copies: Rc::new(copies),
            style: Rc::new(Style {
                context,
                ..Style::clone(&state.style)
            }),
            depth: state.depth + 1,
            ..state.clone()
        };
        match target.tag_name().name() {
            "symbol" | "svg" if self.is_svg(target) => {
                let own = self.sheet.of(target);
                if own.get("display") == Some("none") && target.tag_name().name() == "svg" {
                    return Ok(());
                }
                match self.state(&own, &inner)? {
                    Some(state) => self.inner_svg(&own, Some(declared), &state, sink),
                    None => Ok(()),
                }
            }
            _ => self.element(target, &inner, sink),
        }
    }

    /// Refuses an element that is seen, and has no outline.
    fn refuse(&self, declared: &Declared<'d>, state: &State<'d>) -> Result<(), PathFault> {
        let node = declared.node;
        let size = |name, axis| self.length(declared, state, (name, axis), 1.0);
        let has_size = || -> Result<bool, PathFault> {
            use super::values::Axis;
            Ok(size("width", Axis::X)? > 0.0 && size("height", Axis::Y)? > 0.0)
        };
        let is_visible = state.style.is_visible;
        let (is_seen, reason) = match node.tag_name().name() {
            "text" | "flowRoot" => (
                state.mode == Mode::Clip && is_visible || self.has_letters(node, state)?,
                "text has no outline; convert it to paths (Inkscape: Path, Object to Path)",
            ),
            "image" => (
                is_visible && link_of(node).is_some_and(|link| !link.is_empty()) && has_size()?,
                "an image has no outline; trace it to paths (Inkscape: Path, Trace Bitmap)",
            ),
            "foreignObject" => (
                has_size()?
                    && (node.descendants().skip(1).any(|part| {
                        let is_blank = part.text().is_none_or(|text| text.trim().is_empty());
                        part.is_element() || part.is_text() && !is_blank
                    })),
                "foreign objects are no drawing; leave them out",
            ),
            _ => (
                true,
                "the element is not known; leave it out, or convert it to paths",
            ),
        };
        // In the size of a group, what nobody sees counts for nothing.
        match is_seen && state.mode != Mode::Bounds {
            true => Err(self.fault(node, reason.into())),
            false => Ok(()),
        }
    }

    /// Returns true if text is seen: it has letters, and a fill or a stroke.
    fn has_letters(&self, node: XmlNode<'d, 'd>, state: &State<'d>) -> Result<bool, PathFault> {
        for child in node.children() {
            if child.is_text() {
                let is_blank = child.text().is_none_or(|text| text.trim().is_empty());
                if !is_blank && state.style.font_px > 0.0 && self.inks(state, None)? != [None, None]
                {
                    return Ok(true);
                }
            }
            let undrawn =
                UNDRAWN.contains(&child.tag_name().name()) && child.tag_name().name() != "tref";
            if !self.is_svg(child) || undrawn || state.depth > DEPTH_MAX {
                continue;
            }
            let declared = self.sheet.of(child);
            if self.is_left_out(child, &declared) {
                continue;
            }
            let style = self.within(&state.style, &declared, state.view)?;
            let inner = State {
                alpha: state.alpha * self.opacity(&declared, &style)?,
                style: Rc::new(style),
                depth: state.depth + 1,
                ..state.clone()
            };
            if self.has_letters(child, &inner)? {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// Address that an element names, if it has one.
pub(super) fn link_of<'d>(node: XmlNode<'d, 'd>) -> Option<&'d str> {
    let link = node
        .attribute("href")
        .or_else(|| node.attribute(("http://www.w3.org/1999/xlink", "href")));
    link.map(str::trim)
}

/// Returns true if the conditions of an element hold for an English reader in a browser.
fn conditions(node: XmlNode) -> bool {
    let has_extensions = node.attribute("requiredExtensions").is_none_or(|list| {
        let known = [
            "http://www.w3.org/1999/xhtml",
            "http://www.w3.org/1998/Math/MathML",
        ];
        list.split_whitespace().all(|name| known.contains(&name))
    });
    let language = node.attribute("systemLanguage").is_none_or(|list| {
        list.split(',').any(|name| {
            let name = name.trim().to_ascii_lowercase();
            name == "en" || name.starts_with("en-")
        })
    });
    has_extensions && language
}
