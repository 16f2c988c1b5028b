//! Viewports: the page, `svg` within it, and symbols.

use super::XmlNode;
use super::css::DeclaredStyle;
use super::curve::map_point;
use super::figure::Sink;
use super::path::rectangle;
use super::region::{ClipRegion, RegionShape};
use super::state::{DrawState, Mode};
use super::values::{FONT_PX, PartAxis, UnitFrame, number};
use super::walk::FileWalk;
use crate::PathFault;
use kurbo::Affine;
use svgtypes::{Align, AspectRatio, ViewBox};

/// Sides of a page that names none, px.
const PAGE_PX: f64 = 100.0;

impl<'d> FileWalk<'d> {
    /// View box of an element. None: it has none.
    fn view_box(&self, node: XmlNode) -> Result<Option<ViewBox>, PathFault> {
        let Some(text) = node.attribute("viewBox") else {
            return Ok(None);
        };
        let found: Option<ViewBox> = text.parse().ok();
        let good = |view: &ViewBox| {
            let all = [view.x, view.y, view.w, view.h];
            all.iter().all(|value| value.is_finite()) && view.w > 0.0 && view.h > 0.0
        };
        match found.filter(good) {
            Some(view) => Ok(Some(view)),
            None => Err(self.fault(
                node,
                format!("viewBox: {text:.60}: it has to be four numbers, the last two positive"),
            )),
        }
    }

    /// Map from a view box into a rectangle at the zero point with these sides.
    fn fitted(
        &self,
        node: XmlNode,
        view: &ViewBox,
        [width, height]: [f64; 2],
    ) -> Result<Affine, PathFault> {
        let aspect = match node.attribute("preserveAspectRatio") {
            Some(text) => text
                .parse()
                .map_err(|_| self.unknown(node, "preserveAspectRatio", text))?,
            None => AspectRatio::default(),
        };
        let [sx, sy] = [width / view.w, height / view.h];
        let move_to_zero = Affine::translate((-view.x, -view.y));
        if aspect.align == Align::None {
            return Ok(Affine::scale_non_uniform(sx, sy) * move_to_zero);
        }
        let scale = match aspect.slice {
            true => sx.max(sy),
            false => sx.min(sy),
        };
        let [x, y] = match aspect.align {
            Align::None | Align::XMinYMin => [0.0, 0.0],
            Align::XMidYMin => [0.5, 0.0],
            Align::XMaxYMin => [1.0, 0.0],
            Align::XMinYMid => [0.0, 0.5],
            Align::XMidYMid => [0.5, 0.5],
            Align::XMaxYMid => [1.0, 0.5],
            Align::XMinYMax => [0.0, 1.0],
            Align::XMidYMax => [0.5, 1.0],
            Align::XMaxYMax => [1.0, 1.0],
        };
        let free = (x * (width - scale * view.w), y * (height - scale * view.h));
        Ok(Affine::translate(free) * Affine::scale(scale) * move_to_zero)
    }

    /// Map of the view box of an element into these sides; none where it has none.
    pub(super) fn view_map(&self, node: XmlNode, sides: [f64; 2]) -> Result<Affine, PathFault> {
        match self.view_box(node)? {
            Some(view) => self.fitted(node, &view, sides),
            None => Ok(Affine::IDENTITY),
        }
    }

    /// Sides that the page names, px; a percentage is none.
    fn page_sides(&self) -> Result<[Option<f64>; 2], PathFault> {
        let root = self.document.root_element();
        let declared = self.sheet.of(root);
        let frame = UnitFrame {
            view: [0.0; 2],
            font_px: FONT_PX,
        };
        let side = |name| {
            let Some(text) = declared
                .get(name)
                .filter(|text| !matches!(*text, "auto" | ""))
            else {
                return Ok(None);
            };
            let Some((part, "%")) = number(text) else {
                let length = frame
                    .length(text, PartAxis::X)
                    .filter(|length| *length > 0.0);
                return length.map(Some).ok_or_else(|| {
                    self.fault(
                        root,
                        format!(
                            "{name}: {text:.60}: the size of the page has to be a length, as 100mm"
                        ),
                    )
                });
            };
            // A part of a window counts as that of the view box.
            let whole = self
                .view_box(root)?
                .map_or([PAGE_PX; 2], |view| [view.w, view.h]);
            let whole = if name == "width" { whole[0] } else { whole[1] };
            Ok(Some(0.01 * part * whole))
        };
        Ok([side("width")?, side("height")?])
    }

    /// Sides of the page, px, and the map from its user units to px.
    pub(super) fn page(&self) -> Result<([f64; 2], Affine), PathFault> {
        let root = self.document.root_element();
        let view = self.view_box(root)?;
        let sides = self.page_sides()?;
        let Some(view) = view else {
            let page = match sides {
                [Some(width), Some(height)] => [width, height],
                // A page without a size ends where its drawing does.
                _ => {
                    let declared = self.sheet.of(root);
                    let mut state = DrawState::first(Affine::IDENTITY, [PAGE_PX; 2]);
                    state.mode = Mode::Bounds;
                    let mut end = [0.0_f64; 2];
                    if let Some(state) = self.state(&declared, &state)? {
                        self.children(root, &state, &mut |figure| {
                            for point in figure.chains.iter().flat_map(|chain| chain.points(1e-3)) {
                                let point = map_point(&figure.map, point);
                                end = [0, 1].map(|i| end[i].max(point[i]));
                            }
                            Ok(())
                        })?;
                    }
                    [sides[0].unwrap_or(end[0]), sides[1].unwrap_or(end[1])]
                }
            };
            return Ok((page, Affine::IDENTITY));
        };
        let page = match sides {
            [Some(width), Some(height)] => [width, height],
            [Some(width), None] => [width, width * view.h / view.w],
            [None, Some(height)] => [height * view.w / view.h, height],
            [None, None] => [view.w, view.h],
        };
        Ok((page, self.fitted(root, &view, page)?))
    }

    /// Sides by which percentages on the page count.
    pub(super) fn root_view(&self) -> Result<[f64; 2], PathFault> {
        let root = self.document.root_element();
        if let Some(view) = self.view_box(root)? {
            return Ok([view.w, view.h]);
        }
        Ok(self.page_sides()?.map(|side| side.unwrap_or(PAGE_PX)))
    }

    /// Figures of an `svg` within the page, or of a `symbol`, with the sizes of the `use` that draws it.
    pub(super) fn inner_svg(
        &self,
        declared: &DeclaredStyle<'d>,
        by: Option<&DeclaredStyle<'d>>,
        state: &DrawState<'d>,
        sink: Sink,
    ) -> Result<(), PathFault> {
        let node = declared.node;
        let is_symbol = node.tag_name().name() == "symbol";
        let side = |name, axis, whole| {
            let given = by.filter(|by| by.get(name).is_some_and(|value| value != "auto"));
            let (source, is_given) = match given {
                Some(by) => (by, true),
                None => (
                    declared,
                    declared.get(name).is_some_and(|value| value != "auto"),
                ),
            };
            match is_given {
                true => self.length(source, state, (name, axis), whole),
                false => Ok(whole),
            }
        };
        let sides = [
            side("width", PartAxis::X, state.view[0])?,
            side("height", PartAxis::Y, state.view[1])?,
        ];
        if sides.iter().any(|side| *side <= 0.0) {
            return Ok(());
        }
        let corner = match is_symbol {
            true => [0.0; 2],
            false => [
                self.length(declared, state, ("x", PartAxis::X), 0.0)?,
                self.length(declared, state, ("y", PartAxis::Y), 0.0)?,
            ],
        };
        let view = self.view_box(node)?;
        let place = state.map * Affine::translate((corner[0], corner[1]));
        let map = match &view {
            Some(view) => place * self.fitted(node, view, sides)?,
            None => place,
        };
        let mut inner = DrawState {
            map,
            view: view.map_or(sides, |view| [view.w, view.h]),
            ..state.clone()
        };
        let overflow = self.value(declared, &state.style, "overflow");
        let is_clipped = !matches!(overflow.as_deref(), Some("visible" | "auto"));
        if is_clipped && state.mode == Mode::Draw {
            let edge = rectangle([0.0; 2], sides, [0.0; 2]).mapped(&place);
            let shapes = vec![RegionShape::new(vec![edge], true, true)];
            inner = inner.clipped(vec![ClipRegion { shapes }]);
        }
        self.children(node, &inner, sink)
    }
}
