//! Conversation with senders, one after another.

mod commands;
mod hold;
mod motion;
mod probing;
mod real_time;
mod wait;

use crate::fault;
use crate::input::{MOST, RealTime, SentBytes, SentLine};
use crate::report::{Overrides, Reporter};
use crate::settings::{MachineFacts, Settings};
use crate::state::State;
use crate::view::{MachineAct, MachinePhase, MachineView, MotionCheck};
use hold::Held;
use std::collections::VecDeque;
use std::time::Duration;
use trirrr_toolpath::gcode::{GcodeSetup, Interpreter};
use trirrr_toolpath::{Element, ToolPlace};
use wait::Wait;

/// Conversation with senders, one after another. See the [crate](crate).
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
    /// Everything waits for `$X`.
    is_locked: bool,
    /// A fault, or the loss of the machine, was told.
    has_told: bool,
    /// Drives are off because the sender wants it.
    is_asleep: bool,
    is_check: bool,
    held: Option<Held>,
    /// The machine goes on after a door.
    is_restoring: bool,
    is_closed: bool,
    /// Motions were handed over, and nothing after them.
    is_open: bool,
    overrides: Overrides,
    /// Place where the probe has touched last, or where a motion with it has ended without.
    contact: (ToolPlace, bool),
    reporter: Reporter,
    /// Time since which there was nothing to hand over.
    quiet_since: Option<Duration>,
    /// Time of the last step.
    now: Duration,
}

/// Time without another line after which the machine comes to rest at the end of what it has.
const QUIET: Duration = Duration::from_millis(60);

/// Lines that are carried out in a step: real-time bytes are heard in between.
const LINES: usize = 16;

impl Dialect {
    /// Creates the dialect of a machine that stands at `start`. Work coordinates begin as those of the fixed frame. G28 goes to
    /// `start`.
    pub fn new(facts: MachineFacts, start: ToolPlace) -> Self {
        let settings = Settings::new(facts);
        let interpreter = interpreter(&settings, start);
        Self {
            settings,
            input: SentBytes::default(),
            output: Vec::new(),
            commands: Vec::new(),
            acts: Vec::new(),
            interpreter,
            start,
            waiting: VecDeque::new(),
            wait: None,
            owes_ok: false,
            ends: false,
            line: 0,
            is_jog: false,
            is_locked: true,
            has_told: false,
            is_asleep: false,
            is_check: false,
            held: None,
            is_restoring: false,
            is_closed: false,
            is_open: false,
            overrides: Overrides::NORMAL,
            contact: (ToolPlace::default(), false),
            reporter: Reporter::default(),
            quiet_since: None,
            now: Duration::ZERO,
        }
    }

    /// Begins with a sender that has just come. The machine is locked and drops what is left of the one before; zero points and
    /// settings stay, all else is as after a reset.
    pub fn connect(&mut self) {
        (self.is_locked, self.has_told, self.is_closed) = (true, false, false);
        self.line = 0;
        self.input = SentBytes::default();
        self.commands.clear();
        self.output.clear();
        self.reset();
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

    /// Drops the program for a reason, with an alarm: everything waits for `$X`. Lines that wait are answered one by one.
    fn lock(&mut self, reason: &str, alarm: u8) {
        self.message(reason);
        self.alarm(alarm);
        self.drop_program();
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
        let passed = now.saturating_sub(std::mem::replace(&mut self.now, now));
        self.watch(view);
        for command in std::mem::take(&mut self.commands) {
            self.real_time(command, view);
        }
        self.watch_door(view);
        if self.held.is_some() {
            self.stand_still(passed);
        }
        if self.input.take_flood() {
            self.input.clear();
            let reason = format!(
                "more than {MOST} bytes wait: a sender has to wait for answers. The program is dropped"
            );
            self.lock(&reason, fault::ALARM_FAULT);
            self.acts.push(MachineAct::Stop);
        }
        self.carry_on(view, reach);
        self.flush_if_quiet();
        if view.is_empty && self.waiting.is_empty() && self.acts.is_empty() {
            self.is_jog = false;
        }
        std::mem::take(&mut self.acts)
    }

    /// Hands over what waits, answers, and carries out the next lines, as far as it goes.
    fn carry_on(&mut self, view: &MachineView, reach: &dyn MotionCheck) {
        let (mut room, mut lines) = (view.room, LINES);
        loop {
            // What was handed over just now is not in the view.
            let is_empty = view.is_empty && self.acts.is_empty();
            if !self.wait_is_over(view, is_empty) {
                break;
            }
            if let Some(element) = self.waiting.front().copied() {
                if self.held.is_some() || !self.hand_over(element, &mut room) {
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
            if lines == 0 || !self.next_line(view, reach) {
                break;
            }
            lines -= 1;
        }
    }

    /// Carries out the next line. Returns false if there is none that may be carried out.
    fn next_line(&mut self, view: &MachineView, reach: &dyn MotionCheck) -> bool {
        let Some((line, is_cancelled)) = self.input.next() else {
            return false;
        };
        let SentLine::Text(text) = line else {
            self.line = self.line.saturating_add(1);
            self.refuse(fault::OVERFLOW, "the line is longer than 990 bytes");
            return true;
        };
        let words = words_of(&text);
        // As in an alarm: the lines of a program that was dropped are answered, and not kept.
        let waits = self.held.is_some() && !self.is_blocked(view);
        if waits && !words.starts_with('$') {
            self.input.put_back(&text, is_cancelled);
            return false;
        }
        self.line = self.line.saturating_add(1);
        match words.strip_prefix('$') {
            Some(command) => self.command(command, is_cancelled, view, reach),
            None if words.is_empty() && self.is_blocked(view) => self.say("ok"),
            None => self.gcode(&text, &words, view, reach),
        }
        true
    }

    /// Notices faults of the machine, and its loss.
    fn watch(&mut self, view: &MachineView) {
        let is_fault = matches!(view.phase, MachinePhase::Fault | MachinePhase::Lost);
        if is_fault && !self.has_told {
            if let Some(reason) = &view.reason {
                self.message(reason);
            }
            self.alarm(match self.wait {
                Some(Wait::Awake(true)) if view.phase == MachinePhase::Fault => fault::ALARM_HOMING,
                _ => fault::ALARM_FAULT,
            });
            self.drop_program();
            self.wait = None;
            self.is_locked = true;
        }
        self.has_told = is_fault;
        if is_fault || view.phase == MachinePhase::Off {
            self.interpreter.set_place(view.place);
        }
    }

    /// Returns true if no line may move the machine before `$X` or `$H`.
    fn is_blocked(&self, view: &MachineView) -> bool {
        matches!(self.state(view), State::Alarm | State::Sleep)
    }

    /// State in the words of GRBL.
    fn state(&self, view: &MachineView) -> State {
        let stands = matches!(self.wait, None | Some(Wait::Stand));
        match view.phase {
            MachinePhase::Fault | MachinePhase::Lost => State::Alarm,
            _ if self.is_asleep => State::Sleep,
            MachinePhase::Off => State::Alarm,
            _ if self.is_locked => State::Alarm,
            phase => match self.held_state(view) {
                Some(state) => state,
                None if phase == MachinePhase::Waking => State::Home,
                None if self.is_check => State::Check,
                // A stand is part of the program.
                None if phase == MachinePhase::Idle && view.is_empty && stands => State::Idle,
                None if self.is_jog => State::Jog,
                None => State::Run,
            },
        }
    }

    /// Lets the machine come to rest where no line follows.
    fn flush_if_quiet(&mut self) {
        if !self.acts.is_empty() || !self.waiting.is_empty() || self.held.is_some() {
            self.quiet_since = None;
        }
        if !self.is_open || !self.waiting.is_empty() || self.held.is_some() {
            return;
        }
        let since = *self.quiet_since.get_or_insert(self.now);
        if self.now >= since + QUIET || self.wait.is_some() {
            self.flush();
        }
    }

    fn flush(&mut self) {
        if std::mem::take(&mut self.is_open) {
            self.acts.push(MachineAct::Flush);
        }
    }

    /// Drops what the machine has not taken. The line under way is answered.
    fn drop_program(&mut self) {
        self.waiting.clear();
        self.is_open = false;
        self.is_jog = false;
        self.is_check = false;
        self.ends = false;
        if std::mem::take(&mut self.owes_ok) {
            self.error(fault::LOCKED);
        }
    }

    fn greet(&mut self) {
        self.output
            .extend_from_slice(b"\r\nGrbl 1.1h ['$' for help]\r\n");
        if self.is_locked {
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

/// Words of a line as GRBL has them: without white space and comments, in capitals.
fn words_of(text: &str) -> String {
    let mut words = String::with_capacity(text.len());
    let mut is_comment = false;
    for c in text.chars() {
        match c {
            ')' if is_comment => is_comment = false,
            _ if is_comment || c <= ' ' => {}
            '(' => is_comment = true,
            ';' => break,
            _ => words.push(c.to_ascii_uppercase()),
        }
    }
    words
}

fn interpreter(settings: &Settings, start: ToolPlace) -> Interpreter {
    let facts = settings.facts();
    Interpreter::new(GcodeSetup {
        start,
        home: Some(start),
        full_power: settings.full_power,
        z: facts.z,
        outputs: facts.outputs,
        inputs: facts.inputs,
        ..GcodeSetup::default()
    })
}
