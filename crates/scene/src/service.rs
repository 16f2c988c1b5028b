//! Settings with which the service runs the job.

use crate::autonomous::{Autonomous, read_autonomous};
use crate::read::{Bound, Section};

/// Longest time that a scene may give for any of it, s.
const LONGEST_S: f64 = 3600.0;

/// Settings of the service that plays the job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Service {
    /// A host that is silent for this long is taken for lost: controlled stop, s, positive.
    pub silence_timeout_s: f64,
    /// A hold takes this long from normal speed to rest where the limits leave room, and a resume back, s, positive.
    pub hold_ramp_s: f64,
    /// A hold takes no longer than this to rest, wherever and at whatever pace it comes, s; as long as the path makes it if there
    /// is none. At least `hold_ramp_s`.
    pub stop_time_max_s: Option<f64>,
    /// The machine plans paths itself, of which a host gives the pieces.
    pub plans_paths: bool,
    /// The machine takes moves in batches. If it is not said, it does where the job has need of it: see
    /// [`Scene::takes_batches`](crate::Scene::takes_batches).
    pub batches: Option<bool>,
    /// Levels of the tool's power for which the machine has room, a power of two; 0: it plays no power lists.
    pub power_lists: u16,
    /// Clients may replace legs, platform with loads, and limits of a board while it stands idle.
    pub adjustable: bool,
    /// The program of a board may be replaced over its line.
    pub update: bool,
    /// A board takes the values of another scene over its line, and keeps them.
    pub scene_over_line: bool,
    /// One telemetry sample every so many ticks, from 1, until a client asks for another rate.
    pub telemetry_ticks: u32,
    /// The board plays the job by itself, without a line to a host.
    pub autonomous: Option<Autonomous>,
}

impl Default for Service {
    fn default() -> Self {
        Self {
            silence_timeout_s: 1.0,
            hold_ramp_s: 0.1,
            stop_time_max_s: None,
            plans_paths: false,
            batches: None,
            power_lists: 0,
            adjustable: false,
            update: false,
            scene_over_line: false,
            telemetry_ticks: 1,
            autonomous: None,
        }
    }
}

/// Reads `[service]`; what is left out is as in [`Service::default`].
/// Without a tick rate, the ramp's length in ticks is not checked. Where there is an obstacle to a planner of paths, it is refused.
pub(crate) fn read_service(
    root: &Section,
    rate: Option<f64>,
    obstacle_to_planner: Option<&str>,
) -> Option<Service> {
    let default = Service::default();
    if !root.has("service") {
        return Some(default);
    }
    let section = root.section("service")?;
    let autonomous = read_autonomous(&section);
    let time = |key, default| {
        let seconds = section.number_or(key, Bound::Positive, default)?;
        if seconds > LONGEST_S {
            section.refuse(key, format!("must be at most {LONGEST_S} (s)"));
            return None;
        }
        Some(seconds)
    };
    let silence_timeout_s = time("silence_timeout_s", default.silence_timeout_s);
    let hold_ramp_s = time("hold_ramp_s", default.hold_ramp_s).filter(|seconds| {
        let ticks = rate.map_or(0.0, |rate| (seconds * rate).round());
        let most = f64::from(u16::MAX);
        if ticks > most {
            section.refuse("hold_ramp_s", format!("is {ticks} ticks, at most {most}"));
        }
        ticks <= most
    });
    let stop_time_max_s = match section.has("stop_time_max_s") {
        true => time("stop_time_max_s", 0.0).map(Some),
        false => Some(None),
    };
    let stop_time_max_s = stop_time_max_s.filter(|most| match (most, hold_ramp_s) {
        (Some(most), Some(ramp)) if *most < ramp => {
            let reason = format!("must be at least hold_ramp_s, {ramp} (s)");
            section.refuse("stop_time_max_s", reason);
            false
        }
        _ => true,
    });
    let telemetry_ticks = match section.has("telemetry_ticks") {
        true => section.integer("telemetry_ticks", 1, 65_535),
        false => Some(default.telemetry_ticks),
    };
    let plans_paths = match section.has("plans_paths") {
        true => section.boolean("plans_paths"),
        false => Some(default.plans_paths),
    };
    let plans_paths = plans_paths.filter(|&plans| match obstacle_to_planner {
        Some(obstacle) if plans => {
            section.refuse("plans_paths", obstacle.to_owned());
            false
        }
        _ => true,
    });
    let batches = match section.has("batches") {
        true => section.boolean("batches").map(Some),
        false => Some(None),
    };
    let power_lists = match section.has("power_lists") {
        true => read_power_lists(&section),
        false => Some(0),
    };
    let adjustable = match section.has("adjustable") {
        true => section.boolean("adjustable"),
        false => Some(default.adjustable),
    };
    let update = match section.has("update") {
        true => section.boolean("update"),
        false => Some(default.update),
    };
    let scene_over_line = match section.has("scene_over_line") {
        true => read_scene_over_line(&section, adjustable, update),
        false => Some(default.scene_over_line),
    };
    Some(Service {
        silence_timeout_s: silence_timeout_s?,
        hold_ramp_s: hold_ramp_s?,
        stop_time_max_s: stop_time_max_s?,
        plans_paths: plans_paths?,
        batches: batches?,
        power_lists: power_lists?,
        adjustable: adjustable?,
        update: update?,
        scene_over_line: scene_over_line?,
        telemetry_ticks: telemetry_ticks?,
        autonomous: autonomous?,
    })
}

/// Reads `scene_over_line`, which needs the code of `adjustable` and the flash of `update`.
fn read_scene_over_line(
    section: &Section,
    adjustable: Option<bool>,
    update: Option<bool>,
) -> Option<bool> {
    let takes = section.boolean("scene_over_line")?;
    for (needed, name, reason) in [
        (adjustable, "adjustable", "builds machines from values"),
        (update, "update", "has the flash to keep a scene in"),
    ] {
        if takes && needed == Some(false) {
            let reason = format!("needs {name} = true beside it: such an image {reason}");
            section.refuse("scene_over_line", reason);
            return None;
        }
    }
    Some(takes)
}

/// Fewest and most levels of power for which a machine may have room.
const POWER_LISTS: [u16; 2] = [256, 16_384];

fn read_power_lists(section: &Section) -> Option<u16> {
    let [least, most] = POWER_LISTS;
    let bytes = section.integer("power_lists", 0, most.into())?;
    if bytes != 0 && (bytes < u32::from(least) || !bytes.is_power_of_two()) {
        let reason = format!(
            "must be a power of two from {least} to {most} (bytes of a board's RAM), or 0 for no power lists"
        );
        section.refuse("power_lists", reason);
        return None;
    }
    Some(bytes as u16)
}
