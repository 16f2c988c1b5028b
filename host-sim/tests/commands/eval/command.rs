//! The command: where it writes, and how it ends.

use super::{MACHINE, MACHINE_HEADER, STATE, STATE_HEADER};
use std::fs;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;
use trirrr_host_sim::eval::evaluate;
use trirrr_host_sim::failure::CliError;
use trirrr_scene::NumberType;

#[test]
fn a_reader_that_stops_reading_is_no_error_and_a_full_disk_is() {
    struct Refusing(std::io::ErrorKind);
    impl std::io::Write for Refusing {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(self.0.into())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Err(self.0.into())
        }
    }
    let cases = format!("{MACHINE_HEADER},{STATE_HEADER}\n{MACHINE},{STATE}\n");
    let into = |kind| evaluate(NumberType::F64, "c", cases.as_bytes(), &mut Refusing(kind));
    assert!(into(std::io::ErrorKind::BrokenPipe).is_ok());
    assert!(matches!(
        into(std::io::ErrorKind::StorageFull),
        Err(CliError::Failed(_))
    ));
}

fn eval(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trirrr"))
        .arg("eval")
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("trirrr starts")
}

#[test]
fn standard_input_is_a_table_and_one_without_numbers_fails() {
    let folder = TempDir::new().unwrap();
    let evaluated = |row: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trirrr"))
            .args(["eval", "-"])
            .current_dir(folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("trirrr starts");
        let cases = format!("{MACHINE_HEADER},{STATE_HEADER}\n{row}");
        let mut input = command.stdin.take().unwrap();
        input.write_all(cases.as_bytes()).unwrap();
        drop(input);
        let output = command.wait_with_output().unwrap();
        let [said, told] = [output.stdout, output.stderr].map(String::from_utf8);
        (output.status.code(), said.unwrap(), told.unwrap())
    };
    // 90 m away.
    let (good, bad) = (
        format!("{MACHINE},{STATE}\n"),
        format!("{MACHINE},9{STATE}\n"),
    );
    let (code, said, told) = evaluated(&format!("{good}{bad}"));
    assert_eq!(code, Some(0), "{told}");
    assert_eq!(said.lines().count(), 3);
    assert!(told.contains("-: 1 of 2 rows ok"), "{told}");
    let (code, said, told) = evaluated(&bad);
    assert_eq!(code, Some(1), "{told}");
    assert!(said.contains("1,unreachable: leg"), "{said}");
    assert!(told.contains("no row has numbers"), "{told}");
    assert_eq!(evaluated("").0, Some(0));
}

#[test]
fn the_command_writes_where_it_is_told_and_never_over_its_cases() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let cases = format!("case,{MACHINE_HEADER},{STATE_HEADER}\nstart,{MACHINE},{STATE}\n");
    fs::write(path.join("cases.csv"), &cases).unwrap();

    let to_stdout = eval(&["cases.csv"], path);
    assert_eq!(to_stdout.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&to_stdout.stdout).contains("\nstart,ok,"));
    let to_file = eval(
        &["cases.csv", "--scalar", "f64", "--out", "results.csv"],
        path,
    );
    assert_eq!(to_file.status.code(), Some(0));
    assert!(to_file.stdout.is_empty());
    assert_eq!(
        fs::read(path.join("results.csv")).unwrap(),
        to_stdout.stdout
    );

    for scalar in ["f32", "fixed", "micromath"] {
        let output = eval(&["cases.csv", "--scalar", scalar], path);
        assert_eq!(output.status.code(), Some(0), "{scalar}");
        let results = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(results.contains("\nstart,ok,"), "{scalar}: {results}");
        assert_ne!(output.stdout, to_stdout.stdout, "{scalar} rounds as f64");
    }

    let to_arrow = eval(&["cases.csv", "--out", "results.arrow"], path);
    assert_eq!(to_arrow.status.code(), Some(0));
    let arrow = fs::read(path.join("results.arrow")).unwrap();
    assert!(arrow.starts_with(b"ARROW1") && arrow.ends_with(b"ARROW1"));
    // By its ending, not by its contents.
    fs::copy(path.join("cases.csv"), path.join("cases.arrow")).unwrap();

    let over = eval(&["cases.csv", "--out", "./cases.csv"], path);
    assert_eq!(over.status.code(), Some(2));
    assert_eq!(fs::read_to_string(path.join("cases.csv")).unwrap(), cases);

    for (arguments, code, message) in [
        (&["missing.csv"][..], 2, "missing.csv: cannot be read"),
        (&["cases.csv", "--scalar", "f16"], 2, "f16"),
        (
            &["cases.csv", "--out", "results.parquet"],
            2,
            "--out results.parquet: .parquet files are not supported; use .csv",
        ),
        (
            &["cases.arrow"],
            2,
            "cases.arrow: cannot be read as an Arrow IPC file",
        ),
        (
            &["cases.csv", "--out", "no/such/folder.csv"],
            1,
            "folder.csv: cannot be written",
        ),
        (&[], 2, "CASES.csv"),
    ] {
        let output = eval(arguments, path);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(stderr.contains(message), "{arguments:?}: {stderr}");
    }
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_does_not_panic() {
    let folder = TempDir::new().unwrap();
    // More than a pipe holds.
    let rows = format!("{MACHINE},{STATE}\n").repeat(2000);
    let cases = format!("{MACHINE_HEADER},{STATE_HEADER}\n{rows}");
    fs::write(folder.path().join("cases.csv"), cases).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_trirrr"))
        .args(["eval", "cases.csv"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut some = [0; 100];
    let mut pipe = child.stdout.take().unwrap();
    pipe.read_exact(&mut some).unwrap();
    drop(pipe);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(!String::from_utf8_lossy(&output.stderr).contains("panicked"));
}
