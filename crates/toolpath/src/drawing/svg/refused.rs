//! Elements without an outline: seen by nobody, or refused.

use super::XmlNode;
use super::css::DeclaredStyle;
use super::state::{DrawState, Mode};
use super::values::PartAxis;
use super::walk::{DEPTH_MAX, FileWalk, UNDRAWN, link_of};
use crate::PathFault;
use std::rc::Rc;

impl<'d> FileWalk<'d> {
    /// Refuses an element that is seen, and has no outline.
    pub(super) fn refuse(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
    ) -> Result<(), PathFault> {
        let node = declared.node;
        let size = |name, axis| self.length(declared, state, (name, axis), 1.0);
        let has_size = || -> Result<bool, PathFault> {
            Ok(size("width", PartAxis::X)? > 0.0 && size("height", PartAxis::Y)? > 0.0)
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
                is_visible
                    && has_size()?
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
    fn has_letters(&self, node: XmlNode<'d, 'd>, state: &DrawState<'d>) -> Result<bool, PathFault> {
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
            if self.is_left_out(&declared, &state.style) {
                continue;
            }
            let style = self.within(&state.style, &declared, state.view)?;
            let inner = DrawState {
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
