//! Power lists: levels that the host gives, and moves that have some.

use super::super::offered::Offered;
use super::Background;
use super::moves::check_offer;
use crate::feature::Optional;
use crate::number::ServiceNumber;
use crate::scene::{CurvesOf, Scene};
use trirrr_protocol::message::{LevelPiece, ListedMove, Refusal};
use trirrr_protocol::wire::checksum;

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Takes levels; none where the image reads none.
    #[inline(always)]
    pub(super) fn give_levels(&mut self, piece: Option<&LevelPiece>) -> Result<(), Refusal<N>> {
        match (piece, self.features.levels.get_mut()) {
            (Some(piece), Some(levels)) => levels.give(piece),
            _ => Err(Refusal::NoLevels),
        }
    }

    /// Takes a move with levels to be judged.
    #[inline(always)]
    pub(super) fn offer_listed(
        &mut self,
        listed: Option<&ListedMove<N>>,
    ) -> Result<(), Refusal<N>> {
        match listed.filter(|_| self.features.levels.get().is_some()) {
            Some(listed) => self.take_listed(listed),
            None => Err(Refusal::NoLevels),
        }
    }

    #[inline(never)]
    fn take_listed(&mut self, listed: &ListedMove<N>) -> Result<(), Refusal<N>> {
        let start = self.end_of_moves()?;
        if listed.number != self.status.next {
            return Err(Refusal::MoveNumber {
                expected: self.status.next,
            });
        }
        // A setpoint has a length that is known beforehand.
        let expected = checksum(&start).unwrap_or_default();
        if listed.check != expected {
            return Err(Refusal::Check { expected });
        }
        let each = listed.step.from(&start, listed.number);
        check_offer(&each, self.longest())?;
        let offered = Offered::<N, CurvesOf<S>>::of(&each).ok_or(Refusal::NoQuintics)?;
        let has_room = self.room() != 0;
        let levels = self.features.levels.get_mut().ok_or(Refusal::NoLevels)?;
        let list = levels.list(&offered, listed.levels)?;
        if !has_room || !self.desk.offered.add(offered) {
            return Err(Refusal::QueueFull);
        }
        levels.bind(list);
        self.count_offer();
        self.status.next = self.status.next.wrapping_add(1);
        self.status.end = Some(each.end());
        Ok(())
    }

    /// Levels that were given, and those that belong to moves, both of those that are not free.
    #[cfg(test)]
    pub(crate) fn levels_waiting(&self) -> Option<[u32; 2]> {
        self.features.levels.get().map(|levels| levels.held())
    }
}
