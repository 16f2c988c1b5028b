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
const MOST: usize = 32;

/// Motions for which there is room where none waits. A corner may add a piece to each.
pub(super) const MOTIONS: usize = MOST / 2;

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
        MOST.saturating_sub(self.ready.len()) / 2
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
        for each in &pieces {
            // A corner has the tool of the piece before.
            self.ready(each, before, false);
        }
        self.held = last.map(|last| {
            let tool = if last.setting == next.setting {
                tool
            } else {
                before
            };
            (last, tool)
        });
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
