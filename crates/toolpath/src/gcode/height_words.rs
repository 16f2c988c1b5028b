//! Sense of Z on a machine that moves in the plane.
use super::axis_words::AxisWords;
use super::frames::place;
use super::motion::{STAND, ToolUse, distance};
use super::refusal::{GcodeRefusal, RefusalKind, refusal};
use super::run::LineRun;
use super::setup::ZWords;
use crate::{Act, ToolCurve, ToolMotion, ToolPlace, ToolWork};

/// Heights so near are one, m.
const NEAR_M: f64 = 1e-9;

impl<'t> LineRun<'_, 't> {
    /// Sets the way of Z for the motion of the block; `fixed_frame`: the height is not known behind it.
    pub(super) fn aim_height(
        &mut self,
        words: &AxisWords<'t>,
        fixed_frame: bool,
    ) -> Result<(), GcodeRefusal> {
        let height = &self.state.height;
        let from = height.z_m;
        let to = match words.z {
            None => from,
            Some(_) if fixed_frame => f64::INFINITY,
            Some(word) => {
                let value = self.state.modal.unit.to_metres(word.value);
                match self.state.modal.incremental {
                    true => height.base_m + value,
                    false => value,
                }
            }
        };
        self.heights = [from, to];
        self.done = 0.0;
        let height = &mut self.state.height;
        height.go(to);
        // Motions at a height that is not known are judged by the first one that is: down, or the height of the work.
        if height.lit.is_some_and(|(_, lit)| lit.is_infinite()) && to.is_finite() && !height.is_down
        {
            height.lit = None;
        }
        match height.lit {
            Some((line, lit)) if to < lit - NEAR_M && self.fixed.z == ZWords::Ignored => {
                let reason = format!(
                    "the tool is on in a motion at a feed{}, and line {} lowers it to {}: {LIFTED}",
                    at_height(lit),
                    self.block.number,
                    in_mm(to)
                );
                Err(refusal(RefusalKind::Unsupported, line, "", &reason))
            }
            _ => Ok(()),
        }
    }

    /// Goes to the home place, whose height is not known.
    pub(super) fn lift(&mut self) {
        self.heights = [self.state.height.z_m, f64::INFINITY];
        self.done = 0.0;
        self.state.height.go(f64::INFINITY);
    }

    /// Counts a motion of Z alone.
    pub(super) fn count_plunge(&mut self) {
        let [from, to] = self.heights.map(|z_m| self.is_low(z_m));
        if from != to {
            self.state.program.plunges += 1;
        }
    }

    /// Returns true if the tool is down at a height.
    fn is_low(&self, z_m: f64) -> bool {
        matches!(self.fixed.z, ZWords::Tool { on_at_m } if z_m <= on_at_m + NEAR_M)
    }

    /// Work of the tool that stands where the path is, if Z says so.
    pub(super) fn tool_by_height(&self) -> Option<Option<ToolWork>> {
        let is_tool = matches!(self.fixed.z, ZWords::Tool { .. });
        is_tool.then(|| self.tool_at(self.state.height.z_m, ToolUse::AtRest))
    }

    /// Work of the tool at a height: down, it has the power of S, or all where there is no S. A program with M3 or M4 switches it, too.
    fn tool_at(&self, z_m: f64, tool: ToolUse) -> Option<ToolWork> {
        use super::modal::LaserMode as L;
        let program = &self.state.program;
        let laser = self.state.modal.laser;
        let power = match program.has_s {
            true => self.state.modal.s / self.fixed.full_power,
            false => 1.0,
        };
        let is_off = program.laser.is_some() && laser == L::Off;
        let follows_speed = laser == L::FollowsSpeed;
        let stands_off = follows_speed && tool == ToolUse::AtRest;
        (self.is_low(z_m) && !is_off && !stands_off && power > 0.0).then_some(ToolWork {
            power,
            follows_speed,
        })
    }

    /// Puts a motion that ends `done` of the block's way behind the others, and switches the tool where it crosses the height.
    pub(super) fn push_by_height(
        &mut self,
        start: ToolPlace,
        motion: ToolMotion,
        tool: ToolUse,
        (on_at_m, done): (f64, f64),
    ) {
        let [from, to] = self.heights_to(done);
        if self.is_low(from) == self.is_low(to) {
            let tool = self.tool_at(to, tool);
            return self.push(tool, Act::Motion(motion));
        }
        // From or to a height that is not known the tool is off.
        let part = match (from - on_at_m) / (from - to) {
            part if part.is_finite() => part.clamp(0.0, 1.0),
            _ if self.is_low(to) => 1.0,
            _ => 0.0,
        };
        self.state.program.ramps += 1;
        let tools = [from, to].map(|z_m| self.tool_at(z_m, tool));
        let (first, second) = cut(start, motion, part);
        match (goes(start, &first), goes(first.to, &second)) {
            (true, true) => {
                self.push(tools[0], Act::Motion(first));
                self.push(tools[1], Act::Motion(second));
            }
            (false, _) => self.push(tools[1], Act::Motion(motion)),
            (true, false) => self.push(tools[0], Act::Motion(motion)),
        }
    }

    /// Heights at the start and at the end of the next part of the block's way.
    fn heights_to(&mut self, done: f64) -> [f64; 2] {
        let [from, to] = self.heights;
        let before = std::mem::replace(&mut self.done, done);
        let at = |part: f64| match part {
            0.0 => from,
            1.0 => to,
            part => from + part * (to - from),
        };
        [at(before), at(done)]
    }

    /// Refuses a motion in which the tool is on above the lowest height, where words of Z have no effect: it was lifted there.
    pub(super) fn check_lifted(&mut self) -> Result<(), GcodeRefusal> {
        let [from, to] = self.heights;
        let height = &mut self.state.height;
        // Down to the material on the way.
        let dives = from.is_finite() && from > NEAR_M && from > to + NEAR_M;
        if height.is_down && !dives {
            return Ok(());
        }
        let highest = match from.is_finite() {
            true => from.max(to),
            false => to,
        };
        if highest <= height.lowest_m + NEAR_M || height.lowest_m.is_infinite() {
            height.lit.get_or_insert((self.block.number, highest));
            return Ok(());
        }
        let reason = format!(
            "the tool is on in this motion at a feed{}, above the lowest, {}: {LIFTED}",
            at_height(highest),
            in_mm(height.lowest_m)
        );
        Err(self.block.refuse(RefusalKind::Unsupported, "", &reason))
    }
}

/// Reason and remedy for a tool that is on above the work.
const LIFTED: &str = "the program lifts the tool by Z, and --ignore-z would leave the tool on; with --tool-by-z \
     in its place Z switches the tool";

fn in_mm(z_m: f64) -> String {
    format!("Z{}", (z_m * 1e9).round() / 1e6)
}

fn at_height(z_m: f64) -> String {
    match z_m.is_finite() {
        true => format!(" at {}", in_mm(z_m)),
        false => String::new(),
    }
}

/// Cuts a motion from `start` at a part of its way.
fn cut(start: ToolPlace, motion: ToolMotion, part: f64) -> (ToolMotion, ToolMotion) {
    let mix = |from: f64, to: f64| from + part * (to - from);
    let alpha = mix(start.alpha_rad, motion.to.alpha_rad);
    let [from, to] = [start.position_m, motion.to.position_m];
    let (at, curves) = match motion.curve {
        ToolCurve::Arc { centre_m, turn_rad } => {
            let turns = [part * turn_rad, (1.0 - part) * turn_rad];
            let (sin, cos) = libm::sincos(turns[0]);
            let [x, y] = [0, 1].map(|axis| from[axis] - centre_m[axis]);
            let at = [
                centre_m[0] + cos * x - sin * y,
                centre_m[1] + sin * x + cos * y,
            ];
            let arc = |turn_rad| ToolCurve::Arc { centre_m, turn_rad };
            (at, turns.map(arc))
        }
        curve => ([0, 1].map(|axis| mix(from[axis], to[axis])), [curve; 2]),
    };
    let first = ToolMotion {
        curve: curves[0],
        to: place([at[0], at[1], alpha]),
        stops: false,
        ..motion
    };
    let second = ToolMotion {
        curve: curves[1],
        ..motion
    };
    (first, second)
}

/// Returns false for a motion that goes nowhere.
fn goes(from: ToolPlace, motion: &ToolMotion) -> bool {
    let turns = match motion.curve {
        ToolCurve::Arc { turn_rad, .. } => turn_rad.abs() > STAND,
        _ => distance(from, motion.to) > STAND,
    };
    turns || (motion.to.alpha_rad - from.alpha_rad).abs() > STAND
}
