//! All that both halves share, each part alone in two threads. Miri runs these tests as if the threads had a core each
//! (`cargo xtask nightly`): a part that is read before it is written, or in the wrong order, is found there.

use super::*;
use crate::feature::ChannelMemory;
use crate::handoff::{Ahead, QueuedMove, SharedCounters};
use crate::levels::LevelRing;
use crate::offered::Offered;
use crate::pace::{MovePaces, Room};
use crate::queue::{Receiver, Sender};
use crate::splice::{CutOrder, Place, SpliceOrder, SplicePlayer, SpliceQueues, SpliceSender};
use heapless::spsc::Queue;
use std::thread;
use trirrr_core::number::WideArithmetic;
use trirrr_core::setpoint::{Quintics, Segment, Setpoint};
use trirrr_protocol::message::{LEVEL_PARTS, LevelPiece, LevelRange};

/// Items that go from one thread to the other.
const ITEMS: u32 = if cfg!(miri) { 100 } else { 1000 };

type Curves = Quintics<false>;

/// Calls `each` with the numbers up to `ITEMS`, once it takes them.
fn with_numbers(mut each: impl FnMut(u32) -> bool) {
    for number in 0..ITEMS {
        while !each(number) {
            thread::yield_now();
        }
    }
}

/// Runs both in threads of their own.
fn at_once(one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
    thread::scope(|scope| {
        scope.spawn(one);
        scope.spawn(other);
    });
}

#[test]
fn a_queue_hands_over_whole_items_in_their_order() {
    let mut queue = Queue::<[u32; 5], 4>::new();
    let (put, take) = queue.split();
    let (mut put, mut take) = (Sender::new(put), Receiver::new(take));
    at_once(
        || {
            with_numbers(|number| {
                put.len() <= put.capacity() && put.has_room() && put.send([number; 5])
            })
        },
        || {
            with_numbers(|number| {
                let Some(item) = take.peek() else {
                    return false;
                };
                assert_eq!(*item, [number; 5]);
                assert!(take.len() <= take.capacity());
                match number % 2 {
                    0 => assert_eq!(take.receive(), Some([number; 5])),
                    _ => take.discard(),
                }
                true
            });
        },
    );
}

#[test]
fn a_mailbox_hands_over_whole_items() {
    let mut slot = Queue::<[u32; 9], 2>::new();
    let (put, take) = slot.split();
    let (mut put, mut take) = (Sender::new(put), Receiver::new(take));
    at_once(
        || with_numbers(|number| put.send([number; 9])),
        || {
            with_numbers(|number| {
                let item = take.receive();
                assert!(item.is_none_or(|item| item == [number; 9]));
                item.is_some()
            });
        },
    );
}

/// Whoever sees the room of a move sees the move, at whichever of the words.
#[test]
fn an_account_counts_what_is_in_the_queue() {
    let shared = SharedCounters::new();
    let mut queue = Queue::<u32, 4>::new();
    let (put, take) = queue.split();
    let (mut put, mut take) = (Sender::new(put), Receiver::new(take));
    at_once(
        || {
            with_numbers(|number| {
                let sent = put.send(number);
                if sent {
                    let room = Room([number + 1; 2]);
                    shared.set_ahead(Ahead {
                        room,
                        rests: number + 1,
                    });
                    crate::handoff::count(&shared.heard);
                }
                sent
            });
        },
        || {
            let mut received = 0;
            while received < ITEMS {
                let Ahead { room, rests } = shared.ahead();
                let [any, half] = room.0;
                for counted in [any, half, rests] {
                    while received < counted {
                        assert_eq!(take.receive(), Some(received));
                        received += 1;
                    }
                }
                thread::yield_now();
            }
        },
    );
    assert_eq!(shared.heard.into_inner(), ITEMS);
}

fn queued(number: u32, generation: u8) -> QueuedMove<f64, Curves> {
    let offered = Offered::<f64, Curves>::cubic(&rest(number, home(), pose(0.22, 0.23, 0.16), 10));
    QueuedMove {
        segment: Segment::new(
            &offered.ends(),
            10,
            <f64 as WideArithmetic>::factor_from_f64(PERIOD_S),
        ),
        ticks: 10,
        number,
        tool: None,
        paces: MovePaces::FULL,
        generation,
    }
}

/// Cuts, one after the other: two moves a chain, the second of which is cut. Every third chain is given back, and another takes its place.
#[test]
fn chains_are_played_from_their_cut_on() {
    let mut queues = SpliceQueues::<f64, Curves>::EMPTY;
    let (mut put, mut play) = queues.split();
    let shared = SharedCounters::new();
    let mut done = Queue::<u32, 2>::new();
    let (told, hear) = done.split();
    let (mut told, mut hear) = (Sender::new(told), Receiver::new(hear));
    let cuts = ITEMS / 4;
    at_once(
        || {
            let (mut chain, mut first) = (0, 1);
            let send =
                |put: &mut SpliceSender<'_, f64, Curves>, chain: usize, first: u32, at: u32| {
                    while put.chains[chain].len() != 0 {
                        thread::yield_now();
                    }
                    for number in [first, first + 1] {
                        assert!(put.chains[chain].send(queued(number, 0)));
                    }
                    let ahead = Ahead {
                        room: Room([first; 2]),
                        rests: first,
                    };
                    let order = SpliceOrder::Cut(CutOrder {
                        at: Place {
                            number: at,
                            tick: 3,
                        },
                        first,
                        ahead,
                        chain,
                        generation: 0,
                    });
                    while !put.orders.send(order) {
                        thread::yield_now();
                    }
                };
            let mut at = 0;
            for cut in 0..cuts {
                send(&mut put, chain, first, at);
                if cut % 3 == 2 {
                    while !put.orders.send(SpliceOrder::Withdraw) {
                        thread::yield_now();
                    }
                    first += 2;
                    send(&mut put, chain, first, at);
                }
                while hear.receive() != Some(first) {
                    thread::yield_now();
                }
                shared.set_ahead(Ahead {
                    room: Room([first + 1; 2]),
                    rests: first + 1,
                });
                put.publish((cut + 1) as u8);
                (at, first, chain) = (first + 1, first + 2, 1 - chain);
            }
        },
        || {
            let mut number = 0;
            for cut in 0..cuts {
                take_cut(&mut play, number, cut % 3 == 2);
                assert!(play.cuts(number));
                let first = play.peek(number).expect("a chain").number;
                assert_eq!(play.cut(), Some(Place { number, tick: 3 }));
                let own = play.ahead((cut + 1) as u8).expect("not shared yet");
                assert_eq!((own.room, own.rests), (Room([first; 2]), first));
                for expected in [first, first + 1] {
                    assert_eq!(play.receive(), Some(queued(expected, 0)));
                }
                number = first + 1;
                while !told.send(first) {
                    thread::yield_now();
                }
                while play.ahead((cut + 1) as u8).is_some() {
                    thread::yield_now();
                }
                assert_eq!(shared.ahead().rests, number);
            }
        },
    );
}

/// Takes the order to cut move `number`; of a chain that is given back the order behind it.
fn take_cut(play: &mut SplicePlayer<'_, f64, Curves>, number: u32, again: bool) {
    let mut withdrawn = !again;
    while !withdrawn || play.pending().is_none() || play.is_withdrawn() {
        match play.take_order() {
            Some(SpliceOrder::Cut(cut)) => {
                assert_eq!(cut.at.number, number);
                play.accept(cut, true);
            }
            Some(SpliceOrder::Withdraw) => {
                withdrawn = true;
                play.withdraw(true);
            }
            _ => thread::yield_now(),
        }
    }
}

/// Levels are those of their move, and their places are free when it is over.
#[test]
fn levels_are_read_before_they_are_overwritten() {
    let mut ring = LevelRing::<f64, 16>::EMPTY;
    let (mut store, mut player) = ring.split(PERIOD_S, 16);
    at_once(
        || {
            with_numbers(|number| {
                let piece = LevelPiece::new(6 * number, &[number as u8; 6]);
                if store.give(&piece).is_err() {
                    return false;
                }
                let range = LevelRange {
                    first: 6 * number,
                    count: 6,
                    offset: 0,
                    span: 6 * LEVEL_PARTS,
                };
                let offered = Offered::<f64, Curves>::cubic(&rest(
                    number,
                    home(),
                    pose(0.22, 0.22, 0.157),
                    10,
                ));
                let list = store.list(&offered, range).expect("room for a list");
                store.bind(list);
                store.admit(number, 0);
                true
            });
        },
        || {
            let at = |x: f64| Setpoint {
                pose: pose(x, 0.22, 0.157),
                velocity: [0.0; 3].into(),
                acceleration: [0.0; 3].into(),
            };
            with_numbers(|number| {
                player.begin(number, 0);
                if !player.has_levels() {
                    return false;
                }
                for x in [0.2101, 0.215, 0.2199] {
                    let part = player.part_of(1.0, &at(x));
                    assert!((part * 255.0 - f64::from(number as u8)).abs() < 1e-6);
                }
                player.end();
                true
            });
        },
    );
}
