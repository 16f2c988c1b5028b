//! Machines on Zenoh: a router that fails under load, lines that are cut, clients that vanish.

mod board;
mod commander;
mod processes;
mod recorder;

use board::Board;
use commander::{Commander, ask};
use processes::{fleet, free_endpoint, router, router_with};
use recorder::{Account, Recorder};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};
use trirrr_scene::Scene;
use trirrr_zenoh::session::{self, SessionMode};
use zenoh::Session;

/// Way of a jog along x, m.
const STEP_M: f64 = 2e-4;

/// Start of the thesis machine along x, m.
const START_X_M: f64 = 0.21;

fn scene() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/thesis.toml")
}

fn open(endpoint: &str) -> Session {
    session::open(SessionMode::Client, None, &[endpoint.into()]).unwrap()
}

/// A fleet that is commanded while its router fails.
struct FleetTest {
    machines: usize,
    /// Clients, which share the machines.
    threads: usize,
    restarts: u32,
    /// Time with a router between two failures.
    up: Duration,
    down: Duration,
}

impl FleetTest {
    /// Plays the test. Prints its figures, and returns the account of ticks.
    fn play(&self) -> Account {
        let folder = tempfile::tempdir().unwrap();
        let scene = scene().canonicalize().unwrap();
        let file = folder.path().join("fleet.toml");
        let entry = format!(
            "[[machine]]\nname = \"sim\"\ncount = {}\nscene = {scene:?}\n",
            self.machines
        );
        std::fs::write(&file, entry).unwrap();
        let endpoint = free_endpoint();
        let mut hub = router(&endpoint);
        let session = open(&endpoint);
        let mut recorder = Recorder::start(&session);
        // A crowded computer fetches late.
        let arguments = ["--control", "--history", "180", "--fleet"];
        let arguments = [arguments.as_slice(), &[file.to_str().unwrap()]].concat();
        let _fleet = fleet(&endpoint, &arguments, &folder.path().join("log"));

        let names: Vec<String> = (1..=self.machines).map(|i| format!("sim-{i}")).collect();
        let [sent, repeated, executed] = [(); 3].map(|()| AtomicU64::new(0));
        let (stop, begin) = (AtomicBool::new(false), Instant::now());
        let wanted = std::thread::scope(|scope| {
            let share = names.len().div_ceil(self.threads);
            let workers: Vec<_> = (names.chunks(share))
                .map(|names| {
                    let (session, stop) = (&session, &stop);
                    let (sent, repeated, executed) = (&sent, &repeated, &executed);
                    scope.spawn(move || {
                        let counts = jog_in_turn(session, names, stop);
                        sent.fetch_add(counts[0], Ordering::Relaxed);
                        repeated.fetch_add(counts[1], Ordering::Relaxed);
                        executed.fetch_add(counts[2], Ordering::Relaxed);
                    })
                })
                .collect();
            let mut wait = |time: Duration| {
                let until = Instant::now() + time;
                while Instant::now() < until {
                    recorder.work();
                    std::thread::sleep(Duration::from_millis(20));
                }
            };
            for _ in 0..self.restarts {
                wait(self.up);
                hub.kill();
                wait(self.down);
                hub = router(&endpoint);
            }
            wait(self.up);
            stop.store(true, Ordering::Relaxed);
            while !workers.iter().all(|worker| worker.is_finished()) {
                wait(Duration::from_millis(50));
            }
            for worker in workers {
                worker.join().unwrap();
            }
            let next = |name: &String| {
                let state = Commander::new(&session, name, "recorder").state();
                (name.clone(), state["next_sample"].as_u64().unwrap())
            };
            let wanted: BTreeMap<String, u64> = names.iter().map(next).collect();
            recorder.complete(&wanted, commander::PATIENCE);
            wanted
        });
        let account = recorder.account(&wanted);
        let seconds = begin.elapsed().as_secs_f64();
        let [sent, repeated, executed] = [sent, repeated, executed].map(AtomicU64::into_inner);
        println!(
            "{} machines at 100 ticks per second, {seconds:.0} s, {} router restarts of {} ms",
            account.machines,
            self.restarts,
            self.down.as_millis()
        );
        println!(
            "{} ticks: {} came late from the history, {} lost, {} doubled, {} out of step",
            account.ticks, account.fetched, account.lost, account.doubled, account.out_of_step
        );
        println!(
            "{sent} commands, repeated {repeated} times; {executed} accepted by machines, each executed once"
        );
        account
    }
}

/// Commands machines in turn until `stop`. Checks that each has gone as far as it was told, and no farther. Returns the commands that were sent, the
/// repetitions, and what the machines have executed.
fn jog_in_turn(session: &Session, names: &[String], stop: &AtomicBool) -> [u64; 3] {
    let greet = |name: &String| {
        let mut commander = Commander::new(session, name, "tester");
        commander.accepted("take", json!({ "lease_s": 60 }));
        commander.accepted("enable", json!({}));
        commander.until(|state| state["state"] == "idle");
        (commander, 1_u64, 0_u64)
    };
    let mut machines: Vec<_> = names.iter().map(greet).collect();
    while !stop.load(Ordering::Relaxed) {
        for (commander, executed, jogs) in &mut machines {
            // Each third is repeated though it is answered.
            *executed += commander.jog(json!({ "dx_m": STEP_M }), *jogs % 3 == 0);
            *jogs += 1;
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    let mut counts = [0; 3];
    for (commander, executed, jogs) in &mut machines {
        let mut state =
            commander.until(|state| state["state"] == "idle" || state["state"] == "holding");
        if state["state"] == "holding" {
            let owned = commander.command("take", json!({ "lease_s": 60 }));
            assert!(owned.is_accepted(), "{owned:?}");
            commander.accepted("resume", json!({}));
            *executed += 1;
            state = commander.until(|state| state["state"] == "idle");
        }
        // The pose is that of the last sample: of the rest.
        let expected = START_X_M + STEP_M * *jogs as f64;
        let x = commander.until(|state| is_at(state, expected))["pose"]["x_m"].as_f64();
        assert!(x.is_some(), "{state}");
        assert_eq!(state["executed"].as_u64(), Some(*executed), "{state}");
        counts[0] += commander.sent;
        counts[1] += commander.repeated;
        counts[2] += *executed;
    }
    counts
}

fn is_at(state: &Value, x_m: f64) -> bool {
    let x = state["pose"]["x_m"].as_f64().unwrap_or_default();
    (x - x_m).abs() < 1e-9
}

/// Nothing is lost and nothing doubled.
fn assert_exact(account: &Account) {
    let faults = [account.lost, account.doubled, account.out_of_step];
    assert_eq!(faults, [0; 3], "{account:?}");
}

#[test]
fn nothing_is_lost_or_doubled_where_the_router_fails() {
    let test = FleetTest {
        machines: 3,
        threads: 3,
        restarts: 1,
        up: Duration::from_secs(3),
        down: Duration::from_millis(700),
    };
    let account = test.play();
    assert_exact(&account);
    assert!(account.fetched > 0, "the failure has swallowed nothing");
}

#[test]
#[ignore = "two minutes of a hundred machines: cargo xtask nightly"]
fn a_hundred_machines_are_accounted_for_where_the_router_fails() {
    let test = FleetTest {
        machines: 100,
        threads: 10,
        restarts: 5,
        up: Duration::from_secs(15),
        down: Duration::from_secs(2),
    };
    let account = test.play();
    assert_exact(&account);
    assert!(account.fetched > 0, "the failures have swallowed nothing");
}

#[test]
fn a_command_is_executed_once_where_the_line_is_cut() {
    let folder = tempfile::tempdir().unwrap();
    let endpoint = free_endpoint();
    let _hub = router(&endpoint);
    let session = open(&endpoint);
    let board = Board::start(Scene::read(scene()).unwrap());
    let scene = scene();
    let arguments = [scene.to_str().unwrap(), "--control", "--name", "cell"];
    let arguments = [arguments.as_slice(), &["--port", &board.port]].concat();
    let _fleet = fleet(&endpoint, &arguments, &folder.path().join("log"));

    let mut commander = Commander::new(&session, "cell", "tester");
    commander.until(|state| state["connected"] == true);
    commander.accepted("take", json!({ "lease_s": 30 }));
    commander.accepted("enable", json!({}));
    commander.accepted("feed", json!({ "percent": 90 }));
    commander.until(|state| state["state"] == "idle" && state["feed_percent"] == 90);
    let steps: u32 = 3;
    for _ in 0..steps {
        commander.jog(json!({ "dx_m": STEP_M }), false);
    }
    let end = START_X_M + STEP_M * f64::from(steps);
    commander.until(|state| state["state"] == "idle" && is_at(state, end));

    let heard = board.heard();
    assert_eq!(heard.enabled.len(), 1, "one number: {heard:?}");
    assert!(heard.cut.len() > 2, "{heard:?}");
    assert!(heard.repeated.len() >= 2, "enable and feed: {heard:?}");
    assert!(heard.retargets.len() >= steps as usize, "{heard:?}");
    assert_eq!(commander.state()["executed"], 2 + steps);
}

#[test]
fn a_machine_holds_where_its_client_vanishes() {
    let folder = tempfile::tempdir().unwrap();
    // A job of eight seconds.
    let text = std::fs::read_to_string(scene()).unwrap();
    let slow = text.replace("duration_s = 1.0", "duration_s = 8.0");
    assert_ne!(slow, text);
    let file = folder.path().join("slow.toml");
    std::fs::write(&file, slow).unwrap();
    let endpoint = free_endpoint();
    let _hub = router(&endpoint);
    let session = open(&endpoint);
    let arguments = [file.to_str().unwrap(), "--control", "--name", "cell"];
    let _fleet = fleet(&endpoint, &arguments, &folder.path().join("log"));

    let mut first = Commander::new(&session, "cell", "first");
    let connected = first.until(|state| state["connected"] == true);
    assert_eq!(
        connected["state"], "disabled",
        "a connection enables nothing"
    );
    let early = first.command("enable", json!({}));
    assert!(early.text.contains("take it"), "{early:?}");
    first.accepted("take", json!({ "lease_s": 30 }));
    let off = first.command("run", json!({}));
    assert_eq!(off.text, "not while the machine is disabled");
    first.accepted("enable", json!({}));
    first.until(|state| state["state"] == "idle");
    first.accepted("run", json!({}));
    first.until(|state| state["state"] == "running");

    let mut second = Commander::new(&session, "cell", "second");
    let taken = second.command("take", json!({}));
    assert_eq!(taken.text, "first has control");
    // The lease would run for a long time: its token is gone.
    first.token = None;
    let held = second.until(|state| state["state"] == "holding");
    assert_eq!(held["text"], "holding (host silent)");
    assert_eq!(held["controller"], Value::Null);
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(second.state()["state"], "holding", "nothing resumes it");
    second.token = None;

    // The first comes back. Its job goes on once it says so.
    let mut first = Commander::new(&session, "cell", "first");
    first.accepted("take", json!({ "lease_s": 1 }));
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(first.state()["state"], "holding");
    first.accepted("resume", json!({}));
    first.until(|state| state["state"] == "running");
    // The lease ends in the middle of the way.
    first.until(|state| state["text"] == "holding (host silent)");
    first.accepted("take", json!({ "lease_s": 30 }));
    first.accepted("resume", json!({}));
    let done = first.until(|state| state["state"] == "idle" && state["motion"].is_null());
    assert!(is_at(&done, 0.28), "{done}");
    let events = ask(&session, "trirrr/cell/events", None).unwrap();
    let texts: Vec<_> = (events.as_array().unwrap().iter())
        .map(|event| event["text"].as_str().unwrap())
        .collect();
    assert!(texts.contains(&"job: done"), "{texts:?}");
    let numbers = events.as_array().unwrap().iter();
    assert!(
        numbers
            .enumerate()
            .all(|(i, event)| event["number"] == i as u64)
    );

    // Everybody may make it stand.
    first.accepted("jog", json!({ "dx_m": -0.05 }));
    let mut second = Commander::new(&session, "cell", "second");
    second.accepted("stop", json!({}));
    let stopped = second.until(|state| state["state"] == "idle" && state["motion"].is_null());
    assert!(!is_at(&stopped, 0.23), "{stopped}");
}

#[test]
fn a_program_without_control_looks_on_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let endpoint = free_endpoint();
    let _hub = router(&endpoint);
    let session = open(&endpoint);
    let scene = scene();
    let _fleet = fleet(
        &endpoint,
        &[scene.to_str().unwrap()],
        &folder.path().join("log"),
    );
    let mut commander = Commander::new(&session, "thesis", "tester");
    commander.until(|state| state["connected"] == true);
    for verb in ["take", "enable", "stop"] {
        let answer = commander.command(verb, json!({}));
        assert_eq!(answer.outcome, "refused");
        assert_eq!(answer.text, "the program looks on: start it with --control");
    }
    assert_eq!(commander.state()["state"], "disabled");
    let identity = ask(&session, "trirrr/thesis/identity", None).unwrap();
    assert_eq!(identity["machine"]["scene"], "thesis");
    assert_eq!(identity["machine"]["host_timeout_s"], 1.0);
    let nobody = ask(&session, "trirrr/thesis/command/stop", Some(&json!({}))).unwrap();
    let text = nobody["text"].as_str().unwrap();
    assert!(text.contains("client is missing"), "{text}");
}

#[test]
fn a_router_keeps_commands_away_by_its_configuration() {
    let folder = tempfile::tempdir().unwrap();
    let endpoint = free_endpoint();
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/watchers.json5");
    let _hub = router_with(&endpoint, &["--config", config.to_str().unwrap()]);
    let session = open(&endpoint);
    let scene = scene();
    let arguments = [scene.to_str().unwrap(), "--control"];
    let _fleet = fleet(&endpoint, &arguments, &folder.path().join("log"));
    let begin = Instant::now();
    while ask(&session, "trirrr/thesis/state", None).is_none() {
        assert!(begin.elapsed() < commander::PATIENCE, "no state");
    }
    let hello = json!({ "client": "tester" });
    assert_eq!(
        ask(&session, "trirrr/thesis/command/hello", Some(&hello)),
        None
    );
}
