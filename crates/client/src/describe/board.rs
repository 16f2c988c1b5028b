//! Words for what a board reports of itself.

use trirrr_protocol::message::{
    AngleReference, Clock, Firmware, Message, Registers, Request, Start,
};
use trirrr_protocol::wire::schema::key;
use trirrr_scene::{NumberType, in_number_type, visible};

/// Returns the number type of a board whose messages have the layout `schema`; none of another version.
pub fn number_type(schema: u64) -> Option<NumberType> {
    let layout = |number| in_number_type!(number, N => key::<Request<N>, Message<N>>());
    let mut types = NumberType::ALL.into_iter();
    types.find(|number| layout(*number) == schema)
}

/// Describes a clock that is not as it should be.
pub fn clock(clock: Clock) -> Option<&'static str> {
    match clock {
        Clock::Host | Clock::Crystal | Clock::Emulated => None,
        Clock::Internal => {
            Some("the crystal does not start: the internal oscillator serves, some 1 % off")
        }
        Clock::Slow => Some(
            "neither the crystal nor the PLL starts: the internal oscillator serves, some 1 % off, \
             and the board is slow",
        ),
        Clock::WrongCrystal => Some(
            "the crystal has another frequency than crystal_mhz in the board file: check that key against the part on \
             the board; the internal oscillator serves, some 1 % off",
        ),
    }
}

/// Describes what nobody has measured of where the motors are.
pub fn reference(reference: AngleReference) -> Option<&'static str> {
    match reference {
        AngleReference::Blind => Some(
            "homed without a signal: nothing has told that the motors reached their stops; compare a pose with the machine",
        ),
        AngleReference::Declared | AngleReference::Homed | AngleReference::Measured => None,
    }
}

/// Describes the build of the program: version, commit, board and chip.
pub fn firmware(firmware: &Firmware) -> String {
    let version = name(&firmware.version);
    let board = name(&firmware.board);
    // A simulator has no chip.
    if firmware.chip == Firmware::SIMULATOR.chip {
        return format!("{version}, {board}");
    }
    let commit = match name(&firmware.commit) {
        commit if commit.is_empty() => "built without git".into(),
        commit => match commit.strip_suffix("-dirty") {
            Some(clean) => format!("commit {clean} with changes"),
            None => format!("commit {commit}"),
        },
    };
    format!(
        "{version}, {commit}, board {board}, chip {}",
        name(&firmware.chip)
    )
}

/// Describes the cause of the last start of the board.
pub fn start(start: &Start) -> String {
    match start {
        Start::Power => "it was switched on".into(),
        Start::Reset => "it was reset, or its supply sagged".into(),
        Start::Watchdog => {
            "its watchdog: ticks did not come in time, or its clock was far too slow".into()
        }
        Start::Panic { file, line } => {
            format!("a panic in {}, line {line}", name(file))
        }
        Start::HardFault(registers) => format!("a hard fault{}", at(registers)),
        Start::StackOverflow(registers) => format!("its stack ran over{}", at(registers)),
        Start::CrystalStopped => {
            "its crystal stopped while it ran: the internal oscillator serves until the next reset"
                .into()
        }
        Start::LowSupply => "the supply of its chip fell below 2.7 V".into(),
    }
}

/// Returns the text before the first zero. It is a board's own: nothing in it may command a terminal.
pub fn name(bytes: &[u8]) -> String {
    let length = bytes.iter().position(|byte| *byte == 0);
    let bytes = &bytes[..length.unwrap_or(bytes.len())];
    visible(&String::from_utf8_lossy(bytes)).into_owned()
}

fn at(registers: &Registers) -> String {
    let Registers {
        pc,
        lr,
        sp,
        status,
        address,
    } = registers;
    format!(
        " at {pc:#010x}, called from {lr:#010x}, stack {sp:#010x}, status {status:#010x}, \
         address {address:#010x}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_protocol::message::NAME_CAPACITY;

    #[test]
    fn a_panic_names_its_place() {
        let mut file = [0; NAME_CAPACITY];
        file[..7].copy_from_slice(b"line.rs");
        let panic = Start::Panic { file, line: 12 };
        assert_eq!(start(&panic), "a panic in line.rs, line 12");
        // As long as there is room: no zero behind it.
        let long = Start::Panic {
            file: [b'a'; NAME_CAPACITY],
            line: 1,
        };
        assert_eq!(start(&long).len(), "a panic in , line 1".len() + 32);
        assert!(panic.is_failure() && !Start::Power.is_failure());
    }

    #[test]
    fn a_board_commands_no_terminal() {
        let mut file = [0; NAME_CAPACITY];
        let hostile = "\u{1b}]0;x\u{7}\u{9b}31m\r\n\u{7f}";
        file[..hostile.len()].copy_from_slice(hostile.as_bytes());
        let said = start(&Start::Panic { file, line: 1 });
        assert_eq!(
            said,
            "a panic in \\u{1b}]0;x\\u{7}\\u{9b}31m\\u{d}\\u{a}\\u{7f}, line 1"
        );
        // What is no text at all.
        let file = [0x9b; NAME_CAPACITY];
        let said = start(&Start::Panic { file, line: 1 });
        assert!(!said.contains(char::is_control), "{said:?}");
    }

    #[test]
    fn a_build_names_its_commit_and_its_board() {
        let of = |commit| Firmware::new("0.2.0", commit, "feather-f405", "stm32f405rg");
        for (commit, text) in [
            ("13154213b7", "commit 13154213b7"),
            ("13154213b7-dirty", "commit 13154213b7 with changes"),
            ("", "built without git"),
        ] {
            assert_eq!(
                firmware(&of(commit)),
                format!("0.2.0, {text}, board feather-f405, chip stm32f405rg")
            );
        }
        let simulator = firmware(&Firmware::SIMULATOR);
        assert!(simulator.ends_with(", simulator"), "{simulator}");
    }

    #[test]
    fn a_hard_fault_names_its_registers() {
        let registers = Registers {
            pc: 0x0800_1234,
            lr: 0x0800_4321,
            sp: 0x2000_0010,
            status: 0x8200,
            address: 0x4000_0000,
        };
        assert_eq!(
            start(&Start::HardFault(registers)),
            "a hard fault at 0x08001234, called from 0x08004321, stack 0x20000010, status \
             0x00008200, address 0x40000000"
        );
    }
}
