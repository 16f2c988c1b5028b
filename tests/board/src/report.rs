//! What a board says of itself: why it started, and which fault it has latched.

use crate::expected::Expected;
use crate::port::Port;
use anyhow::{Result, bail};
use std::time::{Duration, Instant};
use trirrr_client::describe::{self, Units};
use trirrr_client::local::HostNumber;
use trirrr_protocol::message::{Command, Identity, Reply, Status};

/// From one look at the board to the next, while nothing has happened.
const LOOK: Duration = Duration::from_millis(100);

/// Asks the board until it has failed, or for `patience`, and prints what it says.
pub(crate) fn run<N: HostNumber>(
    expected: &Expected<N>,
    mut port: Port,
    patience: Duration,
) -> Result<()> {
    port.wait_for_board::<N>()?;
    let start = Instant::now();
    loop {
        // A board that starts anew in between knows of no hello.
        if let Some((identity, status)) = ask(expected, &mut port)? {
            let failed = identity.board.start.is_failure() || status.fault.is_some();
            if failed || start.elapsed() > patience {
                print(&identity, &status);
                return Ok(());
            }
        }
        std::thread::sleep(LOOK);
    }
}

/// Both answers; none where one does not come.
fn ask<N: HostNumber>(
    expected: &Expected<N>,
    port: &mut Port,
) -> Result<Option<(Identity, Status<N>)>> {
    let hello = Command::<N>::Hello(expected.hello);
    let identity = match port.ask(u32::MAX / 2, hello)? {
        Some(Reply::Hello(identity)) => identity,
        Some(reply) => bail!("the board answers a hello with {reply:?}"),
        None => return Ok(None),
    };
    match port.ask(identity.next_sequence, Command::<N>::Status)? {
        Some(Reply::Status(status)) => Ok(Some((identity, status))),
        _ => Ok(None),
    }
}

fn print<N: HostNumber>(identity: &Identity, status: &Status<N>) {
    let units = Units::of(identity);
    println!(
        "firmware: {}",
        describe::board::firmware(&identity.firmware)
    );
    println!("clock: {:?}", identity.board.clock);
    println!("start: {}", describe::board::start(&identity.board.start));
    println!("state: {}", describe::state(status.state, status.acting));
    match &status.fault {
        Some(fault) => println!("fault: {}", describe::fault(fault, &units)),
        None => println!("fault: none"),
    }
}
