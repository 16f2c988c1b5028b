//! Motions of a sender as pieces of a path without an end.

use std::collections::VecDeque;
use trirrr_core::setpoint::Pose;
use trirrr_jobs::{has_length, piece_from, pose_of, tool_of};
use trirrr_plan::corner::round_corners;
use trirrr_plan::course::PathPiece;
use trirrr_plan::piece::Piece;
use trirrr_scene::Tool;
use trirrr_toolpath::{Act, Element, ToolPlace};

/// Pieces that wait for the machine, beyond which no motion is taken. The machine holds as many again.
const MOST: usize = MOTIONS * PER_MOTION;

/// Motions for which there is room where none waits.
pub(super) const MOTIONS: usize = 16;

/// Pieces of a motion at most: its own, and those of a corner, of which each half may have a tool of its own.
const PER_MOTION: usize = 3;

/// Piece that the machine is to get.
#[derive(Clone, Copy, Debug)]
pub(super) struct QueuedPiece {
    pub(super) piece: Piece<f64>,
    pub(super) feed_m_s: Option<f64>,
    pub(super) tool: Option<Tool>,
    /// The motion ends there at rest.
    pub(super) last: bool,
}

/// Pieces on their way to the machine. The newest is kept back until the next one has rounded the corner between them, or until a
/// flush.
pub(super) struct PathFeed {
    corner_m: f64,
    at: Pose<f64>,
    ready: VecDeque<QueuedPiece>,
    held: Option<(PathPiece, Option<Tool>)>,
    /// Different tools so far.
    tools: usize,
    /// The next piece begins at rest.
    stops: bool,
}

impl PathFeed {
    pub(super) fn new(at: Pose<f64>, corner_m: f64) -> Self {
        Self {
            corner_m,
            at,
            ready: VecDeque::new(),
            held: None,
            tools: 0,
            stops: true,
        }
    }

    /// Motions that are taken now.
    pub(super) fn room(&self) -> usize {
        MOST.saturating_sub(self.ready.len()) / PER_MOTION
    }

    pub(super) fn is_empty(&self) -> bool {
        self.ready.is_empty() && self.held.is_none()
    }

    /// The path goes on from `place`, with nothing before it.
    pub(super) fn stand(&mut self, place: &ToolPlace) {
        if self.is_empty() {
            self.at = pose_of(place);
            self.stops = true;
        }
    }

    /// Drops everything.
    pub(super) fn clear(&mut self) {
        self.ready.clear();
        self.held = None;
        self.stops = true;
    }

    /// Takes a motion. One without a length is left out.
    pub(super) fn push(&mut self, element: &Element) {
        let Act::Motion(motion) = &element.act else {
            return;
        };
        let piece = piece_from(self.at, motion);
        if has_length(&piece) {
            self.at = piece.end();
            let tool = tool_of(element.tool, motion.feed_m_s);
            if self.held.is_none_or(|(_, before)| before != tool) {
                self.tools += 1;
            }
            let next = PathPiece {
                piece,
                feed_m_s: motion.feed_m_s,
                source: element.line as usize,
                stops: self.stops,
                setting: self.tools,
            };
            self.join(next, tool);
            self.stops = false;
        }
        self.stops |= motion.stops;
    }

    /// Lets the motion end behind the newest piece.
    pub(super) fn flush(&mut self) {
        if let Some((held, tool)) = self.held.take() {
            self.ready(&held, tool, true);
        }
        self.stops = true;
    }

    /// The piece that the machine is to get next.
    pub(super) fn front(&self) -> Option<QueuedPiece> {
        self.ready.front().copied()
    }

    /// The machine has it.
    pub(super) fn pop(&mut self) {
        self.ready.pop_front();
    }

    /// Puts `next` behind the piece that is held back, with the corner rounded.
    fn join(&mut self, next: PathPiece, tool: Option<Tool>) {
        let Some((held, before)) = self.held.take() else {
            self.held = Some((next, tool));
            return;
        };
        if next.stops {
            self.ready(&held, before, true);
            self.held = Some((next, tool));
            return;
        }
        let mut pieces = match self.corner_m > 0.0 {
            true => round_corners(&[held, next], self.corner_m),
            false => vec![held, next],
        };
        let last = pieces.pop();
        // A half of a corner has the tool of its side.
        let tool_of = |piece: &PathPiece| match piece.setting == next.setting {
            true => tool,
            false => before,
        };
        for each in &pieces {
            self.ready(each, tool_of(each), false);
        }
        self.held = last.map(|last| (last, tool_of(&last)));
    }

    fn ready(&mut self, each: &PathPiece, tool: Option<Tool>, last: bool) {
        self.ready.push_back(QueuedPiece {
            piece: each.piece,
            feed_m_s: each.feed_m_s,
            tool,
            last,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_toolpath::{ToolCurve, ToolMotion, ToolWork};

    const CORNER_M: f64 = 1e-5;

    /// A travel, a stroke and a travel, with a slight turn and a right angle between: the tool is on along the stroke, to within the tolerance.
    #[test]
    fn the_tool_changes_at_the_corners_of_a_stroke() {
        let place = |x: f64, y: f64| ToolPlace {
            position_m: [x, y],
            alpha_rad: 0.4,
        };
        let mut feed = PathFeed::new(pose_of(&place(0.25, 0.245)), CORNER_M);
        let work = ToolWork {
            power: 0.5,
            follows_speed: false,
        };
        let lines = [
            (place(0.27, 0.245), None),
            (place(0.29, 0.2452), Some(work)),
            (place(0.29, 0.255), None),
        ];
        for (line, (end, tool)) in (1..).zip(lines) {
            feed.push(&Element {
                line,
                tool,
                act: Act::Motion(ToolMotion {
                    curve: ToolCurve::Line,
                    to: end,
                    feed_m_s: Some(0.1),
                    stops: false,
                }),
            });
        }
        feed.flush();
        let pieces: Vec<QueuedPiece> = feed.ready.into();
        let changes = pieces
            .windows(2)
            .filter(|pair| pair[0].tool != pair[1].tool);
        let places: Vec<Pose<f64>> = changes.map(|pair| pair[0].piece.end()).collect();
        let corners = [[0.27, 0.245], [0.29, 0.2452]];
        assert_eq!(places.len(), corners.len());
        for (place, [x, y]) in places.iter().zip(corners) {
            let off = (place.position.x - x).hypot(place.position.y - y);
            assert!(off > 0.0 && off <= CORNER_M, "{off}");
        }
    }
}
