//! Proof of the candidates.

use super::super::breach::Breach;
use super::super::taylor::Float;
use super::super::{Judgement, Offer};
use super::aim::{Aim, RESERVE, SHAPES, Stage};
use super::timing::Timing;
use super::{Blocked, RetargetRefusal, Retargeted};
use crate::admission::Enclose;
use trirrr_core::number::Arithmetic;

/// Times that a candidate is made longer after a failed proof.
const PROOFS: u32 = 8;

impl<N: Enclose, const JERK: bool> Aim<N, JERK> {
    /// The candidate that takes least, by its shape, and its ticks.
    pub(super) fn shortest(&self) -> Option<(usize, u32)> {
        let found = self.found.iter().enumerate();
        found
            .filter_map(|(shape, found)| Some((shape, self.problem.duration((*found)?)?)))
            .min_by_key(|&(_, ticks)| ticks)
    }

    /// Chooses in the next step: a slice of work has no recursion.
    pub(super) fn choose(&mut self) {
        self.stage = Stage::Choose;
    }

    /// Begins the proof of the candidate that takes least. Without any, an end is brought to rest in another way, or the
    /// retarget is refused.
    pub(super) fn prove_shortest(&mut self) {
        if let Some((shape, _)) = self.shortest() {
            return self.prove(shape, 0);
        }
        let open = |shape: &usize| !self.failed[*shape] && self.exists(SHAPES[*shape]);
        if let Some(shape) = (0..SHAPES.len()).find(open) {
            self.stage = Stage::Time(shape, self.timing(SHAPES[shape]), true);
            return;
        }
        let other = [0, 1]
            .into_iter()
            .find_map(|end| Some((end, self.next_parts(end)?)));
        if let Some((end, parts)) = other {
            self.again = Some(end);
            self.failed = [false; SHAPES.len()];
            return self.rest(end, parts);
        }
        let unknown = Breach::out_of_range();
        let [stop, arrival, way] = self.breaches.map(|breach| breach.unwrap_or(unknown));
        let (blocked, breach) = match (self.problem.stops, self.stuck) {
            ([None, _], _) => (Blocked::Stop, stop),
            ([_, None], _) => (Blocked::Arrival, arrival),
            (_, Some(0)) => (Blocked::Stop, way),
            (_, Some(_)) => (Blocked::Arrival, way),
            (_, None) => (Blocked::Way, way),
        };
        self.refuse(blocked, breach);
    }

    /// Goes on with move `piece` of a candidate.
    pub(super) fn prove(&mut self, shape: usize, piece: usize) {
        let candidate = self.found[shape];
        let chain = candidate.and_then(|candidate| self.problem.chain(candidate));
        let Some(chain) = chain else {
            self.found[shape] = None;
            self.failed[shape] = true;
            return self.choose();
        };
        if piece == chain.len() {
            self.stage = Stage::Done(Retargeted::Planned(piece), candidate);
            return;
        }
        let (ends, ticks) = chain.piece(piece);
        let mut judgement = Judgement::new();
        judgement.judge(Offer::new(&ends, ticks, self.problem.period));
        self.stage = Stage::Prove {
            shape,
            piece,
            judgement,
        };
    }

    /// Makes the candidate of a shape longer after a failed proof, or gives it up.
    pub(super) fn lengthen(&mut self, shape: usize) {
        match self.found[shape].take() {
            Some(mut candidate) if candidate.slack < PROOFS => {
                candidate.slack += 1;
                candidate.ticks += 1 + candidate.ticks / RESERVE;
                self.stage = Stage::Time(shape, Timing::from(candidate), false);
            }
            _ => {
                self.failed[shape] = true;
                self.choose();
            }
        }
    }

    pub(super) fn refuse(&mut self, blocked: Blocked, breach: Breach<Float<N>>) {
        let chain = self
            .problem
            .chain(self.last)
            .filter(|_| blocked == Blocked::Way);
        let refusal = RetargetRefusal {
            blocked,
            violation: breach.violation(<Float<N>>::ZERO),
            way: chain.map_or(self.problem.ends.map(|end| end.pose), |chain| chain.way()),
        };
        self.stage = Stage::Done(Retargeted::Refused(refusal), None);
    }
}
