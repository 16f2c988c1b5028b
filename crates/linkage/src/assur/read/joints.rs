//! Joints.

use super::links::find_point;
use super::{FARTHEST, Placed, read_each, read_name};
use crate::assur::description::{Joint, JointKind, LinkBody, PointRef, Prismatic};
use trirrr_scene::read::{Bound, Section};

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
    const KINDS: [(&str, bool); 2] = [("revolute", false), ("prismatic", true)];
    let Some(slides) = section.choice("kind", &KINDS) else {
        section.ignore_rest();
        return None;
    };
    let branch = match section.has("branch") {
        true => match section.optional_number("branch", Bound::Within(-1.0, 1.0)) {
            Some(sign) if sign.abs() == 1.0 => Some(Some(sign)),
            Some(_) => {
                section.refuse("branch", "must be 1 or -1");
                None
            }
            None => None,
        },
        false => Some(None),
    };
    let kind = match slides {
        false => read_pins(section, links),
        true => read_slide(section, links),
    };
    Some(Joint {
        name: name?,
        kind: kind?,
        branch: branch?,
    })
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

fn read_slide(section: &Section, links: Option<&[Placed<LinkBody>]>) -> Option<JointKind> {
    let point = |key: &'static str| {
        let text = section.text(key)?;
        find_point(links?, &text)
            .map_err(|reason| section.refuse(key, reason))
            .ok()
    };
    let (guide, slider) = (point("guide"), point("slider"));
    let turn = Bound::Within(-100.0, 100.0);
    let direction = section.number_or("direction_rad", turn, 0.0);
    let angle = section.number_or("angle_rad", turn, 0.0);
    let offset = section.number_or("offset_m", Bound::Within(-FARTHEST, FARTHEST), 0.0);
    let (guide, slider) = (guide?, slider?);
    if guide.link == slider.link {
        section.refuse("slider", "guide and slider are one link");
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
