//! G38: a straight motion that ends where the probe touches.

use super::Dialect;
use super::wait::Wait;
use crate::fault;
use crate::report::axes;
use crate::view::{MachineAct, MachineView, MotionCheck, ProbeEnd};
use trirrr_toolpath::{Act, Element};

/// A line with G38, and what it asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ProbeWords {
    /// The line with G1 in place of G38.
    motion: String,
    /// Until the probe lets go.
    away: bool,
    /// An end without a contact is an alarm.
    must: bool,
}

impl ProbeWords {
    /// Reads the words of a line, in capitals without white space; none without G38.2 to G38.5.
    pub(super) fn read(words: &str) -> Option<Self> {
        let (before, after) = words.split_once("G38.")?;
        let (away, must) = match after.chars().next()? {
            '2' => (false, true),
            '3' => (false, false),
            '4' => (true, true),
            '5' => (true, false),
            _ => return None,
        };
        let after = after.get(1..)?;
        // Another digit is another code.
        if after.starts_with(|c: char| c.is_ascii_digit()) {
            return None;
        }
        Some(Self {
            motion: format!("{before}G1{after}"),
            away,
            must,
        })
    }
}

impl Dialect {
    /// Carries out a line with G38 once the machine stands. The answer comes at the end of the motion. In check mode it is looked at alone.
    pub(super) fn probe(
        &mut self,
        line: &ProbeWords,
        text: &str,
        view: &MachineView,
        reach: &dyn MotionCheck,
    ) {
        if !self.is_check && (!view.is_empty || !self.acts.is_empty()) {
            // The place from which it goes is known at rest.
            self.flush();
            self.input.put_back(text, false);
            self.line -= 1;
            self.wait = Some(Wait::Stand);
            return;
        }
        if !line.motion.contains(['X', 'Y', 'Z', 'A']) {
            return self.refuse(fault::NO_AXES, "G38 needs an axis word: X, Y or A");
        }
        let mut trial = self.interpreter.clone();
        let work = match trial.line(self.line, &line.motion) {
            Ok(work) => work,
            Err(found) => {
                self.message(&format!("line {found}"));
                return self.error(fault::number(found.kind));
            }
        };
        let element = match work.elements.as_slice() {
            [element] => match element.act {
                Act::Motion(motion) => match reach.check(self.interpreter.place(), &motion) {
                    Ok(()) => *element,
                    Err(reason) => return self.refuse(fault::TRAVEL, &reason),
                },
                _ => return self.refuse(fault::TARGET, "G38 needs a straight motion"),
            },
            _ => return self.refuse(fault::TARGET, "G38 needs a straight motion with a length"),
        };
        self.interpreter = trial;
        self.owes_ok = true;
        if self.is_check {
            return;
        }
        self.acts.push(MachineAct::Probe {
            element: Element {
                tool: None,
                ..element
            },
            away: line.away,
        });
        self.wait = Some(Wait::Probe { must: line.must });
    }

    /// Tells the end of a motion with the probe. The line is answered after that; an alarm locks the machine.
    pub(super) fn probed(&mut self, end: &ProbeEnd, must: bool, view: &MachineView) {
        self.wait = None;
        self.interpreter.set_place(view.place);
        let alarm = match end {
            ProbeEnd::Touched(place) => {
                self.contact = (*place, true);
                None
            }
            ProbeEnd::NotTouched => {
                self.contact = (view.place, false);
                must.then_some(fault::ALARM_NO_CONTACT)
            }
            ProbeEnd::Refused(reason) => {
                self.message(reason);
                Some(fault::ALARM_PROBE)
            }
        };
        if let Some(alarm) = alarm {
            self.alarm(alarm);
            self.is_locked = true;
        }
        if !matches!(end, ProbeEnd::Refused(_)) {
            self.say_contact();
        }
    }

    /// Says where the last contact was: 1 behind the place, or 0 where there was none.
    pub(super) fn say_contact(&mut self) {
        let (place, is_touched) = self.contact;
        let place = axes(place, self.settings.inches);
        self.say(&format!("[PRB:{place}:{}]", u8::from(is_touched)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_with_a_probe_become_straight_motions() {
        let read = |text| ProbeWords::read(text).map(|line| (line.motion, line.away, line.must));
        let line = |motion: &str, away, must| Some((motion.to_owned(), away, must));
        assert_eq!(read("G38.2X10F100"), line("G1X10F100", false, true));
        assert_eq!(read("G91G38.3X1"), line("G91G1X1", false, false));
        assert_eq!(read("G38.4X1"), line("G1X1", true, true));
        assert_eq!(read("G38.5X1"), line("G1X1", true, false));
        for text in ["G1X38.2", "G38X1", "G38.6X1", "G38.25X1", "G38."] {
            assert_eq!(read(text), None, "{text}");
        }
    }
}
