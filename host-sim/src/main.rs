//! `trirrr`: plays scenes and G-code, talks to machines; hands over what it is built without.

#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    trirrr_host_sim::program::main()
}
