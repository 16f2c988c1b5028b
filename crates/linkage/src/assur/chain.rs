//! Chains in which nothing can turn, which Gruebler's count does not show.

use super::parts::{Joint, JointDrive, JointKind};

/// Finds joints that close a chain in which nothing turns: prismatic ones, and revolute ones whose
/// angle is driven. Around such a chain the angles are given once too often while a translation
/// stays free; three prismatic joints are the group PPP, which is no Assur group.
pub(super) fn find_turnless_chain(
    links: usize,
    joints: &[Joint],
    drives: &[JointDrive],
) -> Option<Vec<usize>> {
    let is_slide = |joint: &&Joint| matches!(joint.kind, JointKind::Prismatic(_));
    let sliding = joints
        .iter()
        .enumerate()
        .filter(|(_, joint)| is_slide(joint))
        .map(|(index, joint)| {
            let ends = joint.links();
            (index, ends[0], ends[1])
        });
    let turning = drives
        .iter()
        .filter(|drive| !drive.slides)
        .map(|drive| (drive.joint, drive.base, drive.link));
    let mut ties: Vec<Vec<(usize, usize)>> = vec![Vec::new(); links];
    for (joint, a, b) in turning.chain(sliding) {
        if let Some(mut chain) = path(&ties, a, a, b) {
            chain.push(joint);
            return Some(chain);
        }
        ties[a].push((b, joint));
        ties[b].push((a, joint));
    }
    None
}

/// The joints on the way from `from` to `to` in a forest of ties, but not back through the link
/// `before`.
fn path(ties: &[Vec<(usize, usize)>], before: usize, from: usize, to: usize) -> Option<Vec<usize>> {
    if from == to {
        return Some(Vec::new());
    }
    let onwards = ties[from].iter().filter(|(other, _)| *other != before);
    onwards.into_iter().find_map(|&(other, joint)| {
        let mut chain = path(ties, from, other, to)?;
        chain.insert(0, joint);
        Some(chain)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assur::example::{drive, pin, slide};

    #[test]
    fn three_prismatic_joints_in_a_chain_are_found() {
        let joints = [slide(0, 1), slide(1, 2), slide(0, 2), pin(&[2, 3])];
        assert_eq!(find_turnless_chain(4, &joints, &[]), Some(vec![0, 1, 2]));
        assert_eq!(find_turnless_chain(4, &joints[1..], &[]), None);
        // A driven crank closes such a chain too: its angle is given.
        let joints = [pin(&[0, 1]), slide(1, 2), slide(2, 0)];
        let crank = drive(0, 0, 1, false);
        assert_eq!(find_turnless_chain(3, &joints, &[]), None);
        assert_eq!(
            find_turnless_chain(3, &joints, &[crank]),
            Some(vec![1, 0, 2])
        );
    }
}
