//! Requests in flight: those that came before one that is missing, and the answers that a host may ask for again.

use crate::scene::{RequestOf, Scene};
use heapless::{Deque, Vec};
use trirrr_core::number::Number;
use trirrr_protocol::message::{Refusal, WINDOW};

/// The last requests that were executed, and those that wait for one before them.
///
/// Requests are executed in the order of their numbers, each once. A request with a number up to [`WINDOW`] ahead is kept;
/// one with a number up to [`WINDOW`] behind is answered again.
pub(crate) struct RequestWindow<S: Scene> {
    /// Number of the request to execute next.
    next: u32,
    /// From which the numbers of the next conversation are drawn.
    noise: u32,
    /// Number of the hello that began the conversation.
    hello: Option<u32>,
    /// The last of the requests before it, in their order.
    executed: Deque<Executed<S::N>, WINDOW>,
    kept: Vec<Kept<S>, WINDOW>,
}

/// A request that was executed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Executed<N: Number> {
    /// Checksum that tells it from another with its number.
    checksum: u32,
    /// Reason why nothing was done, if nothing was.
    refusal: Option<Refusal<N>>,
}

/// A request that waits, with its checksum.
struct Kept<S: Scene> {
    request: RequestOf<S>,
    checksum: u32,
}

/// RequestPlace of a request among those in flight.
pub(super) enum RequestPlace<N: Number> {
    /// To be executed now.
    Next,
    /// Executed already, with this result.
    Executed(Result<(), Refusal<N>>),
    /// To be executed behind one that is missing.
    Ahead,
    /// Another request has this number.
    Reused,
    /// Too far ahead, or too far behind.
    Outside,
}

/// Mixes the bits of a number: each of them changes half of the others. It is the end of MurmurHash3, with a number added so that
/// zeros do not stay zeros.
fn mixed(noise: u32) -> u32 {
    let mut bits = noise.wrapping_add(0x9e37_79b9);
    bits = (bits ^ (bits >> 16)).wrapping_mul(0x85eb_ca6b);
    bits = (bits ^ (bits >> 13)).wrapping_mul(0xc2b2_ae35);
    bits ^ (bits >> 16)
}

impl<S: Scene> RequestWindow<S> {
    /// A window that waits for request 0.
    // Memory that starts as zeros takes no flash.
    pub(crate) const EMPTY: Self = Self {
        next: 0,
        noise: 0,
        hello: None,
        executed: Deque::new(),
        kept: Vec::new(),
    };

    /// Number of the request to execute next.
    pub(super) fn next(&self) -> u32 {
        self.next
    }

    #[cfg(test)]
    pub(super) fn next_is(&mut self, sequence: u32) {
        self.next = sequence;
    }

    /// Makes the numbers to be drawn depend on `noise`, too.
    pub(super) fn stir(&mut self, noise: u32) {
        self.noise = mixed(self.noise ^ noise);
    }

    /// Another conversation begins with the hello of this number: what is kept is dropped. Its first number is drawn among all.
    /// So what comes late from the conversation before, and who asks without having heard the answer to a hello, is
    /// out of the window. A hello that is repeated begins none.
    pub(super) fn begin(&mut self, hello: u32) {
        self.kept.clear();
        if self.hello != Some(hello) {
            self.stir(hello);
            self.next = self.noise;
            self.executed.clear();
        }
        self.hello = Some(hello);
    }

    /// Finds the place of request `sequence`.
    pub(super) fn place(&self, sequence: u32, checksum: u32) -> RequestPlace<S::N> {
        let ahead = sequence.wrapping_sub(self.next);
        if ahead == 0 {
            return RequestPlace::Next;
        }
        if (ahead as usize) < WINDOW {
            let mut same = self
                .kept
                .iter()
                .filter(|kept| kept.request.sequence == sequence);
            return match same.any(|kept| kept.checksum != checksum) {
                true => RequestPlace::Reused,
                false => RequestPlace::Ahead,
            };
        }
        let behind = self.next.wrapping_sub(sequence) as usize;
        let index = self.executed.len().checked_sub(behind);
        match index.and_then(|index| self.executed.get(index)) {
            Some(executed) if executed.checksum != checksum => RequestPlace::Reused,
            Some(executed) => RequestPlace::Executed(executed.refusal.map_or(Ok(()), Err)),
            None => RequestPlace::Outside,
        }
    }

    /// Keeps a request until those before it are executed.
    pub(super) fn keep(&mut self, request: &RequestOf<S>, checksum: u32) {
        let kept = Kept {
            request: *request,
            checksum,
        };
        let (next, sequence) = (self.next, request.sequence);
        let is_ahead = |number: u32| (number.wrapping_sub(next) as usize) < WINDOW;
        // One that came a second time may be kept, or executed, already.
        let is_spent = |kept: &&mut Kept<S>| {
            let number = kept.request.sequence;
            number == sequence || !is_ahead(number)
        };
        match self.kept.iter_mut().find(is_spent) {
            Some(spent) => *spent = kept,
            // There is room for all that are ahead.
            None => _ = self.kept.push(kept),
        }
    }

    /// Takes the request to execute next out of those that are kept, with its checksum.
    pub(super) fn take_kept(&mut self) -> Option<(RequestOf<S>, u32)> {
        let is_next = |kept: &Kept<S>| kept.request.sequence == self.next;
        let index = self.kept.iter().position(is_next)?;
        let last = self.kept.pop()?;
        let Kept { request, checksum } = match self.kept.get_mut(index) {
            Some(next) => core::mem::replace(next, last),
            None => last,
        };
        Some((request, checksum))
    }

    /// Counts the next request as executed.
    pub(super) fn count(&mut self, checksum: u32, result: Result<(), Refusal<S::N>>) {
        if self.executed.is_full() {
            self.executed.pop_front();
        }
        let refusal = result.err();
        // There is room.
        let _ = self.executed.push_back(Executed { checksum, refusal });
        self.next = self.next.wrapping_add(1);
    }
}
