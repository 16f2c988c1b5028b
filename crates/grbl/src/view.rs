//! Machine, as a sender of G-code sees it.

use trirrr_toolpath::{Element, InputAct, InputChange, OutputAct, ToolMotion, ToolPlace};

/// Phase of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MachinePhase {
    /// Drives are off, or the machine does not know where it stands: only `$X` and `$H` help.
    Off,
    /// A fault is latched.
    Fault,
    /// The machine does not answer: nothing is known of it.
    Lost,
    /// Drives go on, or the machine is on the way to where it can begin.
    Waking,
    /// The machine stands and is ready.
    Idle,
    /// The machine moves along the path.
    Running,
    /// The machine comes to rest on the path, to go on later.
    Slowing,
    /// The machine stands on the path.
    Holding,
    /// The machine comes to rest and drops the path.
    Stopping,
}

/// Machine as the owner of the port knows it now.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineView {
    /// Phase.
    pub phase: MachinePhase,
    /// Reason of a fault, or why the machine cannot be used, in words.
    pub reason: Option<String>,
    /// Place of the tool point in the fixed frame.
    pub place: ToolPlace,
    /// Speed of the tool point, m/s.
    pub speed_m_s: f64,
    /// Power of the tool, 0 to 1.
    pub power: f64,
    /// Motions that the machine takes now.
    pub room: usize,
    /// Motions for which there is room in all that waits to be played, of [`MachineFacts::motions`](crate::MachineFacts::motions).
    pub free: usize,
    /// The machine stands.
    pub stands: bool,
    /// The machine stands, and has nothing left to play.
    pub is_empty: bool,
    /// Contacts.
    pub contacts: ContactsView,
    /// The machine waits for [`MachineAct::Resume`], because the door is open or was.
    pub is_door_hold: bool,
    /// End of the last motion with the probe; none while it is under way, and before any.
    pub probe: Option<ProbeEnd>,
    /// Spare inputs; none before the machine has told them.
    pub inputs: Option<InputsView>,
}

/// Contacts of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactsView {
    /// The door is open.
    pub door: bool,
    /// The probe touches.
    pub probe: bool,
    /// The motors, by their number, that stand on their limit switch.
    pub limits: [bool; 3],
}

/// Spare inputs of the machine: a bit for each, the first is bit 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputsView {
    /// Those that are on.
    pub on: u8,
    /// Those that have gone on since the view before.
    pub risen: u8,
    /// Those that have gone off since.
    pub fallen: u8,
}

impl InputsView {
    /// Returns true if the input is as `act` wants it.
    pub(crate) fn ends(&self, act: &InputAct) -> bool {
        let bits = match act.until {
            InputChange::Rise => self.risen,
            InputChange::Fall => self.fallen,
            InputChange::High => self.on,
            InputChange::Low => !self.on,
        };
        bits >> act.index & 1 != 0
    }
}

/// End of a motion with the probe.
#[derive(Clone, Debug, PartialEq)]
pub enum ProbeEnd {
    /// The contact changed at this place in the fixed frame.
    Touched(ToolPlace),
    /// The motion ended without.
    NotTouched,
    /// The machine has refused it, in words: it has no probe, or the contact was there before.
    Refused(String),
}

/// Demand on the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MachineAct {
    /// Take this motion behind the others. It has the number of its line.
    Motion(Element),
    /// Take this motion, and end it where the probe touches; `away`: where it lets go. The machine stands, and nothing follows before its end.
    Probe {
        /// The motion.
        element: Element,
        /// Until the probe lets go.
        away: bool,
    },
    /// Switch this output: now, for the machine stands, or as the next motion begins.
    Output(OutputAct),
    /// The program ends behind what the machine has.
    End,
    /// No other motion follows soon: the machine comes to rest at the end of what it has.
    Flush,
    /// Switch the drives on, and clear a fault.
    Unlock,
    /// Switch the drives on, find the reference, and go to the start.
    Home,
    /// Switch the drives off.
    Sleep,
    /// Come to rest, and start nothing before [`MachineAct::Resume`] or [`MachineAct::Stop`], whatever was taken before.
    Hold,
    /// Go on.
    Resume,
    /// Come to rest on the path and drop the rest, with a hold.
    Stop,
    /// Play at so many percent of normal speed, 1 to 100.
    Feed(u8),
}

/// Look at a motion before it is taken.
pub trait MotionCheck {
    /// Returns the reason why the machine cannot follow `motion` from `from`, if it knows one.
    ///
    /// # Errors
    /// The reason, in words.
    fn check(&self, from: ToolPlace, motion: &ToolMotion) -> Result<(), String>;
}
