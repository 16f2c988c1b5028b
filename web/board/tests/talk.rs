//! Conversations with a machine in the same program: bytes of the page's modules on one side, of the board's service on the other.

use std::time::Duration;
use trirrr_client::local::{self, HostNumber, LocalService};
use trirrr_line::Frames;
use trirrr_protocol::message::{Message, Request, State};
use trirrr_scene::{Scene, in_number_type};
use trirrr_service::ServiceNumber;
use trirrr_web::Reading;
use trirrr_web_board::{Board, BoardCommand, BoardView};

const THESIS: &str = include_str!("../../../scenes/thesis.toml");

/// A page of the scene in `text`.
fn page(text: &str) -> Board {
    let scene = Reading::whole(text, "my.toml", None)
        .board_scene()
        .expect("a scene");
    let Ok(board) = Board::new(
        scene.name,
        &scene.number,
        scene.key,
        &scene.figures,
        &scene.moves,
        scene.levels,
        &scene.ranges,
        &scene.outputs,
        scene.tools,
        &scene.bodies,
        7,
    ) else {
        panic!("no conversation");
    };
    board
}

/// A page and a machine with a line between them.
struct Bench<'a, N: ServiceNumber> {
    page: Board,
    machine: &'a mut dyn LocalService<N>,
    requests: Frames,
    period_ms: f64,
    now_ms: f64,
    /// The line carries nothing.
    is_cut: bool,
    notes: Vec<String>,
}

impl<N: ServiceNumber> Bench<'_, N> {
    fn tick(&mut self) {
        let bytes = self.page.poll(self.now_ms);
        let mut answers = Vec::new();
        if !self.is_cut {
            let mut requests: Vec<Request<N>> = Vec::new();
            self.requests
                .receive(&bytes, |request| requests.push(request));
            for request in &requests {
                let reply = self.machine.answer(request);
                let sequence = request.sequence;
                Frames::append(&Message::Reply { sequence, reply }, &mut answers);
                while let Some((sequence, reply)) = self.machine.answer_kept() {
                    Frames::append(&Message::Reply { sequence, reply }, &mut answers);
                }
            }
        }
        self.machine.tick();
        while self.machine.step() {}
        while let Some(message) = self.machine.outgoing() {
            if !self.is_cut {
                Frames::append(&message, &mut answers);
            }
        }
        self.page.receive(&answers, self.now_ms);
        self.notes.extend(self.page.take_notes());
        self.now_ms += self.period_ms;
    }

    /// Ticks until the view is as wanted.
    fn until(&mut self, what: &str, is_there: impl Fn(&BoardView) -> bool) -> BoardView {
        for _ in 0..20_000 {
            self.tick();
            let view = self.page.view();
            if is_there(&view) {
                return view;
            }
        }
        panic!("{what}: {:?} {:?}", self.page.view(), self.notes);
    }

    fn state(&mut self, words: &str) -> BoardView {
        self.until(words, |view| view.sentence == words)
    }

    fn give(&mut self, command: BoardCommand) {
        let given = self.page.command(command);
        assert_eq!(given, Ok(()), "{command:?}: {:?}", self.page.view());
    }

    fn is_noted(&self, words: &str) -> bool {
        self.notes.iter().any(|note| note.contains(words))
    }

    /// Pose of the last sample.
    fn pose(&self) -> [f64; 3] {
        let sample = self.page.view().sample.expect("a sample");
        [0, 1, 2].map(|axis| sample.setpoint[axis])
    }
}

fn with_bench<N: HostNumber>(page: Board, scene: &Scene, play: impl FnOnce(Bench<'_, N>)) {
    local::with_machine::<N, _>(scene, |machine| {
        play(Bench {
            page,
            machine,
            requests: Frames::default(),
            period_ms: 1e3 / scene.tick_rate_hz,
            now_ms: 0.0,
            is_cut: false,
            notes: Vec::new(),
        });
    })
    .expect("a machine");
}

fn read(text: &str) -> Scene {
    Scene::parse(text, "my.toml").expect("a scene")
}

fn is_near(pose: [f64; 3], to: [f64; 3], tolerance: f64) -> bool {
    let apart = |axis: usize| (pose[axis] - to[axis]).abs() < tolerance;
    (0..3).all(apart)
}

/// The end of the scene's job.
fn end(scene: &Scene) -> [f64; 3] {
    let to = scene.job.moves.last().expect("a move").to;
    [to.position.x, to.position.y, to.angle]
}

#[test]
fn a_job_is_played_in_every_number_type_held_and_resumed() {
    for number in ["f64", "f32", "fixed", "micromath"] {
        let text = THESIS.replacen("number = \"f64\"", &format!("number = \"{number}\""), 1);
        let scene = read(&text);
        assert_eq!(scene.number.to_string(), number);
        in_number_type!(scene.number, N => with_bench::<N>(page(&text), &scene, |mut bench| {
            let view = bench.state("disabled");
            assert!(view.hindrances[BoardCommand::Run as usize].contains("enable them first"));
            assert!(bench.is_noted("connected: scene thesis"), "{:?}", bench.notes);
            // Nothing is switched on, or moved, before the user asks for it.
            for _ in 0..200 {
                bench.tick();
            }
            assert_eq!(bench.machine.state(), State::Disabled);
            assert!(bench.page.command(BoardCommand::Run).is_err());

            bench.give(BoardCommand::Enable);
            bench.state("idle");
            bench.give(BoardCommand::Run);
            bench.until("under way", |view| view.sentence == "running" && view.done == 0);
            bench.page.halt();
            bench.state("holding (hold)");
            // The sample of the tick in which it came to rest.
            for _ in 0..10 {
                bench.tick();
            }
            let held = bench.pose();
            assert!(!is_near(held, end(&scene), 1e-3), "{number}: {held:?}");
            // The key is pressed once more: the job is not lost.
            bench.page.halt();
            for _ in 0..50 {
                bench.tick();
            }
            assert_eq!(bench.pose(), held);
            bench.give(BoardCommand::Resume);
            bench.until("over", |view| !view.is_playing && view.sentence == "idle");
            assert!(bench.is_noted("the job is played to its end"), "{:?}", bench.notes);
            // Fixed point has steps of its own.
            assert!(is_near(bench.pose(), end(&scene), 1e-6), "{number}: {:?}", bench.pose());
        }));
    }
}

/// The scene's machine carries the pen, that of the second the gripper: the same scene, as its key says.
#[test]
fn a_job_for_another_tool_is_not_begun() {
    let tools = "[[tools]]\nname = \"pen\"\nmass_kg = 0.06\npoint_m = [0.0, 0.03]\n\
                 [[tools]]\nname = \"gripper\"\nmass_kg = 0.3\npoint_m = [0.02, 0.0]\n\
                 [service]\nadjustable = true\n\n[job]\n";
    let text = THESIS.replacen("[job]\n", tools, 1);
    let of = |mounted: &str| {
        let setting = format!("mounted={mounted}").parse().expect("a setting");
        Scene::parse_set(&text, "my.toml", &[setting]).expect("a scene")
    };
    for (mounted, is_played) in [("gripper", false), ("pen", true)] {
        let scene = of(mounted);
        assert_eq!(scene.key, read(&text).key);
        with_bench::<f64>(page(&text), &scene, |mut bench| {
            bench.state("disabled");
            bench.give(BoardCommand::Enable);
            bench.state("idle");
            bench.give(BoardCommand::Run);
            if is_played {
                bench.until("under way", |view| view.sentence == "running");
                return;
            }
            for _ in 0..200 {
                bench.tick();
            }
            let said = "carries the tool \"gripper\", and the job is for the tool \"pen\"";
            assert!(bench.is_noted(said), "{:?}", bench.notes);
            assert_eq!(bench.machine.state(), State::Idle);
        });
    }
}

#[test]
fn a_step_goes_from_where_the_last_one_ends_and_halts() {
    let scene = read(THESIS);
    in_number_type!(scene.number, N => with_bench::<N>(page(THESIS), &scene, |mut bench| {
        bench.state("disabled");
        assert!(bench.page.step(0.001, 0.0, 0.0).is_err());
        bench.give(BoardCommand::Enable);
        bench.until("a pose", |view| view.hindrances[BoardCommand::Step as usize].is_empty());
        let start = scene.job.start;
        let [x, y, alpha] = [start.position.x, start.position.y, start.angle];
        assert_eq!(bench.page.step(0.002, 0.0, 0.0), Ok(()));
        assert_eq!(bench.page.step(0.0, 0.001, 0.01), Ok(()));
        bench.until("under way", |view| view.sentence == "running");
        bench.until("there", |view| view.sentence == "idle" && view.hindrances[BoardCommand::Step as usize].is_empty());
        let there = [x + 0.002, y + 0.001, alpha + 0.01];
        assert!(is_near(bench.pose(), there, 1e-6), "{:?} {there:?}", bench.pose());
        // No faster than a hand can leave.
        assert_eq!(bench.page.step(0.02, 0.0, 0.0), Ok(()));
        let view = bench.until("under way", |view| view.sentence == "running");
        let before = view.sample.expect("a sample").setpoint[0];
        bench.page.halt();
        bench.until("at rest", |view| view.hindrances[BoardCommand::Step as usize].is_empty());
        let [x, ..] = bench.pose();
        assert!(x < before + 0.015, "{x} {before}");
        assert!(bench.page.step(f64::NAN, 0.0, 0.0).is_err());
        // A pose out of reach is refused in words, and nothing moves.
        assert_eq!(bench.page.step(5.0, 0.0, 0.0), Ok(()));
        bench.until("refused", |view| view.hindrances[BoardCommand::Step as usize].is_empty() && view.sentence.starts_with("idle"));
        for _ in 0..200 {
            bench.tick();
        }
        assert!(bench.is_noted("no motion to the goal") || bench.is_noted("refused"), "{:?}", bench.notes);
        assert!((bench.pose()[0] - x).abs() < 1e-9);
    }));
}

#[test]
fn a_page_that_goes_leaves_a_job_that_the_next_one_resumes() {
    let text = THESIS.replacen("duration_s = ", "duration_s = 3.0 # ", 1);
    let scene = read(&text);
    in_number_type!(scene.number, N => with_bench::<N>(page(&text), &scene, |mut bench| {
        bench.state("disabled");
        bench.give(BoardCommand::Enable);
        bench.state("idle");
        bench.give(BoardCommand::Run);
        bench.state("running");
        bench.is_cut = true;
        for _ in 0..400 {
            bench.tick();
        }
        assert_eq!(bench.machine.state(), State::Holding);
        assert!(bench.is_noted("the board does not answer") || bench.page.view().sentence == "running");
        // Another page, by its own clock.
        bench.page = page(&text);
        bench.is_cut = false;
        let view = bench.state("holding (host silent)");
        assert!(!view.is_playing && view.hindrances[BoardCommand::Run as usize].contains("holds"));
        bench.give(BoardCommand::Resume);
        bench.until("over", |view| !view.is_playing && view.sentence == "idle");
        assert!(is_near(bench.pose(), end(&scene), 1e-6), "{:?}", bench.pose());
    }));
}

#[test]
fn a_board_of_another_scene_or_number_type_is_refused_by_name() {
    let scene = read(THESIS);
    let heavier = THESIS.replacen("mass_kg = 0.5", "mass_kg = 0.6", 1);
    let renamed = heavier.replacen("name = \"thesis\"", "name = \"mine\"", 1);
    let other = THESIS.replacen("number = \"f64\"", "number = \"f32\"", 1);
    for (text, words) in [
        (&heavier, "another version of the scene thesis"),
        (
            &renamed,
            "the board has the scene thesis, the page shows mine",
        ),
        (&other, "the board computes in f64, the scene in f32"),
    ] {
        assert_ne!(text, THESIS);
        in_number_type!(scene.number, N => with_bench::<N>(page(text), &scene, |mut bench| {
            let view = bench.until(words, |view| view.is_closed);
            assert!(view.sentence.contains(words), "{}", view.sentence);
            assert_eq!(bench.machine.state(), State::Disabled);
            assert!(bench.page.command(BoardCommand::Enable).is_err());
        }));
    }
}

#[test]
fn noise_on_the_line_is_no_message() {
    let scene = read(THESIS);
    in_number_type!(scene.number, N => with_bench::<N>(page(THESIS), &scene, |mut bench| {
        bench.state("disabled");
        for byte in 0..=255u8 {
            bench.page.receive(&[byte; 40], bench.now_ms);
            bench.page.receive(&[0], bench.now_ms);
        }
        bench.give(BoardCommand::Enable);
        bench.state("idle");
    }));
    let wait = Duration::from_secs(1);
    assert!(page(THESIS).poll(wait.as_secs_f64() * 1e3).len() > 4);
}

#[test]
fn parts_that_are_no_scene_are_refused() {
    let carrying =
        |number: &str, figures: &[f64], moves: &[f64], ranges: &[u32], bodies: &[f64]| {
            let tools = vec!["pen".into(), "saw".into()];
            let levels = vec![];
            let name = "a".into();
            let made = Board::new(
                name,
                number,
                1,
                figures,
                moves,
                levels,
                ranges,
                &[],
                tools,
                bodies,
                7,
            );
            made.map(|_| ())
        };
    let new = |number: &str, figures: &[f64], moves: &[f64], ranges: &[u32]| {
        carrying(number, figures, moves, ranges, &[])
    };
    assert_eq!(new("f32", &[1.0; 8], &[0.0; 22], &[0; 5]), Ok(()));
    assert!(new("f16", &[1.0; 8], &[], &[]).is_err());
    assert!(new("f32", &[1.0; 7], &[], &[]).is_err());
    assert!(new("f32", &[1.0; 8], &[0.0; 21], &[]).is_err());
    assert!(new("f32", &[1.0; 8], &[], &[0; 4]).is_err());
    let with = |bodies: &[f64]| carrying("f32", &[1.0; 8], &[], &[], bodies);
    assert_eq!(with(&[1.0; 13]), Ok(()));
    assert!(with(&[1.0; 12]).is_err() && with(&[1.0; 7]).is_err() && with(&[2.0; 13]).is_err());
}
