//! A whole service in one thread: a move is offered, admitted and played, held and resumed on the way.
//!
//! Run with `cargo run -p trirrr-service --example service_one_thread`.

use std::error::Error;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Command, Message, Move, Reply, State};
use trirrr_service::{Adjustable, Channels, Settings};

fn main() -> Result<(), Box<dyn Error>> {
    // Room for 15 moves and 63 telemetry samples. `Adjustable` can change at run time; an image on a
    // board takes `Compiled`.
    let mut channels = Channels::<Adjustable<Dynamic<f64>>, 16, 64>::new();
    let scene = Adjustable::new(example(), LimitParameters::default());
    let start = Pose::from_f64(0.21, 0.22, 0.157);
    let mut service = channels.service(scene, start, Settings::at(100.0))?;

    // The drives go on here, and hold the machine where it is.
    assert_eq!(service.submit(&Command::Enable), Reply::Done);
    service.tick();

    let there = Pose::from_f64(0.28, 0.28, 0.209);
    for command in [
        Command::telemetry(25),
        Command::Move(Move::rest_to_rest(0, start, there, 100)),
    ] {
        let reply = service.submit(&command);
        assert_eq!(reply, Reply::Done, "{command:?}");
    }
    // The admission judges the move here, below the tick.
    while service.step() {}
    assert_eq!(service.submit(&Command::Start), Reply::Done);

    for tick in 0..400 {
        // Hand the output to the drives here.
        let output = service.tick();
        assert!(output.is_on());
        match tick {
            // A hold comes to rest on the path, a resume goes on from there.
            30 => drop(service.submit(&Command::Hold)),
            60 => drop(service.submit(&Command::Resume)),
            _ => {}
        }
        while service.step() {}
        while let Some(message) = service.outgoing() {
            match message {
                Message::Telemetry(sample) => {
                    let at = sample.setpoint.pose.position;
                    println!("tick {:3}: x {:.4} m, y {:.4} m", sample.tick, at.x, at.y);
                }
                Message::Event(event) => println!("tick {tick:3}: {event:?}"),
                Message::Drives(_) | Message::Reply { .. } => {
                    unreachable!("submit returns its reply, and the scene has no feedback")
                }
            }
        }
        if tick > 0 && service.state() == State::Idle {
            println!("at rest after {tick} ticks");
            break;
        }
    }
    Ok(())
}
