//! Conversation with a sender.

mod commands;
mod motion;
mod probing;
mod real_time;

use crate::fault;
use crate::input::{RealTime, SentBytes, SentLine};
use crate::report::Overrides;
use crate::settings::{MachineFacts, Settings};
use crate::view::{MachineAct, MachinePhase, MachineView, MotionCheck};
use std::collections::VecDeque;
use std::time::Duration;
use trirrr_toolpath::gcode::{GcodeSetup, Interpreter};
use trirrr_toolpath::{Element, InputAct, InputChange, OutputAct, ToolPlace};

/// Reason for which no line is carried out now.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wait {
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

/// Conversation with one sender. See the [crate](crate).
#[derive(Debug)]
pub struct Dialect {
    settings: Settings,
    input: SentBytes,
    output: Vec<u8>,
    commands: Vec<RealTime>,
    acts: Vec<MachineAct>,
    interpreter: Interpreter,
    start: ToolPlace,
    /// Motions, stands and pauses of the line under way that the machine has not taken.
    waiting: VecDeque<Element>,
    wait: Option<Wait>,
    /// The line under way is to be answered.
    owes_ok: bool,
    /// The program ends with the line under way.
    ends: bool,
    /// Number of the line.
    line: u32,
    /// The motions under way are a jog.
    is_jog: bool,
    /// A motion was refused: everything waits for `$X`.
    is_locked: bool,
    /// A fault was told.
    has_told: bool,
    /// The machine was usable once.
    was_on: bool,
    is_check: bool,
    is_door: bool,
    is_closed: bool,
    /// Motions were handed over, and nothing after them.
    is_open: bool,
    overrides: Overrides,
    /// Place where the probe has touched last, or where a motion with it has ended without.
    contact: (ToolPlace, bool),
    reports: u32,
    /// Time since which there was nothing to hand over.
    quiet_since: Option<Duration>,
}

/// Time without another line after which the machine comes to rest at the end of what it has.
const QUIET: Duration = Duration::from_millis(60);

impl Dialect {
    /// Begins the conversation with a machine that stands at `start`. Work coordinates begin as those of the fixed frame.
    /// `is_on`: its drives are on already. G28 goes to `start`.
    pub fn new(facts: MachineFacts, start: ToolPlace, is_on: bool) -> Self {
        let settings = Settings::new(facts);
        let interpreter = interpreter(&settings, start);
        let mut dialect = Self {
            settings,
            input: SentBytes::default(),
            output: Vec::new(),
            commands: Vec::new(),
            acts: Vec::new(),
            interpreter,
            start,
            waiting: VecDeque::new(),
            wait: Some(Wait::Stand),
            owes_ok: false,
            ends: false,
            line: 0,
            is_jog: false,
            is_locked: false,
            has_told: false,
            was_on: is_on,
            is_check: false,
            is_door: false,
            is_closed: false,
            is_open: false,
            overrides: Overrides::NORMAL,
            contact: (ToolPlace::default(), false),
            reports: 0,
            quiet_since: None,
        };
        dialect.greet();
        dialect
    }

    /// Takes bytes of the sender.
    pub fn bytes(&mut self, bytes: &[u8]) {
        if self.is_closed {
            return;
        }
        if self.input.take(bytes, &mut self.commands).is_none() {
            self.is_closed = true;
            self.message("this is a line for senders of G-code, and no page of the web");
        }
    }

    /// Returns true if the sender may send on.
    pub fn wants_more(&self) -> bool {
        self.input.wants_more()
    }

    /// Returns true if the link is to be closed: the far end is no sender.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Bytes for the sender.
    pub fn take_output(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.output)
    }

    /// Says that the machine has refused a motion that it had taken, and all behind it.
    pub fn refused(&mut self, reason: &str) {
        self.lock(reason, fault::ALARM_TRAVEL);
    }

    /// Drops the program for a reason, with an alarm: everything waits for `$X`.
    fn lock(&mut self, reason: &str, alarm: u8) {
        self.message(reason);
        self.alarm(alarm);
        // The line of a motion with the probe, or of a wait for an input, is answered at its end.
        if matches!(self.wait, Some(Wait::Probe { .. } | Wait::Level(..))) {
            self.error(fault::LOCKED);
        }
        self.drop_motions();
        self.is_locked = true;
        self.wait = Some(Wait::Stand);
    }

    /// Carries out what came, at `now`, and returns what the machine is to do.
    pub fn step(
        &mut self,
        now: Duration,
        view: &MachineView,
        reach: &dyn MotionCheck,
    ) -> Vec<MachineAct> {
        self.watch(view);
        for command in std::mem::take(&mut self.commands) {
            self.real_time(command, view);
        }
        let mut room = view.room;
        loop {
            // What was handed over just now is not in the view.
            let is_empty = view.is_empty && self.acts.is_empty();
            if !self.wait_is_over(now, view, is_empty) {
                break;
            }
            if let Some(element) = self.waiting.front().copied() {
                if !self.hand_over(element, &mut room) {
                    break;
                }
                continue;
            }
            if std::mem::take(&mut self.ends) {
                self.acts.push(MachineAct::End);
            }
            if std::mem::take(&mut self.owes_ok) {
                self.say("ok");
            }
            let Some(line) = self.input.next() else {
                break;
            };
            self.line = self.line.saturating_add(1);
            self.carry_out(&line, view, reach);
        }
        self.flush_if_quiet(now);
        if view.is_empty && self.waiting.is_empty() && self.acts.is_empty() {
            self.is_jog = false;
        }
        std::mem::take(&mut self.acts)
    }

    /// Notices faults of the machine.
    fn watch(&mut self, view: &MachineView) {
        let is_fault = view.phase == MachinePhase::Fault;
        if is_fault && !self.has_told {
            if let Some(reason) = &view.reason {
                self.message(reason);
            }
            self.alarm(match self.wait {
                Some(Wait::Awake(true)) => fault::ALARM_HOMING,
                _ => fault::ALARM_FAULT,
            });
            let owed = self.owes_ok;
            self.drop_motions();
            self.wait = None;
            if owed {
                self.error(fault::LOCKED);
            }
        }
        self.has_told = is_fault;
        self.was_on |= view.phase == MachinePhase::Idle;
        if is_fault || view.phase == MachinePhase::Off {
            self.interpreter.set_place(view.place);
        }
    }

    /// Returns true if lines are carried out.
    fn wait_is_over(&mut self, now: Duration, view: &MachineView, is_empty: bool) -> bool {
        let Some(wait) = self.wait else {
            return true;
        };
        let next = match wait {
            Wait::Dwell(seconds) if is_empty => {
                Some(Wait::Until(now + Duration::from_secs_f64(seconds)))
            }
            Wait::Until(time) if now >= time => None,
            Wait::Pause if is_empty => Some(Wait::Paused),
            Wait::Output(act) if is_empty => {
                self.acts.push(MachineAct::Output(act));
                None
            }
            Wait::Input(act) if is_empty => {
                Some(Wait::Level(act, now.saturating_add(timeout(&act))))
            }
            Wait::Level(act, _) if view.inputs.is_some_and(|inputs| inputs.ends(&act)) => None,
            Wait::Level(act, end) if now >= end => {
                self.waited_in_vain(&act);
                return false;
            }
            Wait::Stand if is_empty => {
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

    fn carry_out(&mut self, line: &SentLine, view: &MachineView, reach: &dyn MotionCheck) {
        let text = match line {
            SentLine::Text(text) => text.trim(),
            SentLine::TooLong => {
                return self.refuse(fault::OVERFLOW, "the line is longer than 1,000 bytes");
            }
            SentLine::NoText => return self.refuse(fault::LETTER, "the line is no text"),
        };
        match text.strip_prefix('$') {
            Some(command) => self.command(command, view, reach),
            None => self.gcode(text, view, reach),
        }
    }

    /// Lets the machine come to rest where no line follows.
    fn flush_if_quiet(&mut self, now: Duration) {
        if !self.acts.is_empty() || !self.waiting.is_empty() {
            self.quiet_since = None;
        }
        if !self.is_open || !self.waiting.is_empty() {
            return;
        }
        let since = *self.quiet_since.get_or_insert(now);
        if now >= since + QUIET || self.wait.is_some() {
            self.flush();
        }
    }

    fn flush(&mut self) {
        if std::mem::take(&mut self.is_open) {
            self.acts.push(MachineAct::Flush);
        }
    }

    /// Drops what the machine has not taken.
    fn drop_motions(&mut self) {
        self.waiting.clear();
        self.is_open = false;
        self.is_jog = false;
        self.input.clear();
        self.owes_ok = false;
        self.ends = false;
    }

    fn greet(&mut self) {
        self.output
            .extend_from_slice(b"\r\nGrbl 1.1h ['$' for help]\r\n");
        if self.is_locked || !self.was_on {
            self.message("'$H'|'$X' to unlock");
        }
    }

    fn say(&mut self, text: &str) {
        self.output.extend_from_slice(text.as_bytes());
        self.output.extend_from_slice(b"\r\n");
    }

    /// A message for the user: one line, without the brackets that end it.
    fn message(&mut self, text: &str) {
        let clean = |c: char| match c {
            '[' => '(',
            ']' => ')',
            c if c.is_control() => ' ',
            c => c,
        };
        let text: String = text.chars().map(clean).collect();
        self.say(&format!("[MSG:{text}]"));
    }

    fn error(&mut self, number: u8) {
        self.say(&format!("error:{number}"));
    }

    fn refuse(&mut self, number: u8, reason: &str) {
        let line = self.line;
        self.message(&format!("line {line}: {reason}"));
        self.error(number);
    }

    fn alarm(&mut self, number: u8) {
        self.say(&format!("ALARM:{number}"));
    }
}

fn interpreter(settings: &Settings, start: ToolPlace) -> Interpreter {
    Interpreter::new(GcodeSetup {
        start,
        home: Some(start),
        full_power: settings.full_power,
        ignore_z: settings.facts().ignore_z,
        outputs: settings.facts().outputs,
        inputs: settings.facts().inputs,
        ..GcodeSetup::default()
    })
}

/// Longest wait for an input.
fn timeout(act: &InputAct) -> Duration {
    Duration::try_from_secs_f64(act.timeout_s).unwrap_or(Duration::MAX)
}
