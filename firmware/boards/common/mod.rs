//! Code that all boards share. The package of a board has the modules `board`, `drives`, `pins` and `tool`, and brings these into its root.

#[cfg(digital)]
pub(crate) mod digital;
pub(crate) mod inputs;
pub(crate) mod outputs;
pub(crate) mod wiring;
