//! Messages between a host and a machine, and the frames that carry them.
//!
//! [`message`] defines commands, replies, events and telemetry. [`wire`] turns a message into a
//! frame of bytes and back. Neither allocates, and neither knows a device.
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![no_std]

#[cfg(test)]
extern crate std;

pub mod message;
pub mod wire;
