//! Walk through the elements of a file: each gives figures, is seen by nobody, or is refused.

use super::css::{DeclaredStyle, Sheet};
use super::figure::Sink;
use super::paint::Servers;
use super::state::{DrawState, Mode};
use super::style::Style;
use super::{COPIES_MAX, SVG, XmlNode, layers};
use crate::PathFault;
use kurbo::Affine;
use roxmltree::Document;
use std::cell::Cell;
use std::collections::HashMap;

/// Most elements within each other.
pub(super) const DEPTH_MAX: u32 = 200;

/// Elements that are no drawing themselves: others draw by them, or nobody does.
pub(super) const UNDRAWN: [&str; 37] = [
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

/// A file, and what its elements are looked up in.
pub(super) struct FileWalk<'d> {
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

impl<'d> FileWalk<'d> {
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
        declared: &DeclaredStyle<'d>,
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
        let first = DrawState::first(map, self.root_view()?);
        if self.is_left_out(&declared, &first.style) {
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
        above: &DrawState<'d>,
        sink: Sink,
    ) -> Result<(), PathFault> {
        for child in node.children() {
            self.element(child, above, sink)?;
        }
        Ok(())
    }

    /// Returns true for an element that is left out with all that is in it.
    pub(super) fn is_left_out(&self, declared: &DeclaredStyle<'d>, above: &Style) -> bool {
        let display = declared.get("display");
        let display = display.and_then(|value| above.value(value));
        display.is_some_and(|value| value.trim().eq_ignore_ascii_case("none"))
            || !conditions(declared.node)
    }

    /// Figures of an element in one of the state `above`.
    pub(super) fn element(
        &self,
        node: XmlNode<'d, 'd>,
        above: &DrawState<'d>,
        sink: Sink,
    ) -> Result<(), PathFault> {
        // Elements of other kinds are not drawn, nor what is in them.
        if !self.is_svg(node) || UNDRAWN.contains(&node.tag_name().name()) {
            return Ok(());
        }
        let declared = self.sheet.of(node);
        if self.is_left_out(&declared, &above.style) {
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
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
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
                        &DrawState {
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
