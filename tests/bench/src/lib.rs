//! The thesis machine with the service and its end of the line, for tests that maltreat them.
//!
//! | module | what |
//! |---|---|
//! | [`device`] | both halves of the service and the decoder in front of them, in one thread |
//! | [`faulty_link`] | a line that drops, doubles, reorders, cuts and corrupts frames |
//! | [`job`] | random jobs |
//! | [`trajectory_checker`] | watches every tick of a job |
//! | [`sent`] | checks that what was heard was sent |
//! | [`targets`] | functions that a fuzzer calls with its bytes, and what has to hold then |
#![forbid(unsafe_code)]

pub mod device;
pub mod faulty_link;
pub mod job;
pub mod sent;
pub mod slow_link;
pub mod targets;
pub mod trajectory_checker;
