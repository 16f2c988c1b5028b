//! `$` commands.

use super::{Dialect, Wait, interpreter};
use crate::fault;
use crate::report::axes;
use crate::settings::Settings;
use crate::view::{MachineAct, MachinePhase, MachineView, MotionCheck};
use trirrr_toolpath::ToolPlace;
use trirrr_toolpath::gcode::ORIGINS;

const HELP: &str = "[HLP:$$ $# $G $I $N $x=val $J=line $SLP $C $X $H ~ ! ? ctrl-x]";

impl Dialect {
    /// Carries out the command behind a `$`.
    pub(super) fn command(&mut self, command: &str, view: &MachineView, reach: &dyn MotionCheck) {
        let upper = command.to_ascii_uppercase();
        if let Some(line) = upper.strip_prefix("J=") {
            return self.jog(line, view, reach);
        }
        let is_idle = view.is_empty && !matches!(view.phase, MachinePhase::Waking);
        let needs_idle = matches!(upper.as_str(), "$" | "#" | "G" | "I" | "N" | "X" | "");
        if !is_idle && !needs_idle {
            return self.refuse(fault::NOT_IDLE, "the command needs a machine that stands");
        }
        match upper.as_str() {
            "" => self.say(HELP),
            "$" => {
                let list = self.settings.list();
                self.output.extend_from_slice(list.as_bytes());
            }
            "#" => self.list_offsets(),
            "G" => {
                let modal = self.interpreter.modal().to_string();
                self.say(&format!("[GC:{modal}]"));
            }
            "I" => {
                let name = self.settings.facts().name.clone();
                self.say(&format!("[VER:1.1h.trirrr:{name}]"));
                self.say("[OPT:VZL,32,128]");
            }
            "N" => {
                self.say("$N0=");
                self.say("$N1=");
            }
            "C" => {
                self.is_check = !self.is_check;
                let state = if self.is_check { "Enabled" } else { "Disabled" };
                self.message(state);
                // The place of a program that was only read is not that of the machine.
                self.interpreter.set_place(view.place);
            }
            "X" => return self.wake(MachineAct::Unlock, view),
            "H" => return self.wake(MachineAct::Home, view),
            "SLP" => {
                self.acts.push(MachineAct::Sleep);
                self.message("Sleeping");
            }
            "RST=$" => self.settings = Settings::new(self.settings.facts().clone()),
            "RST=#" => self.clear_offsets(view.place),
            "RST=*" => {
                self.settings = Settings::new(self.settings.facts().clone());
                self.clear_offsets(view.place);
            }
            setting => return self.set(setting, view),
        }
        self.say("ok");
    }

    /// Switches the machine on. The answer comes once it is ready.
    fn wake(&mut self, act: MachineAct, view: &MachineView) {
        let homes = act == MachineAct::Home;
        if !homes && !self.is_locked && view.phase == MachinePhase::Idle {
            return self.say("ok");
        }
        if !view.is_empty && !self.is_locked && view.phase != MachinePhase::Fault {
            return self.refuse(fault::NOT_IDLE, "the machine moves");
        }
        self.is_locked = false;
        self.acts.push(act);
        self.owes_ok = true;
        self.wait = Some(Wait::Awake(homes));
    }

    fn set(&mut self, setting: &str, view: &MachineView) {
        let Some((number, value)) = setting.split_once('=') else {
            return self.refuse(fault::STATEMENT, "there is no such command; $ lists them");
        };
        let is_block = number.starts_with('N');
        if is_block {
            return self.refuse(
                fault::SETTING,
                "startup lines are not kept: a machine does nothing by itself",
            );
        }
        match self.settings.set(number, value) {
            Ok(()) => {
                if number.trim() == "30" {
                    let origins =
                        std::array::from_fn::<_, ORIGINS, _>(|i| self.interpreter.origin(i));
                    self.interpreter = interpreter(&self.settings, view.place);
                    origins
                        .into_iter()
                        .enumerate()
                        .for_each(|(i, origin)| self.interpreter.set_origin(i, origin));
                }
                self.say("ok");
            }
            Err(reason) => self.refuse(fault::STATEMENT, &format!("${setting}: {reason}")),
        }
    }

    fn clear_offsets(&mut self, place: ToolPlace) {
        for index in 0..ORIGINS {
            self.interpreter.set_origin(index, ToolPlace::default());
        }
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
