//! Code that the images of this package share. It holds their scene, as constants and types, and
//! the tick, alone and in its service, as a caller sees it.
#![no_std]

pub mod drives;
pub mod service;
pub mod tick;

/// The scene: `PARAMETERS`, `MOVES`, `PERIOD`, and the types `Scalar` and `Model` that
/// it needs. Written by the build script from the file that `SCENE` names.
#[allow(missing_docs, clippy::approx_constant, clippy::excessive_precision)]
pub mod scene {
    include!(concat!(env!("OUT_DIR"), "/scene.rs"));
}
