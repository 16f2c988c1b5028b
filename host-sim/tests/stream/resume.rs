//! Jobs that are left on their way, and go on.

use crate::common::{Device, Streaming, run, scene, stream, text, ticks};
use std::path::Path;
use tempfile::TempDir;

/// Slower than the machine is: on a busy host neither is it done before it is looked at, nor is a stream that lives taken for silent.
const SLOW: [&str; 2] = ["--speed", "0.5"];

/// A folder with the chained job, whose host may be silent for half a second of the machine's time.
fn chained() -> TempDir {
    let folder = scene("chained", &[]);
    let file = folder.path().join("scene.toml");
    let scene = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, scene.replace("timeout_s = 600", "timeout_s = 0.5")).unwrap();
    folder
}

/// Rows of a table without the time, which counts from the first sample of each stream.
fn rows(table: &str) -> Vec<String> {
    let behind = |row: &str| row.split_once(',').unwrap().1.to_owned();
    table.lines().skip(1).map(behind).collect()
}

fn resumed(folder: &TempDir, number: u32) -> Vec<String> {
    let out = folder.path().join(format!("out/resumed-{number}"));
    rows(&ticks(&out))
}

fn journal(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("out/job.json")).unwrap()
}

/// A stream that is killed: the machine comes to rest on its path and waits. Another stream attaches, and the job goes on at the very
/// bit: what it plays at normal speed is what is left of the job.
#[test]
fn a_job_goes_on_where_its_host_was_killed() {
    let folder = chained();
    let mut device = Device::start(&folder, &SLOW);
    let streaming = Streaming::start(&folder, &device.address, &[]);
    device.lines.wait_for("5 moves done");
    streaming.process.kill();
    device.lines.wait_for("holding (host silent)");
    assert!(journal(folder.path()).contains("\"reached\""));
    let output = stream(&folder, &device.address, &["--resume"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary = text(&output.stdout);
    assert!(summary.contains("22 of 22 moves done\n"), "{summary}");
    assert!(!folder.path().join("out/job.json").exists());
    let (whole, played) = (rows(&run(&folder)), resumed(&folder, 1));
    // From the end of the ramp on, to the end.
    let ramp = 300;
    let left = &played[ramp..];
    assert!(left.len() > 1000 && left.len() < whole.len());
    assert_eq!(left, &whole[whole.len() - left.len()..]);
    // There is nothing to go on with now.
    let output = stream(&folder, &device.address, &["--resume"]);
    assert_eq!(output.status.code(), Some(2));
    let message = text(&output.stderr);
    assert!(message.contains("there is no job to resume"), "{message}");
}

/// A machine that has dropped the job goes back to where it was left, with the tool off until there.
#[test]
fn a_job_goes_on_after_a_stop_and_after_a_power_cut() {
    let folder = chained();
    let mut device = Device::start(&folder, &SLOW);
    let mut streaming = Streaming::start(&folder, &device.address, &["--keys"]);
    device.lines.wait_for("5 moves done");
    {
        use std::io::Write;
        writeln!(streaming.process.0.stdin.as_mut().unwrap(), "stop").unwrap();
    }
    device.lines.wait_for("idle (");
    assert_eq!(streaming.process.code(), Some(0));
    let mut second = Streaming::start(&folder, &device.address, &["--resume", "--recover", "0.5"]);
    second
        .lines
        .wait_for("the machine has lost the job: back to move");
    device.lines.wait_for("running");
    // Into what was not played yet.
    device.lines.wait_for("12 moves done");
    second.process.kill();
    // A power cut of the machine: it knows of nothing any more.
    device.process.kill();
    let device = Device::start(&folder, &SLOW);
    let output = stream(&folder, &device.address, &["--resume", "--recover", "0.5"]);
    let message = text(&output.stderr);
    assert!(output.status.success(), "{message}");
    assert!(
        message.contains("the machine has lost the job: back to move"),
        "{message}"
    );

    let whole = rows(&run(&folder));
    let tool = |row: &str| row.rsplit(',').next().unwrap().parse::<f64>().unwrap();
    let played = resumed(&folder, 2);
    // The job has no rest on its way: the way back begins where the job does.
    assert_eq!(played[0], whole[0]);
    // On a busy machine the queue may run dry: the hold on the path and the way out of it take ticks of their own.
    assert!(played.len() >= whole.len(), "{}", played.len());
    // The end of the job is that of a whole one, with the tool.
    assert_eq!(&played[played.len() - 500..], &whole[whole.len() - 500..]);
    // On the way back the tool is off: where a whole job has it on, up to the place that was reached.
    let on = |row: &&String| tool(row) != 0.0;
    let first = |rows: &[String]| rows.iter().position(|row| on(&row)).unwrap();
    let moves_done = 12 * whole.len() / 22;
    assert!(first(&whole) < 1000);
    assert!(first(&played) > moves_done / 2, "{}", first(&played));
}

/// A journal is of one job: another scene, or another number type, is refused before anything moves.
#[test]
fn another_job_is_not_resumed() {
    let folder = chained();
    let mut device = Device::start(&folder, &SLOW);
    let streaming = Streaming::start(&folder, &device.address, &[]);
    device.lines.wait_for("2 moves done");
    streaming.process.kill();
    let file = folder.path().join("scene.toml");
    let scene = std::fs::read_to_string(&file).unwrap();
    let other = scene.replacen("x_m = 0.2", "x_m = 0.20001", 1);
    assert_ne!(scene, other);
    std::fs::write(&file, other).unwrap();
    let output = stream(&folder, &device.address, &["--resume"]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stdout));
    let message = text(&output.stderr);
    assert!(message.contains("it is of another job"), "{message}");
    streaming.lines.rest();
}

/// A journal that is cut off, changed or something else tells no place, and is said to be damaged. A stream from the start does not
/// replace what it did not write. Neither needs a machine.
#[test]
fn a_damaged_journal_is_named_as_such_and_stays() {
    let folder = chained();
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    let contents: [&[u8]; 6] = [
        b"",
        b"{",
        b"\0\xff\xfe",
        b"[1, 2]",
        b"{\"scene\": \"chained\"}",
        b"of the user",
    ];
    for content in contents {
        std::fs::write(out.join("job.json"), content).unwrap();
        for (more, said) in [
            (&["--resume"][..], "it is damaged"),
            (&[], "is no journal as `trirrr stream` writes it, and stays"),
        ] {
            let output = stream(&folder, "tcp:127.0.0.1:9", more);
            let message = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(message.contains(said), "{content:?}: {message}");
            assert_eq!(std::fs::read(out.join("job.json")).unwrap(), content);
        }
    }
}

/// Telemetry of a machine is not replaced by a simulation, nor a simulation by telemetry, before anything moves.
#[test]
fn a_stream_is_refused_in_the_folder_of_a_run() {
    let folder = chained();
    let table = run(&folder);
    std::fs::rename(folder.path().join("run"), folder.path().join("out")).unwrap();
    let device = Device::start(&folder, &[]);
    let output = stream(&folder, &device.address, &[]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("the results of `trirrr run`"), "{message}");
    assert_eq!(ticks(&folder.path().join("out")), table);
}
