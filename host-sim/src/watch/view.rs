//! Knowledge of a watcher about a machine, and its lines.

use serde_json::json;
use std::time::{Duration, Instant};
use trirrr_client::describe::{self, Units};
use trirrr_core::setpoint::Setpoint;
use trirrr_line::RawMessage;
use trirrr_protocol::message::{
    Acting, Event, Identity, InputStates, Message, Reply, State, Transmit,
};
use trirrr_scene::words::counted;
use trirrr_scene::{NumberType, in_number_type};

/// Knowledge of a watcher about a machine.
pub(super) struct WatchView {
    json: bool,
    start: Instant,
    /// Number type and units, once somebody has said hello.
    machine: Option<(NumberType, Units)>,
    /// x and y in m, alpha in rad.
    pose: Option<[f64; 3]>,
    state: Option<(State, Acting)>,
    done: Option<u32>,
    inputs: InputStates,
    /// Time of the last message.
    heard: Instant,
    lines: Vec<String>,
}

/// Silence of the machine that is worth a word: with a client it says something ten times a second.
const SILENT: Duration = Duration::from_secs(1);

impl WatchView {
    pub(super) fn new(json: bool) -> Self {
        Self {
            json,
            start: Instant::now(),
            machine: None,
            pose: None,
            state: None,
            done: None,
            inputs: InputStates::ABSENT,
            heard: Instant::now(),
            lines: Vec::new(),
        }
    }

    /// Returns the lines since the last call.
    pub(super) fn take_lines(&mut self) -> Vec<String> {
        std::mem::take(&mut self.lines)
    }

    /// Takes a message of the machine.
    pub(super) fn take(&mut self, message: &RawMessage) {
        self.heard = Instant::now();
        // An identity has the same bytes in every number type.
        if let Some(Message::Reply {
            reply: Reply::Hello(identity),
            ..
        }) = message.read::<Message<f64>>()
        {
            self.meet(&identity);
        } else if let Some((number, units)) = self.machine {
            in_number_type!(number, N => if let Some(message) = message.read::<Message<N>>() {
                self.hear(&message, &units);
            });
        }
    }

    /// Prints `text`.
    pub(super) fn note(&mut self, text: &str) {
        let t = self.start.elapsed().as_secs_f64();
        self.lines.push(match self.json {
            true => json!({ "t": t, "event": text }).to_string(),
            false => format!("{t:>10.3} s  {text}"),
        });
    }

    /// Prints what is known.
    pub(super) fn values(&mut self) {
        let t = self.start.elapsed().as_secs_f64();
        let (pose, done) = (self.pose, self.done);
        let state = self.state;
        let state = state.map(|(state, acting)| describe::state(state, acting));
        let inputs = describe::inputs(&self.inputs);
        let silent = Some(self.heard.elapsed()).filter(|silent| *silent > SILENT);
        let silent = silent.map(|silent| silent.as_secs());
        if self.json {
            let line = json!({
                "t": t, "pose": pose, "state": state, "moves_done": done, "inputs": inputs, "silent_s": silent,
            });
            return self.lines.push(line.to_string());
        }
        let known = [
            pose.map(|[x, y, alpha]| format!("x {x:.4} m, y {y:.4} m, alpha {alpha:.4} rad")),
            state,
            done.map(|done| format!("{} done", counted(done as usize, "move"))),
            inputs,
            silent.map(|seconds| format!("nothing has come for {seconds} s")),
        ];
        let known: Vec<String> = known.into_iter().flatten().collect();
        let text = match self.machine {
            None => "no client has said hello yet".into(),
            Some(_) => known.join(", "),
        };
        self.note(&text);
    }

    /// Learns how the machine counts.
    fn meet(&mut self, identity: &Identity) {
        let number = describe::board::number_type(identity.schema);
        let name = identity.name.iter().take_while(|byte| **byte != 0);
        let name: String = name.map(|byte| char::from(*byte)).collect();
        let Some(number) = number else {
            self.machine = None;
            return self.note(&format!("scene {name}: its messages have another layout"));
        };
        self.machine = Some((number, Units::of(identity)));
        let rate = identity.tick_rate_hz;
        self.note(&format!(
            "a client said hello: scene {name} in {number}, {rate} ticks per second; firmware {}",
            describe::board::firmware(&identity.firmware)
        ));
    }

    fn hear<N: Transmit>(&mut self, message: &Message<N>, units: &Units) {
        match message {
            Message::Event(event) => {
                if let Event::State {
                    state,
                    acting,
                    done,
                } = event
                {
                    self.state = Some((*state, *acting));
                    self.done = Some(*done);
                }
                if let Event::Inputs(inputs) = event {
                    self.inputs = *inputs;
                }
                if let Some(text) = describe::event(event, 0, units) {
                    self.note(&text);
                }
            }
            Message::Telemetry(sample) => {
                self.state = Some((sample.state, sample.acting));
                self.pose = Some(pose(&sample.setpoint, units));
            }
            Message::Reply {
                reply: Reply::Status(status),
                ..
            } => {
                self.state = Some((status.state, status.acting));
                self.done = Some(status.done);
                self.inputs = status.inputs;
                // In motion the end of the last move is another pose.
                if let Some(end) = status.end.filter(|_| status.state.is_at_rest()) {
                    self.pose = Some(pose(&end, units));
                }
            }
            Message::Reply { .. } | Message::Drives(_) => {}
        }
    }
}

fn pose<N: Transmit>(setpoint: &Setpoint<N>, units: &Units) -> [f64; 3] {
    let position = setpoint.pose.position;
    let [x, y] = [position.x, position.y].map(|value| value.to_f64() * units.length_m);
    [x, y, N::angle_to_f64(setpoint.pose.angle)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_count_once_the_number_type_is_known() {
        let event: Message<f32> = Message::Event(Event::State {
            state: State::Running,
            acting: Acting::Nothing,
            done: 3,
        });
        for json in [false, true] {
            let mut view = WatchView::new(json);
            view.take(&RawMessage::of(&event).unwrap());
            view.values();
            let [only] = &view.take_lines()[..] else {
                panic!("more than the values");
            };
            let expected = match json {
                true => "\"state\":null",
                false => "no client has said hello yet",
            };
            assert!(only.contains(expected), "{only}");
            view.machine = Some((NumberType::F32, Units::si(1000.0)));
            view.take(&RawMessage::of(&event).unwrap());
            view.values();
            let lines = view.take_lines();
            assert_eq!(lines.len(), 2, "{lines:?}");
            assert!(lines[0].contains("running, 3 moves done"), "{lines:?}");
            let expected = match json {
                true => "\"moves_done\":3",
                false => "running, 3 moves done",
            };
            assert!(lines[1].contains(expected), "{lines:?}");
        }
    }
}
