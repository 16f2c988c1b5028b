//! A loop of four links with a crank, and what is measured of it.

use super::super::description::{Linkage, PointRef};
use super::super::groups::{Dyad, GroupKind};
use super::super::solve::Position;
use super::sweep::Sweep;
use crate::four_bar::{FourBar, Grashof};
use nalgebra::Vector2;
use std::f64::consts::TAU;
use trirrr_core::number::{cross, dot};

/// Crank and coupler in one line: the output turns back there, and could not drive the crank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadPoint {
    /// Time, s.
    pub t_s: f64,
    /// `true` for stretched, `false` for folded.
    pub is_stretched: bool,
}

/// Kinds of loop with a crank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChainKind {
    /// Four pins.
    FourBar {
        /// Lengths, m.
        lengths: FourBar,
        /// Grashof's class, for the ground of the loop.
        class: Grashof,
    },
    /// Three pins and a slider on a guide in the ground.
    SliderCrank {
        /// Length of the crank, m.
        crank: f64,
        /// Length of the coupler, m.
        coupler: f64,
        /// Distance of the slider's pin from the line of the guide through the crank's joint, m.
        offset: f64,
    },
}

/// A loop of four links with a crank: the ground is the link that is solved first, the crank its neighbour that is solved first.
#[derive(Clone, Debug, PartialEq)]
pub struct CrankChain {
    /// Ground, crank, coupler, output (rocker or slider).
    pub links: [usize; 4],
    /// Joints: ground and crank, crank and coupler, coupler and output, output and ground.
    pub joints: [usize; 4],
    /// Kind of the loop.
    pub kind: ChainKind,
    /// Dead points over the motion.
    pub dead: Vec<DeadPoint>,
    /// Angles of the crank at which it cannot go on, rad: coupler and rocker in one line, or the coupler across the guide. From the line
    /// between the joints of the ground, or from the guide's direction. Empty where the crank turns fully.
    pub singular_rad: Vec<f64>,
    /// The same as values of the drive between ground and crank, rad in \[0, 2 pi\); empty without such a drive.
    pub singular_drive_rad: Vec<f64>,
    /// Least transmission angle, rad in \[0, pi/2\], and its time, s. `None` where coupler and output are not solved together from the crank.
    pub transmission: Option<(f64, f64)>,
}

impl CrankChain {
    /// Returns `true` if the crank passes every angle.
    pub fn turns_fully(&self) -> bool {
        match self.kind {
            ChainKind::FourBar { lengths, .. } => lengths.turns_fully(),
            ChainKind::SliderCrank { .. } => self.singular_rad.is_empty(),
        }
    }
}

/// Place of a link in the order in which links are solved; the order of the file among equals.
pub(super) fn rank(linkage: &Linkage, link: usize) -> (usize, usize) {
    let mut groups = linkage.groups.iter();
    let group = groups.position(|group| group.links.contains(&link));
    (group.map_or(0, |group| group + 1), link)
}

/// Returns `true` for a loop whose first link is solved before the others.
pub(super) fn begins_with_ground(linkage: &Linkage, links: [usize; 4]) -> bool {
    let [first, others @ ..] = links.map(|link| rank(linkage, link));
    others.iter().all(|other| first < *other)
}

fn pin(linkage: &Linkage, joint: usize, link: usize) -> Option<PointRef> {
    linkage.joints[joint].point_on(link)
}

/// Distance of two joints on a link, m; `None` where they coincide.
pub(super) fn length(linkage: &Linkage, link: usize, joints: [usize; 2]) -> Option<f64> {
    let [a, b] = joints.map(|joint| pin(linkage, joint, link).map(|point| linkage.local(point)));
    let between = b? - a?;
    let length = f64::hypot(between.x, between.y);
    (length > 0.0).then_some(length)
}

/// Returns `true` if `links` are the two of one dyad of the kind.
pub(super) fn is_dyad(linkage: &Linkage, links: [usize; 2], kind: Dyad) -> bool {
    linkage.groups.iter().any(|group| {
        group.kind == GroupKind::Dyad(kind) && links.iter().all(|link| group.links.contains(link))
    })
}

/// Way between two joints on a link at a position, m.
pub(super) fn way(
    linkage: &Linkage,
    position: &Position,
    link: usize,
    joints: [usize; 2],
) -> Option<Vector2<f64>> {
    let [a, b] = joints.map(|joint| {
        pin(linkage, joint, link).map(|point| position.point(linkage, point).position)
    });
    Some(b? - a?)
}

pub(super) fn dead_points(
    linkage: &Linkage,
    sweep: &Sweep<'_>,
    links: [usize; 4],
    joints: [usize; 4],
) -> Vec<DeadPoint> {
    let [_, crank, coupler, _] = links;
    let ways = |position: &Position| {
        let crank = way(linkage, position, crank, [joints[0], joints[1]]);
        let coupler = way(linkage, position, coupler, [joints[1], joints[2]]);
        crank.zip(coupler)
    };
    let aligned = |position: &Position| ways(position).map_or(0.0, |(one, two)| cross(one, two));
    let at = |t_s: f64| {
        let (one, two) = ways(&sweep.at(t_s)?)?;
        Some(DeadPoint {
            t_s,
            is_stretched: dot(one, two) > 0.0,
        })
    };
    sweep.zeros(aligned).into_iter().filter_map(at).collect()
}

/// Values of the drive between ground and crank at angles of the crank's line from the direction `from`, which is fixed in the
/// ground and given at the first position.
pub(super) fn driven(
    linkage: &Linkage,
    start: &Position,
    [ground, crank, ..]: [usize; 4],
    joints: [usize; 4],
    from: Vector2<f64>,
    angles: &[f64],
) -> Vec<f64> {
    let drive = linkage.drives.iter().find(|drive| {
        let ends = [drive.base, drive.link];
        drive.joint == joints[0] && ends.contains(&ground) && ends.contains(&crank)
    });
    let line = way(linkage, start, crank, [joints[0], joints[1]]);
    let (Some(drive), Some(line)) = (drive, line) else {
        return Vec::new();
    };
    let now = cross(from, line).atan2(dot(from, line));
    let sign = if drive.link == crank { 1.0 } else { -1.0 };
    let value = |angle: &f64| drive.at(start.t)[0] + sign * (angle - now);
    within_a_turn(angles.iter().map(value))
}

/// Angles in [0, 2 pi) in order, each once.
pub(super) fn within_a_turn(angles: impl Iterator<Item = f64>) -> Vec<f64> {
    /// Angles nearer to each other are one.
    const SAME: f64 = 1e-9;
    let turned = angles.map(|angle| angle.rem_euclid(TAU));
    let mut angles: Vec<f64> = turned
        .map(|angle| if TAU - angle < SAME { 0.0 } else { angle })
        .collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup_by(|one, other| *one - *other < SAME);
    angles
}
