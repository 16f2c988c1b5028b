//! `trirrr run`: what it writes, how it ends.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::AtomicBool;
use tempfile::TempDir;
use trirrr_host_sim::run::{JobEnd, TickRows, simulate};
use trirrr_scene::NumberType;
use trirrr_scene::Scene;

const HEADER: &str = "t,x,y,alpha,vx,vy,valpha,ax,ay,aalpha,th1_1,th1_2,th1_3,dth1_1,dth1_2,dth1_3,\
    ddth1_1,ddth1_2,ddth1_3,tau1,tau2,tau3,P1,P2,P3,detA,th2_1,th2_2,th2_3,dth2_1,dth2_2,dth2_3,\
    ddth2_1,ddth2_2,ddth2_3,D1,D2,D3,serial1,serial2,serial3,parallel,tool";

const FILES: [&str; 13] = [
    "ticks.csv",
    "pose.svg",
    "velocity.svg",
    "acceleration.svg",
    "joint_angle.svg",
    "joint_rate.svg",
    "joint_acceleration.svg",
    "torque.svg",
    "power.svg",
    "singularity.svg",
    "machine.svg",
    "path.svg",
    "animation.html",
];

fn scene_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenes")
        .join(name)
}

fn trirrr() -> Command {
    Command::new(env!("CARGO_BIN_EXE_trirrr"))
}

fn run(scene: &Path, out: &Path, more: &[&str]) -> Output {
    let mut command = trirrr();
    command
        .arg("run")
        .arg(scene)
        .arg("--out")
        .arg(out)
        .args(more);
    command.output().expect("trirrr starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// The rows of `ticks.csv` below the header, every field a finite number.
fn rows(folder: &Path) -> Vec<Vec<f64>> {
    let table = fs::read_to_string(folder.join("ticks.csv")).expect("ticks.csv");
    assert!(table.ends_with('\n'), "the last row is whole");
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let number = |field: &str| {
        let value: f64 = field
            .parse()
            .unwrap_or_else(|_| panic!("{field} is no number"));
        assert!(value.is_finite());
        value
    };
    let rows: Vec<Vec<f64>> = lines
        .map(|row| row.split(',').map(number).collect())
        .collect();
    assert!(
        rows.iter()
            .all(|row| row.len() == HEADER.split(',').count())
    );
    rows
}

fn column(name: &str) -> usize {
    HEADER
        .split(',')
        .position(|column| column == name)
        .expect(name)
}

fn assert_all_files(folder: &Path) {
    for file in FILES {
        let written = fs::read_to_string(folder.join(file)).expect(file);
        assert!(
            file == "ticks.csv" || written.ends_with("</svg>\n") || written.ends_with("</html>\n"),
            "{file}"
        );
    }
    // And what they are.
    assert_eq!(fs::read_dir(folder).unwrap().count(), FILES.len() + 1);
}

#[test]
fn the_thesis_scene_gives_101_rows_of_true_values_and_the_figures() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("made/if/missing");
    let output = run(&scene_file("thesis.toml"), &out, &["--fast"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_all_files(&out);

    let rows = rows(&out);
    assert_eq!(rows.len(), 101);
    for (tick, row) in rows.iter().enumerate() {
        assert_eq!(row[0], tick as f64 / 100.0);
    }
    // The pose of both ends exactly, and the true torques there to the digits that
    // docs/errata.md gives.
    let (first, last) = (&rows[0], &rows[100]);
    assert_eq!(first[1..4], [0.21, 0.22, 0.15707963267948966]);
    assert_eq!(last[1..4], [0.28, 0.28, 0.20943951023931953]);
    let tau = column("tau1");
    for (row, torques) in [
        (first, [0.012528697, 0.014246763, -0.029750897]),
        (last, [-0.019558387, -0.015416587, 0.039628158]),
    ] {
        for (computed, expected) in row[tau..tau + 3].iter().zip(torques) {
            assert!((computed - expected).abs() < 1e-9, "{computed} {expected}");
        }
    }
    // The motors' power is the platform's.
    for row in &rows {
        let power: f64 = row[column("P1")..][..3].iter().sum();
        let [vx, vy, va, ax, ay, aa] = row[4..10] else {
            unreachable!()
        };
        let platform = 0.5 * (vx * ax + vy * ay) + 0.0025 * va * aa;
        assert!((power - platform).abs() < 1e-15, "{power} {platform}");
    }

    let summary = text(&output.stdout);
    for part in [
        "thesis",
        "f64",
        "101 of 101",
        "100 Hz",
        "motor 3",
        "peak torque, N m",
        "0.03963",
        "serial",
        "parallel",
        "machine.svg",
    ] {
        assert!(summary.contains(part), "{part} in\n{summary}");
    }
    assert!(!summary.contains("late ticks"), "{summary}");
}

#[test]
fn without_arguments_the_thesis_scene_runs_in_real_time() {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("scenes")).unwrap();
    fs::copy(
        scene_file("thesis.toml"),
        folder.path().join("scenes/thesis.toml"),
    )
    .unwrap();
    let output = trirrr().current_dir(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_all_files(&folder.path().join("out/thesis"));
    let summary = text(&output.stdout);
    for part in [
        "in real time",
        "jitter",
        "late ticks",
        "of 101",
        "out/thesis/ticks.csv",
    ] {
        assert!(summary.contains(part), "{part} in\n{summary}");
    }
}

#[test]
fn the_number_type_can_be_chosen() {
    let folder = TempDir::new().unwrap();
    let output = run(
        &scene_file("thesis.toml"),
        folder.path(),
        &["--fast", "--scalar", "f32"],
    );
    assert!(output.status.success());
    let rows = rows(folder.path());
    assert_eq!(rows.len(), 101);
    for row in &rows {
        for value in &row[1..] {
            assert_eq!(f64::from(*value as f32), *value, "printed without rounding");
        }
    }
    let output = run(
        &scene_file("thesis.toml"),
        folder.path(),
        &["--fast", "--scalar", "fixed"],
    );
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("fixed"));
    let fixed = self::rows(folder.path());
    assert_eq!(fixed.len(), 101);
    for (fixed, float) in fixed.iter().zip(&rows) {
        for (a, b) in fixed[1..4].iter().zip(&float[1..4]) {
            // A few roundings of f32 below 0.5, each at most 2^-26; those of fixed point are finer.
            assert!((a - b).abs() < 2f64.powi(-23), "{a} {b}");
        }
    }
}

#[test]
fn what_cannot_be_read_is_refused_and_what_cannot_be_written_fails() {
    let folder = TempDir::new().unwrap();
    let missing = folder.path().join("missing.toml");
    let output = run(&missing, folder.path(), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("missing.toml"));

    let bad = folder.path().join("bad.toml");
    let scene = fs::read_to_string(scene_file("thesis.toml")).unwrap();
    fs::write(&bad, scene.replace("mass_kg = 0.5", "mass_kg = -0.5")).unwrap();
    let output = run(&bad, folder.path(), &[]);
    assert_eq!(output.status.code(), Some(2));
    let message = text(&output.stderr);
    assert!(
        message.contains("mass_kg") && message.contains("-0.5"),
        "{message}"
    );

    // A file where the folder should be.
    let output = run(&scene_file("thesis.toml"), &bad, &["--fast"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("bad.toml: cannot be written"));
    // A folder where the table should be.
    fs::create_dir(folder.path().join("ticks.csv")).unwrap();
    let output = run(&scene_file("thesis.toml"), folder.path(), &["--fast"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("ticks.csv: cannot be written"));

    let output = trirrr().args(["run", "--sideways"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
}

/// The machine computes no torques, so that a mass beyond f32's forces is none of its business, nor of
/// the record.
#[test]
fn a_position_only_scene_is_written_without_torques_whatever_its_mass() {
    let folder = TempDir::new().unwrap();
    let toml = fs::read_to_string(scene_file("pick-stepper.toml")).unwrap();
    let mass = toml
        .lines()
        .find(|line| line.starts_with("mass_kg"))
        .unwrap();
    let number = toml
        .lines()
        .find(|line| line.starts_with("number"))
        .unwrap();
    let heavy = toml
        .replace(mass, "mass_kg = 3e38")
        .replace(number, "number = \"f32\"");
    fs::write(folder.path().join("heavy.toml"), heavy).unwrap();
    let scenes = [
        scene_file("pick-stepper.toml"),
        folder.path().join("heavy.toml"),
    ];
    let [light, heavy] = scenes.map(|scene| {
        let out = folder.path().join(scene.file_stem().unwrap()).join("out");
        let output = run(&scene, &out, &["--fast", "--scalar", "f32"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let summary = text(&output.stdout);
        assert!(summary.contains("peak rate"), "{summary}");
        for absent in ["torque", "N m", "power"] {
            assert!(!summary.contains(absent), "{absent} in\n{summary}");
        }
        for figure in ["torque.svg", "power.svg"] {
            assert!(!out.join(figure).exists(), "{figure}");
        }
        assert_eq!(fs::read_dir(&out).unwrap().count(), FILES.len() - 1);
        fs::read_to_string(out.join("ticks.csv")).unwrap()
    });
    assert_eq!(light, heavy, "a mass moves nothing");
    let header = HEADER.replace("tau1,tau2,tau3,P1,P2,P3,", "");
    assert_eq!(light.lines().next(), Some(header.as_str()));
    assert!(light.lines().all(|row| row.split(',').count() == 37));
    assert!(light.lines().count() > 100);
}

/// The scene's reader refuses such jobs; the machine holds its own all the same.
#[test]
fn a_job_that_cannot_be_played_is_refused_before_it_starts() {
    let mut scene = Scene::read(scene_file("thesis.toml")).unwrap();
    scene.job.moves[0].to.position.x = 0.6;
    // So that reach and singularities are what stands in the way.
    (scene.limits.rate_rad_s, scene.limits.torque_nm) = (None, None);
    let folder = TempDir::new().unwrap();
    for (scalar, paced) in [(NumberType::F64, false), (NumberType::F32, true)] {
        let never = AtomicBool::new(false);
        let report = simulate(&scene, scalar, paced, TickRows::ALL, folder.path(), &never).unwrap();
        let JobEnd::Refused(why) = report.played.end else {
            panic!("{:?}", report.played.end);
        };
        assert!(
            why.starts_with(
                "move 1 is not admitted: distance from the serial singularity of leg 1"
            ),
            "{why}"
        );
        assert_eq!((report.job.rows, report.setpoints), (0, 101));
        assert!(report.job.peaks.is_none() && report.job.files.is_empty());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
    // Where the machine cannot even stand.
    scene.job.moves[0].from.position.x = 5.0;
    scene.job.start.position.x = 5.0;
    let never = AtomicBool::new(false);
    let error = simulate(
        &scene,
        NumberType::F64,
        false,
        TickRows::ALL,
        folder.path(),
        &never,
    )
    .unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("unreachable: leg"), "{error}");
}

/// What was played until then is written. The move that does not fit is behind more than the queue
/// holds, so the job has begun.
#[test]
fn a_move_that_is_refused_on_the_way_ends_the_run_with_what_came_before() {
    let mut scene = Scene::read(scene_file("chained.toml")).unwrap();
    // There and back, again and again: more than wait.
    let mut there = scene.job.moves[0];
    (there.start_velocity, there.end_velocity) = ([0.0; 3].into(), [0.0; 3].into());
    let mut back = there;
    (back.from, back.to) = (there.to, there.from);
    scene.job.moves = (0..200).flat_map(|_| [there, back]).collect();
    let count = scene.job.moves.len();
    let last = scene.job.moves.last_mut().unwrap();
    last.to.position.x = 0.6;
    let folder = TempDir::new().unwrap();
    let never = AtomicBool::new(false);
    let report = simulate(
        &scene,
        NumberType::F32,
        false,
        TickRows::ALL,
        folder.path(),
        &never,
    )
    .unwrap();
    let JobEnd::Refused(why) = report.played.end else {
        panic!("{:?}", report.played.end);
    };
    let named = format!("move {count} is not admitted: ");
    assert!(why.starts_with(&named), "{why}");
    assert!(
        (1..78_170).contains(&report.job.rows),
        "{}",
        report.job.rows
    );
    assert_eq!(rows(folder.path()).len() as u64, report.job.rows);
    assert_all_files(folder.path());
}

#[test]
fn a_stop_before_the_start_writes_nothing() {
    let scene = Scene::read(scene_file("thesis.toml")).unwrap();
    let folder = TempDir::new().unwrap();
    let stopped = AtomicBool::new(true);
    let report = simulate(
        &scene,
        NumberType::F64,
        true,
        TickRows::ALL,
        folder.path(),
        &stopped,
    )
    .unwrap();
    assert_eq!(report.played.end, JobEnd::Stopped);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_the_run_cleanly() {
    let folder = TempDir::new().unwrap();
    let scene = fs::read_to_string(scene_file("thesis.toml")).unwrap();
    let long = folder.path().join("long.toml");
    fs::write(
        &long,
        scene.replace("duration_s = 1.0", "duration_s = 600.0"),
    )
    .unwrap();
    let out = folder.path().join("out");
    let child = trirrr()
        .args(["run", "long.toml", "--out", "out"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Ctrl-C is handled before the table is begun; then some ticks.
    while !out.join("ticks.csv").exists() {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    std::thread::sleep(std::time::Duration::from_millis(200));
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(kill.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let summary = text(&output.stdout);
    assert!(summary.contains("Ctrl-C"), "{summary}");
    let rows = rows(&out);
    assert!((1..60_001).contains(&rows.len()));
    assert!(
        summary.contains(&format!("{} of 60001", rows.len())),
        "{summary}"
    );
    assert_all_files(&out);
}

/// `--set` goes before the file; `--json` prints one object, whose figures are those of the table.
#[test]
fn a_run_is_one_json_object_with_the_loads_of_the_motors() {
    let folder = TempDir::new().unwrap();
    let scene = scene_file("thesis.toml");
    let set = ["--fast", "--json", "--set", "platform.mass_kg=0.6"];
    let output = run(&scene, folder.path(), &set);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said: serde_json::Value = serde_json::from_str(&text(&output.stdout)).unwrap();
    assert_eq!(said["end"], "complete");
    assert_eq!(said["setpoints"], 101);
    let rows = rows(folder.path());
    for motor in 0..3 {
        let of = |name: &str| column(&format!("{name}{}", motor + 1));
        let peak = rows
            .iter()
            .map(|row| row[of("tau")].abs())
            .fold(0.0, f64::max);
        let motor = &said["motors"][motor];
        let said = |key: &str| motor[key].as_f64().unwrap();
        let read = motor["peak_torque_nm"]["value"].as_f64().unwrap();
        // Reading JSON may round the last bit.
        assert!((read.abs() - peak).abs() < 1e-15);
        // The motion begins and ends at rest: the work is the change of the kinetic energy, which is none.
        let work: f64 = rows.iter().map(|row| row[of("P")]).sum::<f64>() * 0.01;
        assert!((said("work_given_j") - said("work_returned_j") - work).abs() < 1e-12);
        let square: f64 = rows.iter().map(|row| row[of("tau")].powi(2)).sum();
        // The rule takes the ends half.
        let ends = rows[0][of("tau")].powi(2) + rows[100][of("tau")].powi(2);
        let rms = ((square - ends / 2.0) * 0.01).sqrt();
        assert!((said("rms_torque_nm") - rms).abs() < 1e-12);
    }
    let wrong = run(&scene, folder.path(), &["--set", "platform.mas=1"]);
    assert_eq!(wrong.status.code(), Some(2));
    let message = text(&wrong.stderr);
    assert!(
        message.contains("--set: platform.mas = 1: unknown key"),
        "{message}"
    );
    let wrong = run(&scene, folder.path(), &["--set", "platform"]);
    assert_eq!(wrong.status.code(), Some(2));
    let message = text(&wrong.stderr);
    assert!(message.contains("expected KEY=VALUE"), "{message}");
}
