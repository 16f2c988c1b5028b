//! The G-code interpreter against values that are worked out by hand.
mod arcs;
mod common;
mod coordinates;
mod damaged;
mod feeds;
mod files;
mod height;
mod inputs;
mod modes;
mod outputs;
mod posts;
mod programs;
mod refusals;
mod syntax;
mod tool;
