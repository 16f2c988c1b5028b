//! A dyad of the core with the constants that the file's links and joints give it.

use super::description::Linkage;
use super::groups::{Dyad, Group};
use super::rail::{Rail, reframed, turned_back};
use super::state::LinkState;
use crate::motion::{DyadMotion, LinkMotion};
use crate::{LinkageStatus, ppr::Ppr, prp::Prp, rpr::Rpr, rrp::Rrp, rrr::Rrr, rrr::SolveRrr};
use nalgebra::Vector2;
use trirrr_core::number::{cross, perpendicular};

/// One link of a dyad: its index, and in its frame the origin and the x axis of the frame that
/// the core's solution is given in.
#[derive(Clone, Copy, Debug)]
struct Member {
    link: usize,
    at: Vector2<f64>,
    axis: Vector2<f64>,
}

/// Holder of a dyad's outer joint, a link that is solved before: a pin or the start of a guide in
/// its frame, and the guide's direction.
#[derive(Clone, Copy, Debug)]
struct OuterJoint {
    link: usize,
    at: Vector2<f64>,
    axis: Vector2<f64>,
}

#[derive(Clone, Copy, Debug)]
enum Solver {
    Rrr(Rrr<f64>),
    Rpr(Rpr<f64>),
    Rrp(Rrp<f64>),
    Prp(Prp<f64>),
    Ppr(Ppr<f64>),
}

/// A dyad ready to be solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Built {
    ends: [OuterJoint; 2],
    members: [Member; 2],
    solver: Solver,
}

impl Built {
    /// Builds the dyad `kind` of `group`, held by links that come before it, on `branch`.
    ///
    /// `None` for a link whose two pins coincide: it turns freely.
    pub(super) fn new(
        linkage: &Linkage,
        group: &Group,
        kind: Dyad,
        solved: &dyn Fn(usize) -> bool,
        branch: f64,
    ) -> Option<Self> {
        let &[first, inner, last] = group.joints.as_slice() else {
            return None;
        };
        // The link at each outer joint.
        let at = |joint: usize| {
            let ends = linkage.joints[joint].links();
            group.links.iter().copied().find(|link| ends.contains(link))
        };
        let (one, two) = (at(first)?, at(last)?);
        let pin = |joint: usize, link: usize| {
            let point = linkage.joints[joint].point_on(link)?;
            Some(linkage.local(point))
        };
        let end = |joint: usize, own: usize| -> Option<OuterJoint> {
            let ends = linkage.joints[joint].links();
            let link = ends.into_iter().find(|&link| solved(link))?;
            let (at, axis) = match Rail::new(linkage, joint, own) {
                Some(rail) => (rail.point, rail.direction),
                None => (pin(joint, link)?, Vector2::x()),
            };
            Some(OuterJoint { link, at, axis })
        };
        let ends = [end(first, one)?, end(last, two)?];
        let (members, solver) = match kind {
            Dyad::Rrr => {
                let (m1, l1) = rod(one, pin(first, one)?, pin(inner, one)?)?;
                let (m2, l2) = rod(two, pin(inner, two)?, pin(last, two)?)?;
                ([m1, m2], Solver::Rrr(Rrr::new(l1, l2, branch)))
            }
            Dyad::Rpr => {
                let (a, b) = (pin(first, one)?, pin(last, two)?);
                // The line as the second link has it, and the first on it.
                let rail = Rail::new(linkage, inner, one)?;
                let across = rail.left(a) - cross(rail.direction, b - rail.point);
                let members = [
                    member(one, a, rail.own_direction),
                    member(two, b, rail.direction),
                ];
                (members, Solver::Rpr(Rpr::from_offsets(0.0, across, branch)))
            }
            Dyad::Rrp => {
                let rail = Rail::new(linkage, last, two)?;
                let (link, length) = rod(one, pin(inner, one)?, pin(first, one)?)?;
                let slider = member(two, pin(inner, two)?, rail.own_direction);
                let across = rail.left(slider.at);
                let solver = Solver::Rrp(Rrp::from_offsets(length, 0.0, across, branch));
                ([link, slider], solver)
            }
            Dyad::Prp => {
                let on = |outer: usize, link: usize| {
                    let rail = Rail::new(linkage, outer, link)?;
                    let at = pin(inner, link)?;
                    let offset = Vector2::new(0.0, rail.left(at));
                    Some((member(link, at, rail.own_direction), offset))
                };
                let ((m1, first), (m2, second)) = (on(first, one)?, on(last, two)?);
                ([m1, m2], Solver::Prp(Prp::from_offsets(first, second)))
            }
            Dyad::Ppr => {
                let b = pin(last, two)?;
                let outer = Rail::new(linkage, first, one)?;
                let between = Rail::new(linkage, inner, two)?;
                // The slider's reference point lies on the first guide.
                let reference = outer.own_point - perpendicular(outer.own_direction) * outer.offset;
                let left = perpendicular(between.direction);
                let at_zero = between.point + left * between.left(b) - reference;
                let in_guide = |v| turned_back(v, outer.own_direction);
                let solver = Ppr::from_offsets(in_guide(between.direction), in_guide(at_zero));
                let members = [
                    member(one, reference, outer.own_direction),
                    member(two, b, between.own_direction),
                ];
                (members, Solver::Ppr(solver))
            }
        };
        Some(Self {
            ends,
            members,
            solver,
        })
    }

    /// Solves the dyad for the states of the links that hold it; returns its scale-free distance
    /// from the singularity.
    pub(super) fn solve(&self, states: &mut [LinkState]) -> Result<f64, LinkageStatus> {
        fn parts<const S: usize>(m: DyadMotion<f64, S>) -> ([LinkMotion<f64>; 2], f64) {
            ([m.first, m.second], m.singularity_distance)
        }
        let guides = self
            .ends
            .map(|end| states[end.link].motion.frame(end.at, end.axis));
        let ([from, to], pins) = (&guides, guides.map(|guide| guide.origin));
        let (links, distance) = match &self.solver {
            Solver::Rrr(dyad) => parts(dyad.solve(&pins[0], &pins[1])?),
            Solver::Rpr(dyad) => parts(dyad.solve(&pins[0], &pins[1])?),
            Solver::Rrp(dyad) => parts(dyad.solve(&pins[0], to)?),
            Solver::Prp(dyad) => parts(dyad.solve(from, to)?),
            Solver::Ppr(dyad) => parts(dyad.solve(from, &pins[1])?),
        };
        for (member, motion) in self.members.iter().zip(links) {
            states[member.link].take(reframed(&motion, member.axis, member.at));
        }
        Ok(distance)
    }
}

fn member(link: usize, at: Vector2<f64>, axis: Vector2<f64>) -> Member {
    Member { link, at, axis }
}

/// A link between two of its points: its frame for the core, and its length; `None` where the
/// points coincide.
fn rod(link: usize, from: Vector2<f64>, to: Vector2<f64>) -> Option<(Member, f64)> {
    let along = to - from;
    let length = f64::hypot(along.x, along.y);
    (length > 0.0).then(|| (member(link, from, along / length), length))
}
