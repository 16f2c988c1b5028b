//! The two halves in two threads.

use super::path::{chain, expected};
use super::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use trirrr_protocol::message::MessageRef;

/// One thread ticks as fast as it can, the other talks: nothing is shared but the queues. The
/// chain comes out in its own bits wherever the machine did not wait for the talker.
#[test]
fn the_halves_need_nothing_but_their_queues() {
    let mut channels = Box::new(Channels::<Thesis<f64>, 8, 4096>::new());
    let scene = Adjustable::new(example(), LimitParameters::default());
    let settings = Settings {
        // The talker may be put aside for longer than any number of ticks.
        host_timeout_ticks: 0,
        ..settings()
    };
    let (mut foreground, mut background) = channels.split(scene, home(), settings).unwrap();
    let (moves, expected) = (chain::<f64>(), expected::<f64>());
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                foreground.tick();
                thread::yield_now();
            }
        });
        let mut sequence = 0;
        let mut ask = |command, background: &mut Background<Thesis<f64>>| {
            let reply = hear(background, sequence, command);
            sequence += 1;
            reply
        };
        let hello = Hello {
            protocol: PROTOCOL,
            schema: SCHEMA,
            scene: 0,
        };
        hear(&mut background, 0, Command::Hello(hello));
        background.next_sequence_is(0);
        assert_eq!(ask(Command::Enable, &mut background), Reply::Done);
        while background.status().state != State::Idle {
            thread::yield_now();
        }
        for each in &moves {
            assert_eq!(ask(Command::Move(*each), &mut background), Reply::Done);
        }
        while background.step() {}
        assert_eq!(ask(Command::Start, &mut background), Reply::Done);
        let mut samples = Vec::new();
        loop {
            while background.send_next(|message| {
                if let MessageRef::Telemetry(sample) = message {
                    samples.push(**sample);
                }
            }) {}
            let status = background.status();
            if status.done == 6 && status.state == State::Idle {
                break;
            }
            assert_eq!(status.fault, None);
            thread::yield_now();
        }
        over.store(true, Ordering::Relaxed);
        // Samples may be lost while this thread is put aside, but not changed.
        let running = samples
            .iter()
            .filter(|sample| sample.state == State::Running);
        let mut compared = 0;
        for sample in running {
            let before: u32 = moves[..sample.number as usize]
                .iter()
                .map(|each| each.ticks)
                .sum();
            let setpoint = &expected[(before + sample.at) as usize];
            assert_eq!(sample.setpoint, *setpoint);
            compared += 1;
        }
        let lost = background.status().lost;
        assert!(compared + lost >= 189, "{compared} and {lost}");
    });
}
