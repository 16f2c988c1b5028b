//! `[service] autonomous`: a board that plays the job of its scene by itself.

use crate::read::Section;
use trirrr_service::features::{FOREVER, JobStart};

/// Start of the job of a board without a host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Autonomous {
    /// Event that begins the job.
    pub begins: JobStart,
    /// Passes of the job; [`FOREVER`].
    pub passes: u32,
}

/// Keys of `[service]` that are of a line to a host, each with the reason why the board has no use for it.
const OF_A_LINE: [(&str, &str); 8] = [
    ("silence_timeout_s", "no host can fall silent"),
    ("telemetry_ticks", "no sample is sent"),
    ("batches", "no move comes over a line"),
    (
        "plans_paths",
        "no path comes over a line; a [[job.path]] of the scene is planned when it is read",
    ),
    ("power_lists", "no list comes over a line"),
    ("adjustable", "nobody changes its scene"),
    ("update", "no program comes over a line"),
    ("scene_over_line", "no scene comes over a line"),
];

/// Reads `autonomous`, `start` and `repeat`: none of a machine with a host.
pub(crate) fn read_autonomous(section: &Section) -> Option<Option<Autonomous>> {
    let is_autonomous = match section.has("autonomous") {
        true => section.boolean("autonomous")?,
        false => false,
    };
    if !is_autonomous {
        let mut is_good = true;
        for key in ["start", "repeat"] {
            if section.has(key) {
                let reason = "belongs to a board that plays the job by itself: \
                              put autonomous = true beside it, or leave it out";
                section.refuse(key, reason);
                is_good = false;
            }
        }
        return is_good.then_some(None);
    }
    let mut is_good = true;
    for (key, why) in OF_A_LINE {
        if section.has(key) {
            let reason = format!(
                "a board with autonomous = true has no line to a host: {why}; leave {key} out, or autonomous"
            );
            section.refuse(key, reason);
            is_good = false;
        }
    }
    let begins = match section.has("start") {
        true => section.choice(
            "start",
            &[("button", JobStart::Button), ("power", JobStart::Power)],
        ),
        false => Some(JobStart::Button),
    };
    let passes = match section.has("repeat") {
        true => section.count_or("repeat", 1, 1_000_000_000, "forever"),
        false => Some(Some(1)),
    };
    let read = Autonomous {
        begins: begins?,
        passes: passes?.unwrap_or(FOREVER),
    };
    is_good.then_some(Some(read))
}
