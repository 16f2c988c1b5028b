//! `[power]` and `[faults]`: times that drives and brake take to go on and off, and stops at faults.

use crate::read::{Bound, Section};
use trirrr_service::{PowerTimes, Reactions, StopCategory};

/// Longest time that a scene may give, s: 16 bits of ticks are enough for it at every rate.
const LONGEST_S: f64 = 10.0;

/// Times of switching drives on and off, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Power {
    /// From drives on until they hold the motors.
    pub enable_time_s: f64,
    /// The machine has a brake.
    pub has_brake: bool,
    /// From the brake released until it lets go.
    pub brake_release_s: f64,
    /// From the brake engaged until it holds.
    pub brake_engage_s: f64,
}

impl Power {
    /// Returns the times in whole ticks, none of them shorter.
    pub(crate) fn times(&self, tick_rate_hz: f64) -> PowerTimes {
        // The cast saturates.
        let ticks = |seconds: f64| (seconds * tick_rate_hz).ceil() as u16;
        PowerTimes {
            drives_ticks: ticks(self.enable_time_s),
            brake_release_ticks: ticks(self.brake_release_s),
            brake_engage_ticks: ticks(self.brake_engage_s),
        }
    }
}

/// Reads `[power]`; a time that is left out is 0. Without a tick rate, no time is checked in ticks.
pub(crate) fn read_power(root: &Section, rate: Option<f64>) -> Option<Power> {
    if !root.has("power") {
        return Some(Power::default());
    }
    let section = root.section("power")?;
    let most = rate.map_or(LONGEST_S, |rate| {
        (f64::from(u16::MAX) / rate).min(LONGEST_S)
    });
    let time = |key| {
        let seconds = section.number_or(key, Bound::NotNegative, 0.0)?;
        if seconds > most {
            section.refuse(key, format!("must be at most {most} (s)"));
            return None;
        }
        Some(seconds)
    };
    let [enable, release, engage] =
        ["enable_time_s", "brake_release_s", "brake_engage_s"].map(time);
    Some(Power {
        enable_time_s: enable?,
        has_brake: section.has("brake_release_s") || section.has("brake_engage_s"),
        brake_release_s: release?,
        brake_engage_s: engage?,
    })
}

/// Reads `[faults]`; what is left out is as in [`Reactions::default`]. Returns the stop at a contact beside them, none
/// where it is left out.
pub(crate) fn read_reactions(root: &Section) -> Option<(Reactions, Option<StopCategory>)> {
    let default = Reactions::default();
    if !root.has("faults") {
        return Some((default, None));
    }
    let section = root.section("faults")?;
    let category = |key, default| {
        if !section.has(key) {
            return Some(default);
        }
        Some(match section.integer(key, 0, 2)? {
            0 => StopCategory::Off,
            1 => StopCategory::StopThenOff,
            _ => StopCategory::StopAndHold,
        })
    };
    let limit = category("limit", default.limit);
    let overrun = category("overrun", default.overrun);
    let following = category("following", default.following);
    let drive = category("drive", default.drive);
    let limit_switch = category("limit_switch", default.limit_switch);
    let contact = match section.has("contact") {
        true => category("contact", StopCategory::StopThenOff).map(Some),
        false => Some(None),
    };
    let reactions = Reactions {
        limit: limit?,
        overrun: overrun?,
        following: following?,
        drive: drive?,
        limit_switch: limit_switch?,
    };
    Some((reactions, contact?))
}
