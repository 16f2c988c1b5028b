//! Arcs across the plane of the machine, G18 and G19: seen from above, lines along x or y.
use super::arc::{self, ArcPart, Direction};
use super::arc_block::arc_reason;
use super::frames::{axes, place};
use super::modal::Plane;
use super::refusal::{GcodeRefusal, RefusalKind};
use super::run::LineRun;
use super::setup::ZWords;
use crate::ToolPlace;
use std::f64::consts::{PI, TAU};

impl LineRun<'_, '_> {
    /// Arc across the plane, as the lines that it is from above: it turns back at its ends, and the tool may change on its way.
    pub(super) fn arc_across(
        &mut self,
        goal: ToolPlace,
        direction: Direction,
    ) -> Result<(), GcodeRefusal> {
        let refuse = |word: &str, reason: &str| {
            Err(self.block.refuse(RefusalKind::Unsupported, word, reason))
        };
        let (axis, other, letter) = match self.state.modal.plane {
            Plane::Yz => (1, 0, b'J'),
            _ => (0, 1, b'I'),
        };
        let start = self.state.place;
        if start.position_m[other] != goal.position_m[other] {
            return refuse(
                "",
                "an arc of G18 or G19 may not leave its plane; write it as G1",
            );
        }
        let [from_z, to_z] = self.heights;
        if !(from_z.is_finite() && to_z.is_finite()) {
            return refuse(
                "",
                "the arc begins at a height that is not known; give a word of Z before",
            );
        }
        // From above, x and z are a frame of the other hand.
        let direction = match (self.state.modal.plane, direction) {
            (Plane::Yz, direction) => direction,
            (_, Direction::Clockwise) => Direction::Counterclockwise,
            (_, Direction::Counterclockwise) => Direction::Clockwise,
        };
        let whole_turns = self.whole_turns()?;
        let parts = self.parts_across(
            [
                [start.position_m[axis], from_z],
                [goal.position_m[axis], to_z],
            ],
            letter,
            direction,
            whole_turns,
        )?;
        self.need_feed()?;
        let mut at = [start.position_m[axis], from_z];
        let mut before = 0.0;
        for part in &parts {
            for share in self.breaks(at, part) {
                let done = before + share * (part.done - before);
                let [along, z_m] = match share {
                    1.0 => part.to,
                    share => turned(at, part.centre, share * part.turn),
                };
                let mut goal_axes = axes(start);
                goal_axes[axis] = along;
                goal_axes[2] += done * (goal.alpha_rad - start.alpha_rad);
                (self.heights, self.done) = ([self.heights[1], z_m], 0.0);
                if share < 1.0 || part.done < 1.0 {
                    self.line(place(goal_axes))?;
                } else {
                    self.line(goal)?;
                }
            }
            (at, before) = (part.to, part.done);
        }
        Ok(())
    }

    /// Parts of the arc in the frame of its axis and of Z.
    fn parts_across(
        &mut self,
        [from, to]: [[f64; 2]; 2],
        letter: u8,
        direction: Direction,
        whole_turns: f64,
    ) -> Result<Vec<ArcPart>, GcodeRefusal> {
        // The way of the block begins at its start.
        self.heights = [from[1]; 2];
        let [radius, along, across] = [b'R', letter, b'K'].map(|letter| self.block.value(letter));
        let unit = self.state.modal.unit;
        let parts = match (radius, along.or(across)) {
            (Some(word), None) => {
                let radius = unit.to_metres(word.value);
                arc::with_radius(from, to, radius, direction, whole_turns)
            }
            (None, Some(_)) if !self.state.modal.absolute_centres => {
                let metres = |word: Option<super::block::ValueWord<'_>>| {
                    word.map_or(0.0, |word| unit.to_metres(word.value))
                };
                let centre = [from[0] + metres(along), from[1] + metres(across)];
                arc::about(from, to, centre, direction, whole_turns)
            }
            _ => {
                let reason =
                    "an arc of G18 needs I and K, of G19 J and K, from its start (G91.1), or R";
                return Err(self.block.refuse(RefusalKind::NoCentre, "", reason));
            }
        };
        parts.map_err(|fault| {
            let (kind, reason) = arc_reason(fault);
            let word = radius.or(along).or(across).map_or("", |word| word.text);
            self.block.refuse(kind, word, &reason)
        })
    }

    /// Parts of an arc from `from` at which it turns back, or passes the height of the tool, in their order, and 1.
    fn breaks(&self, from: [f64; 2], part: &ArcPart) -> Vec<f64> {
        let [x, z] = [0, 1].map(|axis| from[axis] - part.centre[axis]);
        let first = libm::atan2(z, x);
        let mut angles = vec![0.0, PI];
        if let ZWords::Tool { on_at_m } = self.fixed.z {
            let sine = (on_at_m - part.centre[1]) / libm::hypot(x, z);
            if sine.abs() < 1.0 {
                let angle = libm::asin(sine);
                angles.extend([angle, PI - angle]);
            }
        }
        let rounds = (part.turn.abs() / TAU).ceil() as i32 + 1;
        let mut shares: Vec<f64> = (-rounds..=rounds)
            .flat_map(|round| {
                angles
                    .iter()
                    .map(move |angle| angle + f64::from(round) * TAU)
            })
            .map(|angle| (angle - first) / part.turn)
            .filter(|share| (1e-9..1.0 - 1e-9).contains(share))
            .collect();
        shares.sort_by(f64::total_cmp);
        shares.push(1.0);
        shares
    }
}

fn turned(from: [f64; 2], centre: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    let [x, z] = [0, 1].map(|axis| from[axis] - centre[axis]);
    [centre[0] + cos * x - sin * z, centre[1] + sin * x + cos * z]
}
