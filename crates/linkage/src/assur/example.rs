//! Joints and drives for the tests of what counts and searches them: where points lie does not
//! matter there.

use super::parts::{Joint, JointDrive, JointKind, PointRef, Prismatic};

pub(super) fn pin(links: &[usize]) -> Joint {
    Joint {
        name: String::new(),
        kind: JointKind::Revolute(
            links
                .iter()
                .map(|&link| PointRef { link, point: 0 })
                .collect(),
        ),
        branch: None,
        in_slot: None,
    }
}

pub(super) fn slide(guide: usize, slider: usize) -> Joint {
    let point = |link| PointRef { link, point: 0 };
    Joint {
        name: String::new(),
        kind: JointKind::Prismatic(Prismatic {
            guide: point(guide),
            direction: 0.0,
            slider: point(slider),
            offset: 0.0,
            angle: 0.0,
        }),
        branch: None,
        in_slot: None,
    }
}

pub(super) fn drive(joint: usize, base: usize, link: usize, slides: bool) -> JointDrive {
    JointDrive {
        joint,
        base,
        link,
        slides,
        start: 0.0,
        rate: 1.0,
        acceleration: 0.0,
    }
}
