//! `trirrr stream` and `trirrr device`, each as a process of its own, over TCP and over a
//! serial port.

#![allow(clippy::disallowed_methods)]

mod bridge;
mod calibrated;
mod commands;
mod common;
mod drives;
mod faults;
mod goals;
mod guarded;
mod homing;
#[cfg(target_os = "linux")]
mod hostile;
mod jobs;
mod keys;
mod limits;
mod links;
mod long;
mod outputs;
mod paths;
mod probing;
mod proxy;
mod resume;
mod texts;
mod tools;
mod values;
mod watching;
