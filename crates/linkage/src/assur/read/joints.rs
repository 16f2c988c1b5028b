//! Joints.

use super::links::find_point;
use super::{FARTHEST, NAME_DEMAND, Placed, is_name};
use crate::assur::description::{Joint, JointKind, Link, PointRef, Prismatic};
use trirrr_scene::read::{Bound, Section};

#[derive(Clone, Copy)]
enum Kind {
    Revolute,
    Prismatic,
}

/// The joints; `None` if any is refused. Without links (`resolve` false) nothing is looked up.
pub(super) fn read(
    root: &Section,
    links: &[Placed<Link>],
    resolve: bool,
) -> Option<Vec<Placed<Joint>>> {
    let sections = root.sections("joint")?;
    if sections.is_empty() {
        root.refuse_list("joint", "missing, expected tables [[joint]]");
        return None;
    }
    let mut joints: Vec<Placed<Joint>> = Vec::with_capacity(sections.len());
    let mut good = true;
    for section in &sections {
        match read_joint(section, links, resolve) {
            Some(joint) if joints.iter().any(|(_, other)| other.name == joint.name) => {
                section.refuse("name", "there is another joint of this name");
                good = false;
            }
            Some(joint) => joints.push((section.place(), joint)),
            None => good = false,
        }
    }
    good.then_some(joints)
}

fn read_joint(section: &Section, links: &[Placed<Link>], resolve: bool) -> Option<Joint> {
    let name = section.text("name").and_then(|name| {
        let good = is_name(&name);
        if !good {
            section.refuse("name", NAME_DEMAND);
        }
        good.then(|| name.into_owned())
    });
    const KINDS: [(&str, Kind); 2] = [("revolute", Kind::Revolute), ("prismatic", Kind::Prismatic)];
    let Some(kind) = section.choice("kind", &KINDS) else {
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
    let kind = match kind {
        Kind::Revolute => read_pins(section, links, resolve),
        Kind::Prismatic => read_slide(section, links, resolve),
    };
    Some(Joint {
        name: name?,
        kind: kind?,
        branch: branch?,
    })
}

fn read_pins(section: &Section, links: &[Placed<Link>], resolve: bool) -> Option<JointKind> {
    let texts = section.texts("at")?;
    if texts.len() < 2 {
        section.refuse(
            "at",
            "expected two or more \"link.point\", of different links",
        );
        return None;
    }
    if !resolve {
        return None;
    }
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

fn read_slide(section: &Section, links: &[Placed<Link>], resolve: bool) -> Option<JointKind> {
    let point = |key: &'static str| {
        let text = section.text(key)?;
        if !resolve {
            return None;
        }
        find_point(links, &text)
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
