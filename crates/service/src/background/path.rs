//! Paths: pieces that the host gives, planned here and then judged and queued as if the host had offered moves.

use super::super::planner::{PathPlanner, PathStep};
use super::Background;
use super::moves::is_pose;
use crate::number::ServiceNumber;
use crate::scene::Scene;
use crate::tool::Tool;
use core::borrow::Borrow;
use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::{PathCurve, PathPiece, Refusal, Violation};

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Takes a piece; none where the image reads none.
    #[inline(always)]
    pub(super) fn path(&mut self, piece: Option<&PathPiece<N>>) -> Result<(), Refusal<N>> {
        match piece.filter(|_| self.desk.planner.can_plan()) {
            Some(piece) => self.take_piece(piece),
            None => Err(Refusal::NoPaths),
        }
    }

    #[inline(never)]
    fn take_piece(&mut self, piece: &PathPiece<N>) -> Result<(), Refusal<N>> {
        let before = self.end_of_moves()?;
        if piece.number != self.status.piece {
            return Err(Refusal::MoveNumber {
                expected: self.status.piece,
            });
        }
        check_piece(piece)?;
        if !self.desk.planner.is_active() {
            if self.desk.offered.peek().is_some() || self.is_retargeting() {
                return Err(Refusal::Undecided);
            }
            if !is_at_rest(&before) {
                return Err(Refusal::StartVelocity);
            }
            self.desk.planner.begin(before.pose);
        }
        if !self.desk.planner.push(piece) {
            return Err(Refusal::QueueFull);
        }
        self.count_offer();
        self.status.piece = self.status.piece.wrapping_add(1);
        Ok(())
    }

    /// Returns true while moves are planned here.
    #[inline(always)]
    pub(super) fn is_planning(&self) -> bool {
        self.is_retargeting() || self.desk.planner.is_active()
    }

    /// Does one step of the plan. Returns true if there was one to do.
    #[inline(always)]
    pub(super) fn path_step(&mut self) -> bool {
        // One move at a time: the next plan may depend on its verdict.
        let waits = self.desk.offered.peek().is_some() || self.room() == 0;
        if !self.desk.planner.is_active() || waits {
            return false;
        }
        match self.desk.planner.step(&self.coefficients.borrow().path) {
            PathStep::Working => true,
            PathStep::Waiting => false,
            PathStep::Move(quintic) => self.offer_planned(quintic),
            PathStep::Done => {
                self.desk.planner.drop_path();
                false
            }
            PathStep::Refused { number, violation } => {
                self.end_path(number, violation);
                false
            }
        }
    }

    /// The move of the path that was judged is refused: the planner makes another.
    #[inline(never)]
    pub(super) fn refuse_of_path(&mut self, violation: &Violation<N>) {
        self.withdraw();
        self.desk
            .planner
            .cut(&self.coefficients.borrow().path, violation);
    }

    /// Ends the path before piece `number`. The next piece takes its place.
    #[inline(never)]
    fn end_path(&mut self, number: u32, violation: Violation<N>) {
        self.desk.planner.drop_path();
        self.features.drop_outputs();
        self.status.piece = number;
        self.tell_refused(violation);
    }
}

fn is_at_rest<N: Number>(setpoint: &Setpoint<N>) -> bool {
    let zero = [N::ZERO; 3];
    <[N; 3]>::from(setpoint.velocity) == zero && <[N; 3]>::from(setpoint.acceleration) == zero
}

fn check_piece<N: ServiceNumber>(piece: &PathPiece<N>) -> Result<(), Refusal<N>> {
    let finite = match &piece.curve {
        PathCurve::Line { to } => is_pose(to),
        PathCurve::Arc {
            centre: [x, y],
            turn,
            to_angle,
        } => x.is_finite() && y.is_finite() && turn.is_finite() && N::angle_is_finite(*to_angle),
        PathCurve::Bezier { controls, to } => controls.iter().all(is_pose) && is_pose(to),
    };
    let numbers = [piece.feed, piece.tool_power, piece.tool_speed];
    if !(finite && numbers.iter().all(|value| value.is_finite())) {
        return Err(Refusal::NotFinite);
    }
    if !(piece.feed >= N::ZERO) {
        return Err(Refusal::Feed);
    }
    match Tool::is_one(piece.tool_power, piece.tool_speed) {
        true => Ok(()),
        false => Err(Refusal::Tool),
    }
}
