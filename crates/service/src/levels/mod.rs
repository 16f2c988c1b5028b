//! Power lists: levels of the tool's power at equal distances along a move.
//!
//! The background puts the levels that the host gives into a ring of bytes, and an entry for each listed move that is admitted
//! into a queue. The tick takes the entry when the move begins, looks up the level at the place where the tool is, and
//! gives the levels back when the move is over.
//!
//! The choice is a type: without power lists a scene has neither ring nor queue, nor code for them.

mod list;
mod player;
mod store;

pub(crate) use list::MoveLevels;
pub use player::LevelPlayer;
pub use store::LevelStore;

use crate::number::ServiceNumber;
use crate::offered::Offered;
use crate::queue::{Receiver, Sender};
use crate::scene::Scene;
use crate::splice::{Optional, Present};
use core::sync::atomic::{AtomicU8, AtomicU32};
use heapless::spsc::Queue;
use trirrr_core::number::WideArithmetic;
use trirrr_core::setpoint::Quintics;
use trirrr_protocol::message::{
    AnyMove, Content, LISTED, LevelPiece, LevelRange, ListedContent, ListedMove, Unread,
};

/// Memory of power lists; `()` for a machine that plays none.
pub trait LevelKind<N: ServiceNumber>: Send + 'static {
    /// Nothing in it.
    const EMPTY: Self;

    /// Type as which a listed move in a request is read.
    type Request: Content<ListedMove<N>> + ListedContent<Levels: Content<LevelPiece>>;
    /// End of the background.
    type Background<'q>: Optional<LevelStore<'q, N>>;
    /// End of the tick.
    type Tick<'q>: Optional<LevelPlayer<'q, N>>;

    /// Returns both ends, for ticks of `period` and at most `room` levels.
    fn split(&mut self, period: N::Factor, room: u16) -> (Self::Background<'_>, Self::Tick<'_>);
}

impl<N: ServiceNumber> LevelKind<N> for () {
    const EMPTY: Self = ();
    type Request = Unread<ListedMove<N>>;
    type Background<'q> = ();
    type Tick<'q> = ();

    #[inline(always)]
    fn split(&mut self, _: N::Factor, _: u16) -> ((), ()) {
        ((), ())
    }
}

/// Ring of `BYTES` levels, a power of two, and entries of moves.
pub struct LevelRing<N: ServiceNumber, const BYTES: usize> {
    levels: [AtomicU8; BYTES],
    lists: Queue<MoveLevels<N>, { LISTED + 1 }>,
    /// Number of the first level that the tick may still need. By the tick.
    released: AtomicU32,
}

impl<N: ServiceNumber, const BYTES: usize> LevelKind<N> for LevelRing<N, BYTES>
where
    MoveLevels<N>: Send,
    N: Send + 'static,
{
    const EMPTY: Self = {
        assert!(BYTES.is_power_of_two() && BYTES <= 1 << 15, "BYTES");
        Self {
            levels: [const { AtomicU8::new(0) }; BYTES],
            lists: Queue::new(),
            released: AtomicU32::new(0),
        }
    };
    type Request = ListedMove<N>;
    type Background<'q> = Present<LevelStore<'q, N>>;
    type Tick<'q> = Present<LevelPlayer<'q, N>>;

    fn split(
        &mut self,
        period: N::Factor,
        room: u16,
    ) -> (Present<LevelStore<'_, N>>, Present<LevelPlayer<'_, N>>) {
        let (put, take) = self.lists.split();
        let room = (BYTES as u16).min(room);
        let store = LevelStore::new(
            &self.levels,
            Sender::new(put),
            &self.released,
            (period, room),
        );
        let player = LevelPlayer::new(&self.levels, Receiver::new(take), &self.released);
        (Present(store), Present(player))
    }
}

/// The background's end of the power lists of the scene `S`.
pub(crate) type BackgroundLevels<'q, S> =
    <<S as Scene>::Levels as LevelKind<<S as Scene>::N>>::Background<'q>;

/// The tick's end.
pub(crate) type TickLevels<'q, S> = <<S as Scene>::Levels as LevelKind<<S as Scene>::N>>::Tick<'q>;

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
