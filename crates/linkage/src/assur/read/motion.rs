//! Drives and what they are followed over.

use super::links::find_link;
use super::{Placed, read_each};
use crate::assur::description::{Joint, JointDrive, JointKind, LinkBody, MotionSpan, names};
use std::f64::consts::TAU;
use trirrr_scene::read::{Bound, Section};

/// Steps of a motion.
const STEPS: (u32, u32) = (2, 100_000);
/// Values, rates and accelerations of drives stay within this.
const LARGEST: f64 = 1e6;
/// Longest motion, s.
const LONGEST: f64 = 1e6;
const DEFAULT_STEPS: u32 = 360;

/// The drives; `None` if any is refused. Without links and joints nothing is looked up.
pub(super) fn read_drives(
    root: &Section,
    links: Option<&[Placed<LinkBody>]>,
    joints: Option<&[Placed<Joint>]>,
) -> Option<Vec<Placed<JointDrive>>> {
    let sections = root.sections("drive")?;
    if sections.is_empty() {
        root.refuse_list(
            "drive",
            "missing, expected tables [[drive]], one per degree of freedom",
        );
        return None;
    }
    let read = |_, section: &Section| match (links, joints) {
        (Some(links), Some(joints)) => read_drive(section, links, joints),
        _ => {
            section.ignore_rest();
            None
        }
    };
    let same =
        |a: &JointDrive, b: &JointDrive| (a.joint, a.base, a.link) == (b.joint, b.base, b.link);
    read_each(
        &sections,
        read,
        same,
        ["joint", "this joint is driven already"],
    )
}

fn read_drive(
    section: &Section,
    links: &[Placed<LinkBody>],
    joints: &[Placed<Joint>],
) -> Option<JointDrive> {
    let name = section.text("joint");
    let found = name.and_then(|name| {
        let found = joints.iter().position(|(_, joint)| joint.name == name);
        if found.is_none() {
            let known = names(joints.iter().map(|(_, joint)| joint.name.as_str()));
            let reason = format!("there is no joint `{name}`; the joints are {known}");
            section.refuse("joint", reason);
        }
        found
    });
    let Some(joint) = found else {
        section.ignore_rest();
        return None;
    };
    if joints[joint].1.in_slot.is_some() {
        section.refuse(
            "joint",
            "a pin in a slot cannot be driven: drive a revolute or a prismatic joint",
        );
        section.ignore_rest();
        return None;
    }
    let bound = Bound::Within(-LARGEST, LARGEST);
    let at_joint = joints[joint].1.links();
    let slides = matches!(joints[joint].1.kind, JointKind::Prismatic(_));
    let (base, link) = match section.has("link") {
        false => (at_joint[0], Some(at_joint[1])),
        true if slides => {
            section.refuse("link", "a prismatic joint is driven from guide to slider");
            (at_joint[0], None)
        }
        true => {
            let named = section.text("link")?;
            let link = find_link(links, &named).and_then(|link| match link {
                link if link == at_joint[0] => {
                    Err("the joint's first link is what the angle is measured from".into())
                }
                link if !at_joint.contains(&link) => Err("the link is not at this joint".into()),
                link => Ok(link),
            });
            let link = link
                .map_err(|reason: String| section.refuse("link", reason))
                .ok();
            (at_joint[0], link)
        }
    };
    let keys = match slides {
        true => ["start_m", "rate_m_s", "acceleration_m_s2"],
        false => ["start_rad", "rate_rad_s", "acceleration_rad_s2"],
    };
    let start = section.number_or(keys[0], bound, 0.0);
    let rate = section.number(keys[1], bound);
    let acceleration = section.number_or(keys[2], bound, 0.0);
    Some(JointDrive {
        joint,
        base,
        link: link?,
        slides,
        start: start?,
        rate: rate?,
        acceleration: acceleration?,
    })
}

/// `[motion]`; without it one turn of the first drive.
pub(super) fn read(root: &Section, drives: Option<&[Placed<JointDrive>]>) -> Option<MotionSpan> {
    let section = root.optional_section("motion");
    if section.is_none() && root.has("motion") {
        return None;
    }
    let steps = match &section {
        Some(section) if section.has("steps") => section.integer("steps", STEPS.0, STEPS.1),
        _ => Some(DEFAULT_STEPS),
    };
    let positive = Bound::Within(1e-9, LONGEST);
    if let Some(section) = &section
        && section.has("duration_s")
    {
        if section.has("turns") {
            section.refuse(
                "turns",
                "duration_s is given too; one of them says how long",
            );
            return None;
        }
        return Some(MotionSpan {
            duration: section.optional_number("duration_s", positive)?,
            steps: steps?,
        });
    }
    let turns = match &section {
        Some(section) => section.number_or("turns", Bound::Within(1e-6, 1000.0), 1.0),
        None => Some(1.0),
    };
    let (_, first) = drives?.first()?;
    let refuse = |reason: &str| match &section {
        Some(section) => section.refuse("duration_s", reason),
        None => root.refuse("motion", reason),
    };
    if first.slides {
        refuse("missing: the first drive slides, so the motion is no number of turns");
        return None;
    }
    if first.rate == 0.0 || first.acceleration != 0.0 {
        refuse("missing: turns are counted of a first drive at constant rate, not 0");
        return None;
    }
    let duration = turns? * TAU / first.rate.abs();
    if duration > LONGEST {
        refuse("missing: at this rate the turns take too long");
        return None;
    }
    Some(MotionSpan {
        duration,
        steps: steps?,
    })
}
