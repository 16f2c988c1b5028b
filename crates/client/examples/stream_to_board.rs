//! Streams the job of a scene to a board, or to `trirrr device` in another terminal.
//!
//! ```sh
//! cargo run --release -- device scenes/thesis.toml
//! cargo run -p trirrr-client --example stream_to_board -- scenes/thesis.toml tcp:127.0.0.1:7333
//! ```
//! A board is `/dev/ttyUSB0` in place of the TCP address.

use std::env;
use std::error::Error;
use std::time::{Duration, Instant};
use trirrr_client::{Action, JobClient, Patience, local};
use trirrr_line::{Address, Frames};
use trirrr_protocol::message::Message;
use trirrr_scene::{Scene, offer};

/// Bits per second of a serial port.
const BAUD: u32 = 921_600;

fn main() -> Result<(), Box<dyn Error>> {
    let [file, port] = [1, 2].map(|index| env::args().nth(index));
    let (file, port) = file.zip(port).ok_or("call: stream_to_board SCENE PORT")?;
    let scene = Scene::read(file)?;
    // The number type is that of the scene's image; `f64` is what `trirrr device` takes by default.
    let units = trirrr_scene::units::<f64>(&scene)?;
    let moves = offer::moves::<f64>(&scene, &units);
    let hello = local::hello::<f64>(&scene);

    let address: Address = port.parse()?;
    let mut link = trirrr_line::open(&address, BAUD)?;
    let mut frames = Frames::default();
    // One telemetry sample every 10 ticks; the number tells this conversation from an earlier one.
    let conversation = std::process::id();
    let mut client = JobClient::new(moves, hello, 10, Patience::default(), conversation);
    let start = Instant::now();
    let mut buffer = [0; 4096];
    loop {
        // The client says what to send and how long to listen. It never blocks and has no clock.
        let listen = match client.poll(start.elapsed()) {
            Action::Send(request) => {
                let mut bytes = Vec::new();
                Frames::append(&request, &mut bytes);
                link.send(&bytes)?;
                Duration::ZERO
            }
            Action::Wait(until) => until.saturating_sub(start.elapsed()),
            Action::Lost => return Err("the board is silent".into()),
            Action::Finished(Ok(())) => break,
            Action::Finished(Err(failure)) => return Err(client.describe(&failure).into()),
        };
        let length = link.receive(&mut buffer, listen)?;
        frames.receive(&buffer[..length], |message: Message<f64>| {
            if let Message::Telemetry(sample) = &message {
                let at = sample.setpoint.pose.position;
                println!("tick {}: x {:.4}, y {:.4}", sample.tick, at.x, at.y);
            }
            client.receive(&message, start.elapsed());
        });
    }
    println!("{} moves done", client.done());
    Ok(())
}
