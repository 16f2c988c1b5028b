//! Messages between a host and a machine, and the frames that carry them.
//!
//! [`message`] defines commands, replies, events and telemetry. [`wire`] turns a message into a
//! frame of bytes and back. Neither allocates, and neither knows a device.
#![no_std]

#[cfg(test)]
extern crate std;

pub mod message;
pub mod wire;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
