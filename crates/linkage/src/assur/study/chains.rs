//! Search for the four-bar loops and slider-cranks of a linkage.

use super::super::description::{JointKind, Linkage};
use super::super::groups::Dyad;
use super::super::solve::Position;
use super::chain::{
    ChainKind, CrankChain, begins_with_ground, dead_points, driven, is_dyad, length, rank, way,
    within_a_turn,
};
use super::slider_crank::slider_crank;
use super::sweep::Sweep;
use crate::four_bar::FourBar;
use trirrr_core::number::{cross, dot};

/// Two links at a pin.
type PinnedPair = (usize, usize, usize);

/// All four-bar loops and slider-cranks, in the order of the file.
pub(super) fn chains(linkage: &Linkage, sweep: &Sweep<'_>) -> Vec<CrankChain> {
    let pairs = pinned_pairs(linkage);
    let from = |link: usize| {
        pairs.iter().filter_map(move |&(joint, a, b)| match link {
            link if link == a => Some((joint, b)),
            link if link == b => Some((joint, a)),
            _ => None,
        })
    };
    let mut found = Vec::new();
    // Three pins in a chain of four links, and the joint that closes it.
    for first in 0..linkage.links.len() {
        for (j1, second) in from(first) {
            for (j2, third) in from(second) {
                for (j3, last) in from(third) {
                    let links = [first, second, third, last];
                    if !are_different(links) || !are_different([j1, j2, j3, usize::MAX]) {
                        continue;
                    }
                    for (j4, _) in from(last).filter(|(_, link)| *link == first) {
                        let joints = [j1, j2, j3, j4];
                        if are_different(joints) {
                            found.extend(four_bar(linkage, sweep, links, joints));
                        }
                    }
                    for (j4, joint) in linkage.joints.iter().enumerate() {
                        if let JointKind::Prismatic(slide) = &joint.kind
                            && [slide.guide.link, slide.slider.link].contains(&first)
                            && [slide.guide.link, slide.slider.link].contains(&last)
                        {
                            found.extend(slider_crank(linkage, sweep, links, [j1, j2, j3, j4]));
                        }
                    }
                }
            }
        }
    }
    found
}

fn are_different(values: [usize; 4]) -> bool {
    (1..4).all(|index| !values[..index].contains(&values[index]))
}

fn pinned_pairs(linkage: &Linkage) -> Vec<PinnedPair> {
    let mut pairs = Vec::new();
    for (index, joint) in linkage.joints.iter().enumerate() {
        if let JointKind::Revolute(pins) = &joint.kind {
            for (count, pin) in pins.iter().enumerate() {
                pairs.extend(
                    pins[..count]
                        .iter()
                        .map(|other| (index, other.link, pin.link)),
                );
            }
        }
    }
    pairs
}

/// The loop if it begins with its ground and its crank; every loop is found from each of its links, in both directions.
fn four_bar(
    linkage: &Linkage,
    sweep: &Sweep<'_>,
    links: [usize; 4],
    joints: [usize; 4],
) -> Option<CrankChain> {
    if !begins_with_ground(linkage, links) || rank(linkage, links[1]) > rank(linkage, links[3]) {
        return None;
    }
    let [ground, crank, coupler, output] = links;
    let lengths = FourBar {
        ground: length(linkage, ground, [joints[0], joints[3]])?,
        crank: length(linkage, crank, [joints[0], joints[1]])?,
        coupler: length(linkage, coupler, [joints[1], joints[2]])?,
        rocker: length(linkage, output, [joints[2], joints[3]])?,
    };
    let angle = |position: &Position| {
        let coupler = way(linkage, position, coupler, [joints[1], joints[2]]);
        let rocker = way(linkage, position, output, [joints[3], joints[2]]);
        coupler.zip(rocker).map_or(0.0, |(one, two)| {
            cross(one, two).abs().atan2(dot(one, two).abs())
        })
    };
    let closed = lengths.singular_positions().into_iter().flatten();
    let singular_rad = within_a_turn(closed.flat_map(|angle| [angle, -angle]));
    let start = sweep.track.positions.first()?;
    let line = way(linkage, start, ground, [joints[0], joints[3]])?;
    let is_solved = is_dyad(linkage, [coupler, output], Dyad::Rrr);
    Some(CrankChain {
        links,
        joints,
        kind: ChainKind::FourBar {
            lengths,
            class: lengths.grashof(),
        },
        dead: dead_points(linkage, sweep, links, joints),
        singular_drive_rad: driven(linkage, start, links, joints, line, &singular_rad),
        singular_rad,
        transmission: is_solved.then(|| sweep.least(angle)).flatten(),
    })
}
