//! `trirrr-full`: every command and every kind of file.

#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    trirrr_host_sim::program::main()
}
