//! Slider-cranks.

use super::super::description::{JointKind, Linkage};
use super::super::groups::Dyad;
use super::super::solve::Position;
use super::chain::{
    ChainKind, CrankChain, begins_with_ground, dead_points, driven, is_dyad, length, way,
    within_a_turn,
};
use super::sweep::Sweep;
use std::f64::consts::PI;
use trirrr_core::number::{cross, dot};

/// The loop if it begins with its ground; the guide may be in the ground or in the slider.
pub(super) fn slider_crank(
    linkage: &Linkage,
    sweep: &Sweep<'_>,
    links: [usize; 4],
    joints: [usize; 4],
) -> Option<CrankChain> {
    if !begins_with_ground(linkage, links) {
        return None;
    }
    let [ground, crank, coupler, slider] = links;
    let JointKind::Prismatic(slide) = &linkage.joints[joints[3]].kind else {
        return None;
    };
    let crank_length = length(linkage, crank, [joints[0], joints[1]])?;
    let coupler_length = length(linkage, coupler, [joints[1], joints[2]])?;
    let rod = |position: &Position| way(linkage, position, coupler, [joints[1], joints[2]]);
    let angle = |position: &Position| {
        let u = slide.along(&position.states);
        rod(position).map_or(0.0, |rod| dot(u, rod).abs().atan2(cross(u, rod).abs()))
    };
    // The slider's pin keeps its distance from the line along the guide through the crank's joint.
    let start = sweep.track.positions.first()?;
    let place = |joint: usize, link: usize| {
        let point = linkage.joints[joint].point_on(link)?;
        Some(start.point(linkage, point).position)
    };
    let u = slide.along(&start.states);
    let offset = cross(u, place(joints[2], slider)? - place(joints[0], ground)?);
    // The coupler stands across the guide where the crank's pin is a coupler's length beside the slider's path.
    let sines =
        [offset + coupler_length, offset - coupler_length].map(|beside| beside / crank_length);
    let reached = sines.into_iter().filter(|sine| sine.abs() <= 1.0);
    let singular_rad = within_a_turn(reached.flat_map(|sine| [sine.asin(), PI - sine.asin()]));
    let is_solved = is_dyad(linkage, [coupler, slider], Dyad::Rrp);
    Some(CrankChain {
        links,
        joints,
        kind: ChainKind::SliderCrank {
            crank: crank_length,
            coupler: coupler_length,
            offset: offset.abs(),
        },
        dead: dead_points(linkage, sweep, links, joints),
        singular_drive_rad: driven(linkage, start, links, joints, u, &singular_rad),
        singular_rad,
        transmission: is_solved.then(|| sweep.least(angle)).flatten(),
    })
}
