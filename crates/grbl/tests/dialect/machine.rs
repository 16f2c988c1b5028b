//! Machine behind a dialect, and random numbers.

use std::collections::VecDeque;
use std::time::Duration;
use trirrr_grbl::{
    ContactsView, Dialect, MachineAct, MachineFacts, MachinePhase, MachineView, MotionCheck,
    ProbeEnd,
};
use trirrr_toolpath::gcode::ZWords;
use trirrr_toolpath::{Act, Element, OutputAct, ToolMotion, ToolPlace};

/// A square around the origin, m.
const SIDE_M: f64 = 0.5;

struct Square;

impl MotionCheck for Square {
    fn check(&self, _: ToolPlace, motion: &ToolMotion) -> Result<(), String> {
        let inside = motion.to.position_m.iter().all(|each| each.abs() <= SIDE_M);
        inside.then_some(()).ok_or_else(|| "out of reach".into())
    }
}

/// Machine that plays motions in a time, from the flush on, and asserts that nothing is handed to it in a hold.
pub(crate) struct Machine {
    dialect: Dialect,
    pub(crate) view: MachineView,
    now: Duration,
    /// Time of each motion.
    pub(crate) motion_time: Duration,
    queue: VecDeque<(ToolPlace, Duration)>,
    is_started: bool,
    pub(crate) is_held: bool,
    /// The machine is said not to be empty.
    pub(crate) is_busy: bool,
    pub(crate) motions: u64,
    /// Motions that were begun.
    pub(crate) begun: u64,
    /// Changes of outputs, each with the motions before it.
    pub(crate) outputs: Vec<(u64, OutputAct)>,
    /// Ends of programs.
    pub(crate) ends: u32,
    /// Power of each motion.
    pub(crate) powers: Vec<f64>,
}

impl Machine {
    pub(crate) fn new() -> Self {
        Self::with_z(ZWords::Refused)
    }

    pub(crate) fn with_z(z: ZWords) -> Self {
        let facts = MachineFacts {
            name: "test".into(),
            travel_m: [1.0, 1.0],
            has_homing: false,
            motions: 16,
            z,
            outputs: 2,
            inputs: 2,
        };
        let view = MachineView {
            phase: MachinePhase::Off,
            reason: None,
            place: ToolPlace::default(),
            speed_m_s: 0.0,
            power: 0.0,
            room: 16,
            free: 16,
            stands: true,
            is_empty: true,
            contacts: ContactsView::default(),
            is_door_hold: false,
            probe: None,
            inputs: None,
        };
        let mut machine = Self {
            dialect: Dialect::new(facts, ToolPlace::default()),
            view,
            now: Duration::ZERO,
            motion_time: Duration::ZERO,
            queue: VecDeque::new(),
            is_started: false,
            is_held: false,
            is_busy: false,
            motions: 0,
            begun: 0,
            outputs: Vec::new(),
            ends: 0,
            powers: Vec::new(),
        };
        machine.connect();
        machine
    }

    /// Another sender comes. Returns what it is told.
    pub(crate) fn connect(&mut self) -> String {
        self.dialect.connect();
        self.send(b"")
    }

    /// Says that the machine refuses what it has.
    pub(crate) fn refuse(&mut self, reason: &str) {
        self.queue.clear();
        self.dialect.refused(reason);
    }

    /// Takes bytes, and works until nothing changes. Returns what the dialect says.
    pub(crate) fn send(&mut self, bytes: &[u8]) -> String {
        self.dialect.bytes(bytes);
        let said: String = (0..6).map(|_| self.pass(Duration::from_secs(10))).collect();
        said
    }

    /// Takes bytes, and lets no time pass. Returns what the dialect says.
    pub(crate) fn now(&mut self, bytes: &[u8]) -> String {
        self.dialect.bytes(bytes);
        self.pass(Duration::ZERO)
    }

    /// State of the next report.
    pub(crate) fn state(&mut self) -> String {
        let said = self.now(b"?");
        let report = said
            .lines()
            .find_map(|line| line.strip_prefix('<'))
            .expect("a report");
        report.split('|').next().expect("a state").to_owned()
    }

    /// Lets time pass. Returns what the dialect says.
    pub(crate) fn pass(&mut self, time: Duration) -> String {
        self.now += time;
        self.play(time);
        let view = self.view.clone();
        for act in self.dialect.step(self.now, &view, &Square) {
            self.take(act);
        }
        self.play(Duration::ZERO);
        let said = self.dialect.take_output();
        String::from_utf8(said).expect("text")
    }

    fn take(&mut self, act: MachineAct) {
        let hands_over = matches!(
            act,
            MachineAct::Motion(_) | MachineAct::Probe { .. } | MachineAct::Output(_)
        );
        assert!(!(self.is_held && hands_over), "in a hold: {act:?}");
        match act {
            MachineAct::Motion(element) | MachineAct::Probe { element, .. } => {
                self.motions += 1;
                self.powers
                    .push(element.tool.map_or(0.0, |tool| tool.power));
                self.queue(&element);
                if matches!(act, MachineAct::Probe { .. }) {
                    self.is_started = true;
                    self.view.probe = Some(ProbeEnd::NotTouched);
                }
            }
            MachineAct::Output(act) => self.outputs.push((self.motions, act)),
            MachineAct::End => self.ends += 1,
            MachineAct::Unlock | MachineAct::Home => self.view.phase = MachinePhase::Idle,
            MachineAct::Sleep => self.view.phase = MachinePhase::Off,
            MachineAct::Flush => self.is_started = true,
            MachineAct::Hold => self.is_held = true,
            MachineAct::Resume => self.is_held = false,
            MachineAct::Stop => {
                self.queue.clear();
                self.is_held = false;
            }
            MachineAct::Feed(_) => {}
        }
    }

    fn queue(&mut self, element: &Element) {
        if let Act::Motion(motion) = element.act {
            let [x, y] = motion.to.position_m;
            assert!(x.abs() <= SIDE_M && y.abs() <= SIDE_M, "{motion:?}");
            self.queue.push_back((motion.to, self.motion_time));
        }
    }

    /// Plays the queue for a time, and looks at itself.
    fn play(&mut self, mut time: Duration) {
        // A driver starts what fills the queue.
        self.is_started |= self.queue.len() >= 16;
        while self.is_started && !self.is_held {
            let Some((to, left)) = self.queue.front_mut() else {
                break;
            };
            self.begun += u64::from(*left == self.motion_time);
            let part = time.min(*left);
            (*left, time) = (*left - part, time - part);
            if !left.is_zero() {
                break;
            }
            self.view.place = *to;
            self.queue.pop_front();
        }
        self.is_started &= !self.queue.is_empty();
        let is_on = !matches!(
            self.view.phase,
            MachinePhase::Off | MachinePhase::Fault | MachinePhase::Lost
        );
        if is_on {
            self.view.phase = match (self.is_started, self.is_held) {
                (true, true) => MachinePhase::Holding,
                (true, false) => MachinePhase::Running,
                (false, _) => MachinePhase::Idle,
            };
        }
        self.view.stands = self.view.phase != MachinePhase::Running;
        self.view.is_empty = self.queue.is_empty() && !self.is_busy;
        self.view.room = 16_usize.saturating_sub(self.queue.len());
        self.view.free = self.view.room;
    }
}

pub(crate) fn answers(said: &str) -> usize {
    let is_answer = |line: &&str| *line == "ok" || line.starts_with("error:");
    said.lines().filter(is_answer).count()
}

/// xorshift64*.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn below(&mut self, most: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % most
    }
}
