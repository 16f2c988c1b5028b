//! Answers to lines in all states, and their table in `docs/grbl.md`.

use crate::machine::Machine;
use crate::table::{BEHAVIOUR, DIFFERENT, EQUAL, MEANINGS};
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

/// Most deliberate differences.
const MOST_DIFFERENCES: usize = 15;

/// A machine in a state of GRBL, with lines that come before.
fn machine_in(state: &str, before: &str) -> Machine {
    let mut machine = Machine::new();
    if state != "Alarm" {
        machine.send(b"$X\n");
    }
    machine.send(format!("{before}\n").as_bytes());
    machine.motion_time = Duration::from_secs(1000);
    let begin: &[u8] = match state {
        "Run" => b"G1 X1 F100\n",
        "Jog" => b"$J=X1F100\n",
        "Hold" => b"!",
        "Door" => b"\x84",
        "Check" => b"$C\n",
        "Sleep" => b"$SLP\n",
        _ => b"",
    };
    machine.now(begin);
    machine.pass(Duration::from_millis(100));
    machine.pass(Duration::from_millis(100));
    let shown = machine.state();
    assert_eq!(shown.split(':').next(), Some(state));
    machine.motion_time = Duration::ZERO;
    machine
}

/// Answer to a line: `ok`, or the number of the error. A pause is ended by the user.
fn answer(state: &str, before: &str, line: &str) -> String {
    let mut machine = machine_in(state, before);
    let mut said = machine.now(format!("{line}\n").as_bytes());
    for byte in [b"".as_slice(), b"", b"~", b""] {
        said += &machine.now(byte);
        said += &machine.pass(Duration::from_secs(2));
    }
    let answers: Vec<&str> = said
        .lines()
        .filter_map(|line| {
            line.strip_prefix("error:")
                .or((line == "ok").then_some(line))
        })
        .collect();
    assert_eq!(answers.len(), 1, "{state}, {before:?}, {line:?}: {said}");
    answers[0].to_owned()
}

#[test]
fn answers_are_those_of_grbl_but_for_a_list() {
    let mut wrong = Vec::new();
    let (mut lines, mut commands) = (0, 0);
    let mut look = |state: &str, before: &str, line: &str, expected: &str| {
        match line.trim_start().starts_with('$') {
            true => commands += 1,
            false => lines += 1,
        }
        let found = answer(state, before, line);
        if found != expected {
            wrong.push(format!(
                "{state}, {before:?}, {line:?}: {found}, not {expected}"
            ));
        }
    };
    for rows in EQUAL {
        for line in rows.lines {
            look(rows.state, rows.before, line, rows.answer);
        }
    }
    for difference in DIFFERENT {
        for (line, grbl, here) in difference.lines {
            assert_ne!(grbl, here, "{line} is no difference");
            look(difference.state, difference.before, line, here);
        }
    }
    let differences = DIFFERENT.len() + BEHAVIOUR.len();
    println!(
        "{lines} lines and {commands} commands: {} not as the table; {differences} deliberate differences",
        wrong.len()
    );
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(differences <= MOST_DIFFERENCES);
}

/// The table for readers.
fn table() -> String {
    let mut text = String::from("| error | means | for example |\n|---|---|---|\n");
    for (number, meaning) in MEANINGS {
        let equal = EQUAL.iter().filter(|rows| rows.answer == number);
        let examples: Vec<String> = equal
            .flat_map(|rows| {
                rows.lines
                    .iter()
                    .map(move |line| example(rows.state, rows.before, line))
            })
            .take(3)
            .collect();
        // Writing to a String does not fail.
        let _ = writeln!(text, "| {number} | {meaning} | {} |", examples.join(", "));
    }
    text += "\nDeliberate differences from Grbl 1.1h:\n\n| difference | for example: Grbl, and here |\n|---|---|\n";
    for difference in DIFFERENT {
        let examples = difference.lines.iter().take(3).map(|(line, grbl, here)| {
            let line = example(difference.state, difference.before, line);
            format!("{line}: {grbl}, {here}")
        });
        let examples: Vec<String> = examples.collect();
        let _ = writeln!(text, "| {} | {} |", difference.why, examples.join("; "));
    }
    for why in BEHAVIOUR {
        let _ = writeln!(text, "| {why} | |");
    }
    text
}

fn example(state: &str, before: &str, line: &str) -> String {
    let line = match line.len() {
        0..=40 => line.to_owned(),
        _ => format!("{}...", &line[..12]),
    };
    let before = match before {
        "" => String::new(),
        before => format!(" behind `{}`", before.replace('\n', "`, `")),
    };
    match state {
        "Idle" => format!("`{line}`{before}"),
        state => format!("`{line}` in {state}{before}"),
    }
}

#[test]
fn the_table_in_the_manual_is_this_one() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/grbl.md");
    let text = std::fs::read_to_string(&file).unwrap();
    let marks = ["<!-- replies -->\n", "<!-- end of replies -->\n"];
    let (before, rest) = text.split_once(marks[0]).expect("a mark");
    let (found, after) = rest.split_once(marks[1]).expect("the end of it");
    let expected = format!("\n{}\n", table());
    if std::env::var_os("TRIRRR_BLESS").is_some() {
        let text = [before, marks[0], &expected, marks[1], after].concat();
        return std::fs::write(&file, text).unwrap();
    }
    assert_eq!(found, expected, "TRIRRR_BLESS=1 writes the table anew");
}
