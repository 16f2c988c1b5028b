//! The shipped mechanisms composed by hand: a crank for each drive, then dyads in solving order.
//!
//! The lengths (m) and angles stand here once more. Neither the linkage files nor the loops of the
//! other tests read them, so that each comparison has data of its own on either side.

use core::f64::consts::PI;
use nalgebra::Vector2;
use trirrr_core::number::Number;
use trirrr_linkage::ppr::Ppr;
use trirrr_linkage::prp::Prp;
use trirrr_linkage::rpr::Rpr;
use trirrr_linkage::rrp::Rrp;
use trirrr_linkage::rrr::{Rrr, SolveRrr};
use trirrr_linkage::{
    Crank, Drive, DyadMotion, GuideMotion, LinkMotion, LinkageStatus, PointMotion, SlideMotion,
};

/// The links and the slides of a mechanism.
pub(crate) type Moving<N, const LINKS: usize, const SLIDES: usize> =
    Result<([LinkMotion<N>; LINKS], [SlideMotion<N>; SLIDES]), LinkageStatus>;

/// A point in the fixed frame, or in that of a link.
fn at<N: Number>(x: f64, y: f64) -> Vector2<N> {
    Vector2::new(x, y).map(N::from_f64)
}

fn fixed<N: Number>(x: f64, y: f64) -> PointMotion<N> {
    PointMotion::fixed(at(x, y))
}

/// A fixed guide along the x axis, `height` above it.
fn level<N: Number>(height: f64) -> GuideMotion<N> {
    LinkMotion::fixed(at(0.0, height), at(1.0, 0.0))
}

/// A crank of `length` about (x, y), and its tip.
fn crank<N: Number>(
    x: f64,
    y: f64,
    length: f64,
    drive: &Drive<N>,
) -> (LinkMotion<N>, PointMotion<N>) {
    let crank = Crank::new(Vector2::new(x, y), length);
    let link = crank.at(drive);
    (link, crank.tip(&link))
}

/// The second link of an RRR seen from its outer joint, with its x axis towards the inner one.
fn from_outer<N: Number>(dyad: &DyadMotion<N, 0>, outer: PointMotion<N>) -> LinkMotion<N> {
    LinkMotion {
        origin: outer,
        direction: -dyad.second.direction,
        ..dyad.second
    }
}

/// Crank, coupler, rocker: crank + RRR.
pub(crate) fn four_bar<N: Number>(drive: &Drive<N>) -> Moving<N, 3, 0> {
    let (crank, tip) = crank(0.0, 0.0, 0.1, drive);
    let pivot = fixed(0.4, 0.0);
    let dyad = Rrr::new(0.35, 0.25, 1.0).solve(&tip, &pivot)?;
    Ok(([crank, dyad.first, from_outer(&dyad, pivot)], []))
}

/// Left crank, left link, right link, right crank: two cranks + RRR.
pub(crate) fn five_bar<N: Number>(drives: &[Drive<N>; 2]) -> Moving<N, 4, 0> {
    let (left, start) = crank(0.0, 0.0, 0.05, &drives[0]);
    let (right, end) = crank(0.15, 0.0, 0.04, &drives[1]);
    let dyad = Rrr::new(0.2, 0.22, 1.0).solve(&start, &end)?;
    Ok(([left, dyad.first, from_outer(&dyad, end), right], []))
}

/// Crank, rod, slider, with the stroke from the foot of the centre: crank + RRP. The guide lies
/// `offset` to the left of the centre; the dyad has the offset.
pub(crate) fn slider_crank<N: Number>(
    [length, rod, offset]: [f64; 3],
    guide_angle: f64,
    branch: f64,
    drive: &Drive<N>,
) -> Moving<N, 3, 1> {
    let (crank, tip) = crank(0.0, 0.0, length, drive);
    let guide = LinkMotion::fixed(at(0.0, 0.0), at(guide_angle.cos(), guide_angle.sin()));
    let dyad = Rrp::from_offsets(rod, 0.0, offset, branch).solve(&tip, &guide)?;
    Ok(([crank, dyad.first, dyad.second], dyad.slides))
}

/// Crank, yoke, with the yoke's slide and the pin's: crank + PPR. The slot leans by 10 degrees.
pub(crate) fn scotch_yoke<N: Number>(drive: &Drive<N>) -> Moving<N, 2, 2> {
    let (crank, tip) = crank(0.0, 0.0, 0.1, drive);
    let slot = 80.0 * (PI / 180.0);
    // The dyad counts its second slide from the pin, against the slot's direction.
    let dyad = Ppr::from_offsets(Vector2::new(-slot.cos(), -slot.sin()), Vector2::zeros());
    let dyad = dyad.solve(&level(0.0), &tip)?;
    Ok(([crank, dyad.first], dyad.slides))
}

/// Crank, lever, rod, ram, with the slides of pin and ram: crank + RPR + RRP.
pub(crate) fn quick_return<N: Number>(drive: &Drive<N>) -> Moving<N, 4, 2> {
    let (crank, pin) = crank(0.0, 0.0, 0.1, drive);
    let lever = Rpr::from_offsets(0.0, 0.0, 1.0).solve(&pin, &fixed(0.0, -0.25))?;
    let end = lever.second.point(at(0.5, 0.0));
    let ram = Rrp::from_offsets(0.3, 0.0, 0.0, 1.0).solve(&end, &level(0.23))?;
    let links = [crank, lever.second, ram.first, ram.second];
    Ok((links, [lever.slides[0], ram.slides[0]]))
}

/// Crank, lever, ram, with the slides of pin, block and ram: crank + RPR + PRP. The lever's slot, a
/// guide that turns, is known once the first dyad is solved.
pub(crate) fn slotted_quick_return<N: Number>(drive: &Drive<N>) -> Moving<N, 3, 3> {
    let (crank, pin) = crank(0.0, 0.0, 0.1, drive);
    let lever = Rpr::from_offsets(0.0, 0.0, 1.0).solve(&pin, &fixed(0.0, -0.25))?;
    let ram = Prp::from_offsets(Vector2::zeros(), Vector2::new(0.0, 0.03));
    let ram = ram.solve(&lever.second, &level(0.2))?;
    let [block, stroke] = ram.slides;
    let links = [crank, lever.second, ram.second];
    Ok((links, [lever.slides[0], block, stroke]))
}

/// Crank, rod, bridle, tracing link, rocker: crank + RRR + RRR.
pub(crate) fn fairbairn<N: Number>(drive: &Drive<N>) -> Moving<N, 5, 0> {
    let (crank, tip) = crank(0.33, -0.13, 0.05, drive);
    let (origin, pivot) = (fixed(0.0, 0.0), fixed(0.32, -0.8));
    let bridle = Rrr::new(0.3, 0.2, -1.0).solve(&tip, &origin)?;
    let rocker = Rrr::new(0.2, 0.8, 1.0).solve(&bridle.second.origin, &pivot)?;
    let held = [from_outer(&bridle, origin), from_outer(&rocker, pivot)];
    let links = [crank, bridle.first, held[0], rocker.first, held[1]];
    Ok((links, []))
}

/// Crank, coupler, rocker, rod, pusher, with the pusher's stroke: crank + RRR + RRP.
pub(crate) fn inserter<N: Number>(drive: &Drive<N>) -> Moving<N, 5, 1> {
    let (crank, tip) = crank(0.0, 0.0, 0.06, drive);
    let pivot = fixed(0.22, 0.0);
    let rocker = Rrr::new(0.2, 0.14, 1.0).solve(&tip, &pivot)?;
    let point = rocker.first.point(at(0.15, 0.12));
    let pusher = Rrp::from_offsets(0.3, 0.0, 0.0, 1.0).solve(&point, &level(0.2))?;
    let held = from_outer(&rocker, pivot);
    let links = [crank, rocker.first, held, pusher.first, pusher.second];
    Ok((links, pusher.slides))
}

/// Crank, coupler, rocker, upper and lower part of the telescope, with its slide: crank + RRR + RPR.
/// The coupler's point is known once the first loop is closed.
pub(crate) fn two_loop<N: Number>(drive: &Drive<N>) -> Moving<N, 5, 1> {
    let (crank, tip) = crank(0.0, 0.0, 0.1, drive);
    let (pivot, end) = (fixed(0.4, 0.0), fixed(0.65, 0.0));
    let rocker = Rrr::new(0.35, 0.3, 1.0).solve(&tip, &pivot)?;
    let point = rocker.first.point(at(0.2, 0.0));
    // The dyad's slide runs from the end towards the point, and its arms stand at 180 - 80 and at
    // 100 degrees.
    let degree = PI / 180.0;
    let arms = Rpr::new(0.05, PI - 80.0 * degree, 0.08, 100.0 * degree, 1.0);
    let telescope = arms.solve(&point, &end)?;
    let held = from_outer(&rocker, pivot);
    let links = [crank, rocker.first, held, telescope.first, telescope.second];
    Ok((links, telescope.slides))
}

/// The links of the serial arm for their absolute directions.
pub(crate) fn serial_arm<N: Number>(drives: &[Drive<N>; 3]) -> [LinkMotion<N>; 3] {
    let upper = drives[0].link(fixed(0.0, 0.0));
    let fore = drives[1].link(upper.point(at(0.4, 0.0)));
    let tool = drives[2].link(fore.point(at(0.3, 0.0)));
    [upper, fore, tool]
}

/// Upper arm and forearm for the motion of the tool's tip and of its direction; the elbow lies to
/// the left of the way from base to wrist for `branch` = +1.
pub(crate) fn serial_arm_inverse<N: Number>(
    tip: PointMotion<N>,
    tool: &Drive<N>,
    branch: f64,
) -> Moving<N, 2, 0> {
    let wrist = tool.link(tip).point(at(-0.1, 0.0));
    let arm = Rrr::new(0.4, 0.3, branch).solve(&fixed(0.0, 0.0), &wrist)?;
    Ok(([arm.first, arm.second], []))
}
