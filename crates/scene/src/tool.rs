//! `[tool]`: output of a board to the tool.

use crate::drive::{Drive, DriveKind, EnableLevel};
use crate::duration::whole_ticks;
use crate::job::PlacedJob;
use crate::job_move::{JobMove, Tool};
use crate::job_path::{Dwell, JobPath};
use crate::read::{Bound, Document, Section};

/// Frequencies of a PWM output that every board has, Hz.
const FREQUENCY_HZ: (u32, u32) = (10, 100_000);

/// Frequencies of a servo's pulses, Hz, and the one where the scene does not say.
const SERVO_HZ: (u32, u32) = (40, 400);
const SERVO_DEFAULT_HZ: u32 = 50;

/// Shortest and longest pulse of a servo, s: beyond, servos run against their stops.
const PULSE_S: (f64, f64) = (0.0003, 0.003);

/// Most ticks by which the power is delayed.
const DELAY_MAX: u32 = 64;

/// Longest travel of a tool, s.
const TRAVEL_MAX_S: f64 = 10.0;

/// Output of a board to the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolPort {
    /// Kind of the output.
    pub kind: ToolKind,
    /// The tool takes a low level for on.
    pub inverted: bool,
    /// Ticks by which the output follows the power of the tick: what the motors lag behind their commands, less the lead.
    pub delay_ticks: u32,
    /// Ticks from off to on and back, for which the machine stands.
    pub travel_ticks: u32,
}

/// Kind of a tool's output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToolKind {
    /// Laser or spindle: the duty of a PWM output is the power.
    Pwm {
        /// Frequency, Hz.
        frequency_hz: u32,
        /// Duty at the end of power towards 0, and at full power, 0 to 1. The duty of a tool that is off is 0.
        duty: [f64; 2],
        /// Level of the enable line at which the tool may work, if it has one.
        enable: Option<EnableLevel>,
    },
    /// Pen lifter on a servo: the length of a pulse is the height.
    Servo {
        /// Pulses per second, Hz.
        frequency_hz: u32,
        /// Pulse of the pen up, at no power,
        pulse_up_s: f64,
        /// and down, at full power, s.
        pulse_down_s: f64,
    },
    /// Gripper or relay: on at any power.
    Digital {
        /// The tool keeps its level where no job runs.
        holds: bool,
    },
}

impl ToolPort {
    /// Returns true if the tool is on or off, and needs a power without a speed.
    pub fn switches(&self) -> bool {
        !matches!(self.kind, ToolKind::Pwm { .. })
    }
}

/// Reads `[tool]`; none without the table. Without a tick rate, no time is checked in ticks.
pub(crate) fn read_tool_port(
    root: &Section,
    rate: Option<f64>,
    drive: Option<&Drive>,
) -> Option<Option<ToolPort>> {
    if !root.has("tool") {
        return Some(None);
    }
    let section = root.section("tool")?;
    let kinds = [
        ("pwm", Kind::Pwm),
        ("servo", Kind::Servo),
        ("digital", Kind::Digital),
    ];
    let Some(kind) = section.choice("kind", &kinds) else {
        section.ignore_rest();
        return None;
    };
    let inverted = flag(&section, "inverted");
    let lag = u32::from(drive.is_some_and(|drive| matches!(drive.kind, DriveKind::Stepper(_))));
    let delay = match kind {
        Kind::Pwm => read_delay(&section, rate, lag),
        Kind::Servo | Kind::Digital => Some(lag),
    };
    let travel = match kind {
        Kind::Pwm => Some(0),
        Kind::Digital if !section.has("travel_s") => Some(0),
        Kind::Servo | Kind::Digital => read_travel(&section, rate),
    };
    let kind = match kind {
        Kind::Pwm => read_pwm(&section),
        Kind::Servo => read_servo(&section),
        Kind::Digital => flag(&section, "holds").map(|holds| ToolKind::Digital { holds }),
    };
    Some(Some(ToolPort {
        kind: kind?,
        inverted: inverted?,
        delay_ticks: delay?,
        travel_ticks: travel?,
    }))
}

/// Kinds by their names.
#[derive(Clone, Copy)]
enum Kind {
    Pwm,
    Servo,
    Digital,
}

/// A switch that is off where it is left out.
fn flag(section: &Section, key: &'static str) -> Option<bool> {
    match section.has(key) {
        true => section.boolean(key),
        false => Some(false),
    }
}

fn read_pwm(section: &Section) -> Option<ToolKind> {
    let (low, high) = FREQUENCY_HZ;
    let frequency = section.integer("frequency_hz", low, high);
    let part = Bound::Within(0.0, 1.0);
    let least = section.number_or("duty_min", part, 0.0);
    let most = section.number_or("duty_max", part, 1.0);
    let enable = match section.has("enable") {
        true => section
            .choice(
                "enable",
                &[("low", EnableLevel::Low), ("high", EnableLevel::High)],
            )
            .map(Some),
        false => Some(None),
    };
    let (least, most) = (least?, most?);
    if least >= most {
        let reason = format!(
            "must be less than duty_max, {most}: more power is more duty; for a tool that is on when low take inverted = true"
        );
        section.refuse("duty_min", reason);
        return None;
    }
    Some(ToolKind::Pwm {
        frequency_hz: frequency?,
        duty: [least, most],
        enable: enable?,
    })
}

fn read_servo(section: &Section) -> Option<ToolKind> {
    let (low, high) = SERVO_HZ;
    let frequency = match section.has("frequency_hz") {
        true => section.integer("frequency_hz", low, high),
        false => Some(SERVO_DEFAULT_HZ),
    };
    let pulse = |key| {
        let (low, high) = PULSE_S;
        let pulse = section.number(key, Bound::Within(low, high))?;
        let most = 1.0 / f64::from(frequency?);
        if pulse >= most {
            let reason = format!("must be less than a period of frequency_hz, {most} (s)");
            section.refuse(key, reason);
            return None;
        }
        Some(pulse)
    };
    let [up, down] = ["pulse_up_s", "pulse_down_s"].map(pulse);
    let (up, down) = (up?, down?);
    if up == down {
        section.refuse(
            "pulse_down_s",
            "must differ from pulse_up_s: the pen would not move",
        );
        return None;
    }
    Some(ToolKind::Servo {
        frequency_hz: frequency?,
        pulse_up_s: up,
        pulse_down_s: down,
    })
}

/// Ticks of the delay: `lag`, by which the motors follow their commands, less the lead.
fn read_delay(section: &Section, rate: Option<f64>, lag: u32) -> Option<u32> {
    let key = "lead_s";
    if !section.has(key) {
        return Some(lag);
    }
    let lead = section.number(key, Bound::Finite)?;
    let rate = rate?;
    let delay = f64::from(lag) - (lead * rate).round();
    if delay < 0.0 {
        let most = f64::from(lag) / rate;
        let reason = format!(
            "must be at most {most} (s), by which the motors follow their commands: a board does not know the power of the next tick"
        );
        section.refuse(key, reason);
        return None;
    }
    if delay > f64::from(DELAY_MAX) {
        let least = (f64::from(lag) - f64::from(DELAY_MAX)) / rate;
        let reason =
            format!("must be at least {least} (s): a board keeps the powers of {DELAY_MAX} ticks");
        section.refuse(key, reason);
        return None;
    }
    // A whole number from 0 to `DELAY_MAX`.
    Some(delay as u32)
}

fn read_travel(section: &Section, rate: Option<f64>) -> Option<u32> {
    let key = "travel_s";
    let travel = section.number(key, Bound::Within(0.0, TRAVEL_MAX_S))?;
    if travel == 0.0 {
        return Some(0);
    }
    whole_ticks(travel, rate?)
        .map_err(|reason| section.refuse(key, reason))
        .ok()
}

/// Returns true for work that is power.
fn is_on(tool: Option<Tool>) -> bool {
    tool.is_some_and(|tool| tool.power > 0.0)
}

/// Returns true for a power that follows the speed.
pub(crate) fn follows_speed(tool: Option<Tool>) -> bool {
    tool.is_some_and(|tool| tool.power > 0.0 && tool.speed_m_s > 0.0)
}

/// Reason why a tool that switches does not follow the speed.
pub(crate) const NO_SPEED: &str = "the tool of the scene is on or off, so that its power follows no speed: in a scene leave out speed_m_s, in G-code write M3 in \
     place of M4, with a drawing, an image or a table give --constant-power";

/// Refuses moves of a job that do not wait for the tool.
pub(crate) fn check_tool(document: &Document, port: &ToolPort, placed: &PlacedJob, rate: f64) {
    if !port.switches() {
        return;
    }
    let mut on = false;
    for (each, place) in placed.job.moves.iter().zip(&placed.moves) {
        if follows_speed(each.tool) {
            document.refuse(&place.whole, NO_SPEED);
        }
        let changes = is_on(each.tool) != on;
        on = is_on(each.tool);
        if changes && !waits(each, port.travel_ticks) {
            let switched = if on { "on" } else { "off" };
            let reason = format!(
                "the tool goes {switched} here, and takes {} s: let a move to the pose in which the machine stands, \
                 of at least that duration and with this tool, come before",
                f64::from(port.travel_ticks) / rate
            );
            document.refuse(&place.whole, reason);
        }
    }
}

/// Returns true if the machine stands for so many ticks.
fn waits(each: &JobMove, ticks: u32) -> bool {
    ticks == 0 || (each.from == each.to && each.duration_ticks >= ticks)
}

impl JobPath {
    /// Returns the path on which the machine stands for so many ticks wherever the tool goes on or off. The tool is `on` before it,
    /// or nobody knows.
    pub(crate) fn waiting(&self, ticks: u32, mut on: Option<bool>) -> Self {
        let mut path = self.clone();
        if ticks == 0 {
            return path;
        }
        let given = std::mem::take(&mut path.dwells);
        let mut given = given.into_iter().peekable();
        let mut stops = Vec::new();
        // A dwell at which the tool changes lasts long enough.
        let pass = |dwell: Dwell, on: &mut Option<bool>, dwells: &mut Vec<Dwell>| {
            let here = is_on(self.tools[dwell.source]);
            let changes = *on != Some(here);
            *on = Some(here);
            let ticks = match changes {
                true => dwell.ticks.max(ticks),
                false => dwell.ticks,
            };
            dwells.push(Dwell { ticks, ..dwell });
        };
        let mut last = None;
        for piece in &self.pieces {
            let source = piece.source;
            while let Some(dwell) = given.next_if(|dwell| dwell.source <= source) {
                pass(dwell, &mut on, &mut path.dwells);
            }
            let here = is_on(self.tools[source]);
            if last != Some(source) && on != Some(here) {
                path.dwells.push(Dwell { source, ticks });
                stops.push(source);
            }
            (on, last) = (Some(here), Some(source));
        }
        for dwell in given {
            pass(dwell, &mut on, &mut path.dwells);
        }
        path.stop_before(&stops);
        path
    }

    /// Lets the machine come to rest before the first pieces of the tables `sources`, which are in order.
    fn stop_before(&mut self, sources: &[usize]) {
        let lists = self.free.iter_mut();
        let lists = lists.flat_map(|free| [&mut free.given, &mut free.way.pieces]);
        for pieces in lists.chain([&mut self.pieces]) {
            let mut last = None;
            for piece in pieces {
                let is_first = last.replace(piece.source) != Some(piece.source);
                piece.stops |= is_first && sources.binary_search(&piece.source).is_ok();
            }
        }
    }
}
