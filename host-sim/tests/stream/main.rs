//! `trirrr stream` and `trirrr device`, each as a process of its own, over TCP and over a
//! serial port.

mod commands;
mod common;
mod drives;
mod faults;
mod goals;
mod homing;
mod hostile;
mod limits;
mod links;
mod paths;
mod proxy;
mod resume;
mod values;
