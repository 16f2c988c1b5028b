//! Decomposition into Assur groups, in solving order.

use super::dependence::solved_together;
use super::parts::{FRAME, Joint, JointDrive};

/// Links that are solved together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// Kind of the group.
    pub kind: GroupKind,
    /// Its links, in the order of the file.
    pub links: Vec<usize>,
    /// The joints that tie them to each other and to what was solved before, in the order of the
    /// file; for a dyad, first outer joint, inner joint, second outer joint.
    pub joints: Vec<usize>,
    /// The drives among these joints.
    pub drives: Vec<usize>,
}

/// Kinds of group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupKind {
    /// One link, driven from a link that was solved before.
    Driven,
    /// Two links and three joints, solved in closed form.
    Dyad(Dyad),
    /// Four links and six joints, three of them outside, solved by Newton-Raphson.
    Triad,
    /// Four links and six joints, two of them outside, solved by Newton-Raphson.
    Tetrad,
    /// Anything beyond, solved by Newton-Raphson.
    Other,
}

/// The dyads, read from one outer joint to the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dyad {
    /// Three pins.
    Rrr,
    /// Two pins outside, a slider between.
    Rpr,
    /// A pin outside, a pin between, a slider outside. PRR is read backwards.
    Rrp,
    /// Two sliders outside, a pin between.
    Prp,
    /// A slider outside, a slider between, a pin outside. RPP is read backwards.
    Ppr,
}

impl Dyad {
    /// Three letters.
    pub fn name(self) -> &'static str {
        match self {
            Dyad::Rrr => "RRR",
            Dyad::Rpr => "RPR",
            Dyad::Rrp => "RRP",
            Dyad::Prp => "PRP",
            Dyad::Ppr => "PPR",
        }
    }

    /// Returns `true` for a dyad with two ways to assemble it.
    pub fn has_branches(self) -> bool {
        matches!(self, Dyad::Rrr | Dyad::Rpr | Dyad::Rrp)
    }
}

impl Group {
    /// Returns `true` for a group that is solved by Newton-Raphson.
    pub fn is_iterated(&self) -> bool {
        !matches!(self.kind, GroupKind::Driven | GroupKind::Dyad(_))
    }

    /// `driven link`, `dyad RRR`; what is beyond dyads with how it is solved.
    pub fn title(&self) -> String {
        match self.kind {
            GroupKind::Driven => "driven link".into(),
            GroupKind::Dyad(dyad) => format!("dyad {}", dyad.name()),
            GroupKind::Triad => "triad, by Newton-Raphson".into(),
            GroupKind::Tetrad => "tetrad, by Newton-Raphson".into(),
            GroupKind::Other => format!("{} links, by Newton-Raphson", self.links.len()),
        }
    }
}

/// The groups in solving order: whatever can be solved next, driven links before dyads before
/// others, and among equals in the order of the file.
///
/// `None` if the equations do not determine the links; a linkage that passed the checks of
/// mobility always has its groups.
pub(super) fn decompose(
    links: usize,
    joints: &[Joint],
    drives: &[JointDrive],
) -> Option<Vec<Group>> {
    let component = solved_together(links, joints, drives)?;
    let mut pending: Vec<Vec<usize>> = Vec::new();
    for first in 1..links {
        let members: Vec<usize> = (1..links)
            .filter(|&link| component[link] == component[first])
            .collect();
        if members[0] == first {
            pending.push(members);
        }
    }
    let mut solved = vec![false; links];
    solved[FRAME] = true;
    let mut ordered = Vec::with_capacity(pending.len());
    while !pending.is_empty() {
        let candidates = pending.iter().enumerate().filter_map(|(index, members)| {
            let group = tied(members, joints, drives, &solved)?;
            let rank = match group.kind {
                GroupKind::Driven => 0,
                GroupKind::Dyad(_) => 1,
                GroupKind::Triad | GroupKind::Tetrad | GroupKind::Other => 2,
            };
            Some((rank, index, group))
        });
        let (_, index, group) = candidates.min_by_key(|&(rank, index, _)| (rank, index))?;
        pending.remove(index);
        for &link in &group.links {
            solved[link] = true;
        }
        ordered.push(group);
    }
    Some(ordered)
}

/// The group of `members` with what ties them to each other and to what is solved, if that
/// determines them.
fn tied(
    members: &[usize],
    joints: &[Joint],
    drives: &[JointDrive],
    solved: &[bool],
) -> Option<Group> {
    let own = |link: &usize| members.contains(link);
    let mut equations = 0;
    let mut tying = Vec::new();
    for (index, joint) in joints.iter().enumerate() {
        let ends = joint.links();
        let inside = ends.iter().filter(|link| own(link)).count();
        let known = ends.iter().any(|&link| solved[link]);
        let ties = (inside + usize::from(known)).saturating_sub(1);
        if inside > 0 && ties > 0 {
            tying.push(index);
            equations += 2 * ties;
        }
    }
    let driving: Vec<usize> = (0..drives.len())
        .filter(|&drive| {
            let ends = [drives[drive].base, drives[drive].link];
            ends.iter().any(own) && ends.iter().all(|link| own(link) || solved[*link])
        })
        .collect();
    if equations + driving.len() != 3 * members.len() {
        return None;
    }
    let (kind, joints) = classify(members, tying, &driving, joints);
    Some(Group {
        kind,
        links: members.to_vec(),
        joints,
        drives: driving,
    })
}

/// The kind, and the joints in the order that it is read in.
fn classify(
    members: &[usize],
    tying: Vec<usize>,
    driving: &[usize],
    joints: &[Joint],
) -> (GroupKind, Vec<usize>) {
    match (members, driving.len(), tying.as_slice()) {
        ([_], 1, [_]) => (GroupKind::Driven, tying),
        ([a, b], 0, &[x, y, z]) => {
            let inner = |joint: usize| {
                let ends = joints[joint].links();
                ends.contains(a) && ends.contains(b)
            };
            let read = if inner(x) {
                [y, x, z]
            } else if inner(y) {
                [x, y, z]
            } else {
                [x, z, y]
            };
            match dyad(read.map(|joint| joints[joint].letter())) {
                Some((dyad, backwards)) => {
                    let [first, inner, last] = read;
                    let read = if backwards {
                        [last, inner, first]
                    } else {
                        read
                    };
                    (GroupKind::Dyad(dyad), read.to_vec())
                }
                None => (GroupKind::Other, tying),
            }
        }
        ([_, _, _, _], 0, [_, _, _, _, _, _]) => {
            let outside = |joint: &&usize| {
                let ends = joints[**joint].links();
                ends.iter().any(|link| !members.contains(link))
            };
            let kind = match tying.iter().filter(outside).count() {
                3 => GroupKind::Triad,
                2 => GroupKind::Tetrad,
                _ => GroupKind::Other,
            };
            (kind, tying)
        }
        _ => (GroupKind::Other, tying),
    }
}

/// The dyad of three joints, outer, inner, outer, and whether its name reads them backwards.
fn dyad(letters: [char; 3]) -> Option<(Dyad, bool)> {
    let read = |letters: [char; 3]| {
        let named = |dyad: &Dyad| dyad.name().chars().eq(letters);
        let dyads = [Dyad::Rrr, Dyad::Rpr, Dyad::Rrp, Dyad::Prp, Dyad::Ppr];
        dyads.into_iter().find(named)
    };
    let [first, inner, last] = letters;
    let backwards = || Some((read([last, inner, first])?, true));
    read(letters).map(|dyad| (dyad, false)).or_else(backwards)
}
