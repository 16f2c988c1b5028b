//! Decomposition into Assur groups, in solving order.
//!
//! Every link brings three unknowns and every pin two; every link at a pin brings two equations,
//! a prismatic joint two, a drive one. An assignment of each equation to one of the unknowns in it
//! says what an unknown waits for: the other links and pins of its equation. What waits for each
//! other has to be solved together, and that is exactly an Assur group (or a driven link, which
//! waits for nothing but the link it is driven from). The partition does not depend on which
//! assignment was found.

use super::description::{Drive, FRAME, Joint, JointKind};

/// What is solved in one go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// What it is.
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

    /// Whether there are two ways to assemble it.
    pub fn has_branches(self) -> bool {
        matches!(self, Dyad::Rrr | Dyad::Rpr | Dyad::Rrp)
    }
}

impl Group {
    /// Whether it is solved by Newton-Raphson.
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
pub(super) fn decompose(links: usize, joints: &[Joint], drives: &[Drive]) -> Option<Vec<Group>> {
    let system = System::new(links, joints, drives);
    let component = components(&system.waits(&system.assign()?));
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
fn tied(members: &[usize], joints: &[Joint], drives: &[Drive], solved: &[bool]) -> Option<Group> {
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
    Some(match letters {
        ['R', 'R', 'R'] => (Dyad::Rrr, false),
        ['R', 'P', 'R'] => (Dyad::Rpr, false),
        ['R', 'R', 'P'] => (Dyad::Rrp, false),
        ['P', 'R', 'R'] => (Dyad::Rrp, true),
        ['P', 'R', 'P'] => (Dyad::Prp, false),
        ['P', 'P', 'R'] => (Dyad::Ppr, false),
        ['R', 'P', 'P'] => (Dyad::Ppr, true),
        _ => return None,
    })
}

/// The equations by the bodies in them. Bodies are the links, then one per pin.
struct System {
    /// Unknowns of each body; none for the frame.
    unknowns: Vec<usize>,
    /// The two bodies of each equation.
    equations: Vec<[usize; 2]>,
}

impl System {
    fn new(links: usize, joints: &[Joint], drives: &[Drive]) -> Self {
        let mut unknowns = vec![3; links];
        unknowns[FRAME] = 0;
        let mut equations = Vec::new();
        for joint in joints {
            match &joint.kind {
                JointKind::Revolute(pins) => {
                    let pin = unknowns.len();
                    unknowns.push(2);
                    for held in pins {
                        equations.extend([[held.link, pin]; 2]);
                    }
                }
                JointKind::Prismatic(slide) => {
                    equations.extend([[slide.guide.link, slide.slider.link]; 2]);
                }
            }
        }
        equations.extend(drives.iter().map(|drive| [drive.base, drive.link]));
        Self {
            unknowns,
            equations,
        }
    }

    /// For each equation one of its bodies, none more often than it has unknowns; `None` if that
    /// is impossible or unknowns are left over.
    fn assign(&self) -> Option<Vec<usize>> {
        if self.equations.len() != self.unknowns.iter().sum() {
            return None;
        }
        let mut held: Vec<Vec<usize>> = vec![Vec::new(); self.unknowns.len()];
        for equation in 0..self.equations.len() {
            let mut tried = vec![false; self.unknowns.len()];
            if !self.place(equation, &mut held, &mut tried) {
                return None;
            }
        }
        let mut body_of = vec![0; self.equations.len()];
        for (body, equations) in held.iter().enumerate() {
            for &equation in equations {
                body_of[equation] = body;
            }
        }
        Some(body_of)
    }

    /// Kuhn's augmenting path.
    fn place(&self, equation: usize, held: &mut [Vec<usize>], tried: &mut [bool]) -> bool {
        for body in self.equations[equation] {
            if tried[body] {
                continue;
            }
            tried[body] = true;
            if held[body].len() < self.unknowns[body] {
                held[body].push(equation);
                return true;
            }
            for slot in 0..held[body].len() {
                let other = held[body][slot];
                if self.place(other, held, tried) {
                    held[body][slot] = equation;
                    return true;
                }
            }
        }
        false
    }

    /// For each body the bodies that it waits for.
    fn waits(&self, body_of: &[usize]) -> Vec<Vec<usize>> {
        let mut waits = vec![Vec::new(); self.unknowns.len()];
        for (&[a, b], &body) in self.equations.iter().zip(body_of) {
            waits[body].push(if body == a { b } else { a });
        }
        waits
    }
}

/// Strongly connected components: two bodies have the same number if each waits for the other.
/// The number is the least body of the component.
fn components(waits: &[Vec<usize>]) -> Vec<usize> {
    let reach: Vec<Vec<bool>> = (0..waits.len())
        .map(|body| {
            let mut reached = vec![false; waits.len()];
            let mut stack = vec![body];
            reached[body] = true;
            while let Some(body) = stack.pop() {
                for &next in &waits[body] {
                    if !std::mem::replace(&mut reached[next], true) {
                        stack.push(next);
                    }
                }
            }
            reached
        })
        .collect();
    (0..waits.len())
        .map(|body| {
            (0..waits.len())
                .find(|&other| reach[body][other] && reach[other][body])
                .unwrap_or(body)
        })
        .collect()
}
