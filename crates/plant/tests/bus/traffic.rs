//! The fullest bus: what an interrupt with a queue of a tick hears, and what a poll of three places would.

use crate::bench::{Bench, TICK_RATE_HZ, odrive};
use embedded_can::{Frame, Id, StandardId};
use std::collections::VecDeque;
use trirrr_drives::can::{ClassicFrame, Odrive, frames_per_tick};
use trirrr_plant::bus::BusFrame;

/// Drives that send six messages each as fast as the bus carries them, heartbeats between them, and what reaches the
/// tick.
struct Flood {
    /// Places of the controller.
    places: VecDeque<ClassicFrame>,
    /// Queue of the interrupt.
    queue: VecDeque<ClassicFrame>,
    heartbeats: [u32; 3],
    heard: [u32; 3],
}

impl Flood {
    fn run(bit_rate_hz: u32, tick_rate_hz: f64, by_interrupt: bool) -> Self {
        let room = usize::from(frames_per_tick(bit_rate_hz, tick_rate_hz));
        let mut flood = Self {
            places: VecDeque::new(),
            queue: VecDeque::new(),
            heartbeats: [0; 3],
            heard: [0; 3],
        };
        let tick_ns = (1e9 / tick_rate_hz) as u64;
        let (mut now_ns, mut next_tick_ns, mut number) = (0, tick_ns, 0_u32);
        while now_ns < 3_000_000_000 {
            let (node, command) = (
                number / 7 % 3,
                [1, 9, 3, 0x14, 0x15, 0x17, 0x1C][number as usize % 7],
            );
            // Bytes that stuff nothing: the shortest frames.
            let id = StandardId::new(((node + 1) << 5 | command) as u16).unwrap();
            let data = [0x55; 8];
            let frame = BusFrame::<8>::new(id, &data).unwrap();
            now_ns += frame.duration_ns(bit_rate_hz);
            number += 1;
            // The tick takes everything that came before it.
            while next_tick_ns <= now_ns {
                flood.tick(room, by_interrupt);
                next_tick_ns += tick_ns;
            }
            if command == 1 {
                flood.heartbeats[node as usize] += 1;
            }
            // A fourth frame takes the place of the third.
            if flood.places.len() == 3 {
                flood.places.pop_back();
            }
            flood
                .places
                .push_back(ClassicFrame::new(id, &data).unwrap());
            if by_interrupt {
                let frame = flood.places.pop_front().unwrap();
                assert!(flood.queue.len() < room, "the queue is full");
                flood.queue.push_back(frame);
            }
        }
        flood.tick(room, by_interrupt);
        flood
    }

    fn tick(&mut self, room: usize, by_interrupt: bool) {
        let (from, most) = match by_interrupt {
            true => (&mut self.queue, room),
            false => (&mut self.places, 3),
        };
        for _ in 0..most {
            let Some(frame) = from.pop_front() else {
                return;
            };
            if let Id::Standard(id) = frame.id()
                && id.as_raw() & 0x1F == 1
            {
                self.heard[usize::from(id.as_raw() >> 5) - 1] += 1;
            }
        }
    }
}

#[test]
fn no_heartbeat_is_lost_on_the_fullest_bus() {
    for bit_rate_hz in [125_000, 250_000, 500_000, 1_000_000] {
        for tick_rate_hz in [10.0, 100.0, 250.0, 500.0, 1000.0] {
            let flood = Flood::run(bit_rate_hz, tick_rate_hz, true);
            assert_eq!(
                flood.heard, flood.heartbeats,
                "{bit_rate_hz} {tick_rate_hz}"
            );
            assert!(flood.heartbeats.iter().all(|number| *number > 100));
        }
    }
    // What a poll of the three places would hear at 250 ticks per second.
    let polled = Flood::run(500_000, 250.0, false);
    let [heard, sent] = [polled.heard, polled.heartbeats].map(|all| all.iter().sum::<u32>());
    println!("polled: {heard} of {sent} heartbeats");
    assert!(2 * heard < sent);
}

/// The load that a scene is refused for is what the bus takes: commands and messages of the drives, 135 bits each at
/// the most.
#[test]
fn the_bus_takes_no_more_than_the_build_counts() {
    let mut bench = Bench::new(Odrive, odrive);
    bench.enable(200).unwrap();
    bench.watch(1000).unwrap();
    let counted = 3.0 * (TICK_RATE_HZ + crate::bench::ODRIVE_HZ) * 135.0 / 1e6;
    let load = bench.medium().load();
    println!("{load:.3} of the bus, counted {counted:.3}");
    assert!(load < counted && load > 0.8 * counted, "{load} {counted}");
}
