//! Power lists: levels of the tool's power at equal distances along a move.
//!
//! The background puts the levels that the host gives into a ring of bytes, and an entry for each listed move that is admitted
//! into a queue. The tick takes the entry when the move begins, looks up the level at the place where the tool is, and
//! gives the levels back when the move is over.

mod list;
mod player;
mod store;

pub(crate) use list::MoveLevels;
pub(crate) use player::LevelPlayer;
pub(crate) use store::LevelStore;

use crate::feature::ChannelMemory;
use crate::number::ServiceNumber;
use crate::offered::Offered;
use crate::queue::{Receiver, Sender};
use core::sync::atomic::{AtomicU8, AtomicU32};
use heapless::spsc::Queue;
use trirrr_core::number::WideArithmetic;
use trirrr_core::setpoint::Quintics;
use trirrr_protocol::message::{AnyMove, LISTED, LevelRange};

/// Ring of `BYTES` levels, a power of two, and entries of moves.
pub(crate) struct LevelRing<N: ServiceNumber, const BYTES: usize> {
    levels: [AtomicU8; BYTES],
    lists: Queue<MoveLevels<N>, { LISTED + 1 }>,
    /// Number of the first level that the tick may still need. By the tick.
    released: AtomicU32,
}

impl<N: ServiceNumber, const BYTES: usize> ChannelMemory for LevelRing<N, BYTES> {
    const EMPTY: Self = {
        assert!(BYTES.is_power_of_two() && BYTES <= 1 << 15, "BYTES");
        Self {
            levels: [const { AtomicU8::new(0) }; BYTES],
            lists: Queue::new(),
            released: AtomicU32::new(0),
        }
    };
}

impl<N: ServiceNumber, const BYTES: usize> LevelRing<N, BYTES> {
    /// Returns both ends, for ticks of `period` and at most `room` levels.
    pub(crate) fn split(
        &mut self,
        period: N::Factor,
        room: u16,
    ) -> (LevelStore<'_, N>, LevelPlayer<'_, N>) {
        let (put, take) = self.lists.split();
        let room = (BYTES as u16).min(room);
        let store = LevelStore::new(
            &self.levels,
            Sender::new(put),
            &self.released,
            (period, room),
        );
        let player = LevelPlayer::new(&self.levels, Receiver::new(take), &self.released);
        (store, player)
    }
}

/// Place of level `number` in the ring.
fn slot(levels: &[AtomicU8], number: u32) -> Option<&AtomicU8> {
    // The length is a power of two.
    levels.get(number as usize & (levels.len() - 1))
}

/// Returns true if a service takes `levels` for an offered move, as far as the move itself goes; for ticks of `period`.
pub fn check_levels<N: ServiceNumber>(
    offered: &AnyMove<N>,
    levels: LevelRange,
    period: N::Factor,
) -> bool {
    let known = Offered::<N, Quintics<false>>::of(offered);
    levels.is_whole()
        && known.is_some_and(|known| MoveLevels::new(&known, levels, period).is_some())
}

/// Full level, prepared for fractions of it.
fn full_count<N: WideArithmetic>() -> N::Count {
    N::count(u32::from(trirrr_protocol::message::FULL_LEVEL))
}
