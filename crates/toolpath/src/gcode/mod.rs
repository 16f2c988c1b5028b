//! G-code, line by line, in the manner of GRBL's laser mode and of LinuxCNC.
//!
//! An [`Interpreter`] turns a line into elements of a tool path. [`elements`] reads a whole file. The machine moves in
//! x, y and alpha: words are X, Y and A. What is not in this table is refused with line, word and reason, and a refused
//! line changes nothing.
//!
#![doc = include_str!("words.md")]
mod arc;
mod arc_across;
mod arc_block;
mod axis_words;
mod block;
mod codes;
mod coordinates;
mod dialect;
mod file;
mod frames;
mod height;
mod height_words;
mod interpreter;
mod lines;
mod modal;
mod motion;
mod pins;
mod refusal;
mod run;
mod setup;
mod state;
mod text;
mod uses;
mod words;

pub use codes::ProgramEnd;
pub use file::{GcodeFile, GcodeRemarks, elements};
pub use interpreter::{Interpreter, LineWork};
pub use modal::{FeedMode, LaserMode, LengthUnit, Modal, MotionMode, PathMode, Plane};
pub use refusal::{GcodeRefusal, RefusalKind};
pub use setup::{GcodeSetup, ORIGINS, ZWords};
pub use state::ProgramFacts;
