//! Independent loops of a linkage and the unknowns in their vectors.
//!
//! With c joints between m links, c - (m - 1) loops are independent: one for every joint beyond a tree of links. A loop is a sum
//! of vectors in the plane, so it gives two equations. The position problem has as many unknowns as equations: twice the number of
//! loops.

use super::description::{FRAME, JointKind, Linkage, PointRef};
use std::collections::VecDeque;

/// Loop of links: each with the joint that leads to the next one, the last one back to the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkLoop {
    /// Links and joints in order, blocks of pins in slots among them.
    pub steps: Vec<(usize, usize)>,
}

/// Unknowns of the position problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoopUnknowns {
    /// Links whose angles are unknown; those that cannot turn against each other share one angle.
    pub angles: Vec<Vec<usize>>,
    /// Prismatic joints and pins in slots whose way along the guide is unknown.
    pub slides: Vec<usize>,
}

impl LoopUnknowns {
    /// Number of unknowns.
    pub fn count(&self) -> usize {
        self.angles.len() + self.slides.len()
    }
}

/// Each joint between two links: its index and both links. A pin through k links is k - 1 of them.
fn edges(linkage: &Linkage) -> Vec<(usize, [usize; 2])> {
    let joints = linkage.joints.iter().enumerate();
    let each = joints.flat_map(|(index, joint)| {
        let links = joint.links();
        let first = links[0];
        let others = links.into_iter().skip(1);
        others.map(move |other| (index, [first, other]))
    });
    each.collect()
}

/// Independent loops: for every joint that a tree of shortest ways from the frame leaves over, the loop that it closes.
pub fn independent_loops(linkage: &Linkage) -> Vec<LinkLoop> {
    let edges = edges(linkage);
    // For each link the edge that leads to it, and the link before.
    let mut parent: Vec<Option<(usize, usize)>> = vec![None; linkage.links.len()];
    let mut reached = vec![false; linkage.links.len()];
    reached[FRAME] = true;
    let mut next = VecDeque::from([FRAME]);
    let mut in_tree = vec![false; edges.len()];
    while let Some(link) = next.pop_front() {
        for (edge, (_, ends)) in edges.iter().enumerate() {
            let other = match *ends {
                [a, b] if a == link => b,
                [a, b] if b == link => a,
                _ => continue,
            };
            if !reached[other] {
                reached[other] = true;
                in_tree[edge] = true;
                parent[other] = Some((edge, link));
                next.push_back(other);
            }
        }
    }
    // The way of a link to the frame: links with the joints towards the frame.
    let way = |mut link: usize| {
        let mut way = vec![(link, usize::MAX)];
        while let Some((edge, before)) = parent[link] {
            if let Some(last) = way.last_mut() {
                last.1 = edges[edge].0;
            }
            way.push((before, usize::MAX));
            link = before;
        }
        way
    };
    let left_over = edges.iter().zip(&in_tree).filter(|(_, in_tree)| !**in_tree);
    let closed = left_over.map(|((joint, [a, b]), _)| {
        let (mut one, mut other) = (way(*a), way(*b));
        // What both ways share beyond their first common link is no part of the loop.
        while let ([.., (before, _), _], [.., (also, _), _]) = (one.as_slice(), other.as_slice())
            && before == also
        {
            one.pop();
            other.pop();
        }
        // From the common link out to `b`, over the joint to `a`, and back.
        let mut steps: Vec<(usize, usize)> = Vec::new();
        other.reverse();
        for pair in other.windows(2) {
            steps.push((pair[0].0, pair[1].1));
        }
        steps.push((*b, *joint));
        steps.extend(one.iter().take(one.len() - 1));
        LinkLoop { steps }
    });
    closed.collect()
}

/// Unknown angles and ways along guides, without those that a drive gives.
pub fn unknowns(linkage: &Linkage) -> LoopUnknowns {
    // The links that share an angle up to a given one, by the least of them.
    let mut family: Vec<usize> = (0..linkage.links.len()).collect();
    let mut join = |a: usize, b: usize| {
        let (one, other) = (family[a].min(family[b]), family[a].max(family[b]));
        for each in family.iter_mut().filter(|each| **each == other) {
            *each = one;
        }
    };
    for joint in &linkage.joints {
        if let JointKind::Prismatic(slide) = &joint.kind {
            join(slide.guide.link, slide.slider.link);
        }
    }
    for drive in linkage.drives.iter().filter(|drive| !drive.slides) {
        join(drive.base, drive.link);
    }
    let mut angles: Vec<Vec<usize>> = Vec::new();
    for first in 0..linkage.links.len() {
        if family[first] == first && family[FRAME] != first {
            let members = linkage.file_links().filter(|link| family[*link] == first);
            let members: Vec<usize> = members.collect();
            angles.push(members);
        }
    }
    let is_driven = |joint: usize| {
        let mut drives = linkage.drives.iter();
        drives.any(|drive| drive.slides && drive.joint == joint)
    };
    let is_slide = |joint: &usize| matches!(linkage.joints[*joint].kind, JointKind::Prismatic(_));
    let slides = (0..linkage.joints.len()).filter(is_slide);
    LoopUnknowns {
        angles,
        slides: slides.filter(|joint| !is_driven(*joint)).collect(),
    }
}

/// One vector of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LoopVector {
    /// The link that it is fixed in; `None` for a way along a guide.
    pub(super) link: Option<usize>,
    /// Its start and its end, m.
    pub(super) ends: [[f64; 2]; 2],
}

/// The vectors of a loop at one position, head to tail. Vectors without length are left out.
pub(super) fn vectors(
    linkage: &Linkage,
    position: &super::Position,
    closed: &LinkLoop,
) -> Vec<LoopVector> {
    let place = |point: PointRef| -> [f64; 2] { position.point(linkage, point).position.into() };
    let mut vectors = Vec::new();
    let mut add = |link: Option<usize>, from: [f64; 2], to: [f64; 2]| {
        if f64::hypot(to[0] - from[0], to[1] - from[1]) > 1e-9 * linkage.size() {
            vectors.push(LoopVector {
                link,
                ends: [from, to],
            });
        }
    };
    let count = closed.steps.len();
    for (index, &(link, joint)) in closed.steps.iter().enumerate() {
        let before = closed.steps[(index + count - 1) % count].1;
        let point = |joint: usize, link: usize| linkage.joints[joint].point_on(link).map(place);
        let next = closed.steps[(index + 1) % count].0;
        let (Some(from), Some(to), Some(onwards)) =
            (point(before, link), point(joint, link), point(joint, next))
        else {
            continue;
        };
        add(Some(link), from, to);
        if let JointKind::Prismatic(slide) = &linkage.joints[joint].kind {
            // Along the guide, then across it by the offset.
            let (start, sign) = match slide.guide.link == link {
                true => (to, 1.0),
                false => (onwards, -1.0),
            };
            let u = slide.along(&position.states);
            let s = position.slide(linkage, joint).map_or(0.0, |slide| slide[0]);
            let corner = [start[0] + s * u.x, start[1] + s * u.y];
            if sign > 0.0 {
                add(None, start, corner);
                add(Some(next), corner, onwards);
            } else {
                add(Some(link), to, corner);
                add(None, corner, start);
            }
        }
    }
    vectors
}
