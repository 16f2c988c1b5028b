//! State in which an element is drawn: place, style, opacity, clips.

use super::region::ClipRegion;
use super::style::Style;
use kurbo::Affine;
use roxmltree::NodeId;
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
pub(super) struct DrawState<'d> {
    /// From user units to m on the page, upward.
    pub(super) map: Affine,
    pub(super) style: Rc<Style>,
    /// Sides of the viewport, in user units.
    pub(super) view: [f64; 2],
    /// Opacity of all groups around.
    pub(super) alpha: f64,
    pub(super) clips: Rc<Vec<ClipRegion>>,
    /// Clips around those.
    pub(super) outer: Option<Rc<DrawState<'d>>>,
    pub(super) layer: &'d str,
    /// Elements that are being copied.
    pub(super) copies: Rc<Vec<NodeId>>,
    pub(super) depth: u32,
    pub(super) mode: Mode,
}

impl<'d> DrawState<'d> {
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
    pub(super) fn clipped(self, regions: Vec<ClipRegion>) -> Self {
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
    pub(super) fn regions(&self) -> Vec<&ClipRegion> {
        let mut found: Vec<&ClipRegion> = Vec::new();
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
