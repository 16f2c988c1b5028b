//! Emergency stop and door of a simulated machine: pressed at given times, or by lines on standard input.

use crate::failure::CliError;
use crate::terminal::say;
use std::io::{self, BufRead};
use std::str::FromStr;
use std::sync::mpsc::{Receiver, channel};
use trirrr_scene::Scene;
use trirrr_service::InterlockReadings;

/// An input of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InputName {
    /// Emergency stop.
    EmergencyStop,
    /// Door.
    Door,
}

impl InputName {
    /// Key in `[inputs]` of the scene.
    fn key(self) -> &'static str {
        match self {
            Self::EmergencyStop => "estop",
            Self::Door => "door",
        }
    }

    fn named(text: &str) -> Option<Self> {
        match text {
            "estop" | "e" => Some(Self::EmergencyStop),
            "door" | "d" => Some(Self::Door),
            _ => None,
        }
    }

    fn of(self, readings: &mut InterlockReadings) -> &mut bool {
        match self {
            Self::EmergencyStop => &mut readings.emergency_stop,
            Self::Door => &mut readings.door,
        }
    }
}

/// An input that is pressed, or opened, for a time: `estop@1.5..2`, or from a time on: `door@3`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    input: InputName,
    /// Begin and end, s of the machine since it was switched on.
    from_s: f64,
    to_s: Option<f64>,
}

impl FromStr for Press {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected INPUT@FROM or INPUT@FROM..TO, such as estop@1.5 or door@2..4 (s)";
        let (name, times) = text.split_once('@').ok_or(expected)?;
        let input = InputName::named(name)
            .ok_or_else(|| format!("{name:?} is no input: estop and door are"))?;
        let time = |text: &str| match text.parse::<f64>() {
            Ok(time) if time.is_finite() && time >= 0.0 => Ok(time),
            _ => Err(format!("{text:?} is no time in s; {expected}")),
        };
        let (from_s, to_s) = match times.split_once("..") {
            Some((from, to)) => (time(from)?, Some(time(to)?)),
            None => (time(times)?, None),
        };
        if to_s.is_some_and(|to| to <= from_s) {
            return Err(format!(
                "{times}: the end does not lie behind the beginning"
            ));
        }
        Ok(Self {
            input,
            from_s,
            to_s,
        })
    }
}

impl Press {
    fn is_held(&self, time_s: f64) -> bool {
        time_s >= self.from_s && self.to_s.is_none_or(|to| time_s < to)
    }
}

/// Inputs of a machine.
pub(super) struct PressedInputs {
    tick_rate_hz: f64,
    ticks: u64,
    presses: Vec<Press>,
    /// Changes by a person.
    keys: Option<Receiver<InputName>>,
    /// Inputs that a person has pressed.
    pressed: InterlockReadings,
}

impl PressedInputs {
    /// Inputs of the machine of `scene`. With `keys` a person presses them by lines on standard input.
    ///
    /// # Errors
    /// Refused: an input that the scene does not name.
    pub(super) fn new(scene: &Scene, presses: &[Press], keys: bool) -> Result<Self, CliError> {
        let has = |input| match input {
            InputName::EmergencyStop => scene.inputs.interlocks.emergency_stop.is_some(),
            InputName::Door => scene.inputs.interlocks.door.is_some(),
        };
        if let Some(press) = presses.iter().find(|press| !has(press.input)) {
            let key = press.input.key();
            return Err(CliError::Refused(format!(
                "--press {key}: scene {} names no such input; [inputs.{key}] in it would",
                scene.name
            )));
        }
        if keys && !scene.inputs.are_named() {
            return Err(CliError::Refused(format!(
                "--keys presses inputs, and scene {} names none: [inputs.estop] and [inputs.door] would",
                scene.name
            )));
        }
        Ok(Self {
            tick_rate_hz: scene.tick_rate_hz,
            ticks: 0,
            presses: presses.to_vec(),
            keys: keys.then(|| listen([InputName::EmergencyStop, InputName::Door].map(has))),
            pressed: InterlockReadings::default(),
        })
    }

    /// Returns what the inputs tell in the next tick.
    pub(super) fn read(&mut self) -> InterlockReadings {
        for input in self.keys.iter().flat_map(Receiver::try_iter) {
            let pressed = input.of(&mut self.pressed);
            *pressed = !*pressed;
        }
        // Exact: a count of ticks.
        let time_s = self.ticks as f64 / self.tick_rate_hz;
        self.ticks += 1;
        let mut readings = self.pressed;
        for press in self.presses.iter().filter(|press| press.is_held(time_s)) {
            *press.input.of(&mut readings) = true;
        }
        readings
    }
}

/// Reads lines from standard input as long as there are any, on a thread of its own, which ends with the program. The scene names
/// the inputs of which `has` is true.
fn listen([has_stop, has_door]: [bool; 2]) -> Receiver<InputName> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for line in io::stdin().lock().lines() {
            let Ok(line) = line else { return };
            let input = InputName::named(line.trim()).filter(|input| match input {
                InputName::EmergencyStop => has_stop,
                InputName::Door => has_door,
            });
            match input {
                Some(input) if sender.send(input).is_err() => return,
                Some(_) => {}
                None if line.trim().is_empty() => {}
                None => say(match (has_stop, has_door) {
                    (true, true) => {
                        "estop (e) presses the emergency stop or releases it, door (d) opens the door or closes it"
                    }
                    (true, false) => "estop (e) presses the emergency stop or releases it",
                    _ => "door (d) opens the door or closes it",
                }),
            }
        }
    });
    receiver
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presses_are_read_with_their_times() {
        let press = |input, from_s, to_s| Press {
            input,
            from_s,
            to_s,
        };
        for (text, expected) in [
            ("estop@1.5", press(InputName::EmergencyStop, 1.5, None)),
            ("door@2..4", press(InputName::Door, 2.0, Some(4.0))),
            (
                "e@0..0.01",
                press(InputName::EmergencyStop, 0.0, Some(0.01)),
            ),
        ] {
            assert_eq!(text.parse(), Ok(expected), "{text}");
        }
        for (text, why) in [
            ("estop", "expected INPUT@FROM"),
            ("lid@1", "\"lid\" is no input"),
            ("door@x", "\"x\" is no time"),
            ("door@-1", "is no time"),
            ("door@2..2", "does not lie behind"),
            ("door@1..inf", "is no time"),
        ] {
            let said = text.parse::<Press>().expect_err(text);
            assert!(said.contains(why), "{text}: {said}");
        }
    }

    #[test]
    fn a_press_is_held_from_its_begin_to_its_end() {
        let press: Press = "door@0.5..1".parse().expect("a press");
        let held = [0.499, 0.5, 0.999, 1.0].map(|time| press.is_held(time));
        assert_eq!(held, [false, true, true, false]);
        let press: Press = "door@0.5".parse().expect("a press");
        assert!(press.is_held(1e9));
    }
}
