//! Inputs of a simulated machine: pressed at given times, by lines on standard input, or by a wall in the plane.

use crate::failure::CliError;
use crate::terminal::say;
use std::io::{self, BufRead};
use std::str::FromStr;
use std::sync::mpsc::{Receiver, channel};
use trirrr_scene::Scene;
use trirrr_service::board::InterlockReadings;

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
    /// Spare input, from 0.
    Spare(u8),
}

/// What all inputs tell in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct InputReadings {
    pub(super) interlocks: InterlockReadings,
    /// Spare inputs, a bit for each.
    pub(super) spare: u8,
}

impl InputName {
    /// Key in `[inputs]` of the scene.
    fn key(self) -> &'static str {
        match self {
            Self::EmergencyStop => "estop",
            Self::Door => "door",
            Self::Probe => "probe",
            Self::Limit(_) => "limits",
            Self::Spare(_) => "io",
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
            Self::Spare(index) => usize::from(index) < scene.spare_pins.inputs.len(),
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
            Self::Spare(_) => "the name of a spare input makes it active or not",
        }
    }

    /// The input that `text` names, in a scene with the spare inputs `spare`.
    fn named(text: &str, spare: &[String]) -> Option<Self> {
        let of_scene = spare.iter().position(|name| name == text);
        if let Some(index) = of_scene {
            return Some(Self::Spare(index as u8));
        }
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

    /// Sets the input in `readings` to what `change` makes of it.
    fn change(self, readings: &mut InputReadings, change: impl Fn(bool) -> bool) {
        let InputReadings { interlocks, spare } = readings;
        let level = match self {
            Self::EmergencyStop => &mut interlocks.emergency_stop,
            Self::Door => &mut interlocks.door,
            Self::Probe => &mut interlocks.probe,
            Self::Limit(0) => &mut interlocks.limits[0],
            Self::Limit(1) => &mut interlocks.limits[1],
            Self::Limit(_) => &mut interlocks.limits[2],
            Self::Spare(index) => {
                let is_active = change(*spare >> index & 1 != 0);
                *spare = *spare & !(1 << index) | u8::from(is_active) << index;
                return;
            }
        };
        *level = change(*level);
    }
}

/// All inputs that a line on standard input changes; one of the limit switches for all of them, and one of the spare inputs.
const INPUTS: [InputName; 5] = [
    InputName::EmergencyStop,
    InputName::Door,
    InputName::Probe,
    InputName::Limit(0),
    InputName::Spare(0),
];

/// Names of the spare inputs of a scene.
fn spare_names(scene: &Scene) -> Vec<String> {
    let inputs = scene.spare_pins.inputs.iter();
    inputs.map(|input| input.name.clone()).collect()
}

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
#[derive(Clone, Debug, PartialEq)]
pub struct Press {
    /// Its name, which may be that of a spare input of the scene.
    input: String,
    /// Begin and end, s of the machine since it was switched on.
    from_s: f64,
    to_s: Option<f64>,
}

impl FromStr for Press {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected INPUT@FROM or INPUT@FROM..TO, such as estop@1.5 or door@2..4 (s)";
        let (name, times) = text.split_once('@').ok_or(expected)?;
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
            input: name.into(),
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
    presses: Vec<(InputName, Press)>,
    /// Changes by a person.
    keys: Option<Receiver<InputName>>,
    /// Inputs that a person has pressed.
    pressed: InputReadings,
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
        let spare = spare_names(scene);
        let mut named_presses = Vec::with_capacity(presses.len());
        for press in presses {
            let name = &press.input;
            let input = InputName::named(name, &spare).ok_or_else(|| {
                CliError::Refused(format!(
                    "--press: {name:?} is no input of scene {}: estop, door, probe, limit1, limit2 and limit3 may be, and the names of \
                     its [[io.inputs]] are",
                    scene.name
                ))
            })?;
            if !input.is_in(scene) {
                let key = input.key();
                return Err(unnamed(&format!("--press {key}"), key));
            }
            named_presses.push((input, press.clone()));
        }
        if wall.is_some() && !InputName::Probe.is_in(scene) {
            return Err(unnamed("--touch", "probe"));
        }
        if keys && !scene.inputs.are_named() && spare.is_empty() {
            return Err(CliError::Refused(format!(
                "--keys presses inputs, and scene {} names none: [inputs.estop], [inputs.door], [inputs.probe], [inputs.limits] or \
                 [[io.inputs]] would",
                scene.name
            )));
        }
        let start = scene.job.start.position;
        let start_m = [start.x, start.y];
        let named = INPUTS.into_iter().filter(|input| input.is_in(scene));
        Ok(Self {
            tick_rate_hz: scene.tick_rate_hz,
            ticks: 0,
            presses: named_presses,
            keys: keys.then(|| listen(named.collect(), spare)),
            pressed: InputReadings::default(),
            wall,
            start_m,
            place_m: start_m,
        })
    }

    /// Returns what the inputs tell in the next tick. `place_m`: where D was commanded to be in the last one, m; none in a tick
    /// without a setpoint.
    pub(super) fn read(&mut self, place_m: Option<[f64; 2]>) -> InputReadings {
        for input in self.keys.iter().flat_map(Receiver::try_iter) {
            input.change(&mut self.pressed, |is_pressed| !is_pressed);
        }
        // Exact: a count of ticks.
        let time_s = self.ticks as f64 / self.tick_rate_hz;
        self.ticks += 1;
        let mut readings = self.pressed;
        for (input, press) in &self.presses {
            if press.is_held(time_s) {
                input.change(&mut readings, |_| true);
            }
        }
        self.place_m = place_m.unwrap_or(self.place_m);
        let touches = |wall: Wall| wall.is_touched(self.start_m, self.place_m);
        readings.interlocks.probe |= self.wall.is_some_and(touches);
        readings
    }
}

/// Reads lines from standard input as long as there are any, on a thread of its own, which ends with the program. `named` are the inputs
/// of the scene.
fn listen(named: Vec<InputName>, spare: Vec<String>) -> Receiver<InputName> {
    let (sender, receiver) = channel();
    let is_named = move |input: InputName| named.iter().any(|each| each.key() == input.key());
    std::thread::spawn(move || {
        for line in io::stdin().lock().lines() {
            let Ok(line) = line else { return };
            let input = InputName::named(line.trim(), &spare).filter(|input| is_named(*input));
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
        let press = |input: &str, from_s, to_s| Press {
            input: input.into(),
            from_s,
            to_s,
        };
        for (text, expected) in [
            ("estop@1.5", press("estop", 1.5, None)),
            ("door@2..4", press("door", 2.0, Some(4.0))),
            ("probe@1", press("probe", 1.0, None)),
            ("limit2@1", press("limit2", 1.0, None)),
            ("e@0..0.01", press("e", 0.0, Some(0.01))),
        ] {
            assert_eq!(text.parse(), Ok(expected), "{text}");
        }
        for (text, why) in [
            ("estop", "expected INPUT@FROM"),
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
    fn inputs_are_found_by_name_and_change_one_by_one() {
        let spare = ["sheet".to_owned(), "door".to_owned()];
        assert_eq!(InputName::named("lid", &spare), None);
        // The scene's own name comes first.
        assert_eq!(InputName::named("door", &spare), Some(InputName::Spare(1)));
        assert_eq!(InputName::named("door", &[]), Some(InputName::Door));
        let mut readings = InputReadings::default();
        for input in [InputName::Spare(1), InputName::Limit(2)] {
            input.change(&mut readings, |is_active| !is_active);
        }
        assert_eq!(readings.spare, 0b10);
        assert_eq!(readings.interlocks.limits, [false, false, true]);
        InputName::Spare(0).change(&mut readings, |_| true);
        InputName::Spare(1).change(&mut readings, |is_active| !is_active);
        assert_eq!(readings.spare, 0b01);
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
