//! Splices: a chain of moves takes the place of what is queued, from a tick within a move on.
//!
//! The background plans the chain from the state that the tick will play there, puts it into a queue of its own and orders
//! the cut. The tick accepts the order while the place is ahead; at the place it changes over to the chain as from one move
//! to the next. There are two such queues, taken in turn: what is left of the one before is dropped at once. Behind
//! the chain the common queue goes on, once what was cut is dropped from it, too.

use crate::feature::ChannelMemory;
use crate::handoff::{Ahead, QueuedMove};
use crate::number::ServiceNumber;
use crate::queue::{Receiver, Sender};
use core::sync::atomic::{AtomicU8, Ordering};
use heapless::spsc::Queue;
use trirrr_core::setpoint::CurveKind;

/// Most moves of a chain.
pub(crate) const CHAIN: usize = 13;

/// Number of no chain.
const WITHDRAWN: usize = 2;

/// Place within a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// Number of the move.
    pub(crate) number: u32,
    /// Whole ticks since its start.
    pub(crate) tick: u32,
}

/// Order to the tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SpliceOrder {
    /// To report where it is.
    Locate,
    /// To change over to a chain.
    Cut(CutOrder),
    /// To give the chain of the cut ahead back, and to wait for another: where the machine holds before the cut.
    Withdraw,
}

/// Order to change over to a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CutOrder {
    /// Place at which the chain begins: ahead, and behind the start of its move.
    pub(crate) at: Place,
    /// Number of the chain's first move.
    pub(crate) first: u32,
    /// Account of the chain.
    pub(crate) ahead: Ahead,
    /// Queue of the chain.
    pub(crate) chain: usize,
    /// Generation of what is cut.
    pub(crate) generation: u8,
}

/// State of splices, for the background.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SpliceReport {
    /// Orders taken so far, modulo 256.
    pub(crate) orders: u8,
    /// The last order to cut was in time, or the chain was given back.
    pub(crate) accepted: bool,
    /// Cuts done so far, modulo 256.
    pub(crate) cuts: u8,
    /// Whole ticks on the move under way.
    pub(crate) tick: u32,
}

/// The queues.
pub(crate) struct SpliceQueues<N: ServiceNumber, K: CurveKind> {
    chains: [Queue<QueuedMove<N, K>, { CHAIN + 1 }>; 2],
    orders: Queue<SpliceOrder, 2>,
    /// Generation of the account that the background shares.
    published: AtomicU8,
}

impl<N: ServiceNumber, K: CurveKind> ChannelMemory for SpliceQueues<N, K> {
    const EMPTY: Self = Self {
        chains: [Queue::new(), Queue::new()],
        orders: Queue::new(),
        published: AtomicU8::new(0),
    };
}

impl<N: ServiceNumber, K: CurveKind> SpliceQueues<N, K> {
    /// Returns both ends.
    pub(crate) fn split(&mut self) -> (SpliceSender<'_, N, K>, SplicePlayer<'_, N, K>) {
        let [first, second] = self.chains.each_mut().map(Queue::split);
        let (put, take) = self.orders.split();
        let sender = SpliceSender {
            chains: [Sender::new(first.0), Sender::new(second.0)],
            orders: Sender::new(put),
            published: &self.published,
        };
        let player = SplicePlayer {
            chains: [Receiver::new(first.1), Receiver::new(second.1)],
            orders: Receiver::new(take),
            published: &self.published,
            pending: None,
            playing: None,
            hides_queue: false,
            ahead: None,
            report: SpliceReport::default(),
        };
        (sender, player)
    }
}

/// End at which the background puts chains and orders in.
pub(crate) struct SpliceSender<'q, N: ServiceNumber, K: CurveKind> {
    pub(crate) chains: [Sender<'q, QueuedMove<N, K>>; 2],
    pub(crate) orders: Sender<'q, SpliceOrder>,
    published: &'q AtomicU8,
}

impl<N: ServiceNumber, K: CurveKind> SpliceSender<'_, N, K> {
    /// Says that the shared account is that of this generation; after the account itself.
    pub(crate) fn publish(&self, generation: u8) {
        self.published.store(generation, Ordering::Release);
    }
}

/// End at which the tick takes chains.
pub(crate) struct SplicePlayer<'q, N: ServiceNumber, K: CurveKind> {
    chains: [Receiver<'q, QueuedMove<N, K>>; 2],
    orders: Receiver<'q, SpliceOrder>,
    published: &'q AtomicU8,
    /// Cut that is ahead.
    pending: Option<CutOrder>,
    /// Chain that is played, or was last.
    playing: Option<usize>,
    /// The common queue has moves of before the cut.
    pub(crate) hides_queue: bool,
    /// Account of a chain until the background shares it.
    ahead: Option<Ahead>,
    report: SpliceReport,
}

impl<N: ServiceNumber, K: CurveKind> SplicePlayer<'_, N, K> {
    /// Report of a tick that is `tick` whole ticks on its move.
    #[inline]
    pub(crate) fn report(&self, tick: u32) -> SpliceReport {
        SpliceReport {
            tick,
            ..self.report
        }
    }

    /// Returns the next order.
    #[inline]
    pub(crate) fn take_order(&mut self) -> Option<SpliceOrder> {
        let order = self.orders.receive()?;
        self.report.orders = self.report.orders.wrapping_add(1);
        Some(order)
    }

    /// The cut that is ahead.
    #[inline]
    pub(crate) fn pending(&self) -> Option<&CutOrder> {
        self.pending.as_ref()
    }

    /// Returns true if the chain of the cut ahead was given back: the path stands until another takes its place.
    pub(crate) fn is_withdrawn(&self) -> bool {
        matches!(&self.pending, Some(cut) if cut.chain == WITHDRAWN)
    }

    /// Moves that wait in the chain that is played.
    pub(crate) fn len(&self) -> usize {
        let chain = self.playing.and_then(|playing| self.chains.get(playing));
        chain.map_or(0, Receiver::len)
    }

    /// Takes an order to cut, or drops its chain.
    pub(crate) fn accept(&mut self, cut: CutOrder, accepted: bool) {
        self.report.accepted = accepted;
        match accepted {
            true => self.pending = Some(cut),
            false => self.drop_chain(cut.chain),
        }
    }

    /// Gives the chain of the cut ahead back, if `stands` and there is one.
    pub(crate) fn withdraw(&mut self, stands: bool) {
        let chain = match &mut self.pending {
            Some(cut) if stands => core::mem::replace(&mut cut.chain, WITHDRAWN),
            _ => WITHDRAWN,
        };
        self.report.accepted = chain != WITHDRAWN;
        self.drop_chain(chain);
    }

    /// Drops the moves of a chain at once: the background fills its queue as soon as it knows.
    #[inline(never)]
    fn drop_chain(&mut self, chain: usize) {
        if let Some(chain) = self.chains.get_mut(chain) {
            // At most a chain: the background sends no other before it knows. A loop over a known number would be unrolled.
            while chain.receive().is_some() {}
        }
    }

    /// Tick of move `number`, or that of the cut where it comes first.
    #[inline]
    pub(crate) fn clip(&self, number: u32, tick: u32) -> u32 {
        match &self.pending {
            Some(cut) if cut.at.number == number => tick.min(cut.at.tick),
            _ => tick,
        }
    }

    /// Returns true if move `number` is cut.
    #[inline]
    pub(crate) fn cuts(&self, number: u32) -> bool {
        matches!(&self.pending, Some(cut) if cut.at.number == number)
    }

    /// The cut: from now on the chain is played. Returns the place.
    pub(crate) fn cut(&mut self) -> Option<Place> {
        let cut = self.pending.take()?;
        if let Some(before) = self.playing.replace(cut.chain) {
            self.drop_chain(before);
        }
        self.hides_queue = true;
        self.ahead = Some(cut.ahead);
        self.report.cuts = self.report.cuts.wrapping_add(1);
        Some(cut.at)
    }

    /// The chain's move that follows move `number`; none where the common queue goes on.
    #[inline]
    pub(crate) fn peek(&self, number: u32) -> Option<&QueuedMove<N, K>> {
        let chain = match &self.pending {
            Some(cut) if cut.at.number == number => Some(cut.chain),
            _ => self.playing,
        };
        self.chains.get(chain?)?.peek()
    }

    /// The same, of the chain that is played, taken out.
    #[inline]
    pub(crate) fn receive(&mut self) -> Option<QueuedMove<N, K>> {
        self.chains.get_mut(self.playing?)?.receive()
    }

    /// Account of the chain, unless the background shares it by now.
    #[inline]
    pub(crate) fn ahead(&self, generation: u8) -> Option<Ahead> {
        match &self.pending {
            Some(cut) => Some(cut.ahead),
            None if self.published.load(Ordering::Acquire) == generation => None,
            None => self.ahead,
        }
    }

    /// All that is queued is dropped.
    pub(crate) fn drop_queue(&mut self) {
        self.pending = None;
        self.playing = None;
        self.ahead = None;
        (0..self.chains.len()).for_each(|chain| self.drop_chain(chain));
    }
}
