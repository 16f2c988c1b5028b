//! From power-on to a host, and with other crystals.

use super::{OSCILLATOR_HZ, Row, Subject, fact, name, never_on};
use crate::chip::{Crystal, Kind, ResetCause};
use crate::host::BAUD;
use crate::time::MS;
use crate::usb::UsbHost;
use anyhow::{Result, ensure};
use trirrr_protocol::message::Start;

/// Causes of a reset that a board at rest may meet.
const CAUSES: [ResetCause; 5] = [
    ResetCause::Power,
    ResetCause::Pin,
    ResetCause::BrownOut,
    ResetCause::Watchdog,
    ResetCause::Software,
];

/// No output is on before a host enables the machine, whatever the reset, and the board tells its cause.
pub(super) fn rest(subject: &Subject) -> Result<Vec<Row>> {
    let outputs = subject.outputs();
    let mut rows = Vec::new();
    for cause in CAUSES {
        let mut board = subject.switch_on()?;
        if cause != ResetCause::Power {
            board.run(100 * MS)?;
            board.reset(cause)?;
        }
        let since = board.now();
        board.run(since + 200 * MS)?;
        let what = format!("200 ms without a host after {}", name(cause));
        rows.push(never_on(&board, &outputs, "power-up", what, since));
        let mut host = subject.host(&mut board)?;
        let now = board.now();
        host.run(&mut board, now + 30 * MS)?;
        let start = host
            .client()
            .identity()
            .map(|identity| identity.board.start);
        let expected = match cause {
            ResetCause::Power => Start::Power,
            // Power-on and brown-out have one flag there.
            ResetCause::BrownOut if subject.kind == Kind::Stm32g474 => Start::Power,
            ResetCause::BrownOut => Start::LowSupply,
            ResetCause::Watchdog => Start::Watchdog,
            _ => Start::Reset,
        };
        let subject = format!("start in the identity after {}", name(cause));
        let start = start.map_or("none".into(), |start| format!("{start:?}"));
        rows.push(fact("power-up", &subject, start, &format!("{expected:?}")));
        let unknown = &board.chip().unknown;
        ensure!(
            unknown.is_empty(),
            "registers that are not modelled: {unknown:?}"
        );
    }
    Ok(rows)
}

/// Clock and baud rate with the crystal, without, and with one that dies at speed.
pub(super) fn crystal(subject: &Subject) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    let right = subject.kind.crystal();
    let boots: [(&str, Crystal, &str); 5] = [
        ("crystal as in the board file", right, "Crystal"),
        ("crystal missing", Crystal::Missing, "Internal"),
        (
            "crystal of 12 MHz",
            Crystal::Runs { mhz: 12 },
            "WrongCrystal",
        ),
        ("crystal of 6 MHz", Crystal::Runs { mhz: 6 }, "WrongCrystal"),
        (
            "crystal of 26 MHz",
            Crystal::Runs { mhz: 26 },
            "WrongCrystal",
        ),
    ];
    // Only the STM32F405 measures its crystal.
    let count = match subject.kind {
        Kind::Stm32f405 => boots.len(),
        Kind::Stm32g474 => 2,
    };
    for (what, crystal, expected) in boots.into_iter().take(count) {
        let mut board = subject.switch_on_with(&subject.image, crystal, OSCILLATOR_HZ[0])?;
        let mut host = subject.host(&mut board)?;
        let now = board.now();
        host.run(&mut board, now + 30 * MS)?;
        if subject.has_usb {
            let is_open = board.chip().plug.as_ref().is_some_and(UsbHost::is_open);
            // The internal oscillator of an STM32F405 is not exact enough for USB. The STM32G474 has one of its own for that.
            let expected = expected == "Crystal" || subject.kind == Kind::Stm32g474;
            rows.push(fact(
                "crystal",
                &format!("{what}: a host finds the port"),
                is_open.to_string(),
                &expected.to_string(),
            ));
            continue;
        }
        let clock = host
            .client()
            .identity()
            .map(|identity| identity.board.clock);
        let clock = clock.map_or("none".into(), |clock| format!("{clock:?}"));
        rows.push(fact("crystal", &format!("{what}: clock"), clock, expected));
        let baud = board.chip().line_baud().unwrap_or(0.0);
        let off = (baud / BAUD - 1.0) * 100.0;
        rows.push(Row {
            case: "crystal",
            subject: format!("{what}: baud rate of the line"),
            measured: format!("{off:+.2} %"),
            bound: "± 2 %".into(),
            holds: off.abs() <= 2.0,
        });
    }
    Ok(rows)
}
