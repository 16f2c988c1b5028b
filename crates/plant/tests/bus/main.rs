//! Drives on a bus: the code of an image against state machines from the makers' documents, with faults.

mod bench;
mod faults;
mod loops;
mod restarts;
mod sequence;
mod service;
mod stepped;
mod traffic;
