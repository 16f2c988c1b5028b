//! Constants of the scene: its rate, the coefficients and settings of its service, and the types `Scalar`,
//! `Model`. The build script writes them from the file that `SCENE` names.
#![allow(missing_docs, clippy::approx_constant, clippy::excessive_precision)]

include!(concat!(env!("OUT_DIR"), "/scene.rs"));
