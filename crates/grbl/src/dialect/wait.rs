//! Reasons for which no line is carried out.

use super::Dialect;
use super::hold::Held;
use crate::fault;
use crate::view::{MachineAct, MachinePhase, MachineView};
use std::time::Duration;
use trirrr_toolpath::{InputAct, InputChange, OutputAct};

/// Reason for which no line is carried out now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wait {
    /// The machine plays what came before a stand of so many seconds.
    Dwell(f64),
    /// The machine stands until this time.
    Until(Duration),
    /// The machine plays what came before a pause of the program.
    Pause,
    /// The program waits for the user.
    Paused,
    /// The machine plays what comes before a change of an output.
    Output(OutputAct),
    /// The machine plays what comes before a wait for an input.
    Input(InputAct),
    /// The machine stands until the input is as the program wants it, at the latest until this time.
    Level(InputAct, Duration),
    /// The machine comes to rest: its place is then that of the path.
    Stand,
    /// Drives go on. True: until the reference is found, too.
    Awake(bool),
    /// A motion with the probe is under way. `must`: an end without a contact is an alarm.
    Probe { must: bool },
}

impl Wait {
    /// Ends later by `by`, if it ends at a time.
    pub(super) fn put_off(&mut self, by: Duration) {
        if let Self::Until(end) | Self::Level(_, end) = self {
            *end = end.saturating_add(by);
        }
    }
}

impl Dialect {
    /// Returns true if lines are carried out. In a hold nothing ends that would hand something over, or let time pass.
    pub(super) fn wait_is_over(&mut self, view: &MachineView, is_empty: bool) -> bool {
        let Some(wait) = self.wait else {
            return true;
        };
        let is_free = self.held.is_none();
        let now = self.now;
        let next = match wait {
            Wait::Dwell(seconds) if is_empty && is_free => Some(Wait::Until(after(now, seconds))),
            Wait::Until(time) if now >= time && is_free => None,
            Wait::Pause if is_empty => {
                self.hold(Held::Feed);
                Some(Wait::Paused)
            }
            Wait::Paused if is_free => None,
            Wait::Output(act) if is_empty && is_free => {
                self.acts.push(MachineAct::Output(act));
                None
            }
            Wait::Input(act) if is_empty && is_free => {
                Some(Wait::Level(act, after(now, act.timeout_s)))
            }
            // A change in a hold is one, too: the view has it once.
            Wait::Level(act, _) if view.inputs.is_some_and(|inputs| inputs.ends(&act)) => None,
            Wait::Level(act, end) if now >= end && is_free => {
                self.waited_in_vain(&act);
                return false;
            }
            // Of a machine that is lost nothing is known: the lines are refused.
            Wait::Stand if is_empty || view.phase == MachinePhase::Lost => {
                self.interpreter.set_place(view.place);
                None
            }
            // What the machine is to do about it is not in the view yet.
            Wait::Awake(homes) => return self.acts.is_empty() && self.woke(view, homes),
            Wait::Probe { must } => match &view.probe {
                Some(end) if is_empty => {
                    self.probed(end, must, view);
                    return true;
                }
                _ => return false,
            },
            _ => return false,
        };
        self.wait = next;
        next.is_none()
    }

    /// Ends a wait for an input that has not come.
    fn waited_in_vain(&mut self, act: &InputAct) {
        let wanted = match act.until {
            InputChange::Rise => "has not gone on",
            InputChange::Fall => "has not gone off",
            InputChange::High => "was not on",
            InputChange::Low => "was not off",
        };
        let (line, index, seconds) = (self.line, act.index, act.timeout_s);
        let reason = format!("line {line}: input {index} {wanted} within {seconds} s");
        self.lock(&reason, fault::ALARM_NO_CONTACT);
    }

    /// Answers `$X` and `$H` once the machine is ready, or cannot be.
    fn woke(&mut self, view: &MachineView, homes: bool) -> bool {
        match view.phase {
            MachinePhase::Idle if view.is_empty => {
                self.interpreter.set_place(view.place);
                if !homes {
                    self.message("Caution: Unlocked");
                }
            }
            MachinePhase::Off if view.reason.is_some() => {
                let reason = view.reason.clone().unwrap_or_default();
                self.message(&reason);
                if homes {
                    self.alarm(fault::ALARM_HOMING);
                }
                self.owes_ok = false;
                self.error(fault::LOCKED);
            }
            _ => return false,
        }
        self.wait = None;
        true
    }
}

/// Time so many seconds after `now`; the last there is where that is too far.
fn after(now: Duration, seconds: f64) -> Duration {
    let wait = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
    now.saturating_add(wait)
}
