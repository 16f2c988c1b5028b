//! Gradients and patterns: whether they show anything.

use super::XmlNode;
use super::paint::{BLACK, Paint, Server};
use super::values::part;
use super::walk::{FileWalk, link_of};
use crate::PathFault;

/// Most gradients that are named one by another.
const LINKS_MAX: usize = 32;

impl<'d> FileWalk<'d> {
    /// Gradient or pattern of a name. None: the file has none.
    pub(super) fn server(&self, id: &str, view: [f64; 2]) -> Result<Option<Server>, PathFault> {
        if let Some(known) = self.servers.0.borrow().get(id) {
            return Ok(*known);
        }
        let found = match self.named(id) {
            Some(node) => self.read_server(node, view)?,
            None => None,
        };
        self.servers.0.borrow_mut().insert(id.to_owned(), found);
        Ok(found)
    }

    fn read_server(
        &self,
        node: XmlNode<'d, 'd>,
        view: [f64; 2],
    ) -> Result<Option<Server>, PathFault> {
        let is_pattern = match node.tag_name().name() {
            "linearGradient" | "radialGradient" => false,
            "pattern" => true,
            "meshgradient" | "hatch" | "solidColor" | "solidcolor" => {
                return Ok(Some(Server {
                    alpha: 1.0,
                    of_box: false,
                }));
            }
            _ => return Ok(None),
        };
        // What one does not say, that which it names says.
        let mut chain = vec![node];
        while let Some(next) = chain
            .last()
            .and_then(|last| link_of(*last))
            .and_then(|link| self.named(link.strip_prefix('#')?))
            .filter(|_| chain.len() < LINKS_MAX)
        {
            chain.push(next);
        }
        let units = if is_pattern {
            "patternUnits"
        } else {
            "gradientUnits"
        };
        let units = chain.iter().find_map(|node| node.attribute(units));
        let of_box = units != Some("userSpaceOnUse");
        let parts = |node: &XmlNode<'d, 'd>| {
            let kept = |part: &XmlNode| {
                self.is_svg(*part) && (is_pattern || part.tag_name().name() == "stop")
            };
            node.children().filter(kept).collect::<Vec<_>>()
        };
        let own = chain.iter().map(parts).find(|parts| !parts.is_empty());
        let Some(parts) = own else {
            // Without stops, or without a drawing, it shows nothing.
            return Ok(Some(Server { alpha: 0.0, of_box }));
        };
        let mut alpha: f64 = if is_pattern { 1.0 } else { 0.0 };
        for stop in parts.into_iter().filter(|_| !is_pattern) {
            let declared = self.sheet.of(stop);
            let style = self.style_of(stop, view)?;
            let colour = match self.value(&declared, &style, "stop-color") {
                None => BLACK,
                Some(value) => match Paint::read(&value) {
                    Some(Paint::Colour(colour)) => colour,
                    Some(Paint::Current) => style.colour,
                    _ => return Err(self.unknown(stop, "stop-color", &value)),
                },
            };
            let opacity = match self.value(&declared, &style, "stop-opacity") {
                None => 1.0,
                Some(value) => {
                    part(&value).ok_or_else(|| self.unknown(stop, "stop-opacity", &value))?
                }
            };
            alpha = alpha.max(colour.alpha * opacity);
        }
        Ok(Some(Server { alpha, of_box }))
    }
}
