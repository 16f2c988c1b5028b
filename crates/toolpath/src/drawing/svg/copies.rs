//! Copies: elements that a `use` draws once more.

use super::css::DeclaredStyle;
use super::figure::Sink;
use super::state::{DrawState, Mode};
use super::style::Style;
use super::values::PartAxis;
use super::walk::{FileWalk, link_of};
use crate::PathFault;
use kurbo::Affine;
use std::rc::Rc;

impl<'d> FileWalk<'d> {
    /// Figures of the element that a `use` names.
    pub(super) fn copy(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
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
        let at = [("x", PartAxis::X), ("y", PartAxis::Y)];
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
        let inner = DrawState {
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
}
