//! Figures to the strokes and areas of a drawing.

use super::PIXEL_M;
use super::chain::CurveChain;
use super::curve::{PathCurve, distance};
use super::dash::{DASHES_MAX, dashes};
use super::figure::SeenFigure;
use super::region::{ClipRegion, cut_area, cut_lines};
use super::values::number;
use super::walk::FileWalk;
use crate::drawing::join::join;
use crate::drawing::{Area, AreaClip, Drawing, Shape, Stroke};
use crate::{PathFault, PathRemark};

/// Largest distance from an axis, m: lengths beyond are a mistake.
const FAR_M: f64 = 1e9;

/// Gap of ends that meet where a clip has cut, m.
const MEET_M: f64 = 2e-6;

/// Adds the strokes and the area of a figure, on a page from zero to its sides, m.
pub(super) fn add(
    walk: &FileWalk,
    figure: &SeenFigure,
    page_m: [f64; 2],
    drawing: &mut Drawing,
) -> Result<(), PathFault> {
    let Some(ink) = figure.stroke.or(figure.fill) else {
        return Ok(());
    };
    let shape = drawing.shapes.len();
    let far = |chain: &CurveChain| {
        chain.hull().any(|point| {
            point
                .iter()
                .any(|value| !value.is_finite() || value.abs() > FAR_M)
        })
    };
    let placed: Vec<CurveChain> = figure
        .chains
        .iter()
        .map(|chain| cleaned(chain.mapped(&figure.map)))
        .collect();
    if placed.iter().any(far) {
        return Err(walk.fault(
            figure.node,
            "a coordinate is no number, or beyond 1e9 m".into(),
        ));
    }
    let (mut chains, mut area) = (Vec::new(), None);
    if figure.stroke.is_some() {
        if figure.style.has_caps
            && placed.iter().any(|chain| chain.curves.is_empty())
            && has_dot(&figure.chains)
        {
            let reason = "a line without a length is seen as a dot by its ends, which has no path; draw a small circle";
            return Err(walk.fault(figure.node, reason.into()));
        }
        chains = cut_lines(&dashed(walk, figure, &placed)?, &figure.regions);
    }
    let filled: Vec<CurveChain> = placed
        .iter()
        .filter(|chain| chain.has_area())
        .cloned()
        .collect();
    if figure.fill.is_some() && !filled.is_empty() {
        let cut = cut_area(&filled, figure.style.is_non_zero, &figure.regions);
        let is_seen = cut.as_ref().is_none_or(|parts| !parts.is_empty());
        if is_seen {
            area = Some(cut.is_some());
        }
        if figure.stroke.is_none() {
            chains = match cut {
                None => filled.clone(),
                Some(parts) => parts,
            };
        }
    }
    chains.retain(|chain| !chain.curves.is_empty());
    let mut strokes: Vec<Stroke> = chains
        .iter()
        .map(|chain| chain.stroke(shape, ink.rgb))
        .collect();
    if figure.stroke.is_none() && area == Some(true) {
        strokes = join(strokes, MEET_M, |_| ());
    }
    if strokes.is_empty() && area.is_none() {
        return Ok(());
    }
    if figure.stroke.is_none() && ink.rgb == Some([255; 3]) && covers(&filled, page_m) {
        let place = walk.fault(figure.node, String::new());
        let text = format!(
            "{}: a white area covers the page; if it is the paper, remove it, or leave it out: --pen \"#ffffff=off\"",
            place.word
        );
        drawing.remarks.push(PathRemark::new(place.line, text));
    }
    drawing.shapes.push(Shape {
        name: figure.node.attribute("id").unwrap_or_default().to_owned(),
        layer: figure.layer.to_owned(),
    });
    if let (Some(fill), Some(is_cut)) = (figure.fill, area) {
        let clips = figure.regions.iter().filter(|_| is_cut);
        drawing.areas.push(Area {
            shape,
            colour: fill.rgb,
            non_zero: figure.style.is_non_zero,
            outlines: filled
                .iter()
                .map(|chain| chain.stroke(shape, ink.rgb))
                .collect(),
            clips: clips.flat_map(|region| clip_of(region, shape)).collect(),
            stroked: figure.stroke.is_some(),
        });
    }
    drawing.strokes.extend(strokes);
    Ok(())
}

/// Returns true if an area reaches around the page.
fn covers(chains: &[CurveChain], page_m: [f64; 2]) -> bool {
    let points = || chains.iter().flat_map(CurveChain::hull);
    [0, 1].into_iter().all(|i| {
        let near = 5e-3 * page_m[i];
        points().any(|point| point[i] <= near) && points().any(|point| point[i] >= page_m[i] - near)
    })
}

/// Shapes of a region; the last one ends the region.
fn clip_of(region: &ClipRegion, shape: usize) -> Vec<AreaClip> {
    let count = region.shapes.len();
    let shapes = region.shapes.iter().enumerate();
    let clips = shapes.map(|(index, part)| AreaClip {
        outlines: part
            .chains
            .iter()
            .map(|chain| chain.stroke(shape, None))
            .collect(),
        non_zero: part.is_non_zero,
        adds: part.adds,
        is_last: index + 1 == count,
    });
    clips.collect()
}

/// Chain without curves that have no length.
fn cleaned(mut chain: CurveChain) -> CurveChain {
    let mut at = chain.start;
    chain.curves.retain(|curve| {
        let end = curve.end();
        let near = 1e-12 + 4.0 * f64::EPSILON * (end[0].abs() + end[1].abs());
        let is_long = match *curve {
            PathCurve::Line(to) => distance(at, to) > near,
            PathCurve::Bezier(points) => points.iter().any(|point| distance(at, *point) > near),
            PathCurve::Arc { axes, ends, .. } => {
                let size = axes
                    .as_flattened()
                    .iter()
                    .fold(0.0_f64, |size, value| size.max(value.abs()));
                size * (ends[1] - ends[0]).abs() > near
            }
        };
        if is_long {
            at = end;
        }
        is_long
    });
    chain
}

/// Returns true if one of the outlines is a point that is drawn: a line to itself, or a closed point.
fn has_dot(chains: &[CurveChain]) -> bool {
    let is_dot = |chain: &CurveChain| {
        cleaned(chain.clone()).curves.is_empty() && (chain.closed || !chain.curves.is_empty())
    };
    chains.iter().any(is_dot)
}

/// Dashes of a figure's outlines, m.
fn dashed(
    walk: &FileWalk,
    figure: &SeenFigure,
    placed: &[CurveChain],
) -> Result<Vec<CurveChain>, PathFault> {
    let style = &figure.style;
    if style.dashes.is_empty() {
        return Ok(placed.to_vec());
    }
    if style.has_caps && style.dashes.iter().step_by(2).any(|length| *length == 0.0) {
        let reason = "stroke-dasharray: dashes without a length are seen as dots by their ends, which have no path; give them a length";
        return Err(walk.fault(figure.node, reason.into()));
    }
    let mut factor = match figure.keeps_dashes {
        true => PIXEL_M,
        false => 1.0,
    };
    let chains: Vec<CurveChain> = match figure.keeps_dashes {
        true => placed.to_vec(),
        false => figure
            .chains
            .iter()
            .map(|chain| cleaned(chain.clone()))
            .collect(),
    };
    let given = figure
        .path_length
        .and_then(|text| number(text.trim()))
        .map(|(value, _)| value);
    if let Some(given) = given.filter(|given| *given > 0.0) {
        factor = chains.iter().map(CurveChain::length).sum::<f64>() / given;
    }
    let lengths: Vec<f64> = style.dashes.iter().map(|length| factor * length).collect();
    let cut = dashes(&chains, &lengths, factor * style.dash_offset).ok_or_else(|| {
        walk.fault(
            figure.node,
            format!(
                "stroke-dasharray: the shape has more than {DASHES_MAX} dashes; make them longer"
            ),
        )
    })?;
    Ok(match figure.keeps_dashes {
        true => cut,
        false => cut.iter().map(|chain| chain.mapped(&figure.map)).collect(),
    })
}
