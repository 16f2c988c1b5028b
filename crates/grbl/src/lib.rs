//! The line protocol of GRBL 1.1, without a port, a thread and a clock.
//!
//! A [`Dialect`] stands between a sender of G-code and a machine:
//!
//! - Bytes of the sender go into [`Dialect::bytes`]. Real-time bytes (`?`, `!`, `~`, 0x18, 0x84 and above) act at once, wherever
//!   they stand. The rest are lines.
//! - [`Dialect::step`] carries out lines, in their order, as long as the machine takes more. The owner gives a [`MachineView`], and
//!   gets [`MachineAct`]s for the machine back.
//! - [`Dialect::take_output`] hands out the bytes for the sender.
//!
//! A line is answered by `ok` once the machine has taken all its motions, and by `error:N` with the reason in a `[MSG:...]` before it
//! if any part is refused: then nothing of the line moves. Lines are read by the interpreter of `trirrr-toolpath`, the one of job files.
//! A motion is looked at by a [`MotionCheck`] before it is taken. A refusal that comes later, from the machine's own proof, is
//! `ALARM:2`: the machine stands on its path, and everything behind is dropped.
//!
//! **Held** is a state of the conversation. `!`, 0x84 and an open door set it in every state but a jog, which they cancel; `~` and ^X
//! clear it. While it is set, no motion, no dwell and no output reaches the machine, and lines of G-code wait.
#![forbid(unsafe_code)]

mod dialect;
mod fault;
mod input;
mod report;
mod settings;
mod state;
mod view;

pub use dialect::Dialect;
pub use settings::MachineFacts;
pub use view::{
    ContactsView, InputsView, MachineAct, MachinePhase, MachineView, MotionCheck, ProbeEnd,
};
