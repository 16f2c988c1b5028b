//! Lines of G-code, and jogs.

use super::Dialect;
use super::commands::{Done, LOCKED, Refused};
use super::probing::ProbeWords;
use super::wait::Wait;
use crate::fault;
use crate::view::{MachineAct, MachineView, MotionCheck};
use trirrr_toolpath::gcode::{Interpreter, LineWork};
use trirrr_toolpath::{Act, Element, PathFault, ToolMotion};

impl Dialect {
    /// Reads a line of G-code, whose words without comments are `words`. All of it is taken, or nothing.
    pub(super) fn gcode(
        &mut self,
        text: &str,
        words: &str,
        view: &MachineView,
        reach: &dyn MotionCheck,
    ) {
        if self.is_blocked(view) {
            return self.refuse(fault::LOCKED, LOCKED);
        }
        if self.is_jog && !view.is_empty && !words.is_empty() {
            return self.refuse(fault::LOCKED, "a jog is under way");
        }
        if let Some(probe) = ProbeWords::read(words) {
            return self.probe(&probe, text, view, reach);
        }
        let mut trial = self.interpreter.clone();
        let work = match trial.line(self.line, text) {
            Ok(work) => work,
            Err(found) => {
                self.message(&format!("line {found}"));
                return self.error(fault::number(found.kind));
            }
        };
        if let Err(reason) = self.check(&work, reach) {
            return self.refuse(fault::TRAVEL, &reason);
        }
        for message in work.message.iter().chain(&work.tool_change) {
            self.message(message);
        }
        self.interpreter = trial;
        self.owes_ok = true;
        if self.is_check {
            return;
        }
        self.waiting.extend(work.elements);
        if work.end.is_some() {
            self.flush();
            self.ends = true;
        }
    }

    /// Reads what stands behind `$J=`: a line at a feed, with modes of its own. One that is cancelled already goes nowhere.
    pub(super) fn jog(
        &mut self,
        words: &str,
        is_cancelled: bool,
        reach: &dyn MotionCheck,
    ) -> Result<Done, Refused> {
        let mut trial = self.interpreter.clone();
        let work = jog_line(&mut trial, self.line, words)?;
        self.check(&work, reach)
            .map_err(|reason| (fault::TRAVEL, reason))?;
        if is_cancelled {
            return Ok(Done::Now);
        }
        self.interpreter.set_place(trial.place());
        self.is_jog = true;
        let elements = work.elements.into_iter();
        self.waiting.extend(elements.map(|element| Element {
            tool: None,
            ..element
        }));
        Ok(Done::Later)
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

/// Interprets a jog on a copy of the state: G91, G20 and the like hold for it alone. A jog is a line of G1 and G94 with an F.
fn jog_line(trial: &mut Interpreter, number: u32, words: &str) -> Result<LineWork, Refused> {
    const HINT: &str = "a jog is axis words with F, and G20, G21, G90, G91 or G53";
    // G53 has no use for distances; a jog may say so itself.
    let distances = match words.contains("G53") && !words.contains("G9") {
        true => "G90",
        false => "",
    };
    // Lines that are always good.
    let _ = trial.line(number, &format!("G1G94F0{distances}"));
    let work = trial.line(number, words).map_err(|found| {
        let number = fault::number(found.kind);
        match found.fault {
            PathFault { word, reason, .. } if word.is_empty() => (number, reason),
            PathFault { word, reason, .. } => (number, format!("{word}: {reason}")),
        }
    })?;
    let number_of = |letter: char| words.split(letter).skip(1);
    if let Some(letter) = ['S', 'T']
        .into_iter()
        .find(|letter| words.contains(*letter))
    {
        return Err((fault::UNUSED, format!("{letter}: {HINT}")));
    }
    let is_foreign = |code: &str| {
        let digits = code.split(|c: char| c.is_ascii_alphabetic()).next();
        !matches!(digits.unwrap_or_default(), "20" | "21" | "90" | "91" | "53")
    };
    if number_of('G').any(is_foreign) || words.contains('M') {
        return Err((fault::JOG, HINT.into()));
    }
    if !words.contains('F') {
        return Err((fault::FEED, "a jog needs F, the feed, in its line".into()));
    }
    Ok(work)
}
