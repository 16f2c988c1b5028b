//! Joints.

use super::links::find_point;
use super::{FARTHEST, Placed, read_each, read_name};
use crate::assur::description::{
    Joint, JointDrive, JointKind, LinkBody, PointRef, Prismatic, SlotPart,
};
use crate::assur::parts::BodyMass;
use nalgebra::Vector2;
use trirrr_scene::read::{Bound, Section};

/// Kinds of joint in a file.
#[derive(Clone, Copy)]
enum FileKind {
    Revolute,
    Prismatic,
    PinInSlot,
}

/// The joints; `None` if any is refused. Without links nothing is looked up.
pub(super) fn read(
    root: &Section,
    links: Option<&[Placed<LinkBody>]>,
) -> Option<Vec<Placed<Joint>>> {
    let sections = root.sections("joint")?;
    if sections.is_empty() {
        root.refuse_list("joint", "missing, expected tables [[joint]]");
        return None;
    }
    let read = |_, section: &Section| read_joint(section, links);
    let same = |a: &Joint, b: &Joint| a.name == b.name;
    let reason = "there is another joint of this name";
    read_each(&sections, read, same, ["name", reason])
}

fn read_joint(section: &Section, links: Option<&[Placed<LinkBody>]>) -> Option<Joint> {
    let name = read_name(section);
    const KINDS: [(&str, FileKind); 3] = [
        ("revolute", FileKind::Revolute),
        ("prismatic", FileKind::Prismatic),
        ("pin-in-slot", FileKind::PinInSlot),
    ];
    let Some(file_kind) = section.choice("kind", &KINDS) else {
        section.ignore_rest();
        return None;
    };
    let branch = match section.has("branch") {
        true => section.sign("branch").map(Some),
        false => Some(None),
    };
    let kind = match file_kind {
        FileKind::Revolute => read_pins(section, links),
        FileKind::Prismatic => read_slide(section, links, ["guide", "slider"]),
        FileKind::PinInSlot => read_slide(section, links, ["slot", "pin"]),
    };
    Some(Joint {
        name: name?,
        kind: kind?,
        branch: branch?,
        in_slot: matches!(file_kind, FileKind::PinInSlot).then_some(SlotPart::Slot),
    })
}

/// Gives every pin in a slot its block: a link that turns on the pin and slides in the slot. What was read holds the pin as the
/// slider; the pin's joint comes right behind it, so that outer joints keep the order of the file.
pub(super) fn add_blocks(
    links: &mut Vec<Placed<LinkBody>>,
    joints: Vec<Placed<Joint>>,
    drives: &mut [Placed<JointDrive>],
) -> Vec<Placed<Joint>> {
    let mut all: Vec<Placed<Joint>> = Vec::with_capacity(joints.len());
    for (index, (place, mut joint)) in joints.into_iter().enumerate() {
        for (_, drive) in drives.iter_mut().filter(|(_, drive)| drive.joint == index) {
            drive.joint = all.len();
        }
        let JointKind::Prismatic(slide) = &mut joint.kind else {
            all.push((place, joint));
            continue;
        };
        if joint.in_slot.is_none() {
            all.push((place, joint));
            continue;
        }
        let block = PointRef {
            link: links.len(),
            point: 0,
        };
        let pin = std::mem::replace(&mut slide.slider, block);
        let body = LinkBody {
            // No name of a file has spaces.
            name: format!("block of {}", joint.name),
            points: vec![("P".into(), Vector2::zeros())],
            guess: None,
            mass: BodyMass::NONE,
            is_block: true,
        };
        links.push((place.clone(), body));
        let pin = Joint {
            name: joint.name.clone(),
            kind: JointKind::Revolute(vec![pin, block]),
            branch: joint.branch,
            in_slot: Some(SlotPart::Pin),
        };
        all.push((place.clone(), joint));
        all.push((place, pin));
    }
    all
}

fn read_pins(section: &Section, links: Option<&[Placed<LinkBody>]>) -> Option<JointKind> {
    let texts = section.texts("at")?;
    if texts.len() < 2 {
        section.refuse(
            "at",
            "expected two or more \"link.point\", of different links",
        );
        return None;
    }
    let links = links?;
    let mut pins: Vec<PointRef> = Vec::with_capacity(texts.len());
    for (place, text) in &texts {
        match find_point(links, text) {
            Ok(point) if pins.iter().any(|pin| pin.link == point.link) => {
                section.refuse_at(place, "the link is at this joint already");
            }
            Ok(point) => pins.push(point),
            Err(reason) => section.refuse_at(place, reason),
        }
    }
    (pins.len() == texts.len()).then_some(JointKind::Revolute(pins))
}

/// Reads a slider on a guide, or a pin in a slot, under the keys of the line's start and of the point on it.
fn read_slide(
    section: &Section,
    links: Option<&[Placed<LinkBody>]>,
    [line, on_line]: [&'static str; 2],
) -> Option<JointKind> {
    let turns = line == "slot";
    let point = |key: &'static str| {
        let text = section.text(key)?;
        find_point(links?, &text)
            .map_err(|reason| section.refuse(key, reason))
            .ok()
    };
    let (guide, slider) = (point(line), point(on_line));
    let turn = Bound::Within(-100.0, 100.0);
    let direction = section.number_or("direction_rad", turn, 0.0);
    let angle = match turns {
        true => Some(0.0),
        false => section.number_or("angle_rad", turn, 0.0),
    };
    let offset = section.number_or("offset_m", Bound::Within(-FARTHEST, FARTHEST), 0.0);
    let (guide, slider) = (guide?, slider?);
    if guide.link == slider.link {
        section.refuse(on_line, format!("{line} and {on_line} are of one link"));
        return None;
    }
    Some(JointKind::Prismatic(Prismatic {
        guide,
        direction: direction?,
        slider,
        offset: offset?,
        angle: angle?,
    }))
}
