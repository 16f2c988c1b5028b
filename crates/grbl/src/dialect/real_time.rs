//! Real-time bytes.

use super::Dialect;
use super::hold::Held;
use super::wait::Wait;
use crate::input::{Override, RealTime};
use crate::report::{Accessory, Overrides, ReportContent, plus};
use crate::view::{MachineAct, MachineView};

/// Bounds of the feed override: the plan is as fast as allowed, so there is no more than 100 %.
const FEED: (u8, u8) = (10, 100);

/// Bounds of the override of the power; a power ends at 1 all the same.
const POWER: (u8, u8) = (10, 200);

impl Dialect {
    pub(super) fn real_time(&mut self, command: RealTime, view: &MachineView) {
        match command {
            RealTime::Status => self.report(view),
            RealTime::Hold => self.hold(Held::Feed),
            RealTime::Door => self.hold(Held::Door),
            RealTime::Resume => self.resume(view),
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
    pub(super) fn reset(&mut self) {
        self.acts.clear();
        self.acts.push(MachineAct::Stop);
        // The greeting is the answer to the line under way.
        self.owes_ok = false;
        self.drop_program();
        self.interpreter.reset();
        self.wait = Some(Wait::Stand);
        (self.held, self.is_restoring) = (None, false);
        if std::mem::take(&mut self.is_asleep) {
            self.is_locked = true;
        }
        if self.overrides.feed != Overrides::NORMAL.feed {
            self.acts.push(MachineAct::Feed(Overrides::NORMAL.feed));
        }
        self.overrides = Overrides::NORMAL;
        self.greet();
    }

    /// Ends the jog, and those in lines that wait. Each is answered as ever.
    pub(super) fn cancel_jog(&mut self) {
        self.acts.push(MachineAct::Stop);
        self.input.cancel_jogs();
        self.waiting.clear();
        self.is_open = false;
        self.wait = Some(Wait::Stand);
    }

    fn report(&mut self, view: &MachineView) {
        let origin = self.interpreter.origin(self.interpreter.modal().origin);
        let content = ReportContent {
            state: self.state(view),
            zero: plus(origin, self.interpreter.shift()),
            free_bytes: self.input.free(),
            overrides: self.overrides,
            accessory: Accessory(self.interpreter.modal().laser),
        };
        let text = self.reporter.report(view, &self.settings, &content);
        self.output.extend_from_slice(text.as_bytes());
    }
}

fn changed(value: u8, change: Override, (least, most): (u8, u8)) -> u8 {
    match change {
        Override::Normal => 100,
        Override::Step(step) => value.saturating_add_signed(step).clamp(least, most),
    }
}
