//! `trirrr stream` and `trirrr device`, each as a process of its own, over TCP and over a
//! serial port.

mod commands;
mod common;
mod faults;
mod homing;
mod links;
mod proxy;
mod values;
