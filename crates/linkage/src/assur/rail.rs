//! A prismatic joint seen from one of its two links, whichever of them is the guide.

use super::description::{JointKind, Linkage, Prismatic};
use crate::motion::LinkMotion;
use crate::motion::unit;
use nalgebra::Vector2;
use trirrr_core::number::{Arithmetic, dot, perpendicular};

/// A line in one link and how the other link lies on it. The other does not turn against it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rail {
    /// A point of the line and its direction, in the frame of the link that is known.
    pub(super) point: Vector2<f64>,
    pub(super) direction: Vector2<f64>,
    /// The line's direction in the frame of the other link.
    pub(super) own_direction: Vector2<f64>,
    /// The other link's point, in its frame, that lies `offset` to the left of the line.
    pub(super) own_point: Vector2<f64>,
    pub(super) offset: f64,
    /// `true` where the other link is the slider. If not, the line moves with the other link.
    pub(super) own_is_slider: bool,
}

impl Rail {
    /// The prismatic joint `joint` seen from the other link than `own`; `None` for a pin, and
    /// where `own` has no part in it.
    pub(super) fn new(linkage: &Linkage, joint: usize, own: usize) -> Option<Self> {
        let JointKind::Prismatic(slide) = &linkage.joints[joint].kind else {
            return None;
        };
        let Prismatic {
            guide,
            direction,
            slider,
            offset,
            angle,
        } = *slide;
        let (in_guide, in_slider) = (unit(direction), unit(direction - angle));
        if own == slider.link {
            Some(Self {
                point: linkage.local(guide),
                direction: in_guide,
                own_direction: in_slider,
                own_point: linkage.local(slider),
                offset,
                own_is_slider: true,
            })
        } else if own == guide.link {
            Some(Self {
                point: linkage.local(slider),
                direction: in_slider,
                own_direction: in_guide,
                own_point: linkage.local(guide),
                offset: -offset,
                own_is_slider: false,
            })
        } else {
            None
        }
    }

    /// Returns the distance to the left of the line of a point of the other link, in its frame.
    pub(super) fn left(&self, own: Vector2<f64>) -> f64 {
        self.offset + dot(perpendicular(self.own_direction), own - self.own_point)
    }
}

/// `v` turned back by the angle of `direction`, a unit vector.
pub(super) fn turned_back(v: Vector2<f64>, direction: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(
        f64::ab_plus_cd(direction.x, v.x, direction.y, v.y),
        f64::ab_minus_cd(direction.x, v.y, direction.y, v.x),
    )
}

/// The motion of a link's own frame, from that of a frame fixed in it whose origin is the link's
/// point `at` and whose x axis points along `axis` there.
pub(super) fn reframed(
    motion: &LinkMotion<f64>,
    axis: Vector2<f64>,
    at: Vector2<f64>,
) -> LinkMotion<f64> {
    let turned = LinkMotion {
        direction: turned_back(motion.direction, axis),
        ..*motion
    };
    LinkMotion {
        origin: turned.point(-at),
        ..turned
    }
}
