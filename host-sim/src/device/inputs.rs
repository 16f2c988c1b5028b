//! Inputs of a simulated machine: pressed at given times, by lines on standard input, or by a wall in the plane.

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
    /// Probe.
    Probe,
    /// Limit switch of a motor, from 0.
    Limit(u8),
}

impl InputName {
    /// Key in `[inputs]` of the scene.
    fn key(self) -> &'static str {
        match self {
            Self::EmergencyStop => "estop",
            Self::Door => "door",
            Self::Probe => "probe",
            Self::Limit(_) => "limits",
        }
    }

    /// Returns true if the scene names it.
    fn is_in(self, scene: &Scene) -> bool {
        let interlocks = &scene.inputs.interlocks;
        match self {
            Self::EmergencyStop => interlocks.emergency_stop.is_some(),
            Self::Door => interlocks.door.is_some(),
            Self::Probe => interlocks.probe.is_some(),
            Self::Limit(_) => interlocks.limits.is_some(),
        }
    }

    /// Its line on standard input, and what that does.
    fn help(self) -> &'static str {
        match self {
            Self::EmergencyStop => "estop (e) presses the emergency stop or releases it",
            Self::Door => "door (d) opens the door or closes it",
            Self::Probe => "probe (p) makes the probe touch or lets it go",
            Self::Limit(_) => {
                "limit1, limit2 and limit3 close the limit switch of a motor or open it"
            }
        }
    }

    fn named(text: &str) -> Option<Self> {
        match text {
            "estop" | "e" => Some(Self::EmergencyStop),
            "door" | "d" => Some(Self::Door),
            "probe" | "p" => Some(Self::Probe),
            "limit1" => Some(Self::Limit(0)),
            "limit2" => Some(Self::Limit(1)),
            "limit3" => Some(Self::Limit(2)),
            _ => None,
        }
    }

    fn of(self, readings: &mut InterlockReadings) -> &mut bool {
        match self {
            Self::EmergencyStop => &mut readings.emergency_stop,
            Self::Door => &mut readings.door,
            Self::Probe => &mut readings.probe,
            Self::Limit(0) => &mut readings.limits[0],
            Self::Limit(1) => &mut readings.limits[1],
            Self::Limit(_) => &mut readings.limits[2],
        }
    }
}

/// All inputs that a line on standard input changes; one of the limit switches for all of them.
const INPUTS: [InputName; 4] = [
    InputName::EmergencyStop,
    InputName::Door,
    InputName::Probe,
    InputName::Limit(0),
];

/// A wall in the plane, which the probe at D touches from there on: `x=0.12`, or `y=0.3`, in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// 0 for x, 1 for y.
    axis: usize,
    at_m: f64,
}

impl FromStr for Wall {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected x=METRES or y=METRES, such as x=0.12";
        let (axis, at) = text.split_once('=').ok_or(expected)?;
        let axis = match axis {
            "x" => 0,
            "y" => 1,
            _ => return Err(format!("{axis:?} is no axis of the plane; {expected}")),
        };
        match at.parse::<f64>() {
            Ok(at_m) if at_m.is_finite() => Ok(Self { axis, at_m }),
            _ => Err(format!("{at:?} is no place in m; {expected}")),
        }
    }
}

impl Wall {
    /// Returns true if D at `place` is at the wall or beyond it, on the way from `start`, m.
    fn is_touched(&self, start: [f64; 2], place: [f64; 2]) -> bool {
        let (from, now) = (start[self.axis], place[self.axis]);
        match from <= self.at_m {
            true => now >= self.at_m,
            false => now <= self.at_m,
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
        let input = InputName::named(name).ok_or_else(|| {
            format!("{name:?} is no input: estop, door, probe, limit1, limit2 and limit3 are")
        })?;
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
    /// Wall that the probe touches.
    wall: Option<Wall>,
    /// Place of D at the start of the job, and in the last tick that had one, m.
    start_m: [f64; 2],
    place_m: [f64; 2],
}

impl PressedInputs {
    /// Inputs of the machine of `scene`. With `keys` a person presses them by lines on standard input.
    ///
    /// # Errors
    /// Refused: an input that the scene does not name.
    pub(super) fn new(
        scene: &Scene,
        presses: &[Press],
        wall: Option<Wall>,
        keys: bool,
    ) -> Result<Self, CliError> {
        let unnamed = |what: &str, key: &str| {
            CliError::Refused(format!(
                "{what}: scene {} names no such input; [inputs.{key}] in it would",
                scene.name
            ))
        };
        if let Some(press) = presses.iter().find(|press| !press.input.is_in(scene)) {
            let key = press.input.key();
            return Err(unnamed(&format!("--press {key}"), key));
        }
        if wall.is_some() && !InputName::Probe.is_in(scene) {
            return Err(unnamed("--touch", "probe"));
        }
        if keys && !scene.inputs.are_named() {
            return Err(CliError::Refused(format!(
                "--keys presses inputs, and scene {} names none: [inputs.estop], [inputs.door], [inputs.probe] or [inputs.limits] would",
                scene.name
            )));
        }
        let start = scene.job.start.position;
        let start_m = [start.x, start.y];
        let named = INPUTS.into_iter().filter(|input| input.is_in(scene));
        Ok(Self {
            tick_rate_hz: scene.tick_rate_hz,
            ticks: 0,
            presses: presses.to_vec(),
            keys: keys.then(|| listen(named.collect())),
            pressed: InterlockReadings::default(),
            wall,
            start_m,
            place_m: start_m,
        })
    }

    /// Returns what the inputs tell in the next tick. `place_m`: where D was commanded to be in the last one, m; none in a tick
    /// without a setpoint.
    pub(super) fn read(&mut self, place_m: Option<[f64; 2]>) -> InterlockReadings {
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
        self.place_m = place_m.unwrap_or(self.place_m);
        let touches = |wall: Wall| wall.is_touched(self.start_m, self.place_m);
        readings.probe |= self.wall.is_some_and(touches);
        readings
    }
}

/// Reads lines from standard input as long as there are any, on a thread of its own, which ends with the program. `named` are the inputs
/// of the scene.
fn listen(named: Vec<InputName>) -> Receiver<InputName> {
    let (sender, receiver) = channel();
    let is_named = move |input: InputName| named.iter().any(|each| each.key() == input.key());
    std::thread::spawn(move || {
        for line in io::stdin().lock().lines() {
            let Ok(line) = line else { return };
            let input = InputName::named(line.trim()).filter(|input| is_named(*input));
            match input {
                Some(input) if sender.send(input).is_err() => return,
                Some(_) => {}
                None if line.trim().is_empty() => {}
                None => {
                    let known = INPUTS.into_iter().filter(|input| is_named(*input));
                    let help: Vec<&str> = known.map(InputName::help).collect();
                    say(&help.join(", "));
                }
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
            ("probe@1", press(InputName::Probe, 1.0, None)),
            ("limit2@1", press(InputName::Limit(1), 1.0, None)),
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

    #[test]
    fn a_wall_is_touched_from_the_side_on_which_the_job_starts() {
        let wall: Wall = "x=0.25".parse().expect("a wall");
        let touched = |start: f64, now: f64| wall.is_touched([start, 0.0], [now, 0.0]);
        assert_eq!(
            [0.249, 0.25, 0.3].map(|now| touched(0.2, now)),
            [false, true, true]
        );
        assert_eq!(
            [0.251, 0.25, 0.2].map(|now| touched(0.3, now)),
            [false, true, true]
        );
        let wall: Wall = "y=-0.1".parse().expect("a wall");
        assert!(wall.is_touched([0.0, 0.0], [0.0, -0.2]));
        for (text, why) in [
            ("0.1", "expected x="),
            ("z=1", "\"z\" is no axis"),
            ("x=inf", "is no place"),
        ] {
            let said = text.parse::<Wall>().expect_err(text);
            assert!(said.contains(why), "{text}: {said}");
        }
    }
}
