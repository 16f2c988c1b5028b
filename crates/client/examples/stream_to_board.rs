//! Streams the job of a scene to a board, or to `trirrr device` in another terminal.
//!
//! ```sh
//! cargo run --release -- device scenes/thesis.toml
//! cargo run -p trirrr-client --example stream_to_board -- scenes/thesis.toml tcp:127.0.0.1:7333
//! ```
//! A board is `/dev/ttyUSB0` in place of the TCP address.

use std::env;
use std::error::Error;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use trirrr_client::{Dialogue, JobClient, JobFailure, Patience, Turn, drive, local};
use trirrr_line::{Port, Retry};
use trirrr_protocol::message::Message;
use trirrr_scene::{Scene, offer};

/// Bits per second of a serial port.
const BAUD: u32 = 921_600;

/// Time without the board after which the job is given up.
const PATIENCE: Duration = Duration::from_secs(10);

fn main() -> Result<(), Box<dyn Error>> {
    let [file, port] = [1, 2].map(|index| env::args().nth(index));
    let (file, port) = file.zip(port).ok_or("call: stream_to_board SCENE PORT")?;
    let scene = Scene::read(file)?;
    // The number type is that of the scene's image; `f64` is what `trirrr device` takes by default.
    let units = trirrr_scene::units::<f64>(&scene)?;
    let moves = offer::moves::<f64>(&scene, &units);
    let hello = local::hello::<f64>(&scene);

    let port = Port::new(port.parse()?, BAUD, None, Retry::For(PATIENCE));
    // One telemetry sample every 10 ticks; the number tells this conversation from an earlier one.
    let conversation = std::process::id();
    let client = JobClient::new(moves, hello, 10, Patience::default(), conversation);
    let mut printed = Printed { client };
    // Whatever raises this ends the job on its path, such as Ctrl-C.
    let stop = AtomicBool::new(false);
    if let Err(failure) = drive(&mut printed, &mut port.opened()?, &stop)? {
        return Err(printed.client.describe(&failure).into());
    }
    println!("{} moves done", printed.client.done());
    Ok(())
}

/// The dialogue of a job, whose samples are printed.
struct Printed {
    client: JobClient<f64>,
}

impl Dialogue<f64> for Printed {
    type End = Result<(), JobFailure<f64>>;

    fn poll(&mut self, now: Duration) -> Turn<f64, Self::End> {
        self.client.poll(now)
    }

    fn receive(&mut self, message: &Message<f64>, now: Duration) {
        if let Message::Telemetry(sample) = message {
            let at = sample.setpoint.pose.position;
            println!("tick {}: x {:.4}, y {:.4}", sample.tick, at.x, at.y);
        }
        self.client.receive(message, now);
    }

    fn stop(&mut self) {
        self.client.stop();
    }

    fn reconnected(&mut self) {
        self.client.reconnected();
    }
}
