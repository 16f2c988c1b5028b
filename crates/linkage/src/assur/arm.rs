//! Inverse of a serial planar 3R arm: from the motion of its end link to its drives.
//!
//! The end link's angle and the place of its point give the wrist. Between the base and the wrist lie two links, a dyad RRR: two
//! solutions, with the elbow on either side of the way from the base to the wrist.

use super::description::{FRAME, JointKind, Linkage, PointRef};
use super::groups::GroupKind;
use super::loads::drive_loads;
use super::solve::{Position, Solver};
use crate::LinkageStatus;
use crate::motion::{LinkMotion, PointMotion, unit};
use crate::rrr::{Rrr, SolveRrr};
use nalgebra::Vector2;
use thiserror::Error;
use trirrr_core::number::Arithmetic;

/// Motion of the end link: x, y of its point and its angle; m and rad, m/s and rad/s, m/s^2 and rad/s^2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndMotion {
    /// x and y of the point, angle of the link's frame.
    pub pose: [f64; 3],
    /// Rates of the three.
    pub velocity: [f64; 3],
    /// Their accelerations.
    pub acceleration: [f64; 3],
}

/// Serial arm of three links: the frame, a pin with a drive, a link, and so on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialArm {
    /// The links from the base outwards.
    pub links: [usize; 3],
    /// The pins before them.
    pub joints: [usize; 3],
    /// The drives in the pins.
    pub drives: [usize; 3],
    /// The point of the end link that is given: the first traced one.
    pub end: PointRef,
}

/// One solution.
#[derive(Clone, Debug)]
pub struct ArmBranch {
    /// +1: the elbow lies to the left of the way from the base to the wrist, -1: to the right.
    pub elbow: f64,
    /// Value, rate and acceleration of each drive from the base outwards: rad, rad/s, rad/s^2.
    pub drives: [[f64; 3]; 3],
    /// Sine of the angle between the two inner links: 0 where both solutions meet.
    pub distance: f64,
    /// The arm with these drives, solved forward.
    pub position: Position,
    /// Distance of the end's point in that position from where it was asked for, m.
    pub residual_m: f64,
    /// Torques of the drives from the base outwards, N m; `None` of an arm without masses.
    pub torques_nm: Option<[f64; 3]>,
}

/// Reason why an arm has no inverse.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ArmError {
    /// The linkage is no such arm.
    #[error("no serial arm of three driven links: {0}")]
    Shape(String),
    /// No point of the end link is traced.
    #[error(
        "trace: missing a point of the end link `{0}`: the inverse is asked for the first one that is traced"
    )]
    NoEnd(String),
    /// The wrist is out of reach.
    #[error("out of reach: the wrist would be {distance_m:.6} m from the base, {} than the arm can; by {by_m:.6} m", if *.too_far { "farther" } else { "nearer" })]
    OutOfReach {
        /// Distance from the base to the wrist, m.
        distance_m: f64,
        /// `true` beyond the stretched arm, `false` within the folded one.
        too_far: bool,
        /// By how much, m.
        by_m: f64,
    },
    /// The arm is stretched or folded: both solutions meet, and rates are not defined.
    #[error(
        "singular: the arm is stretched or folded there, its two solutions meet and rates are not defined"
    )]
    Straight,
    /// A value is beyond the number format.
    #[error("a value is beyond the number format")]
    Range,
}

impl SerialArm {
    /// Finds the arm in `linkage`.
    ///
    /// # Errors
    /// [`ArmError::Shape`] or [`ArmError::NoEnd`].
    pub fn of(linkage: &Linkage) -> Result<Self, ArmError> {
        let shape = |reason: &str| ArmError::Shape(reason.into());
        if linkage.links.len() != 4 || linkage.joints.len() != 3 {
            let (links, joints) = (linkage.links.len(), linkage.joints.len());
            return Err(ArmError::Shape(format!(
                "it has {links} links and {joints} joints, the frame among the links, instead of 4 and 3"
            )));
        }
        let pinned = |joint: &super::Joint| matches!(&joint.kind, JointKind::Revolute(pins) if pins.len() == 2);
        if !linkage.joints.iter().all(pinned) {
            return Err(shape("not every joint is a pin through two links"));
        }
        if !linkage
            .groups
            .iter()
            .all(|group| group.kind == GroupKind::Driven)
        {
            return Err(shape("not every link is driven"));
        }
        let (mut links, mut joints, mut drives) = ([0; 3], [0; 3], [0; 3]);
        let mut before = FRAME;
        for (place, group) in linkage.groups.iter().enumerate() {
            let (joint, link) = (group.joints[0], group.links[0]);
            if !linkage.joints[joint].links().contains(&before) {
                return Err(shape("its links branch instead of following one another"));
            }
            (links[place], joints[place], drives[place]) = (link, joint, group.drives[0]);
            before = link;
        }
        let end = linkage.traces.iter().find(|trace| trace.link == before);
        let end = end.ok_or_else(|| ArmError::NoEnd(linkage.links[before].name.clone()))?;
        Ok(Self {
            links,
            joints,
            drives,
            end: *end,
        })
    }

    /// Place of a pin in the frame of one of its links.
    fn local(&self, linkage: &Linkage, joint: usize, link: usize) -> Vector2<f64> {
        let point = linkage.joints[joint].point_on(link);
        point.map_or_else(Vector2::zeros, |point| linkage.local(point))
    }

    /// Both solutions, that with the elbow on the left first.
    ///
    /// # Errors
    /// [`ArmError`].
    pub fn inverse(&self, linkage: &Linkage, end: &EndMotion) -> Result<[ArmBranch; 2], ArmError> {
        let [first, second, last] = self.links;
        let [base, elbow, wrist] = self.joints;
        let [[x, y, angle], [vx, vy, rate], [ax, ay, acceleration]] =
            [end.pose, end.velocity, end.acceleration];
        let tip = PointMotion {
            position: Vector2::new(x, y),
            velocity: Vector2::new(vx, vy),
            acceleration: Vector2::new(ax, ay),
        };
        let end_link = LinkMotion {
            origin: tip,
            direction: unit(angle),
            rate,
            acceleration,
        };
        let to_wrist = self.local(linkage, wrist, last) - linkage.local(self.end);
        let wrist_motion = end_link.point(to_wrist);
        let base_motion = PointMotion::fixed(self.local(linkage, base, FRAME));
        let arm_of = |link: usize, from: usize, to: usize| {
            self.local(linkage, to, link) - self.local(linkage, from, link)
        };
        let (inner, outer) = (arm_of(first, base, elbow), arm_of(second, elbow, wrist));
        let size = |v: Vector2<f64>| Arithmetic::sqrt(v.x * v.x + v.y * v.y);
        let (l1, l2) = (size(inner), size(outer));
        let distance_m = size(wrist_motion.position - base_motion.position);
        let solve = |sign: f64| {
            // The dyad's links are rods: their frames point from pin to pin.
            let found = Rrr::new(l1, l2, sign).solve(&base_motion, &wrist_motion);
            let found = found.map_err(|status| match status {
                LinkageStatus::Unreachable => ArmError::OutOfReach {
                    distance_m,
                    too_far: distance_m > l1 + l2,
                    by_m: if distance_m > l1 + l2 {
                        distance_m - (l1 + l2)
                    } else {
                        (l1 - l2).abs() - distance_m
                    },
                },
                LinkageStatus::Singular => ArmError::Straight,
                LinkageStatus::OutOfRange => ArmError::Range,
            })?;
            let turned = |rod: Vector2<f64>| Arithmetic::atan2(rod.y, rod.x);
            let angles = [
                found.first.angle() - turned(inner),
                found.second.angle() - turned(outer),
                angle,
            ];
            let absolute = [
                [angles[0], found.first.rate, found.first.acceleration],
                [angles[1], found.second.rate, found.second.acceleration],
                [angles[2], rate, acceleration],
            ];
            self.branch(linkage, end, sign, found.singularity_distance, absolute)
        };
        Ok([solve(1.0)?, solve(-1.0)?])
    }

    /// The solution with the absolute motions of the links, solved forward.
    fn branch(
        &self,
        linkage: &Linkage,
        end: &EndMotion,
        elbow: f64,
        distance: f64,
        absolute: [[f64; 3]; 3],
    ) -> Result<ArmBranch, ArmError> {
        let mut drives = [[0.0; 3]; 3];
        let mut before = [0.0; 3];
        let mut driven = linkage.clone();
        for place in 0..3 {
            let drive = &mut driven.drives[self.drives[place]];
            // A drive may count from the outer link to the inner one.
            let sign = if drive.link == self.links[place] {
                1.0
            } else {
                -1.0
            };
            let mut motion = [0, 1, 2].map(|order| sign * (absolute[place][order] - before[order]));
            motion[0] = super::constraint::wrapped(motion[0]);
            [drive.start, drive.rate, drive.acceleration] = motion;
            (drives[place], before) = (motion, absolute[place]);
        }
        let (_, position) = Solver::start(&driven).map_err(|_| ArmError::Range)?;
        let at = position.point(&driven, self.end).position;
        let loads = match linkage.has_masses() {
            true => Some(drive_loads(&driven, &position).ok_or(ArmError::Straight)?),
            false => None,
        };
        Ok(ArmBranch {
            elbow,
            drives,
            distance,
            residual_m: f64::hypot(at.x - end.pose[0], at.y - end.pose[1]),
            position,
            torques_nm: loads.map(|loads| self.drives.map(|drive| loads[drive])),
        })
    }
}
