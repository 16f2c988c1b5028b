//! Sees what the machine does, at its motors, and what either end believes to have heard.

use crate::job::segment;
use std::collections::HashSet;
use trirrr_core::message::{Acting, Move, State, Telemetry};
use trirrr_core::setpoint::Segment;

/// Watches one job from tick to tick.
pub(crate) struct Witness {
    moves: Vec<Move<f64>>,
    segments: Vec<Segment<f64>>,
    /// The machine's number of the first move.
    base: u32,
    /// Move and tick of the sample before.
    before: Option<(u32, u32)>,
    ended: bool,
}

impl Witness {
    pub(crate) fn new(moves: &[Move<f64>], base: u32) -> Self {
        Self {
            moves: moves.to_vec(),
            segments: moves.iter().map(segment).collect(),
            base,
            before: None,
            ended: false,
        }
    }

    /// A sample of a tick, taken at the machine. Every tick has one.
    pub(crate) fn see(&mut self, sample: &Telemetry<f64>) {
        let playing = matches!(
            sample.state,
            State::Running | State::Slowing | State::Holding
        );
        if !playing {
            assert_eq!(sample.state, State::Idle, "{sample:?}");
            return;
        }
        assert!(!self.ended, "a job that was over goes on: {sample:?}");
        let index = sample.number.wrapping_sub(self.base);
        let place = (index, sample.at);
        match self.before {
            None => assert_eq!(place, (0, 0), "a job starts at its start"),
            Some(before) => self.follows(before, place, sample),
        }
        // At normal speed the setpoint is that of the move, in the bits; on the way to and from a
        // hold it lies between two ticks.
        if sample.part == 0 && sample.acting == Acting::Nothing {
            let expected = self.segments[index as usize].at(sample.at);
            assert_eq!(sample.setpoint.pose, expected.pose, "{sample:?}");
        }
        self.before = Some(place);
        let ticks = self.moves[index as usize].ticks;
        self.ended = index as usize + 1 == self.moves.len() && sample.at == ticks;
    }

    /// The next tick of a move, the same, or the first of the next move behind the last of this one.
    fn follows(&self, before: (u32, u32), now: (u32, u32), sample: &Telemetry<f64>) {
        let (index, at) = before;
        let ticks = self.moves[index as usize].ticks;
        let waits = sample.acting != Acting::Nothing;
        let next_tick = now == (index, at + 1);
        // The end of a move is the start of the next; a hold may cross the border inside a tick.
        let next_move = now.0 == index + 1 && now.1 <= 1 && at + 1 >= ticks;
        let same = now == before && waits;
        assert!(
            next_tick || next_move || same,
            "{before:?} of {ticks} ticks is followed by {now:?}: {sample:?}"
        );
    }

    /// The job is said to be complete.
    pub(crate) fn assert_complete(&self) {
        assert!(self.ended, "the job ended at {:?}", self.before);
    }
}

/// Every message that was sent in one direction.
#[derive(Default)]
pub(crate) struct Sent(HashSet<Vec<u8>>);

impl Sent {
    pub(crate) fn record(&mut self, frame: &[u8]) {
        self.0.insert(frame.to_vec());
    }

    /// The other end has heard what is this frame.
    pub(crate) fn assert_was_sent(&self, frame: &[u8]) {
        assert!(self.0.contains(frame), "never sent: {frame:02X?}");
    }
}
