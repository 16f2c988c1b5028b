//! The machine in motion, as a page that needs nothing from elsewhere: it plays, pauses, and is drawn at any time by mouse and keys.

use crate::tick_record::AnyTick;
use serde_json::{Value, json};
use trirrr_figures::document::escaped;

/// Poses that are kept; the page interpolates between them.
const FRAMES: u64 = 600;

/// Style, drawing and program; `/*DATA*/null` is where the data go.
const PLAYER: &str = include_str!("animation.html");

/// Poses of a job, thinned out.
pub(crate) struct Animation {
    ticks: u64,
    torque: bool,
    seen: u64,
    frames: Vec<AnimationFrame>,
    /// The last record, if it is not among the frames.
    last: Option<AnimationFrame>,
    legs: Option<Value>,
}

/// Time; x, y, alpha; angles of the motors; torques; places of the base joints, where sliders move them.
type AnimationFrame = Vec<f64>;

impl Animation {
    /// For a job of about `ticks` records of a scene with or without `torque`.
    pub(crate) fn new(ticks: u64, torque: bool) -> Self {
        Self {
            ticks: ticks.max(1),
            torque,
            seen: 0,
            frames: Vec::new(),
            last: None,
            legs: None,
        }
    }

    /// Adds the record of the next tick.
    pub(crate) fn push(&mut self, record: &AnyTick) {
        self.legs.get_or_insert_with(|| legs(record));
        // The first record of each of so many stretches of the job.
        let stretch = |tick: u64| u128::from(tick) * u128::from(FRAMES) / u128::from(self.ticks);
        let is_kept = self.seen == 0 || stretch(self.seen) != stretch(self.seen - 1);
        let [pose, ..] = record.platform();
        // In the memory of the one before, if it is not kept.
        let mut frame = self.last.take().unwrap_or_default();
        frame.clear();
        frame.push(record.t());
        frame.extend(pose);
        frame.extend(record.each_leg().map(|leg| leg.th1));
        if self.torque {
            frame.extend(record.each_leg().map(|leg| leg.torque));
        }
        if has_sliders(record) {
            frame.extend(record.each_leg().flat_map(|leg| leg.base));
        }
        match is_kept {
            true => self.frames.push(frame),
            false => self.last = Some(frame),
        }
        self.seen += 1;
    }

    /// Part of a page: style, drawing and program. Empty without a record.
    pub(crate) fn player(&self) -> String {
        let frames: Vec<&AnimationFrame> = self.frames.iter().chain(&self.last).collect();
        if frames.is_empty() {
            return String::new();
        }
        let shown: Vec<Vec<f64>> = frames
            .iter()
            .map(|frame| frame.iter().map(|value| short(*value)).collect())
            .collect();
        let data = json!({ "legs": self.legs, "torque": self.torque, "frames": shown });
        PLAYER.replacen("/*DATA*/null", &data.to_string(), 1)
    }

    /// The page. `heading` begins its title.
    pub(crate) fn page(&self, heading: &str) -> String {
        let heading = escaped(heading);
        format!(
            "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
             <meta name=\"color-scheme\" content=\"light dark\"><title>{heading}: animation</title>\n\
             <body style=\"margin:1.5em auto;max-width:900px;padding:0 1em\">\n<h1 style=\"font:bold 20px sans-serif\">{heading}</h1>\n{}\
             <p style=\"font:14px sans-serif\">Space: play and pause. Left and right: to and fro, with Shift farther. Home, End. Drag on the curves.</p>\n</body></html>\n",
            self.player()
        )
    }
}

fn has_sliders(record: &AnyTick) -> bool {
    let redundant = record.redundant();
    redundant.is_some_and(|record| record.legs.iter().any(|leg| leg.slider.is_some()))
}

/// Base joints that stand, lengths of the proximal links, and platform joints in the platform's frame, m.
fn legs(record: &AnyTick) -> Value {
    let [[x, y, alpha], ..] = record.platform();
    let (sin, cos) = alpha.sin_cos();
    let of_leg = |leg: &trirrr_scene::record::LegRecord| {
        let [cx, cy] = leg.platform_joint();
        let (u, v) = (cx - x, cy - y);
        let joint = [cos * u + sin * v, cos * v - sin * u];
        json!({
            "base": (!has_sliders(record)).then(|| leg.base.map(short)),
            "proximal": short(leg.r1[0].hypot(leg.r1[1])),
            "joint": joint.map(short),
        })
    };
    record.each_leg().map(of_leg).collect()
}

/// Rounds to six digits, which are more than a screen shows.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_scene::record::Record;

    fn animation(ticks: u64, torque: bool) -> Animation {
        let mut animation = Animation::new(ticks, torque);
        for tick in 0..ticks {
            animation.push(&Record {
                t: tick as f64,
                ..Record::default()
            });
        }
        animation
    }

    #[test]
    fn poses_are_thinned_evenly_and_the_ends_stay() {
        for (ticks, kept) in [(1, 1), (101, 101), (1_000_000, 601)] {
            let animation = animation(ticks, true);
            let frames: Vec<_> = animation.frames.iter().chain(&animation.last).collect();
            assert_eq!(frames.len(), kept, "{ticks}");
            assert_eq!(frames[0][0], 0.0);
            assert_eq!(frames[kept - 1][0], (ticks - 1) as f64);
            let longest = frames.windows(2).map(|pair| pair[1][0] - pair[0][0]);
            let longest = longest.fold(0.0, f64::max);
            assert!(longest <= ticks as f64 / 600.0 + 1.0, "{longest}");
        }
    }

    #[test]
    fn the_page_is_small_and_needs_nothing_from_elsewhere() {
        let page = animation(100_000, true).page("a < b");
        assert!(page.len() < 64_000, "{}", page.len());
        assert!(page.contains("a &lt; b") && !page.contains("/*DATA*/"));
        assert!(!page.contains("src=") && !page.contains("http"));
        assert!(!Animation::new(5, true).page("nothing").contains("<script"));
    }
}
