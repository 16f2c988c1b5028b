//! Jobs in files of their own, on the machine of a scene.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;

fn repository(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file)
}

/// Runs `trirrr COMMAND JOB --machine SCENE ARGUMENTS` in `folder`.
fn trirrr(folder: &TempDir, command: &str, job: &Path, arguments: &[&str]) -> Output {
    crate::common::command(folder, &[])
        .arg(command)
        .arg(job)
        .arg("--machine")
        .arg(repository("scenes/engraving.toml"))
        .args(arguments)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Writes `lines` as a job into `folder`, runs it fast, and returns exit code and standard error.
fn run(folder: &TempDir, lines: &str, arguments: &[&str]) -> (i32, String) {
    let file = Path::new("job.ngc");
    fs::write(folder.path().join(file), lines).unwrap();
    let output = trirrr(folder, "run", file, &[&["--fast"], arguments].concat());
    (output.status.code().unwrap(), text(&output.stderr))
}

/// Columns of `ticks.csv`, by name.
fn columns<const N: usize>(folder: &TempDir, job: &str, names: [&str; N]) -> Vec<[f64; N]> {
    let table = fs::read_to_string(folder.path().join("out").join(job).join("ticks.csv")).unwrap();
    let mut rows = table.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let at = names.map(|name| header.iter().position(|each| *each == name).unwrap());
    rows.map(|row| at.map(|column| row[column].parse().unwrap()))
        .collect()
}

/// The same drawing, in a scene and in G-code: the same motion.
#[test]
fn a_drawing_in_g_code_is_played_as_the_one_in_a_scene() {
    let folder = TempDir::new().unwrap();
    let scene = crate::common::command(&folder, &["run", "--fast", "--out", "out/scene"])
        .arg(repository("scenes/engraving.toml"))
        .status();
    assert!(scene.unwrap().success());
    let job = repository("scenes/jobs/plate.ngc");
    let placed = ["--fast", "--origin", "180,245", "--corner", "0"];
    let output = trirrr(&folder, "run", &job, &placed);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let names = ["t", "x", "y", "alpha", "tool"];
    let (of_scene, of_job) = (
        columns(&folder, "scene", names),
        columns(&folder, "plate", names),
    );
    assert_eq!(of_scene.len(), of_job.len());
    for (scene, job) in of_scene.iter().zip(&of_job) {
        // Decimals are rounded on their way from mm to m; f32 has 3e-8 m here.
        let near = |column: usize, most: f64| (scene[column] - job[column]).abs() <= most;
        assert_eq!(scene[0], job[0]);
        assert!(
            near(1, 1e-6) && near(2, 1e-6) && near(3, 1e-6),
            "{scene:?} {job:?}"
        );
        assert!(near(4, 1e-3), "{scene:?} {job:?}");
    }
}

/// The feed is the speed of the tool point; a rapid is as fast as the machine may; the tool is off in it.
#[test]
fn a_feed_is_kept_and_a_rapid_is_faster() {
    let folder = TempDir::new().unwrap();
    let job = "G21 G90\nG0 X260 Y250\nM3 S250 F3000\nG1 X280\nG2 X290 Y260 R10\nG4 P0.05\nM5\nG0 X250 Y245\nM2\n";
    let (code, error) = run(&folder, job, &[]);
    assert_eq!(code, 0, "{error}");
    let rows = columns(&folder, "job", ["t", "x", "y", "vx", "vy", "tool"]);
    let speed = |row: &[f64; 6]| row[3].hypot(row[4]);
    let on: Vec<_> = rows.iter().filter(|row| row[5] > 0.0).collect();
    assert!(
        on.iter()
            .all(|row| row[5] == 0.25 && speed(row) <= 0.05 * (1.0 + 1e-5))
    );
    let fastest = |part: &mut dyn Iterator<Item = &[f64; 6]>| part.map(speed).fold(0.0, f64::max);
    assert!(fastest(&mut on.iter().copied()) > 0.0499);
    assert!(fastest(&mut rows.iter().filter(|row| row[5] == 0.0)) > 0.06);
    // The quarter of a circle ends at (0.29, 0.26), where the tool stays on for 50 ticks.
    let stands = on
        .iter()
        .filter(|row| row[1] == 0.29f32 as f64 && row[2] == 0.26f32 as f64);
    assert!(stands.count() >= 50);
    let last = rows.last().unwrap();
    assert!(
        (last[1] - 0.25).abs() < 1e-6 && (last[2] - 0.245).abs() < 1e-6,
        "{last:?}"
    );
}

#[test]
fn refusals_name_file_line_and_word() {
    let folder = TempDir::new().unwrap();
    for (job, parts) in [
        // Beyond the reach of a leg.
        (
            "G21 G90\nF600\nG1 X255 Y245\nG1 X900\n",
            ["job.ngc:4: ", "leg"],
        ),
        ("G21 G90\nG1 X255 Y245\n", ["job.ngc:2: ", "F"]),
        ("G21\nG1 X255 F600\nG41 X3\n", ["job.ngc:3: ", "G41"]),
        ("G21 (\u{7f}\n", ["job.ngc:1: ", "("]),
        (
            "M5\nM2\n",
            ["job.ngc:", "nothing in the file moves the machine"],
        ),
        ("", ["job.ngc:", "nothing in the file moves the machine"]),
    ] {
        let (code, error) = run(&folder, job, &[]);
        assert_eq!(code, 2, "{job:?}: {error}");
        for part in parts {
            assert!(error.contains(part), "{part:?} of {job:?} in {error}");
        }
        assert!(!folder.path().join("out").exists(), "{job:?} left files");
    }
}

#[test]
fn a_job_and_a_scene_are_told_apart() {
    let folder = TempDir::new().unwrap();
    let scene = repository("scenes/engraving.toml");
    let output = trirrr(&folder, "run", &scene, &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("leave --machine out"));
    let alone = crate::common::command(&folder, &["plan", "job.ngc"])
        .output()
        .unwrap();
    assert_eq!(alone.status.code(), Some(2));
    assert!(text(&alone.stderr).contains("add --machine SCENE.toml"));
    let missing = trirrr(&folder, "plan", Path::new("none.ngc"), &[]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(text(&missing.stderr).contains("none.ngc: cannot be read"));
}

/// Chords of a curve: the motion goes on from one to the next.
#[test]
fn corners_are_rounded_as_far_as_the_user_allows() {
    let folder = TempDir::new().unwrap();
    let mut job = String::from("G21 G90 F6000\n");
    for step in 1..=40 {
        let angle = std::f64::consts::TAU * f64::from(step) / 40.0;
        let (x, y) = (250.0 + 20.0 * angle.sin(), 265.0 - 20.0 * angle.cos());
        job += &format!("G1 X{x:.4} Y{y:.4}\n");
    }
    let mut stops = Vec::new();
    for corner in ["0", "0.02"] {
        let (code, error) = run(&folder, &job, &["--corner", corner]);
        assert_eq!(code, 0, "{error}");
        let rows = columns(&folder, "job", ["vx", "vy"]);
        let inner = &rows[5..rows.len() - 5];
        stops.push(
            inner
                .iter()
                .filter(|row| row[0].hypot(row[1]) < 1e-4)
                .count(),
        );
    }
    assert!(stops[0] >= 39 && stops[1] == 0, "{stops:?}");
    // What the program says goes before the argument.
    let exact = job.replace("G90", "G90 G61");
    assert_eq!(run(&folder, &exact, &["--corner", "0.02"]).0, 0);
    let rows = columns(&folder, "job", ["vx", "vy"]);
    assert!(
        rows.iter()
            .filter(|row| row[0].hypot(row[1]) < 1e-4)
            .count()
            >= 39
    );
}

#[test]
fn a_job_is_checked_without_a_trace() {
    let folder = TempDir::new().unwrap();
    let job = repository("scenes/jobs/plate.ngc");
    let placed = ["--origin", "180,245", "--corner", "0"];
    let output = trirrr(&folder, "check", &job, &placed);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).starts_with("plate: good\n"));
    let output = trirrr(&folder, "check", &job, &[&placed[..], &["--json"]].concat());
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let scene = crate::common::command(&folder, &["check", "--json"])
        .arg(repository("scenes/engraving.toml"))
        .output()
        .unwrap();
    let scene: serde_json::Value = serde_json::from_slice(&scene.stdout).unwrap();
    // The same drawing on the same machine.
    assert_eq!(found["ticks"], scene["ticks"]);
    assert_eq!(found["key"], scene["key"]);
    assert_eq!([&found["scene"], &scene["scene"]], ["plate", "engraving"]);
    // Elsewhere the machine does not reach it.
    let output = trirrr(&folder, "check", &job, &["--origin", "0,0"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("plate.ngc:"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Writes `content` as the job `file` into `folder`, and checks it.
fn check(folder: &TempDir, file: &str, content: &str, arguments: &[&str]) -> (i32, String) {
    fs::write(folder.path().join(file), content).unwrap();
    let output = trirrr(folder, "check", Path::new(file), arguments);
    (output.status.code().unwrap(), text(&output.stderr))
}

/// The tool is on along the strokes of the file, where `--fit` says that it has put them.
#[test]
fn a_drawing_is_placed_and_drawn() {
    let folder = TempDir::new().unwrap();
    let job = repository("scenes/jobs/badge.svg");
    let fit = ["--fast", "--speed", "6000", "--pen", "#ff0000=off", "--fit"];
    let output = trirrr(&folder, "run", &job, &fit);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said = text(&output.stderr);
    let (_, placed) = said.split_once("--scale 1.0000 --origin ").unwrap();
    let numbers: Vec<f64> = placed
        .split(['\n', ','])
        .take(2)
        .map(|number| 1e-3 * number.parse::<f64>().unwrap())
        .collect();
    let rows = columns(&folder, "badge", ["x", "y", "vx", "vy", "tool"]);
    let on: Vec<_> = rows.iter().filter(|row| row[4] > 0.0).collect();
    assert!(
        on.iter()
            .all(|row| row[2].hypot(row[3]) <= 0.1 * (1.0 + 1e-5))
    );
    // Two circles of 7 mm; the rim is left out; what is left of the star is its outline.
    let mut drawn = [0; 3];
    for row in on {
        let at = [row[0] - numbers[0], row[1] - numbers[1]];
        let around = |x: f64| (at[0] - x).hypot(at[1] - 0.03);
        // Corners to the ways are rounded within 0.01 mm, which begins some hundredths before them.
        let circle = |x: f64| (around(x) - 0.007).abs() < 1e-4;
        let shape = [circle(0.015), around(0.045) < 0.0165, circle(0.075)];
        assert_eq!(shape.iter().filter(|is_on| **is_on).count(), 1, "{at:?}");
        for (count, is_on) in drawn.iter_mut().zip(shape) {
            *count += usize::from(is_on);
        }
    }
    // 44 mm each at 0.1 m/s and 1000 ticks/s.
    assert!(
        drawn[0] > 400 && drawn[2] > 400 && drawn[1] > 900,
        "{drawn:?}"
    );
    // As --fit says: the same job.
    let there = placed.lines().next().unwrap();
    let again = [&fit[..5], &["--scale", "1", "--origin", there]].concat();
    let output = trirrr(&folder, "run", &job, &again);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(columns(&folder, "badge", ["x"]).len(), rows.len());
    // Three times as large it has no room.
    let larger = [&fit[1..], &["--scale", "9"]].concat();
    let output = trirrr(&folder, "check", &job, &larger);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said = text(&output.stderr);
    let scale = said.split_once("--scale ").unwrap().1;
    let scale: f64 = scale.split(' ').next().unwrap().parse().unwrap();
    assert!((1.5..5.0).contains(&scale), "{said}");
}

/// Times the same job: the machine goes back with the tool off, and does the same again.
#[test]
fn a_job_is_played_as_often_as_asked() {
    let folder = TempDir::new().unwrap();
    let lines = "G21 G90\nM4 S500 F3000\nG0 X10 Y10\nG1 X30\nG4 P0.1\nG1 Y25\nM0\nM2\n";
    let names = ["x", "y", "tool"];
    let placed = ["--origin", "220,280"];
    assert_eq!(run(&folder, lines, &placed).0, 0);
    let once = columns(&folder, "job", names);
    let (code, error) = run(&folder, lines, &[&placed[..], &["--repeat", "3"]].concat());
    assert_eq!(code, 0, "{error}");
    assert_eq!(error.matches("waits for the user").count(), 1, "{error}");
    let thrice = columns(&folder, "job", names);
    let worked = |rows: &[[f64; 3]]| -> Vec<[f64; 3]> {
        rows.iter().filter(|row| row[2] > 0.0).copied().collect()
    };
    let (one, all) = (worked(&once), worked(&thrice));
    assert_eq!(all.len(), 3 * one.len());
    for (found, expected) in all.iter().zip(one.iter().cycle()) {
        assert!((found[0] - expected[0]).hypot(found[1] - expected[1]) < 1e-6);
    }
    // The second time a line cannot be followed is named as the first.
    let wide = lines.replace("X30", "X300");
    let (code, error) = run(&folder, &wide, &[&placed[..], &["--repeat", "3"]].concat());
    assert_eq!(code, 2);
    assert!(error.contains("job.ngc:4 (time 1 of 3): "), "{error}");
    let (code, error) = run(&folder, lines, &[&placed[..], &["--repeat", "0"]].concat());
    assert_eq!(code, 2, "{error}");
}

#[test]
fn jobs_wait_for_each_other_and_all_are_read_first() {
    let folder = TempDir::new().unwrap();
    for (file, lines) in [
        ("one.ngc", "G21 G90\nG0 X230 Y290\n"),
        ("two.ngc", "G21 G90\nG0 X235 Y290\n"),
        ("wrong.ngc", "G21 G90\nG0 X900 Y290\n"),
    ] {
        fs::write(folder.path().join(file), lines).unwrap();
    }
    fs::create_dir(folder.path().join("a")).unwrap();
    fs::copy(
        folder.path().join("one.ngc"),
        folder.path().join("a/one.ngc"),
    )
    .unwrap();
    let queue = |then: &str| {
        trirrr(
            &folder,
            "run",
            Path::new("one.ngc"),
            &[then, "--fast", "--every", "10"],
        )
    };
    for (then, parts) in [
        ("wrong.ngc", ["wrong.ngc:2", "leg"]),
        ("a/one.ngc", ["one.ngc and a/one.ngc", "--repeat"]),
    ] {
        let output = queue(then);
        assert_eq!(output.status.code(), Some(2));
        let error = text(&output.stderr);
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
        assert!(!folder.path().join("out").exists());
    }
    let output = queue("two.ngc");
    assert!(output.status.success(), "{}", text(&output.stderr));
    for (job, x) in [("one", 0.23), ("two", 0.235)] {
        let rows = columns(&folder, job, ["t", "x"]);
        assert!((rows[rows.len() - 1][1] - x).abs() < 1e-4);
        assert!(
            rows.windows(2)
                .all(|pair| (pair[1][0] - pair[0][0] - 0.01).abs() < 1e-9)
        );
    }
}

/// A job of many thousand lines is planned in blocks: nothing of it is lost, and the place of a fault is known.
#[test]
fn long_jobs_keep_every_line() {
    let folder = TempDir::new().unwrap();
    let mut lines = String::from("G21 G90\nG0 X10 Y0\nM4 S500 F6000\n");
    let count = 9_000;
    for index in 1..=count {
        let (sin, cos) = (f64::from(index) * 0.013).sin_cos();
        let [x, y] = [10.0 * cos, 10.0 * sin];
        lines += &format!("G1 X{x:.4} Y{y:.4}\n");
        if index % 2_500 == 0 {
            lines += "G4 P0.02\n";
        }
    }
    let placed = ["--origin", "250,300"];
    let (code, error) = run(&folder, &lines, &placed);
    assert_eq!(code, 0, "{error}");
    let rows = columns(&folder, "job", ["x", "y", "vx", "vy", "tool"]);
    let mut turned = 0.0;
    let mut before: Option<f64> = None;
    let mut stands = 0;
    for [x, y, vx, vy, tool] in &rows {
        let (dx, dy) = (x - 0.25, y - 0.30);
        if *tool > 0.0 {
            // A chord of 0.13 mm is 0.2 um within the circle.
            assert!((dx.hypot(dy) - 0.01).abs() < 2e-5, "{dx} {dy}");
            let angle = dy.atan2(dx);
            if let Some(before) = before {
                turned += (angle - before + 3.0).rem_euclid(std::f64::consts::TAU) - 3.0;
            }
            before = Some(angle);
        }
        stands += u32::from(vx.hypot(*vy) == 0.0);
    }
    let way = 0.013 * f64::from(count);
    assert!((turned / way - 1.0).abs() < 1e-3, "{turned} of {way}");
    // Three dwells of 20 ticks, the ends, and between two blocks an instant.
    assert!((60..80).contains(&stands), "{stands}");
    // At the feed nearly everywhere: 0.1 m/s.
    let least = 0.01 * way / 0.1 / 1e-3;
    assert!(
        (rows.len() as f64) < 1.05 * least + 300.0,
        "{} {least}",
        rows.len()
    );
    // Out of reach in the last block.
    let wrong = lines + "G1 X400\n";
    let (code, error) = run(&folder, &wrong, &placed);
    let line = wrong.lines().count();
    assert_eq!(code, 2);
    assert!(error.contains(&format!("job.ngc:{line}: ")), "{error}");
}

/// Layers of a DXF file are drawn by their pens, where the file has them.
#[test]
fn a_dxf_file_is_drawn_by_its_layers() {
    let folder = TempDir::new().unwrap();
    let job = repository("scenes/jobs/bracket.dxf");
    let arguments = [
        "--fast",
        "--fit",
        "--speed",
        "6000",
        "--pen",
        "mark=0.4@3000",
    ];
    let output = trirrr(&folder, "run", &job, &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let rows = columns(&folder, "bracket", ["x", "y", "alpha", "vx", "vy", "tool"]);
    // Smallest or largest coordinate where the tool has at least a power.
    let edge = |axis: usize, power: f64, pick: fn(f64, f64) -> f64| {
        let drawn = rows.iter().filter(|row| row[5] >= power);
        drawn.map(|row| row[axis]).reduce(pick).unwrap()
    };
    for (axis, length) in [(0, 0.08), (1, 0.05)] {
        // At full power the layer `cut` alone is drawn, and it has the outline. The tool is slower near corners.
        for power in [0.01, 0.99] {
            let found = edge(axis, power, f64::max) - edge(axis, power, f64::min);
            assert!((found - length).abs() < 2e-4, "{axis} {power}: {found}");
        }
    }
    let mark = rows.iter().filter(|row| (0.39..0.41).contains(&row[5]));
    assert!(mark.count() > 1000);
}

/// Each pixel is burnt with its tone, at the same dose whatever the speed, and nothing beside the image is.
#[test]
fn an_image_is_burnt_pixel_by_pixel() {
    let folder = TempDir::new().unwrap();
    // From above, in a portable form: BMP with 24 bits, rows from below, each 4 pixels and no filling.
    let tones: [[u8; 4]; 3] = [[0, 255, 128, 0], [255; 4], [64, 64, 255, 192]];
    let mut file = Vec::from(*b"BM");
    for word in [90_u32, 0, 54, 40, 4, 3, 0x18_0001, 0, 36, 2835, 2835, 0, 0] {
        file.extend(word.to_le_bytes());
    }
    let bytes = tones.iter().rev().flatten().flat_map(|tone| [*tone; 3]);
    file.extend(bytes);
    fs::write(folder.path().join("tones.bmp"), file).unwrap();
    let arguments = [
        "--fast",
        "--speed",
        "3000",
        "--power",
        "0.5",
        "--origin",
        "230,300",
        "--pitch",
        "2",
        "--overscan",
        "5",
    ];
    let output = trirrr(&folder, "run", Path::new("tones.bmp"), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let rows = columns(&folder, "tones", ["x", "y", "vx", "vy", "tool"]);
    let mut seen = [[0; 4]; 3];
    let mut dose = 0.0;
    for [x, y, vx, vy, tool] in rows {
        dose += 1e-3 * tool;
        let [column, row] = [(x - 0.23) / 2e-3, (y - 0.30) / 2e-3];
        // A tick is 0.05 mm, and the tool changes at the nearest one.
        let edge = (column - column.round()).abs() < 0.05;
        let inside = (0.0..4.0).contains(&column) && (0.0..3.0).contains(&row);
        if !inside {
            assert!(tool == 0.0 || edge, "{x} {y}");
            continue;
        }
        let tone = tones[2 - row as usize][column as usize];
        let is_row = (row.fract() - 0.5).abs() < 1e-3 && vx.abs() > 1e-3;
        if edge || !is_row {
            continue;
        }
        // At the full speed along the row: the overscan is long enough.
        let part = vx.hypot(vy) / 0.05;
        assert!((0.998..1.0 + 1e-5).contains(&part) || tone == 255, "{part}");
        let power = 0.5 * part * (1.0 - f64::from(tone) / 255.0);
        assert!(
            (tool - power).abs() < 1e-4,
            "{column} {row}: {tool} is not {power}"
        );
        seen[row as usize][column as usize] += 1;
    }
    for (row, tones) in seen.iter().zip(tones.iter().rev()) {
        for (count, tone) in row.iter().zip(tones) {
            assert!(*count > 30 || *tone == 255, "{seen:?}");
        }
    }
    // 2 mm at 50 mm/s for each pixel.
    let tones: f64 = tones
        .iter()
        .flatten()
        .map(|tone| 1.0 - f64::from(*tone) / 255.0)
        .sum();
    assert!((dose / (0.5 * 0.04 * tones) - 1.0).abs() < 0.01, "{dose}");
}

/// The order of a table is the user's, and each row is a pose.
#[test]
fn a_table_is_followed_row_by_row() {
    let folder = TempDir::new().unwrap();
    let job = repository("scenes/jobs/poses.csv");
    let placed = ["--fast", "--origin", "230,250,22.9", "--corner", "0"];
    let output = trirrr(&folder, "run", &job, &placed);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let rows = columns(&folder, "poses", ["x", "y", "alpha", "vx", "vy", "tool"]);
    let mut next = rows.iter();
    for [x, y, degrees] in [
        [0.0, 0.0, 0.0],
        [40.0, 0.0, 5.0],
        [40.0, 40.0, 0.0],
        [0.0, 40.0, -5.0],
        [0.0, 0.0, 0.0],
        [20.0, -5.0, 0.0],
    ] {
        let pose = [
            0.23 + 1e-3 * x,
            0.25 + 1e-3 * y,
            f64::to_radians(22.9 + degrees),
        ];
        let there = |row: &&[f64; 6]| (0..3).all(|axis| (row[axis] - pose[axis]).abs() < 1e-6);
        assert!(next.any(|row| there(&row)), "{x} {y}");
    }
    let on = rows.iter().filter(|row| row[5] > 0.0);
    // 160 mm at 50 mm/s, and from rest to rest at each corner.
    assert!((3190..3800).contains(&on.clone().count()));
    let last = rows.iter().rposition(|row| row[5] > 0.0).unwrap();
    let stands = rows[last + 1..]
        .iter()
        .filter(|row| row[3].hypot(row[4]) == 0.0);
    assert!(stands.count() >= 499);
    assert!(
        on.clone()
            .all(|row| row[3].hypot(row[4]) <= 0.05 * (1.0 + 1e-5))
    );
}

#[test]
fn refusals_of_drawings_and_tables_name_the_shape_and_the_argument() {
    let folder = TempDir::new().unwrap();
    let svg = |content: &str| {
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='50mm' height='50mm' viewBox='0 0 50 50'>{content}</svg>"
        )
    };
    let dxf = |entity: &str| {
        let pairs = format!("0 SECTION 2 ENTITIES 0 {entity} 0 ENDSEC 0 EOF ");
        pairs.replace(' ', "\n")
    };
    let bar = "<path id='bar' d='M0 0H9' stroke='red'/>";
    let feed = ["--speed", "600"];
    let text = svg("<text>a</text>");
    for (file, content, arguments, parts) in [
        ("a.svg", svg(bar), &[][..], ["a.svg: ", "--speed"]),
        (
            "a.svg",
            svg(bar),
            &feed[..],
            [" way to shape 1 (bar): ", "leg"],
        ),
        ("a.svg", text, &feed, ["a.svg:1: text: ", "paths"]),
        (
            "a.svg",
            svg(bar),
            &["--speed", "6", "--pen", "#ff0000=off"],
            ["a.svg: ", "left out"],
        ),
        (
            "a.svg",
            svg(bar),
            &["--speed", "6", "--origin", "1,2,3"],
            ["a.svg: --origin", "ALPHA"],
        ),
        ("a.png", "no".into(), &feed, ["a.png: ", "no image"]),
        (
            "a.png",
            "no".into(),
            &["--pen", "a=1"],
            ["a.png: --pen", "an image"],
        ),
        (
            "a.svg",
            svg(bar),
            &["--pitch", "1"],
            ["a.svg: --pitch", "a drawing"],
        ),
        (
            "a.svg",
            svg(bar),
            &["--speed", "6", "--pen", "#red=1"],
            ["--pen", "#ff0000"],
        ),
        (
            "a.dxf",
            dxf("LINE 8 cut 10 0 20 0 11 9 21 0"),
            &feed,
            [
                " way to shape 1 (LINE in line 6, layer cut): ",
                "a.dxf: the drawing is 9 by 0 mm",
            ],
        ),
        (
            "a.dxf",
            dxf("TEXT 8 notes 10 0 20 0 1 a"),
            &feed,
            ["a.dxf:6: TEXT: ", "explode"],
        ),
        (
            "a.dxf",
            dxf("LINE 8 cut 10 0 20 0 11 9 21 0"),
            &["--speed", "6", "--pen", "cut=off"],
            ["a.dxf: ", "drawn"],
        ),
        (
            "a.csv",
            "x_mm,y_mm\n9,9\n".into(),
            &[],
            ["a.csv:2: ", "leg"],
        ),
        (
            "a.csv",
            "x_mm,y_mm\n9,b\n".into(),
            &[],
            ["a.csv:2: y_mm: ", "number"],
        ),
        (
            "a.csv",
            "x_mm,y_mm\n9,9\n".into(),
            &["--hatch", "1"],
            ["a.csv: --hatch", "table"],
        ),
        (
            "a.ngc",
            "G0 X1\n".into(),
            &feed,
            ["a.ngc: --speed", "G-code"],
        ),
    ] {
        let (code, error) = check(&folder, file, &content, arguments);
        assert_eq!(code, 2, "{content}: {error}");
        for part in parts {
            assert!(error.contains(part), "{part:?} of {content} in {error}");
        }
    }
}

/// A path is drawn before it is planned: of a refused job, too, with the place marked.
#[test]
fn a_path_is_drawn_before_anything_moves() {
    let folder = TempDir::new().unwrap();
    let job = repository("scenes/jobs/plate.ngc");
    for (origin, code, marked) in [("180,245", 0, false), ("300,245", 2, true)] {
        let arguments = ["--origin", origin, "--figure", "path.svg"];
        let output = trirrr(&folder, "check", &job, &arguments);
        assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
        let figure = fs::read_to_string(folder.path().join("path.svg")).unwrap();
        assert!(figure.contains("tool on"));
        assert_eq!(figure.contains("here the path is refused"), marked);
        // The shades of the reach.
        assert!(figure.matches("<polygon").count() > 200);
    }
}

#[test]
fn shells_complete_the_commands() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = crate::common::command(".", &["completions", shell])
            .output()
            .unwrap();
        assert!(output.status.success());
        let script = text(&output.stdout);
        for word in ["stream", "linkage", "machine"] {
            assert!(script.contains(word), "{word} for {shell}");
        }
    }
}
