//! The two halves of a service in two threads, as on a board: one ticks and never waits, the other talks
//! and admits moves.
//!
//! Run with `cargo run -p trirrr-service --example service_two_threads`.

use std::error::Error;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Command, Move, Reply, State};
use trirrr_service::{Adjustable, Channels, Settings};

/// Tick rate, Hz.
const RATE_HZ: f64 = 500.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut channels = Channels::<Adjustable<Dynamic<f64>>, 16, 64>::new();
    let scene = Adjustable::new(example(), LimitParameters::default());
    let start = Pose::from_f64(0.21, 0.22, 0.157);
    // The queues in `channels` join the halves: neither half locks, waits or allocates.
    let (mut foreground, mut background) = channels.split(scene, start, Settings::at(RATE_HZ))?;
    let over = AtomicBool::new(false);

    thread::scope(|scope| {
        // On a board: the interrupt of a timer.
        scope.spawn(|| {
            let period = Duration::from_secs_f64(1.0 / RATE_HZ);
            let mut due = Instant::now();
            while !over.load(Ordering::Relaxed) {
                thread::sleep(due.saturating_duration_since(Instant::now()));
                // Hand the output to the drives here.
                foreground.tick();
                due += period;
            }
        });

        // On a board: the idle loop, which also moves the bytes of the line.
        assert_eq!(background.submit(&Command::Enable), Reply::Done);
        while background.status().state != State::Idle {
            thread::sleep(Duration::from_millis(1));
        }
        let there = Pose::from_f64(0.28, 0.28, 0.209);
        let offered = Move::rest_to_rest(0, start, there, 250);
        let reply = background.submit(&Command::Move(offered));
        assert_eq!(reply, Reply::Done);
        while background.step() {}
        assert_eq!(background.submit(&Command::Start), Reply::Done);
        loop {
            background.step();
            let status = background.status();
            if status.state == State::Idle && status.done == 1 {
                println!("the move is over after {} ticks", status.tick);
                break;
            }
            thread::sleep(Duration::from_millis(1));
        }
        over.store(true, Ordering::Relaxed);
    });
    Ok(())
}
