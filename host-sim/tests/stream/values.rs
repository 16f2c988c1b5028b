//! What is streamed is what is run.

use crate::common::{Device, run, scene, stream, text, ticks};

/// Every sample of a board is the tick of the run, in the bits: another process, a line between,
/// the same core.
#[test]
fn telemetry_is_the_ticks_of_the_run() {
    let fixed: &[_] = &[("number = \"f64\"", "number = \"fixed\"")];
    let cases = [
        ("thesis", 1, &[] as &[_]),
        ("thesis", 1, fixed),
        ("vertical", 5, &[]),
        ("chained", 22, &[]),
    ];
    for (name, moves, edits) in cases {
        let folder = scene(name, edits);
        let device = Device::start(&folder, &["--speed", "5"]);
        let output = stream(&folder, &device.address, &[]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert_eq!(
            ticks(&folder.path().join("out")),
            run(&folder),
            "samples of {name}"
        );
        let summary = text(&output.stdout);
        for part in [
            &format!("{moves} of {moves} moves done\n") as &str,
            "one every tick, 0 missing",
            "0 frames damaged",
            "machine.svg",
        ] {
            assert!(summary.contains(part), "{part} in\n{summary}");
        }
        assert!(!summary.contains("warning"), "{summary}");
    }
}

#[test]
fn a_sample_every_few_ticks_is_every_few_ticks_of_the_run() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &["--speed", "5"]);
    let output = stream(&folder, &device.address, &["--telemetry", "7"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("one every 7 ticks, 0 missing"));
    let (streamed, whole) = (ticks(&folder.path().join("out")), run(&folder));
    let rows: Vec<&str> = whole.lines().collect();
    let kept: Vec<usize> = streamed
        .lines()
        .map(|row| rows.iter().position(|other| *other == row).expect(row))
        .collect();
    // The header, and 101 ticks in steps of 7 from wherever the machine's own count puts them.
    assert!((15..=16).contains(&kept.len()), "{kept:?}");
    assert!(kept[1..].windows(2).all(|pair| pair[1] - pair[0] == 7));
}

/// The tool's power is that of the scene at full speed, in proportion below, and 0 without.
#[test]
fn the_laser_follows_the_speed() {
    let folder = scene("chained", &[]);
    let table = run(&folder);
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|other| *other == name).unwrap();
    let (vx, vy, tool) = (column("vx"), column("vy"), column("tool"));
    let mut on = 0;
    for row in table.lines().skip(1) {
        let row: Vec<f64> = row.split(',').map(|field| field.parse().unwrap()).collect();
        if row[tool] == 0.0 {
            continue;
        }
        on += 1;
        // 0.6 at 0.1 m/s, in f32: a few roundings of 2^-24.
        let expected = 6.0 * row[vx].hypot(row[vy]);
        let error = (row[tool] - expected).abs() / expected;
        assert!(error < 8.0 * f64::from(f32::EPSILON), "{row:?}");
    }
    // Ticks of the outline and the circle: a tick between two moves belongs to the later one.
    assert_eq!(on, 700 + 4 * 331 + 2 * 500 + 1000 + 300 + 8 * 199);
}
