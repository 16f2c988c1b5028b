//! Remarks about jobs that can be played, and were hardly meant so.

use trirrr_scene::Scene;
use trirrr_scene::words::six_digits;
use trirrr_toolpath::gcode::GcodeRemarks;
use trirrr_toolpath::{Act, Element, PathRemark, ToolCurve, ToolMotion};

/// Longest dwell that is meant as such, s: other machines count milliseconds.
const DWELL_MAX_S: f64 = 60.0;

/// Least part of its feed that a job keeps on the whole.
const PACE_LEAST: f64 = 0.2;

/// Watch over the elements of a path: what a user has to know before the job is played.
#[derive(Clone, Debug, Default)]
pub struct JobWatch {
    /// Remarks of readers, in their order.
    said: Vec<PathRemark>,
    /// Facts of a program, where the job is one.
    program: Option<GcodeRemarks>,
    /// The path is played so many times.
    repeat: u32,
    /// Numbers of elements are no lines of the file.
    is_drawn: bool,
    at_m: [f64; 2],
    is_on: bool,
    switches: bool,
    /// First motion with a feed, its line.
    first_feed: Option<u32>,
    feed_m: f64,
    feed_s: f64,
    rapid_m: f64,
    dwells: Dwells,
}

/// Dwells of a path.
#[derive(Clone, Debug, Default)]
struct Dwells {
    sum_s: f64,
    /// Line and duration of the longest,
    longest: (u32, f64),
    /// and of the first in which the tool is on, and their number.
    burning: (u32, f64),
    burning_count: usize,
}

impl JobWatch {
    /// Watch over a path that begins at a place, m.
    pub(crate) fn new(at_m: [f64; 2]) -> Self {
        Self {
            at_m,
            repeat: 1,
            ..Self::default()
        }
    }

    /// Takes an element as it comes.
    pub(crate) fn push(&mut self, element: &Element) {
        match &element.act {
            Act::Motion(motion) => self.motion(element, motion),
            Act::Dwell { seconds } => {
                let dwells = &mut self.dwells;
                dwells.sum_s += seconds;
                if *seconds > dwells.longest.1 {
                    dwells.longest = (element.line, *seconds);
                }
                if element.tool.is_some() {
                    if dwells.burning_count == 0 {
                        dwells.burning = (element.line, *seconds);
                    }
                    dwells.burning_count += 1;
                }
            }
            Act::Output(_) => self.switches = true,
            Act::Pause | Act::Input(_) => {}
        }
    }

    fn motion(&mut self, element: &Element, motion: &ToolMotion) {
        let to = motion.to.position_m;
        let way_m = way_m(self.at_m, motion);
        self.at_m = to;
        self.is_on |= element.tool.is_some();
        match motion.feed_m_s {
            Some(feed_m_s) => {
                self.first_feed.get_or_insert(element.line);
                self.feed_m += way_m;
                self.feed_s += way_m / feed_m_s;
            }
            None => self.rapid_m += way_m,
        }
    }

    /// Takes remarks of a reader.
    pub fn say(&mut self, remarks: impl IntoIterator<Item = PathRemark>) {
        self.said.extend(remarks);
    }

    /// Takes what the interpreter of a program has found.
    pub fn program(&mut self, found: GcodeRemarks) {
        self.say(found.remarks.iter().cloned());
        self.program = Some(found);
    }

    /// Numbers of the elements are those of shapes or rows, and no lines of the file.
    pub(crate) fn is_drawn(&mut self) {
        self.is_drawn = true;
    }

    /// The path is played so many times.
    pub fn repeats(&mut self, times: u32) {
        self.repeat = times;
    }

    /// Remarks, once the job is planned in `scene`.
    pub fn remarks(&self, scene: &Scene) -> Vec<PathRemark> {
        let mut remarks = self.said.clone();
        let found = self.never_on(scene).into_iter().chain(self.dwells());
        let found = found.chain(self.pace(scene.duration_s()));
        remarks.extend(found.map(|remark| PathRemark {
            line: if self.is_drawn { 0 } else { remark.line },
            ..remark
        }));
        remarks
    }

    /// Remark about a program whose tool is off all the way, on a machine that has one and switches nothing else.
    fn never_on(&self, scene: &Scene) -> Option<PathRemark> {
        let program = self.program.as_ref()?;
        let has_tool = scene.tool.is_some() || scene.tools.is_some();
        if self.is_on || self.switches || !has_tool || self.first_feed.is_none() {
            return None;
        }
        Some(match program.facts.laser {
            Some(line) if program.facts.has_power => PathRemark::new(
                line,
                "the tool is never on: no motion at a feed (G1, G2, G3) has both M3 or M4 and an S above 0",
            ),
            Some(line) => PathRemark::new(
                line,
                "the tool is never on: M3 and M4 need a power, S above 0; no line has one",
            ),
            None if program.facts.has_z => PathRemark::new(
                0,
                "the tool is never on: no line has M3 or M4; --tool-by-z has it on where Z is 0 or below",
            ),
            None => PathRemark::new(0, "the tool is never on: no line has M3 or M4"),
        })
    }

    fn dwells(&self) -> impl Iterator<Item = PathRemark> {
        let Dwells {
            longest,
            burning,
            burning_count,
            ..
        } = self.dwells;
        let long = (longest.1 > DWELL_MAX_S).then(|| {
            let (line, seconds) = longest;
            let text = format!(
                "the machine stands for {}: P of G4 is in seconds",
                seconds_in(seconds)
            );
            PathRemark::new(line, text)
        });
        let burning = (burning_count > 0).then(|| {
            let (line, seconds) = burning;
            let others = match burning_count - 1 {
                0 => String::new(),
                1 => ", and so in one dwell more".to_owned(),
                more => format!(", and so in {more} dwells more"),
            };
            let seconds = seconds_in(seconds);
            PathRemark::new(
                line,
                format!("the tool stays on while the machine stands for {seconds}{others}; with M4 or M5 it is off there"),
            )
        });
        long.into_iter().chain(burning)
    }

    /// Remarks about the time that the job takes.
    fn pace(&self, played_s: f64) -> Vec<PathRemark> {
        let mut remarks = Vec::new();
        let times = f64::from(self.repeat);
        let stands_s = times * self.dwells.sum_s;
        if stands_s > 0.5 * played_s {
            remarks.push(PathRemark::new(
                self.dwells.longest.0,
                format!(
                    "the machine stands for {} of the {} of the job; this is its longest dwell",
                    seconds_in(stands_s),
                    seconds_in(played_s)
                ),
            ));
        }
        let moves_s = played_s - stands_s;
        if self.feed_m > 0.0 && moves_s > 0.0 {
            let mean_m_s = times * (self.feed_m + self.rapid_m) / moves_s;
            let feed_m_s = self.feed_m / self.feed_s;
            if mean_m_s < PACE_LEAST * feed_m_s {
                let mm_min = |m_s: f64| format!("{} mm/min", six_digits(60e3 * m_s));
                remarks.push(PathRemark::new(
                    self.first_feed.unwrap_or(0),
                    format!(
                        "on the whole the job is played at {}, not at the {} of its feeds: `trirrr plan` says what limits it",
                        mm_min(mean_m_s),
                        mm_min(feed_m_s)
                    ),
                ));
            }
        }
        remarks
    }
}

fn seconds_in(value: f64) -> String {
    format!("{} s", six_digits(value))
}

/// Length of a motion, m; of a Bezier curve the mean of its chord and of its control points' chain.
fn way_m(from: [f64; 2], motion: &ToolMotion) -> f64 {
    let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let to = motion.to.position_m;
    match motion.curve {
        ToolCurve::Line => distance(from, to),
        ToolCurve::Arc { centre_m, turn_rad } => turn_rad.abs() * distance(centre_m, to),
        ToolCurve::Bezier { controls_m: [a, b] } => {
            0.5 * (distance(from, to) + distance(from, a) + distance(a, b) + distance(b, to))
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{JobOptions, gcode_job};
    use trirrr_scene::Scene;
    use trirrr_toolpath::{PathRemark, ToolPlace};

    fn remarks(text: &str) -> Vec<PathRemark> {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/engraving.toml");
        let mut scene = Scene::read(file).expect("a shipped scene");
        let options = JobOptions {
            origin: ToolPlace {
                position_m: [0.23, 0.25],
                alpha_rad: scene.job.start.angle,
            },
            ..JobOptions::default()
        };
        let job = gcode_job(text.as_bytes(), &scene, &options).expect("a good program");
        job.plan(&mut scene).expect("a plan");
        job.watch.remarks(&scene)
    }

    /// Each kind of job that cannot be meant has one remark, with its line.
    #[test]
    fn jobs_that_cannot_be_meant_are_told() {
        for (text, line, words) in [
            ("M3\nG0 X5\nG1 X10 F600", 1, "need a power"),
            ("M3 S0\nG1 X10 F600", 1, "need a power"),
            ("M3\nM5\nS5\nG1 X10 F600", 1, "no motion at a feed"),
            ("G1 X10 F600", 0, "no line has M3"),
            ("M4 S1\nG1 X10 F600\nG4 P61", 3, "61 s: P of G4"),
            (
                "M3 S1\nG1 X10 F600\nG4 P0.1\nG4 P.2",
                3,
                "0.1 s, and so in one dwell more",
            ),
            (
                "M4 S1\nG1 X10 F6000\nG4 P30",
                3,
                "stands for 30 s of the 30.",
            ),
            ("G91 M4 S1\nF100000\nG1 X1", 3, "`trirrr plan`"),
        ] {
            let found = remarks(text);
            assert!(
                found
                    .iter()
                    .any(|each| each.line == line && each.text.contains(words)),
                "{text}: {found:?}"
            );
        }
        for good in [
            "M3 S500\nG0 X5\nG1 X10 F600\nM5\nG4 P0.5",
            "M4 S500\nG1 X5 F600\nG4 P0.1\nX10",
        ] {
            assert_eq!(remarks(good), [], "{good}");
        }
    }
}
