//! `[feedback]`: limits of the watch over drives that tell where they are.

use crate::read::{Bound, Section};
use trirrr_service::features::FeedbackParameters;

/// Longest time that a scene may give, s.
const LONGEST_S: f64 = 10.0;

/// Watch over drives that tell where they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback {
    /// A drive that tells nothing for longer is silent, s.
    pub timeout_s: f64,
    /// All drives have to be on within this time, s.
    pub enable_time_max_s: f64,
    /// A joint moves less than this while the machine is enabled, rad.
    pub still_rad: f64,
    /// Greatest following error of a joint that stands, rad.
    pub following_standing_rad: f64,
    /// Greatest following error of a joint that moves, rad.
    pub following_moving_rad: f64,
    /// A following error beyond its limit is a fault after this time, s.
    pub following_time_s: f64,
}

impl Default for Feedback {
    fn default() -> Self {
        Self {
            timeout_s: 0.25,
            enable_time_max_s: 2.0,
            still_rad: 2e-3,
            following_standing_rad: 0.02,
            following_moving_rad: 0.1,
            following_time_s: 0.02,
        }
    }
}

impl Feedback {
    /// Returns the limits in whole ticks, none of them shorter.
    pub fn parameters(&self, tick_rate_hz: f64) -> FeedbackParameters {
        // The casts saturate.
        let ticks = |seconds: f64| (seconds * tick_rate_hz).ceil().max(1.0) as u16;
        FeedbackParameters {
            timeout_ticks: ticks(self.timeout_s),
            enable_ticks: ticks(self.enable_time_max_s),
            still_rad: self.still_rad,
            standing_rad: self.following_standing_rad,
            moving_rad: self.following_moving_rad,
            window_ticks: ticks(self.following_time_s),
        }
    }
}

/// Reads `[feedback]`; what is left out is as in [`Feedback::default`], all of it for drives that measure. Refused for
/// drives that tell nothing.
pub(crate) fn read_feedback(
    root: &Section,
    rate: Option<f64>,
    measures: bool,
) -> Option<Option<Feedback>> {
    if !root.has("feedback") {
        return Some(measures.then(Feedback::default));
    }
    let section = root.section("feedback")?;
    if !measures {
        root.refuse(
            "feedback",
            "needs drives that tell where they are: kind = \"can\", or \"bldc\" with encoder_counts_per_rev",
        );
        return None;
    }
    let default = Feedback::default();
    let most = rate.map_or(LONGEST_S, |rate| {
        (f64::from(u16::MAX) / rate).min(LONGEST_S)
    });
    let time = |key, default| {
        let seconds = section.number_or(key, Bound::Positive, default)?;
        if seconds > most {
            section.refuse(key, format!("must be at most {most} (s)"));
            return None;
        }
        Some(seconds)
    };
    let angle = |key, default| {
        let radians = section.number_or(key, Bound::Positive, default)?;
        if radians > 1.0 {
            section.refuse(key, "must be at most 1 (rad)");
            return None;
        }
        Some(radians)
    };
    let timeout_s = time("timeout_s", default.timeout_s);
    let enable_time_max_s = time("enable_time_max_s", default.enable_time_max_s);
    let following_time_s = time("following_time_s", default.following_time_s);
    let still_rad = angle("still_rad", default.still_rad);
    let standing = angle("following_standing_rad", default.following_standing_rad);
    let moving = angle("following_moving_rad", default.following_moving_rad);
    Some(Some(Feedback {
        timeout_s: timeout_s?,
        enable_time_max_s: enable_time_max_s?,
        still_rad: still_rad?,
        following_standing_rad: standing?,
        following_moving_rad: moving?,
        following_time_s: following_time_s?,
    }))
}
