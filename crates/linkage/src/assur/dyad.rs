//! A dyad of the core with the constants that the file's links and joints give it.

use super::description::{JointKind, Linkage};
use super::groups::{Dyad, Group};
use super::rail::{Rail, reframed, turned_back};
use super::state::{Motion, State};
use crate::motion::PointMotion;
use crate::{LinkageStatus, ppr::Ppr, prp::Prp, rpr::Rpr, rrp::Rrp, rrr::Rrr, rrr::SolveRrr};
use nalgebra::Vector2;

/// One link of a dyad: its index, and in its frame the origin and the x axis of the frame that
/// the core's solution is given in.
#[derive(Clone, Copy, Debug)]
struct Member {
    link: usize,
    at: Vector2<f64>,
    axis: Vector2<f64>,
}

/// Holder of a dyad's outer joint: a point or line of a link that is solved before.
#[derive(Clone, Copy, Debug)]
enum End {
    /// A point in the link's frame.
    Pin(usize, Vector2<f64>),
    /// A line in the link's frame: point and direction.
    Line(usize, Vector2<f64>, Vector2<f64>),
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
    ends: [End; 2],
    members: [Member; 2],
    solver: Solver,
}

/// Two points of a link in its frame, from the pins `from` and `to`.
fn pins(linkage: &Linkage, link: usize, from: usize, to: usize) -> Option<[Vector2<f64>; 2]> {
    let local = |joint: usize| {
        let joint = &linkage.joints[joint];
        let pin = match joint.kind {
            JointKind::Revolute(_) => joint.point_on(link)?,
            JointKind::Prismatic(_) => return None,
        };
        let [x, y] = linkage.local(pin);
        Some(Vector2::new(x, y))
    };
    Some([local(from)?, local(to)?])
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
        let end = |joint: usize, own: usize| -> Option<End> {
            let ends = linkage.joints[joint].links();
            let holder = ends.into_iter().find(|&link| solved(link))?;
            match Rail::new(linkage, joint, own) {
                Some(rail) => Some(End::Line(holder, rail.point, rail.direction)),
                None => {
                    let pin = linkage.joints[joint].point_on(holder)?;
                    let [x, y] = linkage.local(pin);
                    Some(End::Pin(holder, Vector2::new(x, y)))
                }
            }
        };
        let ends = [end(first, one)?, end(last, two)?];
        let (members, solver) = match kind {
            Dyad::Rrr => {
                let [a, b] = pins(linkage, one, first, inner)?;
                let [b_too, c] = pins(linkage, two, inner, last)?;
                let (m1, l1) = rod(one, a, b)?;
                let (m2, l2) = rod(two, b_too, c)?;
                ([m1, m2], Solver::Rrr(Rrr::new(l1, l2, branch)))
            }
            Dyad::Rpr => {
                let [a, _] = pins(linkage, one, first, first)?;
                let [b, _] = pins(linkage, two, last, last)?;
                // The line as the second link has it, and the first on it.
                let rail = Rail::new(linkage, inner, one)?;
                let across = rail.left(a) - left_of(&rail, b);
                let members = [
                    member(one, a, rail.own_direction),
                    member(two, b, rail.direction),
                ];
                (members, Solver::Rpr(Rpr::from_offsets(0.0, across, branch)))
            }
            Dyad::Rrp => {
                let [a, d] = pins(linkage, one, first, inner)?;
                let [_, d_too] = pins(linkage, two, inner, inner)?;
                let rail = Rail::new(linkage, last, two)?;
                let (link, length) = rod(one, d, a)?;
                let slider = member(two, d_too, rail.own_direction);
                let across = rail.left(d_too);
                let solver = Solver::Rrp(Rrp::from_offsets(length, 0.0, across, branch));
                ([link, slider], solver)
            }
            Dyad::Prp => {
                let [c, _] = pins(linkage, one, inner, inner)?;
                let [c_too, _] = pins(linkage, two, inner, inner)?;
                let (r1, r2) = (
                    Rail::new(linkage, first, one)?,
                    Rail::new(linkage, last, two)?,
                );
                let offsets = [
                    Vector2::new(0.0, r1.left(c)),
                    Vector2::new(0.0, r2.left(c_too)),
                ];
                let members = [
                    member(one, c, r1.own_direction),
                    member(two, c_too, r2.own_direction),
                ];
                let solver = Solver::Prp(Prp::from_offsets(offsets[0], offsets[1]));
                (members, solver)
            }
            Dyad::Ppr => {
                let [b, _] = pins(linkage, two, last, last)?;
                let outer = Rail::new(linkage, first, one)?;
                let between = Rail::new(linkage, inner, two)?;
                // The slider's reference point lies on the first guide.
                let normal = Vector2::new(-outer.own_direction.y, outer.own_direction.x);
                let reference = outer.own_point - normal * outer.offset;
                let left = Vector2::new(-between.direction.y, between.direction.x);
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
    pub(super) fn solve(&self, states: &mut [State]) -> Result<f64, LinkageStatus> {
        let pin = |end: &End| -> PointMotion<f64> {
            match *end {
                End::Pin(link, at) | End::Line(link, at, _) => states[link].motion.point(at),
            }
        };
        let line = |end: &End| -> Motion {
            match *end {
                End::Line(link, at, direction) => states[link].motion.frame(at, direction),
                End::Pin(link, at) => states[link].motion.frame(at, Vector2::x()),
            }
        };
        let [from, to] = &self.ends;
        let (one, two, distance) = match &self.solver {
            Solver::Rrr(dyad) => {
                let m = dyad.solve(&pin(from), &pin(to))?;
                (m.first, m.second, m.singularity_distance)
            }
            Solver::Rpr(dyad) => {
                let m = dyad.solve(&pin(from), &pin(to))?;
                (m.first, m.second, m.singularity_distance)
            }
            Solver::Rrp(dyad) => {
                let m = dyad.solve(&pin(from), &line(to))?;
                (m.first, m.second, m.singularity_distance)
            }
            Solver::Prp(dyad) => {
                let m = dyad.solve(&line(from), &line(to))?;
                (m.first, m.second, m.singularity_distance)
            }
            Solver::Ppr(dyad) => {
                let m = dyad.solve(&line(from), &pin(to))?;
                (m.first, m.second, m.singularity_distance)
            }
        };
        for (member, motion) in self.members.iter().zip([one, two]) {
            states[member.link].take(reframed(&motion, member.axis, member.at));
        }
        Ok(distance)
    }
}

/// Returns the distance to the left of the rail's line of a point of the link that holds the line.
fn left_of(rail: &Rail, point: Vector2<f64>) -> f64 {
    let along = rail.direction;
    let from = point - rail.point;
    along.x * from.y - along.y * from.x
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
