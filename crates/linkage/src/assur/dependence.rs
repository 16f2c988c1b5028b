//! Links that have to be solved together, from the unknowns in each equation.
//!
//! Every link brings three unknowns and every pin two; every link at a pin brings two equations,
//! a prismatic joint two, a drive one. An assignment of each equation to one of the unknowns in it
//! says what an unknown waits for: the other links and pins of its equation. What waits for each
//! other has to be solved together, and that is exactly an Assur group (or a driven link, which
//! waits for nothing but the link it is driven from). The partition does not depend on which
//! assignment was found.

use super::parts::{FRAME, Joint, JointDrive, JointKind};

/// For every link, in their order, a number that links share if they have to be solved together.
///
/// `None` if the equations do not determine the links.
pub(super) fn solved_together(
    links: usize,
    joints: &[Joint],
    drives: &[JointDrive],
) -> Option<Vec<usize>> {
    let system = EquationSystem::new(links, joints, drives);
    let mut numbers = components(system.waits()?);
    numbers.truncate(links);
    Some(numbers)
}

/// The equations by the bodies in them. Bodies are the links, then one per pin.
struct EquationSystem {
    /// Unknowns of each body; none for the frame.
    unknowns: Vec<usize>,
    /// The two bodies of each equation.
    equations: Vec<[usize; 2]>,
}

impl EquationSystem {
    fn new(links: usize, joints: &[Joint], drives: &[JointDrive]) -> Self {
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

    /// Assigns each equation to one of its bodies, none more often than it has unknowns. Returns for
    /// each body `true` at the bodies that it waits for: the others in its equations. `None` if
    /// there is no such assignment or unknowns are left over.
    fn waits(&self) -> Option<Vec<Vec<bool>>> {
        let bodies = self.unknowns.len();
        if self.equations.len() != self.unknowns.iter().sum::<usize>() {
            return None;
        }
        let mut held: Vec<Vec<usize>> = vec![Vec::new(); bodies];
        for equation in 0..self.equations.len() {
            if !self.place(equation, &mut held, &mut vec![false; bodies]) {
                return None;
            }
        }
        let mut waits = vec![vec![false; bodies]; bodies];
        for (body, equations) in held.iter().enumerate() {
            for &equation in equations {
                let [a, b] = self.equations[equation];
                waits[body][if body == a { b } else { a }] = true;
            }
        }
        Some(waits)
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
}

/// Strongly connected components: two bodies have the same number if each waits for the other,
/// itself or through others. The number is the least body of the component.
fn components(mut reach: Vec<Vec<bool>>) -> Vec<usize> {
    for middle in 0..reach.len() {
        reach[middle][middle] = true;
        // Warshall: every way through `middle`.
        let onwards = reach[middle].clone();
        for from in reach.iter_mut().filter(|from| from[middle]) {
            for (to, &onwards) in from.iter_mut().zip(&onwards) {
                *to |= onwards;
            }
        }
    }
    let mutual = |body: usize| (0..=body).find(|&other| reach[body][other] && reach[other][body]);
    (0..reach.len())
        .map(|body| mutual(body).unwrap_or(body))
        .collect()
}
