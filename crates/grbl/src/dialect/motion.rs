//! Lines of G-code, and jogs.

use super::probing::ProbeWords;
use super::{Dialect, Wait};
use crate::fault;
use crate::view::{MachineAct, MachinePhase, MachineView, MotionCheck};
use trirrr_toolpath::gcode::{Interpreter, LineWork};
use trirrr_toolpath::{Act, Element, ToolMotion};

impl Dialect {
    /// Reads a line of G-code. All of it is taken, or nothing.
    pub(super) fn gcode(&mut self, text: &str, view: &MachineView, reach: &dyn MotionCheck) {
        let may_move = self.may_move(view);
        if !may_move && !text.is_empty() {
            return self.refuse(
                fault::LOCKED,
                "the machine is locked: $X unlocks it, $H brings it to its start",
            );
        }
        if self.is_jog && !view.is_empty && !text.is_empty() {
            return self.refuse(fault::NOT_IDLE, "a jog is under way");
        }
        if let Some(probe) = ProbeWords::read(text).filter(|_| !self.is_check) {
            return self.probe(&probe, text, view, reach);
        }
        let mut trial = self.interpreter.clone();
        let work = match trial.line(self.line, text) {
            Ok(work) => work,
            Err(fault) => {
                let number = fault::number(&fault);
                self.message(&format!("line {fault}"));
                return self.error(number);
            }
        };
        if let Err(reason) = self.check(&work, reach) {
            return self.refuse(fault::TRAVEL, &reason);
        }
        if let Some(message) = &work.message {
            self.message(message);
        }
        self.interpreter = trial;
        self.owes_ok = true;
        if !self.is_check {
            self.waiting.extend(work.elements);
        }
        if work.end.is_some() {
            self.flush();
            self.ends = !self.is_check;
        }
    }

    /// Reads `$J=...`: a line at a feed, with modes of its own.
    pub(super) fn jog(&mut self, text: &str, view: &MachineView, reach: &dyn MotionCheck) {
        let is_free = view.phase == MachinePhase::Idle && view.is_empty;
        if !self.may_move(view) {
            return self.refuse(fault::LOCKED, "the machine is locked: $X unlocks it");
        }
        if !is_free && !self.is_jog {
            return self.refuse(fault::NOT_IDLE, "a jog needs a machine that stands idle");
        }
        let words = text.to_ascii_uppercase();
        if words.contains('M') || words.contains('S') || !words.contains('F') {
            return self.refuse(
                fault::JOG,
                "a jog is axis words with F, and G20, G21, G90, G91 or G53 before them",
            );
        }
        let mut trial = self.interpreter.clone();
        // G53 needs absolute coordinates, and a jog leaves the modes as they are.
        let line = match words.contains("G5") || words.contains("G0") || words.contains("G1") {
            true => words.clone(),
            false => format!("G1{words}"),
        };
        let work = match jog_line(&mut trial, self.line, &line) {
            Ok(work) => work,
            Err(reason) => return self.refuse(fault::JOG, &reason),
        };
        if let Err(reason) = self.check(&work, reach) {
            return self.refuse(fault::TRAVEL, &reason);
        }
        self.interpreter.set_place(trial.place());
        self.owes_ok = true;
        self.is_jog = true;
        let elements = work.elements.into_iter();
        self.waiting.extend(elements.map(|element| Element {
            tool: None,
            ..element
        }));
    }

    fn may_move(&self, view: &MachineView) -> bool {
        let is_off = matches!(view.phase, MachinePhase::Off | MachinePhase::Fault);
        self.is_check || !(is_off || self.is_locked)
    }

    /// Looks at all motions of a line.
    fn check(&self, work: &LineWork, reach: &dyn MotionCheck) -> Result<(), String> {
        let mut from = self.interpreter.place();
        for element in &work.elements {
            if let Act::Motion(motion) = &element.act {
                reach.check(from, motion)?;
                from = motion.to;
            }
        }
        Ok(())
    }

    /// Hands the first waiting element to the machine. Returns false if it has to wait.
    pub(super) fn hand_over(&mut self, element: Element, room: &mut usize) -> bool {
        match element.act {
            Act::Motion(motion) => {
                if *room == 0 {
                    return false;
                }
                *room -= 1;
                self.is_open = true;
                let element = self.overridden(element, motion);
                self.acts.push(MachineAct::Motion(element));
            }
            Act::Dwell { seconds } => self.stand(Wait::Dwell(seconds)),
            // Which move begins with the next motion is known at rest alone: the machine plans the moves.
            Act::Output(act) => self.stand(Wait::Output(act)),
            Act::Input(act) => self.stand(Wait::Input(act)),
            Act::Pause => self.stand(Wait::Pause),
        }
        self.waiting.pop_front();
        true
    }

    /// Lets the machine come to rest at the end of what it has, for `wait`.
    fn stand(&mut self, wait: Wait) {
        self.flush();
        self.wait = Some(wait);
    }

    /// The element with the overrides of rapids and of the power as they are now.
    fn overridden(&self, element: Element, motion: ToolMotion) -> Element {
        let share = |percent: u8| f64::from(percent) / 100.0;
        let rapid_m_s = self.settings.rapid_mm_min / 60_000.0;
        let is_slow = self.overrides.rapid < 100;
        let feed_m_s = motion
            .feed_m_s
            .or_else(|| is_slow.then(|| rapid_m_s * share(self.overrides.rapid)));
        let tool = element.tool.map(|mut tool| {
            tool.power = (tool.power * share(self.overrides.power)).min(1.0);
            tool
        });
        Element {
            tool,
            act: Act::Motion(ToolMotion { feed_m_s, ..motion }),
            ..element
        }
    }
}

/// Interprets a jog on a copy of the state: G91, G20 and the like hold for it alone.
fn jog_line(trial: &mut Interpreter, number: u32, line: &str) -> Result<LineWork, String> {
    let allowed = |c: char| "GXYZAF0123456789.+- ".contains(c);
    if !line.chars().all(allowed) {
        return Err("a jog is axis words with F, and G20, G21, G90, G91 or G53 before them".into());
    }
    let line = match line.contains("G53") && !line.contains("G0") && !line.contains("G1") {
        true => format!("G1{line}"),
        false => line.to_owned(),
    };
    trial
        .line(number, &line)
        .map_err(|fault| match fault.word.as_str() {
            "" => fault.reason,
            word => format!("{word}: {}", fault.reason),
        })
}
