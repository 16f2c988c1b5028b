//! Degrees of freedom: Gruebler's count for the whole, and a search for locked parts, which the
//! count does not show where others are loose.

use super::parts::{Joint, JointDrive, SlotPart};
use std::fmt;

/// Gruebler's count F = 3 (m - 1) - 2 c - h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mobility {
    /// m: links, the frame among them.
    pub links: usize,
    /// c: joints between two links; a pin through k links counts for k - 1.
    pub joints: usize,
    /// h: pins in slots, each of which takes one freedom.
    pub slots: usize,
}

impl Mobility {
    /// Counts. `links` and `joints` are all that are solved; a block in a slot with its two joints counts as one pin in a slot.
    pub fn count(links: usize, joints: &[Joint]) -> Self {
        let is_slot = |joint: &&Joint| joint.in_slot == Some(SlotPart::Slot);
        let slots = joints.iter().filter(is_slot).count();
        let simple = joints.iter().filter(|joint| joint.in_slot.is_none());
        Self {
            links: links - slots,
            joints: simple.map(Joint::simple_joints).sum(),
            slots,
        }
    }

    /// F; negative where there are more joints than a locked structure needs.
    pub fn freedoms(&self) -> i64 {
        3 * (self.links as i64 - 1) - 2 * self.joints as i64 - self.slots as i64
    }
}

impl fmt::Display for Mobility {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (m, c) = (self.links, self.joints);
        write!(f, "3 ({m} - 1) - 2 * {c}")?;
        if self.slots > 0 {
            write!(f, " - {}", self.slots)?;
        }
        write!(f, " = {}", self.freedoms())
    }
}

/// A joint or a drive that is one too many, by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tie {
    Joint(usize),
    Drive(usize),
}

/// Links, in the order of the file, that are rigid among themselves before `tie` ties them once
/// more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Locked {
    pub(super) tie: Tie,
    pub(super) links: Vec<usize>,
}

/// Refuses the first joint or drive whose constraints are not independent of those before it, for
/// links of general dimensions.
///
/// The (3, 3) pebble game: every link starts with the three pebbles of its freedoms, a constraint
/// between two links takes one, and it is independent exactly if four pebbles can be gathered on
/// the two links before it does (three always stay: a rigid body moves as a whole).
pub(super) fn check_ties(
    links: usize,
    joints: &[Joint],
    drives: &[JointDrive],
) -> Result<(), Locked> {
    let locked = |tie: Tie| move |links| Locked { tie, links };
    for (index, joint) in joints.iter().enumerate() {
        let ends = joint.links();
        for other in joints[..index].iter().map(Joint::links) {
            let mut shared: Vec<usize> =
                ends.iter().copied().filter(|l| other.contains(l)).collect();
            if shared.len() > 1 {
                shared.sort_unstable();
                return Err(locked(Tie::Joint(index))(shared));
            }
        }
    }
    let mut game = Pebbles {
        free: vec![3; links],
        towards: vec![Vec::new(); links],
    };
    for (index, joint) in joints.iter().enumerate() {
        for pair in joint.links().windows(2) {
            for _ in 0..2 {
                game.tie(pair[0], pair[1])
                    .map_err(locked(Tie::Joint(index)))?;
            }
        }
    }
    for (index, drive) in drives.iter().enumerate() {
        game.tie(drive.base, drive.link)
            .map_err(locked(Tie::Drive(index)))?;
    }
    Ok(())
}

struct Pebbles {
    free: Vec<u8>,
    /// A constraint that took its pebble from link a points from a to the other link.
    towards: Vec<Vec<usize>>,
}

impl Pebbles {
    /// Adds a constraint between two different links, or gives the rigid part that holds both.
    fn tie(&mut self, a: usize, b: usize) -> Result<(), Vec<usize>> {
        while self.free[a] + self.free[b] < 4 {
            // Fetched for whichever link has room; the other's stay where they are.
            let fetched =
                (self.free[a] < 3 && self.fetch(a, b)) || (self.free[b] < 3 && self.fetch(b, a));
            if !fetched {
                let mut part = self.reach(&[a, b]);
                part.sort_unstable();
                return Err(part);
            }
        }
        let (from, to) = if self.free[a] > 0 { (a, b) } else { (b, a) };
        self.free[from] -= 1;
        self.towards[from].push(to);
        Ok(())
    }

    /// Moves a free pebble to `root` from where its constraints lead, but not from `kept`.
    fn fetch(&mut self, root: usize, kept: usize) -> bool {
        let mut came_from = vec![None; self.free.len()];
        came_from[root] = Some(root);
        came_from[kept] = Some(kept);
        let mut stack = vec![root];
        while let Some(link) = stack.pop() {
            for &next in &self.towards[link] {
                if came_from[next].is_some() {
                    continue;
                }
                came_from[next] = Some(link);
                if self.free[next] == 0 {
                    stack.push(next);
                    continue;
                }
                // Turn the constraints of the path round: each link on it gives and gets one.
                self.free[next] -= 1;
                self.free[root] += 1;
                let mut to = next;
                while to != root {
                    let Some(from) = came_from[to] else { break };
                    if let Some(edge) = self.towards[from].iter().position(|&link| link == to) {
                        self.towards[from].swap_remove(edge);
                    }
                    self.towards[to].push(from);
                    to = from;
                }
                return true;
            }
        }
        false
    }

    fn reach(&self, roots: &[usize]) -> Vec<usize> {
        let mut reached = roots.to_vec();
        let mut next = 0;
        while next < reached.len() {
            for &link in &self.towards[reached[next]] {
                if !reached.contains(&link) {
                    reached.push(link);
                }
            }
            next += 1;
        }
        reached
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assur::example::{drive, pin};

    #[test]
    fn the_count_is_gruebler_s() {
        let four_bar = [pin(&[0, 1]), pin(&[1, 2]), pin(&[2, 3]), pin(&[3, 0])];
        let count = Mobility::count(4, &four_bar);
        assert_eq!(count.freedoms(), 1);
        assert_eq!(count.to_string(), "3 (4 - 1) - 2 * 4 = 1");
        // One pin through three links is two joints.
        let multiple = [pin(&[0, 1]), pin(&[1, 2, 3]), pin(&[2, 0]), pin(&[3, 0])];
        assert_eq!(Mobility::count(4, &multiple).joints, 5);
        assert_eq!(Mobility::count(4, &multiple).freedoms(), -1);
    }

    #[test]
    fn a_driven_four_bar_is_not_locked_and_a_second_drive_is_one_too_many() {
        let joints = [pin(&[0, 1]), pin(&[1, 2]), pin(&[2, 3]), pin(&[3, 0])];
        let crank = drive(0, 0, 1, false);
        assert_eq!(check_ties(4, &joints, &[crank]), Ok(()));
        let locked = check_ties(4, &joints, &[crank, drive(3, 0, 3, false)]).unwrap_err();
        assert_eq!(
            (locked.tie, locked.links),
            (Tie::Drive(1), vec![0, 1, 2, 3])
        );
    }

    #[test]
    fn a_locked_part_is_found_beside_a_loose_one() {
        // 1 and 2 share two pins; 3 and 4 hang loose: the count says F = 1 with one drive.
        let joints = [
            pin(&[0, 1]),
            pin(&[1, 2]),
            pin(&[1, 2]),
            pin(&[2, 3]),
            pin(&[3, 4]),
        ];
        assert_eq!(Mobility::count(5, &joints).freedoms(), 2);
        let locked = check_ties(5, &joints, &[]).unwrap_err();
        assert_eq!((locked.tie, locked.links), (Tie::Joint(2), vec![1, 2]));
    }
}
