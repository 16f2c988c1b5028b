//! The scene: its rate, the coefficients and settings of its service, and the types `Scalar`,
//! `Payload`, `Links` that it needs. Written by the build script from the file that `SCENE` names.
#![allow(
    missing_docs,
    unreachable_pub,
    clippy::approx_constant,
    clippy::excessive_precision
)]
// On a host there is only the name to tell.
#![cfg_attr(not(target_os = "none"), allow(dead_code))]

include!(concat!(env!("OUT_DIR"), "/scene.rs"));
