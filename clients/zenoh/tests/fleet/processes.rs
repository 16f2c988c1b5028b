//! Programs of the test: the router, and the machines.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for a program to say that it is ready.
const READY: Duration = Duration::from_secs(30);

/// A program that ends with the test.
pub(crate) struct Program(Child);

impl Program {
    fn start(command: &mut Command, ready: &str) -> Self {
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let begin = Instant::now();
        loop {
            let line = lines.next().expect("the program has ended").unwrap();
            if line.contains(ready) {
                break;
            }
            assert!(begin.elapsed() < READY, "{ready} is not said");
        }
        Self(child)
    }

    /// Ends the program at once, as a failure of its computer does.
    pub(crate) fn kill(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Address of a router that listens at a free port.
pub(crate) fn free_endpoint() -> String {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    format!("tcp/{}", listener.local_addr().unwrap())
}

/// Starts a router.
pub(crate) fn router(endpoint: &str) -> Program {
    router_with(endpoint, &[])
}

/// Starts a router with other arguments.
pub(crate) fn router_with(endpoint: &str, arguments: &[&str]) -> Program {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trirrr-zenoh-router"));
    command.args(["--listen", endpoint]).args(arguments);
    Program::start(&mut command, "router")
}

/// Starts the program with machines; what it complains of goes to `log`.
pub(crate) fn fleet(endpoint: &str, arguments: &[&str], log: &Path) -> Program {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trirrr-zenoh"));
    command.args(["--connect", endpoint]).args(arguments);
    command.stderr(File::create(log).unwrap());
    Program::start(&mut command, "machines below")
}
