//! The scene: its rate, the coefficients and settings of its service, and the types `Scalar`,
//! `Payload`, `Links` that it needs. Written by the build script from the file that `SCENE` names.
#![allow(missing_docs, clippy::approx_constant, clippy::excessive_precision)]

include!(concat!(env!("OUT_DIR"), "/scene.rs"));
