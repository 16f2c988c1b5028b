//! `$` commands.

use super::wait::Wait;
use super::{Dialect, interpreter};
use crate::fault;
use crate::input::RECEIVE_BUFFER;
use crate::report::axes;
use crate::settings::Settings;
use crate::state::State;
use crate::view::{MachineAct, MachinePhase, MachineView, MotionCheck};
use trirrr_toolpath::ToolPlace;
use trirrr_toolpath::gcode::ORIGINS;

const HELP: &str = "[HLP:$$ $# $G $I $N $x=val $J=line $SLP $C $X $H ~ ! ? ctrl-x]";

/// Reason to refuse what moves a locked machine.
pub(super) const LOCKED: &str = "the machine is locked: $X unlocks it, $H brings it to its start";

/// Refusal of a command: the number of GRBL, and the reason.
pub(super) type Refused = (u8, String);

/// End of a command that is not refused.
pub(super) enum Done {
    /// It is answered now.
    Now,
    /// The answer comes once the machine is ready.
    Later,
    /// It was answered.
    Before,
}

impl Dialect {
    /// Carries out the command behind a `$`, in capitals without white space.
    pub(super) fn command(
        &mut self,
        command: &str,
        is_cancelled: bool,
        view: &MachineView,
        reach: &dyn MotionCheck,
    ) {
        let done = match command.strip_prefix("J=") {
            Some(words) if self.state(view).allows(Some('J')).is_ok() => {
                self.jog(words, is_cancelled, reach)
            }
            _ => self.look_up(command, view),
        };
        match done {
            Ok(Done::Now) => self.say("ok"),
            Ok(Done::Later) => self.owes_ok = true,
            Ok(Done::Before) => {}
            Err((number, reason)) => self.refuse(number, &reason),
        }
    }

    /// Looks at the state first, and at the rest of the command after it, as GRBL does.
    fn look_up(&mut self, command: &str, view: &MachineView) -> Result<Done, Refused> {
        let state = self.state(view);
        state
            .allows(command.chars().next())
            .map_err(|number| (number, needs(command, state)))?;
        match command {
            "" => self.say(HELP),
            "$" => self
                .output
                .extend_from_slice(self.settings.list().as_bytes()),
            "#" => self.list_offsets(),
            "G" => {
                let modal = self.interpreter.modal().to_string();
                self.say(&format!("[GC:{modal}]"));
            }
            "I" => {
                let facts = self.settings.facts();
                let version = format!("[VER:1.1h.trirrr:{}]", facts.name);
                let options = format!("[OPT:V,{},{RECEIVE_BUFFER}]", facts.motions);
                self.say(&version);
                self.say(&options);
            }
            "N" => ["$N0=", "$N1="].iter().for_each(|line| self.say(line)),
            "C" => return Ok(self.check_mode(state)),
            "X" if matches!(state, State::Alarm | State::Sleep) => {
                return self.wake(MachineAct::Unlock, view);
            }
            "X" => {}
            "H" => return self.wake(MachineAct::Home, view),
            "SLP" => {
                self.acts.push(MachineAct::Sleep);
                self.is_asleep = true;
                self.message("Sleeping");
            }
            "RST=$" | "RST=#" | "RST=*" => {
                if command != "RST=#" {
                    self.settings = Settings::new(self.settings.facts().clone());
                }
                if command != "RST=$" {
                    self.clear_offsets(view.place);
                }
                self.message("Restoring defaults");
            }
            other => self.set(other, state, view)?,
        }
        Ok(Done::Now)
    }

    /// Begins to look at lines alone, or ends it: with a reset, as in GRBL.
    fn check_mode(&mut self, state: State) -> Done {
        if state != State::Check {
            self.is_check = true;
            self.message("Enabled");
            return Done::Now;
        }
        self.message("Disabled");
        self.say("ok");
        self.reset();
        Done::Before
    }

    /// Switches the machine on. The answer comes once it is ready.
    fn wake(&mut self, act: MachineAct, view: &MachineView) -> Result<Done, Refused> {
        if view.phase == MachinePhase::Lost {
            return Err((fault::LOCKED, "the machine does not answer".into()));
        }
        if view.contacts.door {
            return Err((fault::DOOR, "the door is open: close it first".into()));
        }
        self.is_locked = false;
        self.is_asleep = false;
        self.acts.push(act);
        self.wait = Some(Wait::Awake(act == MachineAct::Home));
        Ok(Done::Later)
    }

    /// Sets what is neither of the words above.
    fn set(&mut self, command: &str, state: State, view: &MachineView) -> Result<(), Refused> {
        let unknown = || "there is no such command; $ lists them".to_owned();
        let (command, is_block) = match command.strip_prefix('N') {
            Some(_) if state != State::Idle => {
                return Err((fault::NOT_IDLE, needs(command, state)));
            }
            Some(rest) => (rest, true),
            None => (command, false),
        };
        if !is_block && command.starts_with(['$', 'G', 'C', 'X', 'J', 'H', 'S', 'I', 'R', '#']) {
            return Err((fault::STATEMENT, unknown()));
        }
        let (number, rest) = leading_number(command).ok_or((fault::NUMBER, unknown()))?;
        let value = rest
            .strip_prefix('=')
            .ok_or((fault::STATEMENT, unknown()))?;
        if is_block && value.is_empty() {
            return Ok(());
        }
        if is_block {
            let reason = "startup lines are not kept: a machine does nothing by itself";
            return Err((fault::STATEMENT, reason.into()));
        }
        let (value, rest) = leading_number(value)
            .ok_or_else(|| (fault::NUMBER, format!("${command}: the value is no number")))?;
        if rest.starts_with(',') {
            let reason = format!("${command}: the decimal sign is a point, and no comma");
            return Err((fault::STATEMENT, reason));
        }
        if !rest.is_empty() {
            let reason = format!("${command}: {rest} behind the value is not understood");
            return Err((fault::STATEMENT, reason));
        }
        let before = self.settings.full_power;
        self.settings
            .set(number, value)
            .map_err(|(code, reason)| (code, format!("${command}: {reason}")))?;
        if self.settings.full_power != before {
            self.rescale(view.place);
        }
        Ok(())
    }

    /// Begins anew with another full power: the zero points stay.
    fn rescale(&mut self, place: ToolPlace) {
        let origins = std::array::from_fn::<_, ORIGINS, _>(|i| self.interpreter.origin(i));
        self.interpreter = interpreter(&self.settings, place);
        let origins = origins.into_iter().enumerate();
        origins.for_each(|(i, origin)| self.interpreter.set_origin(i, origin));
    }

    fn clear_offsets(&mut self, place: ToolPlace) {
        for index in 0..ORIGINS {
            self.interpreter.set_origin(index, ToolPlace::default());
        }
        // A line that is always good.
        let _ = self.interpreter.line(self.line, "G92.1");
        self.interpreter.set_place(place);
    }

    fn list_offsets(&mut self) {
        let inches = self.settings.inches;
        for index in 0..ORIGINS {
            let origin = axes(self.interpreter.origin(index), inches);
            self.say(&format!("[G{}:{origin}]", 54 + index));
        }
        let (home, none) = (axes(self.start, inches), axes(ToolPlace::default(), inches));
        self.say(&format!("[G28:{home}]"));
        self.say(&format!("[G30:{none}]"));
        let shift = axes(self.interpreter.shift(), inches);
        self.say(&format!("[G92:{shift}]"));
        self.say("[TLO:0.000]");
        self.say_contact();
    }
}

/// Reason to refuse a command in a state.
fn needs(command: &str, state: State) -> String {
    let states = match command.chars().next() {
        _ if state == State::Alarm => LOCKED,
        Some('J') => "a jog needs a machine that stands idle, or jogs",
        Some('$') => "settings are listed while the machine stands",
        Some('C') => "check mode begins while the machine stands idle, without an alarm",
        _ => "the command needs a machine that stands idle",
    };
    states.into()
}

/// Number that `text` begins with, as GRBL reads it, and the rest.
fn leading_number(text: &str) -> Option<(f64, &str)> {
    let mut has_point = false;
    let ends = |(at, c): &(usize, char)| match c {
        '0'..='9' => false,
        '+' | '-' => *at > 0,
        '.' => std::mem::replace(&mut has_point, true),
        _ => true,
    };
    let length = text
        .char_indices()
        .find(ends)
        .map_or(text.len(), |(at, _)| at);
    let (number, rest) = text.split_at(length);
    Some((number.parse().ok()?, rest))
}
