//! Figures: shapes that are seen.

use super::XmlNode;
use super::chain::CurveChain;
use super::region::ClipRegion;
use super::style::{Ink, Style};
use crate::PathFault;
use kurbo::Affine;
use std::rc::Rc;

/// Receiver of figures.
pub(super) type Sink<'s> = &'s mut dyn FnMut(SeenFigure) -> Result<(), PathFault>;

/// A shape, as it is seen.
pub(super) struct SeenFigure<'f> {
    pub(super) node: XmlNode<'f, 'f>,
    /// Outlines in user units.
    pub(super) chains: Vec<CurveChain>,
    /// From user units to m.
    pub(super) map: Affine,
    pub(super) style: Rc<Style>,
    pub(super) fill: Option<Ink>,
    pub(super) stroke: Option<Ink>,
    /// Regions of clips and masks in which it is seen.
    pub(super) regions: Vec<&'f ClipRegion>,
    pub(super) layer: &'f str,
    /// Dashes have their length on the page, whatever the map.
    pub(super) keeps_dashes: bool,
    /// Length that the file gives the outline: dashes count by it.
    pub(super) path_length: Option<&'f str>,
}
