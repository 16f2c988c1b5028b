//! Real-time bytes.

use super::{Dialect, Wait};
use crate::input::{Override, RealTime};
use crate::report::{self, Overrides, ReportContent, less};
use crate::view::{MachineAct, MachinePhase, MachineView};

/// Bounds of the feed override: the plan is as fast as allowed, so there is no more than 100 %.
const FEED: (u8, u8) = (10, 100);

/// Bounds of the override of the power; a power ends at 1 all the same.
const POWER: (u8, u8) = (10, 200);

impl Dialect {
    pub(super) fn real_time(&mut self, command: RealTime, view: &MachineView) {
        match command {
            RealTime::Status => self.report(view),
            RealTime::Hold | RealTime::Door => {
                if self.is_jog {
                    return self.cancel_jog();
                }
                self.is_door = command == RealTime::Door;
                if view.phase == MachinePhase::Running {
                    self.acts.push(MachineAct::Hold);
                }
            }
            RealTime::Resume => {
                self.is_door = false;
                if self.wait == Some(Wait::Paused) {
                    self.wait = None;
                }
                if matches!(view.phase, MachinePhase::Slowing | MachinePhase::Holding) {
                    self.acts.push(MachineAct::Resume);
                }
            }
            RealTime::Reset => self.reset(),
            RealTime::JogCancel if self.is_jog => self.cancel_jog(),
            RealTime::JogCancel => {}
            RealTime::Feed(change) => {
                let feed = changed(self.overrides.feed, change, FEED);
                self.overrides.feed = feed;
                self.acts.push(MachineAct::Feed(feed));
            }
            RealTime::Rapid(percent) => self.overrides.rapid = percent,
            RealTime::Power(change) => {
                self.overrides.power = changed(self.overrides.power, change, POWER);
            }
        }
    }

    /// Brings the machine to rest, drops everything, and begins anew. The place is known: there is no alarm.
    fn reset(&mut self) {
        self.acts.clear();
        self.acts.push(MachineAct::Stop);
        // Lines that came behind the reset stay.
        let input = std::mem::take(&mut self.input);
        self.drop_motions();
        self.input = input;
        self.interpreter.reset();
        self.wait = Some(Wait::Stand);
        (self.is_check, self.is_door) = (false, false);
        if self.overrides.feed != Overrides::NORMAL.feed {
            self.acts.push(MachineAct::Feed(Overrides::NORMAL.feed));
        }
        self.overrides = Overrides::NORMAL;
        self.greet();
    }

    fn cancel_jog(&mut self) {
        self.acts.push(MachineAct::Stop);
        self.waiting.clear();
        self.is_open = false;
        self.wait = Some(Wait::Stand);
    }

    fn report(&mut self, view: &MachineView) {
        let zero = less(view.place, self.interpreter.work_place(view.place));
        let content = ReportContent {
            state: self.state(view),
            zero,
            free_bytes: self.input.free(),
            overrides: self.overrides,
            count: self.reports,
        };
        let text = report::status(view, &self.settings, &content);
        self.reports = self.reports.wrapping_add(1);
        self.output.extend_from_slice(text.as_bytes());
    }

    /// State in the words of GRBL.
    pub(super) fn state(&self, view: &MachineView) -> &'static str {
        match view.phase {
            MachinePhase::Fault => "Alarm",
            _ if self.is_locked => "Alarm",
            MachinePhase::Off if self.was_on => "Sleep",
            MachinePhase::Off => "Alarm",
            MachinePhase::Waking => "Home",
            MachinePhase::Holding if self.is_door => "Door:0",
            MachinePhase::Slowing if self.is_door => "Door:2",
            MachinePhase::Holding => "Hold:0",
            MachinePhase::Slowing => "Hold:1",
            _ if self.wait == Some(Wait::Paused) => "Hold:0",
            _ if self.is_check => "Check",
            MachinePhase::Running | MachinePhase::Stopping if self.is_jog => "Jog",
            MachinePhase::Running | MachinePhase::Stopping => "Run",
            // A stand is part of the program.
            MachinePhase::Idle if !view.is_empty || self.wait.is_some() => match self.is_jog {
                true => "Jog",
                false => "Run",
            },
            MachinePhase::Idle => "Idle",
        }
    }
}

fn changed(value: u8, change: Override, (least, most): (u8, u8)) -> u8 {
    match change {
        Override::Normal => 100,
        Override::Step(step) => value.saturating_add_signed(step).clamp(least, most),
    }
}
