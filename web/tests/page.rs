//! Answers that the page gets, against what the host's crates say.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use trirrr_core::number::Number;
use trirrr_host_sim::job_file::{DrawingArgs, JobFileArgs, read_job};
use trirrr_host_sim::run::{TickRows, simulate};
use trirrr_scene::record::tick_columns;
use trirrr_scene::{Scene, SceneError, in_number_type, pipeline};
use trirrr_web::{
    GivenDrawing, JobInputs, PlayedJob, Problem, Reading, bits_of, is_drawing, machine_file,
};
use trirrr_web_drawing::read_drawing;

const THESIS: &str = include_str!("../../scenes/thesis.toml");
const VERTICAL: &str = include_str!("../../scenes/vertical.toml");

fn read(text: &str) -> Reading {
    Reading::whole(text, "my.toml", None)
}

fn state(job: &trirrr_web::PlayedJob, row: usize) -> Vec<f64> {
    let columns = [
        "x", "y", "alpha", "vx", "vy", "valpha", "ax", "ay", "aalpha",
    ];
    columns
        .map(|name| job.values(name).expect("a column")[row])
        .into()
}

#[test]
fn a_refusal_is_that_of_the_host_tools_with_line_and_column() {
    let text = THESIS.replacen("proximal_m = 0.2", "proximal_m = -0.2", 1);
    let text = text.replacen("mass_kg = 0.5", "  mass_kg = \"heavy\"", 1);
    let reading = read(&text);
    let SceneError::Refused { problems, .. } = Scene::parse(&text, "my.toml").expect_err("refused")
    else {
        panic!("not refused");
    };
    let host = problems.iter().map(ToString::to_string);
    let page = reading.problems();
    let told = page
        .iter()
        .map(|problem| format!("{}: {}", problem.line, problem.sentence));
    assert!(host.eq(told), "{page:?}");
    assert_eq!(
        reading.refusal(),
        Scene::parse(&text, "my.toml")
            .err()
            .map(|error| error.to_string())
    );
    // The values stand behind `proximal_m = ` and `  mass_kg = `.
    let places: Vec<_> = page
        .iter()
        .map(|problem| (problem.line, problem.column))
        .collect();
    assert_eq!(places, [(11, 14), (34, 13)]);
    assert!(reading.machine().is_err() && reading.job(100).is_err());
}

#[test]
fn text_that_is_no_toml_has_a_place() {
    let reading = Reading::draft("name = \"a\"\nmass = 0,5\n", "my.toml", None);
    let [
        Problem {
            line,
            column,
            sentence,
            reason,
        },
    ] = &reading.problems()[..]
    else {
        panic!("{:?}", reading.problems());
    };
    assert_eq!((*line, *column), (2, 9));
    assert!(sentence.ends_with(reason), "{sentence}");
    assert!(sentence.contains("decimal point"), "{sentence}");
}

#[test]
fn a_refused_job_leaves_the_machine() {
    let reading = read(&VERTICAL.replace("duration_s = ", "duration_s = 0.1 # "));
    assert!(
        reading
            .refusal()
            .is_some_and(|text| text.contains("would be long enough"))
    );
    assert!(reading.machine().is_ok());
    assert!(reading.job(100).is_err());
}

#[test]
fn figures_of_a_dragged_pose_are_those_of_the_tick() {
    for text in [THESIS, VERTICAL] {
        let text = text.replace("number = \"f32\"", "number = \"f64\"");
        let reading = read(&text);
        let job = reading.job(u32::MAX).expect("a job");
        let machine = reading.machine().expect("a machine");
        for row in [0, 17, 50, 99] {
            let figures = machine.figures(&state(&job, row)).expect("finite");
            for leg in 0..3 {
                let column =
                    |name: &str| job.values(&format!("{name}{}", leg + 1)).expect("a column")[row];
                assert_eq!(figures.angles[leg], column("th1_"), "{row}");
                assert_eq!(figures.rates[leg], column("dth1_"), "{row}");
                assert_eq!(figures.torques[leg], column("tau"), "{row}");
                assert_eq!(figures.serial[leg], column("serial"), "{row}");
            }
            assert_eq!(
                figures.parallel,
                job.values("parallel").expect("a column")[row]
            );
        }
    }
}

#[test]
fn eight_working_modes_and_all_assemblies_contain_the_scene_itself() {
    let machine = read(THESIS).machine().expect("a machine");
    let [x, y, alpha] = machine.start()[..] else {
        panic!("a pose");
    };
    let state = [x, y, alpha, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0];
    let own = machine.figures(&state).expect("finite");
    let modes = machine.working_modes(&state).expect("finite");
    assert_eq!(modes.len(), 8);
    let [mode] = &modes.iter().filter(|mode| mode.is_own).collect::<Vec<_>>()[..] else {
        panic!("one mode is the scene's");
    };
    assert_eq!((mode.name.as_str(), &mode.torques), ("+++", &own.torques));
    assert_eq!(mode.elbows, own.elbows);
    let list = machine
        .assemblies(&own.angles, &[x, y, alpha])
        .expect("a list");
    let here: Vec<_> = list.modes.iter().filter(|mode| mode.is_here).collect();
    assert!(list.is_complete && here.len() == 1, "{list:?}");
    for (joint, expected) in here[0].platform.iter().zip(&own.platform) {
        assert!((joint - expected).abs() < 1e-9, "{joint} {expected}");
    }
}

#[test]
fn a_pose_out_of_reach_says_by_how_much() {
    let machine = read(THESIS).machine().expect("a machine");
    let figures = machine
        .figures(&[0.7, 0.22, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        .expect("finite");
    let reason = figures.reason.expect("a reason");
    assert!(
        reason.starts_with("unreachable: leg 1 is ") && reason.ends_with(" mm too short"),
        "{reason}"
    );
    assert!(figures.torques.is_empty() && figures.platform.len() == 6);
    assert!(machine.figures(&[f64::NAN; 9]).is_err());
    assert!(machine.figures(&[0.0; 3]).is_err());
    assert!(
        machine
            .assemblies(&[0.0, f64::INFINITY, 0.0], &[0.0; 3])
            .is_err()
    );
}

#[test]
fn a_long_job_is_thinned_and_keeps_its_ends() {
    let reading = read(THESIS);
    let job = reading.job(10).expect("a job");
    let times = job.values("t").expect("times");
    assert!(
        times.len() <= 12 && times.first() == Some(&0.0) && times.last() == Some(&1.0),
        "{times:?}"
    );
    assert_eq!(job.ticks(), 100);
}

const ENGRAVING: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/engraving.toml");
const PLATE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/jobs/plate.ngc");
const BADGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/jobs/badge.svg");

fn text_of(file: &str) -> String {
    std::fs::read_to_string(file).expect("a shipped file")
}

/// The page's reading of the job in `file` on the machine of `engraving`.
fn job_of(file: &str, text: &str, inputs: JobInputs) -> Reading {
    let scene = Reading::whole(&text_of(ENGRAVING), ENGRAVING, None);
    let drawing = is_drawing(file).then(|| {
        let read = read_drawing(text);
        match read.reason {
            Some(reason) => GivenDrawing::refused(read.line, read.word, reason),
            None => GivenDrawing::read(read.numbers, read.names),
        }
    });
    let read = scene.with_job(text, file, &inputs, drawing);
    read.expect("a good scene")
}

/// Arguments of the command line for the machine of `engraving`.
fn arguments() -> JobFileArgs {
    JobFileArgs {
        machine: Some(ENGRAVING.into()),
        ..JobFileArgs::default()
    }
}

/// Holds the table of `job` to the ticks that the command plays.
fn check_ticks<N: Number>(job: &PlayedJob, scene: &Scene) {
    let played = pipeline::scene::<N>(scene).expect("a machine");
    assert_eq!(job.ticks(), played.player.ticks());
    let columns = tick_columns(scene.torque).map(|name| job.values(name).expect("a column"));
    let columns: Vec<_> = columns.collect();
    for tick in 0..=job.ticks() {
        let record = played.machine.evaluate(0.0, &played.player.at(tick));
        let record = record.expect("a motion");
        // The first column is the time.
        for (column, value) in columns.iter().zip(record.tick_row(scene.torque)).skip(1) {
            assert_eq!(column[tick as usize], value, "{tick}");
        }
    }
}

#[test]
fn a_job_of_a_file_has_the_plan_of_the_command() {
    let program = JobInputs {
        x_mm: 180.0,
        y_mm: 245.0,
        ..JobInputs::default()
    };
    let plate = JobFileArgs {
        origin: Some([180.0, 245.0, 0.0]),
        ..arguments()
    };
    // A small drawing at a high speed: a short job.
    let drawing = JobInputs {
        fit: true,
        scale: Some(0.3),
        speed_mm_min: Some(6000.0),
        hatch_mm: Some(2.0),
        ..JobInputs::default()
    };
    let badge = JobFileArgs {
        drawing: DrawingArgs {
            fit: true,
            scale: Some(0.3),
            speed: Some(6000.0),
            hatch: Some(2.0),
            ..DrawingArgs::default()
        },
        ..arguments()
    };
    for (file, inputs, arguments) in [(PLATE, program, plate), (BADGE, drawing, badge)] {
        let reading = job_of(file, &text_of(file), inputs);
        assert_eq!(reading.refusal(), None);
        let job = reading.job(u32::MAX).expect("a plan");
        let native = read_job(Path::new(file), &arguments).expect("a plan");
        in_number_type!(native.number, N => check_ticks::<N>(&job, &native));
        assert!(reading.verdict().expect("a verdict").contains(" moves, "));
        assert!(reading.path().len() > 100 && reading.breach().is_none());
        assert_eq!(reading.notes().len(), usize::from(inputs.fit));
        // Speeds along strokes are those that the file asks for.
        let fastest = job.feeds().last().copied().expect("a feed");
        assert!(
            job.speeds()
                .iter()
                .any(|speed| (speed / fastest - 1.0).abs() < 0.01)
        );
    }
}

#[test]
fn a_refused_job_has_the_message_of_the_command_and_its_line() {
    let told = |file: &str, text: &str, inputs: JobInputs, arguments: &JobFileArgs| {
        let folder = tempfile::tempdir().expect("a folder");
        let name = Path::new(file).file_name().expect("a name");
        let copy = folder.path().join(name);
        std::fs::write(&copy, text).expect("written");
        let reading = job_of(&copy.display().to_string(), text, inputs);
        let native = read_job(&copy, arguments).expect_err("refused").to_string();
        assert_eq!(reading.refusal(), Some(native));
        assert!(reading.job(10).is_err());
        let [problem] = &reading.problems()[..] else {
            panic!("{:?}", reading.problems());
        };
        (
            (problem.line, problem.column),
            problem.reason.clone(),
            reading.breach(),
        )
    };
    let plate = text_of(PLATE);
    // At the zero of the machine the program leaves its reach in the middle of a line.
    let (place, reason, breach) = told(PLATE, &plate, JobInputs::default(), &arguments());
    assert_eq!(place, (6, 1));
    assert!(
        reason.contains("leg 2 comes nearer") && breach.is_some(),
        "{reason}"
    );
    let wrong = plate.replacen("G1 Y70", "G1 Q70", 1);
    let (place, reason, breach) = told(PLATE, &wrong, JobInputs::default(), &arguments());
    assert_eq!((place, breach), ((8, 4), None));
    assert!(reason.starts_with("Q70: "), "{reason}");
    let badge = text_of(BADGE);
    let (place, reason, _) = told(BADGE, &badge, JobInputs::default(), &arguments());
    assert_eq!(place, (1, 1));
    assert!(reason.contains("--speed MM_PER_MIN"), "{reason}");
    let cut = badge.replacen("</g>", "", 1);
    let (place, reason, _) = told(BADGE, &cut, JobInputs::default(), &arguments());
    assert!(
        place.0 > 1 && reason.contains("no SVG file"),
        "{place:?} {reason}"
    );
}

#[test]
fn the_plant_is_that_of_the_run() {
    // Sampled loops, a continuous controller, and drives on a bus with setpoints in binary32.
    for (name, tolerance) in [
        ("plant-thesis", 0.0),
        ("plant-reference", 0.0),
        ("plant-odrive", 0.01),
    ] {
        let file = format!("{}/../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let scene = Scene::read(&file).expect("a shipped scene");
        let reading = Reading::whole(&text_of(&file), &file, None);
        assert!(reading.has_plant());
        let plant = reading.plant(500).expect("a run").expect("a plant");
        let folder = tempfile::tempdir().expect("a folder");
        let stop = AtomicBool::new(false);
        let ticks = TickRows::ALL;
        let native = simulate(&scene, scene.number, false, ticks, folder.path(), &stop);
        let native = native.expect("a run").plant.expect("a plant").outcome;
        let near = |here: f64, there: f64| {
            assert!(
                (here - there).abs() <= tolerance * there.abs(),
                "{name}: {here} {there}"
            );
        };
        let (here, there) = (plant.outcome().statistics, native.statistics);
        assert_eq!(plant.outcome().end, native.end);
        assert!(here.tool_position.peak > 1e-7, "{name}");
        near(here.tool_position.peak, there.tool_position.peak);
        near(here.tool_angle.rms(), there.tool_angle.rms());
        for (here, there) in here.motors.iter().zip(&there.motors) {
            near(here.error.peak, there.error.peak);
            near(here.torque.rms(), there.torque.rms());
            near(here.power.peak, there.power.peak);
        }
        let times = plant.values("t").expect("times");
        let off = plant.values("off").expect("errors");
        assert!((100..=502).contains(&times.len()) && times.len() == off.len());
        let peak = off.iter().copied().fold(0.0, f64::max);
        assert!(peak > 0.5 * here.tool_position.peak && peak <= here.tool_position.peak);
        assert_eq!(plant.tool()[0], here.tool_position.peak);
        assert_eq!(plant.loads().len(), 24);
    }
    assert!(read(THESIS).plant(10).expect("a run").is_none());
}

#[test]
fn a_machine_in_a_file_of_its_own_is_taken_or_asked_for() {
    let text = include_str!("../../scenes/plotter.toml");
    assert_eq!(machine_file(text).as_deref(), Some("thesis.toml"));
    assert_eq!(machine_file(THESIS), None);
    let reading = Reading::whole(text, "plotter.toml", Some(THESIS.into()));
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/plotter.toml");
    let native = Scene::read(file).expect("a shipped scene");
    let job = reading.job(u32::MAX).expect("a job");
    in_number_type!(native.number, N => check_ticks::<N>(&job, &native));
    // Without the file, the line that names it says which one to add.
    let line = text.lines().position(|line| line.starts_with("machine = "));
    let line = line.expect("a machine") as u32 + 1;
    for reading in [
        Reading::whole(text, "plotter.toml", None),
        Reading::draft(text, "plotter.toml", None),
    ] {
        let [problem] = &reading.problems()[..] else {
            panic!("{:?}", reading.problems());
        };
        assert_eq!(problem.line, line);
        assert!(problem.reason.contains("drop thesis.toml"), "{problem:?}");
    }
    // A problem in that file is told at the same line, with its own place.
    let wrong = THESIS.replacen("proximal_m = 0.2", "proximal_m = -0.2", 1);
    let reading = Reading::draft(text, "plotter.toml", Some(wrong));
    let problem = &reading.problems()[0];
    assert_eq!(problem.line, line);
    assert!(
        problem
            .sentence
            .starts_with("thesis.toml:11: machine.leg[1]"),
        "{problem:?}"
    );
}

/// Z is the tool, or has no effect, as with the command; remarks stand among the notes.
#[test]
fn the_sense_of_z_is_that_of_the_command() {
    let at = |inputs: JobInputs| JobInputs {
        x_mm: 230.0,
        y_mm: 250.0,
        ..inputs
    };
    let text = "M3 S1000\nG1 Z-1 F2000\nX10\nZ3\nX20\n";
    let refused = job_of("a.nc", text, at(JobInputs::default())).refusal();
    assert!(refused.is_some_and(|told| told.contains("a.nc:2: Z-1: ")));
    let ignored = JobInputs {
        ignore_z: true,
        ..JobInputs::default()
    };
    let refused = job_of("a.nc", text, at(ignored)).refusal();
    assert!(refused.is_some_and(|told| told.contains("a.nc:5: ")));
    let by_z = JobInputs {
        tool_by_z_mm: Some(0.0),
        ..JobInputs::default()
    };
    let reading = job_of("a.nc", text, at(by_z));
    assert_eq!(reading.refusal(), None);
    assert!(
        reading
            .notes()
            .iter()
            .any(|note| note.contains("--tool-by-z"))
    );
}

#[test]
fn an_input_out_of_range_is_refused() {
    for (inputs, word) in [
        (
            JobInputs {
                x_mm: f64::NAN,
                ..JobInputs::default()
            },
            "--origin",
        ),
        (
            JobInputs {
                corner_mm: Some(-1.0),
                ..JobInputs::default()
            },
            "--corner",
        ),
        (
            JobInputs {
                scale: Some(0.0),
                ..JobInputs::default()
            },
            "--scale",
        ),
        (
            JobInputs {
                power: Some(1.5),
                ..JobInputs::default()
            },
            "--power",
        ),
    ] {
        let refusal = job_of(BADGE, &text_of(BADGE), inputs).refusal();
        assert!(
            refusal.as_ref().is_some_and(|text| text.contains(word)),
            "{refusal:?}"
        );
    }
    let refused = read(&THESIS.replacen("proximal_m = 0.2", "proximal_m = -0.2", 1));
    assert!(
        refused
            .with_job("G1 X1", "a.ngc", &JobInputs::default(), None)
            .is_err()
    );
}

/// Generator of damage, SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as usize % count
    }
}

/// Damages a scene at a few places: characters go, come, or swap lines.
fn damaged(random: &mut Random) -> String {
    const PIECES: [&str; 12] = [
        "-",
        "0",
        "9e9",
        "\"",
        "[",
        "]",
        "=",
        "\n",
        "\u{e4}",
        "1e308",
        "[[machine.leg]]\n",
        "nan",
    ];
    let mut characters: Vec<char> = [THESIS, VERTICAL][random.below(2)].chars().collect();
    for _ in 0..=random.below(3) {
        let at = random.below(characters.len());
        let end = (at + random.below(12)).min(characters.len());
        let piece = PIECES[random.below(PIECES.len())];
        characters.splice(at..end, piece.chars());
    }
    characters.into_iter().collect()
}

#[test]
fn no_text_makes_the_core_panic() {
    let mut random = Random(22);
    let mut refused = 0;
    for round in 0..600 {
        let text = damaged(&mut random);
        let draft = Reading::draft(&text, "my.toml", None);
        refused += usize::from(draft.refusal().is_some());
        assert_eq!(
            draft.refusal().is_some(),
            !draft.problems().is_empty(),
            "{text}"
        );
        let lines = text.lines().count() as u32 + 1;
        for problem in draft.problems() {
            assert!(
                (1..=lines).contains(&problem.line) && problem.column >= 1,
                "{problem:?}\n{text}"
            );
        }
        if let Ok(machine) = draft.machine() {
            let start = machine.start();
            let state = [&start[..], &[0.1; 6]].concat();
            let figures = machine.figures(&state).expect("finite");
            assert_eq!(
                figures.reason.is_none(),
                figures.torques.len() == 3,
                "{text}"
            );
            assert_eq!(machine.working_modes(&state).expect("finite").len(), 8);
            let _ = machine.assemblies(&figures.angles, &start);
        }
        // The admission of a job takes longer.
        if round % 10 == 0 {
            let whole = read(&text);
            assert_eq!(whole.job(50).is_ok(), whole.refusal().is_none(), "{text}");
        }
    }
    assert!(refused > 100, "{refused} of 600 damaged scenes are refused");
}

#[test]
fn a_hash_is_of_the_motion() {
    let hash = |text: &str| bits_of(text, "my.toml", None, 500);
    let path = include_str!("../../scenes/engraving.toml");
    let planned = hash(path).expect("a hash");
    assert_eq!(hash(path).as_ref(), Ok(&planned), "planned again");
    let slower = path.replacen("feed_m_s = 0.25", "feed_m_s = 0.2", 1);
    assert_ne!(slower, path);
    assert_ne!(hash(&slower), Ok(planned), "another plan");
    assert!(hash("name = 1").is_err());
}
