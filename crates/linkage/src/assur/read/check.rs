//! Checks of a whole linkage: degrees of freedom, groups, branches.

use crate::assur::chain::find_turnless_chain;
use crate::assur::description::{JointKind, Linkage, SlotPart};
use crate::assur::groups::{Group, GroupKind, decompose};
use crate::assur::mobility::{Locked, Mobility, Tie, check_ties};
use trirrr_scene::read::{Document, Place};

/// Places of the parts in the file.
pub(super) struct Places {
    pub(super) links: Place,
    pub(super) drives: Place,
    pub(super) joint: Vec<Place>,
    pub(super) link: Vec<Place>,
}

/// Refuses what cannot be solved, and orders the rest into groups.
pub(super) fn check(document: &Document, linkage: &mut Linkage, places: &Places) {
    let whole = |place: &Place| Place {
        value: None,
        ..place.clone()
    };
    let links = linkage.links.len();
    let locked = check_ties(links, &linkage.joints, &linkage.drives).err();
    let mobility = Mobility::count(links, &linkage.joints);
    let (freedoms, drives) = (mobility.freedoms(), linkage.drives.len() as i64);
    if freedoms != drives {
        let verdict = if freedoms < drives { "over" } else { "under" };
        let mut reason =
            format!("{verdict}-constrained: degrees of freedom {mobility}, drives {drives}");
        if let Some(locked) = locked.filter(|_| freedoms < drives) {
            reason = format!("{reason}; {}", describe_locked(linkage, &locked));
        }
        return document.refuse(&whole(&places.drives), reason);
    }
    if let Some(locked) = locked {
        let place = match locked.tie {
            Tie::Joint(joint) => &places.joint[joint],
            Tie::Drive(_) => &places.drives,
        };
        let reason = format!(
            "over-constrained in one part and under-constrained in another, although degrees of \
             freedom {mobility} equal the drives: {}",
            describe_locked(linkage, &locked)
        );
        return document.refuse(&whole(place), reason);
    }
    let chain = find_turnless_chain(links, &linkage.joints, &linkage.drives);
    if let Some(chain) = chain {
        let sliding =
            |joint: &&usize| matches!(linkage.joints[**joint].kind, JointKind::Prismatic(_));
        let name = match chain.iter().filter(sliding).count() {
            3 => "PPP, which is no Assur group: ",
            _ => "",
        };
        let reason = format!(
            "{name}around the joints {} nothing can turn: the angles are given once too often \
             while a translation stays free",
            linkage.joint_names(&chain)
        );
        let place = chain
            .last()
            .map_or(&places.links, |&joint| &places.joint[joint]);
        return document.refuse(&whole(place), reason);
    }
    let Some(groups) = decompose(links, &linkage.joints, &linkage.drives) else {
        let reason = "the joints and drives do not determine every link";
        return document.refuse(&whole(&places.links), reason);
    };
    linkage.groups = groups;
    for group in &linkage.groups {
        check_group(document, linkage, group, places);
    }
    check_branches(document, linkage, places);
}

fn describe_locked(linkage: &Linkage, locked: &Locked) -> String {
    let tie = match locked.tie {
        Tie::Joint(joint) => format!("joint {}", linkage.joints[joint].name),
        Tie::Drive(drive) => {
            let joint = linkage.drives[drive].joint;
            format!("the drive in joint {}", linkage.joints[joint].name)
        }
    };
    format!(
        "{tie} ties links that the joints and drives before it leave no freedom for it: {}",
        linkage.link_names(&locked.links)
    )
}

fn check_group(document: &Document, linkage: &Linkage, group: &Group, places: &Places) {
    if matches!(group.kind, GroupKind::Dyad(_)) {
        let pins = |joint: usize, link: usize| {
            let joint = &linkage.joints[joint];
            match joint.kind {
                JointKind::Revolute(_) => joint.point_on(link).map(|pin| linkage.local(pin)),
                JointKind::Prismatic(_) => None,
            }
        };
        for &link in &group.links {
            let at: Vec<_> = group
                .joints
                .iter()
                .filter_map(|&joint| pins(joint, link))
                .collect();
            if let [a, b] = at[..]
                && a == b
            {
                let reason = "both joints of the link are at one point: nothing holds its angle";
                document.refuse(&places.link[link], reason);
            }
        }
    }
    if group.is_iterated() {
        for &link in &group.links {
            // A block begins where its pin is.
            if linkage.links[link].guess.is_none() && !linkage.links[link].is_block {
                let reason = format!(
                    "missing: the links {} are no dyad, and Newton-Raphson needs to know roughly \
                     where each of them is at the start",
                    linkage.link_names(&group.links)
                );
                let place = &places.link[link];
                let place = Place {
                    key: format!("{}.guess", place.key),
                    ..place.clone()
                };
                document.refuse(&place, reason);
            }
        }
    }
}

fn check_branches(document: &Document, linkage: &Linkage, places: &Places) {
    let is_inner = |index: usize| {
        linkage.groups.iter().any(|group| match group.kind {
            GroupKind::Dyad(dyad) => group.joints[1] == index && dyad.has_branches(),
            _ => false,
        })
    };
    for (index, joint) in linkage.joints.iter().enumerate() {
        // The pin of a slot is judged with the slot: one of the two is the inner joint.
        if joint.in_slot == Some(SlotPart::Pin) {
            continue;
        }
        let pin = joint.in_slot.and_then(|_| linkage.pin_of_slot(index));
        let inner = is_inner(index) || pin.is_some_and(is_inner);
        if let (Some(sign), false) = (joint.branch, inner) {
            let place = Place {
                key: format!("{}.branch", places.joint[index].key),
                value: Some(sign.to_string()),
                ..places.joint[index].clone()
            };
            let reason = "the joint is not between the two links of a dyad RRR, RPR or RRP: there \
                          is no branch to choose";
            document.refuse(&place, reason);
        }
    }
}
