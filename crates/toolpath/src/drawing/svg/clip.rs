//! Clip paths and masks: the regions that they leave.

use super::XmlNode;
use super::css::DeclaredStyle;
use super::figure::SeenFigure;
use super::paint::SEEN;
use super::path::rectangle;
use super::region::{ClipRegion, RegionShape};
use super::state::{DrawState, Mode};
use super::style::{Ink, reference};
use super::values::PartAxis;
use super::walk::FileWalk;
use crate::PathFault;
use kurbo::{Affine, Rect};
use std::rc::Rc;

/// Opacity from which a mask shows a shape as it is.
const WHOLE: f64 = 1.0 - SEEN;

/// Most clip paths within each other.
const CLIPS_MAX: usize = 16;

impl<'d> FileWalk<'d> {
    /// Regions of the clip path and the mask of an element.
    pub(super) fn clips_of(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
    ) -> Result<Vec<ClipRegion>, PathFault> {
        let mut regions = Vec::new();
        for name in ["clip-path", "-webkit-clip-path"] {
            if let Some(node) = self.referred(declared, state, name, "clipPath")? {
                self.add_clip(node, declared, state, &mut regions)?;
                break;
            }
        }
        for name in ["mask", "-webkit-mask", "mask-image"] {
            if let Some(node) = self.referred(declared, state, name, "mask")? {
                self.add_mask(node, declared, state, &mut regions)?;
                break;
            }
        }
        Ok(regions)
    }

    /// Element of a kind that a property names. None: it names none, or one that the file does not have.
    fn referred(
        &self,
        declared: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
        name: &str,
        kind: &str,
    ) -> Result<Option<XmlNode<'d, 'd>>, PathFault> {
        let Some(value) = self.value(declared, &state.style, name) else {
            return Ok(None);
        };
        let Some(id) = reference(&value) else {
            let reason = format!(
                "{name}: {value:.60}: a shape that is no {kind} of this file; apply it in the drawing program"
            );
            return Err(self.fault(declared.node, reason));
        };
        let found = id.and_then(|id| self.named(id));
        Ok(found.filter(|node| node.tag_name().name() == kind))
    }

    /// State within a clip path or a mask: its style is that of its own place in the file.
    fn inner_state(
        &self,
        node: XmlNode<'d, 'd>,
        units: &str,
        by: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
    ) -> Result<Option<DrawState<'d>>, PathFault> {
        let mut map = state.map;
        let mut view = state.view;
        if node.attribute(units) == Some("objectBoundingBox") {
            let Some(bounds) = self.bounds(by, state)?.filter(|all| all.area() > 0.0) else {
                return Ok(None);
            };
            map *= of_box(bounds);
            view = [1.0; 2];
        }
        Ok(Some(DrawState {
            style: Rc::new(self.style_of(node, view)?),
            layer: "",
            ..DrawState::first(map, view)
        }))
    }

    fn add_clip(
        &self,
        node: XmlNode<'d, 'd>,
        by: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
        regions: &mut Vec<ClipRegion>,
    ) -> Result<(), PathFault> {
        if regions.len() >= CLIPS_MAX {
            return Err(self.fault(
                node,
                format!("more than {CLIPS_MAX} clip paths on each other"),
            ));
        }
        let declared = self.sheet.of(node);
        let mut shapes = Vec::new();
        if let Some(mut inner) = self.inner_state(node, "clipPathUnits", by, state)? {
            let frame = inner.style.frame(inner.view);
            if let Some(value) = self.value(&declared, &inner.style, "transform") {
                let is_style = declared.style("transform").is_some();
                let map = frame.transform(&value, is_style);
                inner.map *= map.ok_or_else(|| self.unknown(node, "transform", &value))?;
            }
            inner.mode = Mode::Clip;
            self.children(node, &inner, &mut |figure| {
                shapes.push(region_of(&figure, figure.style.clips_non_zero, true));
                Ok(())
            })?;
        }
        regions.push(ClipRegion { shapes });
        match self.referred(&declared, state, "clip-path", "clipPath")? {
            Some(outer) => self.add_clip(outer, by, state, regions),
            None => Ok(()),
        }
    }

    fn add_mask(
        &self,
        node: XmlNode<'d, 'd>,
        by: &DeclaredStyle<'d>,
        state: &DrawState<'d>,
        regions: &mut Vec<ClipRegion>,
    ) -> Result<(), PathFault> {
        let declared = self.sheet.of(node);
        let refused = |at: XmlNode, what: &str| {
            let id = node.attribute("id").unwrap_or_default();
            let reason = format!(
                "{what} in the mask #{id} of {}; a mask is applied if all in it is filled white or black: apply it in the drawing program",
                by.node.tag_name().name()
            );
            self.fault(at, reason)
        };
        let is_alpha = matches!(declared.get("mask-type"), Some("alpha"))
            || matches!(by.get("mask-mode"), Some("alpha"));
        let mut shapes = Vec::new();
        if let Some(inner) = self.inner_state(node, "maskContentUnits", by, state)? {
            self.children(node, &inner, &mut |figure| {
                if figure.stroke.is_some() {
                    return Err(refused(figure.node, "a line"));
                }
                let Some(Ink { rgb, alpha }) = figure.fill else {
                    return Ok(());
                };
                let adds = match (rgb, is_alpha) {
                    (Some([255, 255, 255]), _) | (Some(_), true) => true,
                    (Some([0, 0, 0]), false) => false,
                    _ => return Err(refused(figure.node, "grey, a colour or a gradient")),
                };
                if alpha < WHOLE {
                    return Err(refused(figure.node, "what is half seen"));
                }
                if !figure.regions.is_empty() {
                    return Err(refused(figure.node, "a clip"));
                }
                shapes.push(region_of(&figure, figure.style.is_non_zero, adds));
                Ok(())
            })?;
        }
        regions.push(ClipRegion { shapes });
        // The rectangle of a mask, if it names one: that which it has otherwise is wider than what it masks.
        let sides = ["x", "y", "width", "height"];
        if sides.iter().any(|name| node.attribute(*name).is_some()) {
            let is_user = node.attribute("maskUnits") == Some("userSpaceOnUse");
            let mut inner = DrawState {
                style: Rc::new(self.style_of(node, state.view)?),
                ..DrawState::first(state.map, state.view)
            };
            if !is_user {
                let Some(bounds) = self.bounds(by, state)? else {
                    return Ok(());
                };
                inner.map *= of_box(bounds);
                inner.view = [1.0; 2];
            }
            let [width, height] = inner.view;
            let side =
                |name, axis, initial: f64| self.length(&declared, &inner, (name, axis), initial);
            let corner = [
                side("x", PartAxis::X, -0.1 * width)?,
                side("y", PartAxis::Y, -0.1 * height)?,
            ];
            let sides = [
                side("width", PartAxis::X, 1.2 * width)?,
                side("height", PartAxis::Y, 1.2 * height)?,
            ];
            let edge = rectangle(corner, sides, [0.0; 2]).mapped(&inner.map);
            let shapes = vec![RegionShape::new(vec![edge], true, true)];
            regions.push(ClipRegion { shapes });
        }
        if let Some(outer) = self.referred(&declared, state, "mask", "mask")? {
            return Err(self.fault(
                outer,
                "a mask of a mask is not read; apply it in the drawing program".into(),
            ));
        }
        Ok(())
    }
}

/// From parts of a bounding box to user units.
fn of_box(bounds: Rect) -> Affine {
    Affine::translate(bounds.origin().to_vec2())
        * Affine::scale_non_uniform(bounds.width(), bounds.height())
}

/// Inside of a figure: added to a region, or taken out.
fn region_of(figure: &SeenFigure, is_non_zero: bool, adds: bool) -> RegionShape {
    let chains = figure.chains.iter().map(|chain| chain.mapped(&figure.map));
    RegionShape::new(chains.collect(), is_non_zero, adds)
}
