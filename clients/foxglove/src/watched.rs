//! A machine behind a port for watchers.

use crate::error::FoxgloveError;
use crate::topics::Topics;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};
use trirrr_client::describe::{self, Units};
use trirrr_client::drive_records::DriveSamples;
use trirrr_client::records::Samples;
use trirrr_line::{Address, Frames, KeyRefusal, Link, OpenError, RawMessage, SharedKey};
use trirrr_protocol::message::{Event, Message, Reply, Telemetry, TelemetryFields};
use trirrr_scene::{Scene, in_number_type, pipeline, units};
use trirrr_service::ServiceNumber;

/// Longest wait for the machine before Ctrl-C is looked at.
const LOOK: Duration = Duration::from_millis(20);

/// Time from one attempt to open the port to the next.
const AGAIN: Duration = Duration::from_secs(1);

/// Bytes taken from the link at a time.
const CHUNK: usize = 4096;

/// Gives out all that the machine of `scene` tells at `port`, until `stop` is raised. A port that closes is opened anew.
///
/// # Errors
/// Refused: the key file; a machine of another scene. Failed: the port when it is opened first, or its key.
pub(crate) fn watch(
    port: &str,
    key: Option<&Path>,
    scene: &Scene,
    topics: &mut Topics,
    stop: &AtomicBool,
) -> Result<(), FoxgloveError> {
    let key = key.map(SharedKey::read).transpose();
    let key = key.map_err(|error| FoxgloveError::Refused(error.to_string()))?;
    let line = WatchedLine {
        address: Address::Tcp(port.into()),
        key,
    };
    in_number_type!(scene.number, N => watch_in::<N>(&line, scene, topics, stop))
}

/// Port for watchers.
struct WatchedLine {
    address: Address,
    key: Option<SharedKey>,
}

impl WatchedLine {
    fn open(&self) -> Result<Box<dyn Link>, OpenError> {
        trirrr_line::open_watched(&self.address, self.key.as_ref())
    }
}

fn watch_in<N: ServiceNumber>(
    line: &WatchedLine,
    scene: &Scene,
    topics: &mut Topics,
    stop: &AtomicBool,
) -> Result<(), FoxgloveError> {
    let refused = |error: &dyn std::fmt::Display| FoxgloveError::Refused(error.to_string());
    let machine_units = units::<N>(scene).map_err(|error| refused(&error))?;
    let machine = pipeline::of_scene::<N>(scene, machine_units).map_err(|error| refused(&error))?;
    let units = Units::of_scene(scene, &machine_units);
    let mut watcher = Watcher {
        scene,
        topics,
        units,
        samples: Samples::new(&*machine, units),
        drives: DriveSamples::new(scene, units, 1).map_err(|error| refused(&error))?,
        is_warned: false,
    };
    let failed = |error: OpenError| FoxgloveError::Failed(error.to_string());
    let mut link = line.open().map_err(failed)?;
    let mut frames = Frames::default();
    while !stop.load(Ordering::Relaxed) {
        let mut bytes = [0; CHUNK];
        match link.receive(&mut bytes, LOOK) {
            Ok(length) => {
                let mut messages: Vec<RawMessage> = Vec::new();
                frames.receive(&bytes[..length], |message| messages.push(message));
                for message in &messages {
                    watcher.take(message)?;
                }
            }
            Err(error) if KeyRefusal::of(&error).is_some() => {
                return Err(FoxgloveError::Failed(format!("{}: {error}", line.address)));
            }
            Err(error) => {
                watcher.warn(&format!("{}: {error}; opening it anew", line.address));
                std::thread::sleep(AGAIN);
                match line.open() {
                    Ok(opened) => (link, frames) = (opened, Frames::default()),
                    Err(error) if error.may_pass() => {}
                    Err(error) => return Err(failed(error)),
                }
            }
        }
    }
    Ok(())
}

/// Everything that is known of a machine.
struct Watcher<'a, N: ServiceNumber> {
    scene: &'a Scene,
    topics: &'a mut Topics,
    units: Units,
    samples: Samples<'a, N>,
    drives: Option<DriveSamples<N>>,
    /// It was said that samples have no setpoint.
    is_warned: bool,
}

impl<N: ServiceNumber> Watcher<'_, N> {
    fn take(&mut self, message: &RawMessage) -> Result<(), FoxgloveError> {
        // An identity has the same bytes in every number type.
        if let Some(Message::Reply {
            reply: Reply::Hello(identity),
            ..
        }) = message.read::<Message<f64>>()
        {
            let own = trirrr_client::local::hello::<N>(self.scene);
            if identity.schema != own.schema || identity.scene != self.scene.key {
                let name = identity.name.iter().take_while(|byte| **byte != 0);
                let name: String = name.map(|byte| char::from(*byte)).collect();
                return Err(FoxgloveError::Refused(format!(
                    "the machine was built from another scene, {name}, or in another number type than {}: give the one that it was built from",
                    self.scene.number
                )));
            }
        } else if let Some(message) = message.read::<Message<N>>() {
            self.hear(&message);
        }
        Ok(())
    }

    fn hear(&mut self, message: &Message<N>) {
        match message {
            Message::Event(event) => {
                if let Some(text) = describe::event(event, 0, &self.units) {
                    let is_warning = matches!(event, Event::Fault(_));
                    self.topics.say(&text, is_warning, now());
                }
            }
            Message::Telemetry(sample) => self.sample(sample),
            Message::Drives(sample) => {
                let Some(drives) = &mut self.drives else {
                    return;
                };
                drives.drives(sample);
                while let Some(record) = drives.next_record() {
                    self.topics.drives(&record, now());
                }
            }
            Message::Reply { .. } => {}
        }
    }

    fn sample(&mut self, sample: &Telemetry<N>) {
        let at = now();
        let state = describe::state(sample.state, sample.acting);
        self.topics.state(&state, sample.number, sample.lost, at);
        if !sample.fields.contain(TelemetryFields::SETPOINT) {
            if !self.is_warned {
                self.is_warned = true;
                self.warn("the machine's client asks for samples without setpoints: there is nothing to draw");
            }
            return;
        }
        if let Some(drives) = &mut self.drives {
            drives.command(sample);
        }
        match self.samples.record(sample, 1) {
            Ok(record) => self.topics.record(&record, at),
            Err(status) => self.warn(&status.to_string()),
        }
    }

    fn warn(&self, text: &str) {
        eprintln!("{text}");
        self.topics.say(text, true, now());
    }
}

/// Nanoseconds since 1970.
fn now() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    // A clock before 1970 tells no time.
    since.map_or(0, |since| since.as_nanos() as u64)
}
