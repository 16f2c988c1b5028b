//! The program: what it records, and what it gives to Foxglove.

use mcap::MessageStream;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::Duration;
use tempfile::TempDir;
use trirrr_core::number::Arithmetic;
use trirrr_core::units::Units;
use trirrr_line::Frames;
use trirrr_protocol::message::{Acting, Event, Message, State, Telemetry, TelemetryFields};
use trirrr_scene::record::Record;
use trirrr_scene::{Scene, pipeline};
use tungstenite::client::IntoClientRequest;
use tungstenite::http::HeaderValue;

fn scene_file() -> String {
    format!("{}/../../scenes/vertical.toml", env!("CARGO_MANIFEST_DIR"))
}

fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trirrr-foxglove"));
    command.arg(scene_file()).args(arguments);
    command
}

/// Records of the scene's job in binary64.
fn records() -> Vec<Record> {
    let scene = Scene::read(scene_file()).unwrap();
    let machine = pipeline::of_scene::<f64>(&scene, Units::SI).unwrap();
    let player = trirrr_scene::JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let record = |(index, setpoint)| {
        let t = index as f64 * scene.period_s();
        machine.evaluate(t, &setpoint).unwrap()
    };
    player.setpoints().enumerate().map(record).collect()
}

/// A table as `trirrr run` writes it, without what is not read.
fn table(records: &[Record]) -> String {
    let mut text = String::from("t,x,y,alpha,vx,vy,valpha,ax,ay,aalpha,tool\n");
    for record in records {
        let motion = [record.pose, record.velocity, record.acceleration].concat();
        let cells = motion.iter().map(|value| format!("{value:?},"));
        let cells: String = cells.collect();
        writeln!(text, "{:?},{cells}0.25", record.t).unwrap();
    }
    text
}

/// Messages of a recording by topic: their times in nanoseconds, and their bytes.
fn messages(file: &Path) -> BTreeMap<String, Vec<(u64, Vec<u8>)>> {
    let bytes = std::fs::read(file).unwrap();
    let mut topics: BTreeMap<String, Vec<(u64, Vec<u8>)>> = BTreeMap::new();
    for message in MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.as_ref().unwrap();
        assert!(!schema.data.is_empty(), "{}", message.channel.topic);
        let topic = topics.entry(message.channel.topic.clone()).or_default();
        topic.push((message.log_time, message.data.to_vec()));
    }
    topics
}

fn text(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn a_table_becomes_a_recording_with_its_values() {
    let folder = TempDir::new().unwrap();
    let records = records();
    let csv = folder.path().join("ticks.csv");
    std::fs::write(&csv, table(&records)).unwrap();
    let file = folder.path().join("run.mcap");
    let paths = [
        "--ticks",
        csv.to_str().unwrap(),
        "--mcap",
        file.to_str().unwrap(),
    ];
    let output = program(&paths).output().unwrap();
    assert!(output.status.success(), "{}", text(&output));

    let topics = messages(&file);
    let names: Vec<&str> = topics.keys().map(String::as_str).collect();
    assert_eq!(names, ["/motors", "/platform", "/scene", "/tf"]);
    for topic in ["/motors", "/platform", "/tf"] {
        assert_eq!(topics[topic].len(), records.len());
    }
    // Drawings are for eyes.
    let drawn: Vec<u64> = topics["/scene"].iter().map(|(at, _)| *at).collect();
    assert!(drawn.len() > records.len() / 10);
    assert!(drawn.windows(2).all(|pair| pair[1] - pair[0] >= 16_000_000));
    let rows = topics["/motors"].iter().zip(&topics["/platform"]);
    for ((motors, platform), record) in rows.zip(&records) {
        assert_eq!(motors.0, (1e9 * record.t).round() as u64);
        let motors: Value = serde_json::from_slice(&motors.1).unwrap();
        let platform: Value = serde_json::from_slice(&platform.1).unwrap();
        for (index, leg) in record.legs.iter().enumerate() {
            assert_eq!(motors["th1"][index], leg.th1);
            assert_eq!(motors["tau"][index], leg.torque);
        }
        assert_eq!(platform["alpha"], record.pose[2]);
        assert_eq!(platform["tool"], 0.25);
    }

    // What was recorded stays.
    let before = std::fs::read(&file).unwrap();
    let again = program(&paths).output().unwrap();
    assert_eq!(again.status.code(), Some(2));
    assert!(
        text(&again).contains("is there already"),
        "{}",
        text(&again)
    );
    assert_eq!(std::fs::read(&file).unwrap(), before);
}

#[test]
fn a_table_that_is_none_is_refused_by_line_and_column() {
    let folder = TempDir::new().unwrap();
    let records = records();
    let good = table(&records[..3]);
    let cases = [
        (good.replace("valpha", "w"), "no column valpha"),
        (
            good.replacen("0.25", "on", 1),
            "line 2: tool is \"on\", expected a number",
        ),
        (good.replacen("0.25\n", "0.25,7\n", 1), "line: 2"),
    ];
    for (index, (bad, why)) in cases.iter().enumerate() {
        let csv = folder.path().join("bad.csv");
        std::fs::write(&csv, bad).unwrap();
        let file = folder.path().join(format!("{index}.mcap"));
        let paths = [
            "--ticks",
            csv.to_str().unwrap(),
            "--mcap",
            file.to_str().unwrap(),
        ];
        let output = program(&paths).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output).contains(why), "{why}: {}", text(&output));
    }
}

/// Ends with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn sample(record: &Record, tick: u32) -> Message<f32> {
    let setpoint = trirrr_core::setpoint::Setpoint::<f32> {
        pose: trirrr_core::setpoint::Pose::from_f64(record.pose[0], record.pose[1], record.pose[2]),
        velocity: nalgebra::Vector3::from(record.velocity).map(f32::from_f64),
        acceleration: nalgebra::Vector3::from(record.acceleration).map(f32::from_f64),
    };
    Message::Telemetry(Telemetry {
        tick,
        state: State::Running,
        acting: Acting::Nothing,
        number: 1,
        at: tick,
        part: 0,
        lost: 0,
        fields: TelemetryFields::SETPOINT | TelemetryFields::TOOL,
        setpoint,
        angles: [0.0; 3],
        rates: [0.0; 3],
        accelerations: [0.0; 3],
        torques: [0.0; 3],
        tool: 0.5,
        duration: 0,
    })
}

/// A machine for watchers: it says the same ten samples, ten times a second, until the watcher goes.
fn machine(records: Vec<Record>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let event: Message<f32> = Message::Event(Event::State {
            state: State::Running,
            acting: Acting::Nothing,
            done: 0,
        });
        loop {
            let mut bytes = Vec::new();
            Frames::append(&event, &mut bytes);
            for (tick, record) in (1..).zip(&records) {
                Frames::append(&sample(record, tick), &mut bytes);
            }
            if stream.write_all(&bytes).is_err() {
                return;
            }
            thread::sleep(Duration::from_millis(100));
        }
    });
    format!("tcp:{address}")
}

/// Foxglove's side of its protocol: text in JSON, and messages as bytes.
#[test]
fn foxglove_subscribes_to_the_motors_of_a_watched_machine() {
    let records = records();
    let wanted: Vec<Record> = records
        .iter()
        .skip(100)
        .step_by(10)
        .take(10)
        .cloned()
        .collect();
    let port = machine(wanted.clone());
    let mut child = program(&["--port", &port, "--listen", "0"]);
    let mut child = Running(child.stdout(Stdio::piped()).spawn().unwrap());
    let mut lines = BufReader::new(child.0.stdout.take().unwrap()).lines();
    let first = lines.next().unwrap().unwrap();
    let (_, address) = first.split_once("ws://").unwrap();

    let mut request = format!("ws://{address}").into_client_request().unwrap();
    let protocol = HeaderValue::from_static("foxglove.sdk.v1");
    request
        .headers_mut()
        .insert("Sec-WebSocket-Protocol", protocol);
    let stream = TcpStream::connect(address).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_secs(20)))
        .unwrap();
    let (mut socket, _) = tungstenite::client(request, stream).unwrap();
    let mut channel = None;
    while channel.is_none() {
        let tungstenite::Message::Text(said) = socket.read().unwrap() else {
            continue;
        };
        let said: Value = serde_json::from_str(&said).unwrap();
        let channels = said["channels"].as_array().into_iter().flatten();
        channel = channel.or(channels
            .filter(|channel| channel["topic"] == "/motors")
            .find_map(|channel| {
                assert_eq!(channel["encoding"], "json");
                assert_eq!(channel["schemaEncoding"], "jsonschema");
                channel["id"].as_u64()
            }));
    }
    let subscribe = serde_json::json!({
        "op": "subscribe", "subscriptions": [{ "id": 7, "channelId": channel.unwrap() }],
    });
    socket
        .send(tungstenite::Message::Text(subscribe.to_string().into()))
        .unwrap();

    // A message: 1, the subscription, a time, and the bytes.
    let scene = Scene::read(scene_file()).unwrap();
    let machine = pipeline::of_scene::<f32>(&scene, Units::SI).unwrap();
    let torques = |record: &Record| {
        let Message::Telemetry(sample) = sample(record, 0) else {
            panic!("a sample");
        };
        let found = machine.evaluate(0.0, &sample.setpoint).unwrap();
        found.legs.each_ref().map(|leg| leg.torque)
    };
    let wanted: Vec<[f64; 3]> = wanted.iter().map(torques).collect();
    let mut found = Vec::new();
    while found.len() < 20 {
        let tungstenite::Message::Binary(said) = socket.read().unwrap() else {
            continue;
        };
        assert_eq!(said[0], 1);
        assert_eq!(u32::from_le_bytes(said[1..5].try_into().unwrap()), 7);
        let values: Value = serde_json::from_slice(&said[13..]).unwrap();
        found.push([0, 1, 2].map(|motor| values["tau"][motor].as_f64().unwrap()));
    }
    assert!(
        found.iter().all(|torque| wanted.contains(torque)),
        "{found:?} {wanted:?}"
    );
}

#[test]
fn a_port_that_is_not_there_is_a_failure() {
    let output = program(&["--port", "tcp:127.0.0.1:1", "--listen", "0"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output).contains("127.0.0.1:1"), "{}", text(&output));
}
