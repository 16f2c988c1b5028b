//! `trirrr grbl` with its own machine, from the side of a sender.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Longest wait for what has to come. It is long for busy machines; nothing is measured by it.
const PATIENCE: Duration = Duration::from_secs(60);

struct Server {
    process: Child,
    address: String,
    /// What else it says.
    lines: Receiver<String>,
}

impl Server {
    fn start(more: &[&str]) -> Self {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/engraving.toml");
        let own = ["grbl", scene, "--listen", "tcp:127.0.0.1:0"];
        Self::of(&[&own, more].concat())
    }

    fn of(arguments: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_trirrr"))
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(process.stdout.take().unwrap()).lines();
        let first = lines.next().unwrap().unwrap();
        // What else it says must not fill the pipe.
        let (say, said) = channel();
        std::thread::spawn(move || {
            // A test that does not listen has dropped the other end.
            lines
                .map_while(Result::ok)
                .for_each(|line| drop(say.send(line)));
        });
        let (address, _) = first.strip_prefix("tcp:").unwrap().split_once(' ').unwrap();
        Self {
            process,
            address: address.to_owned(),
            lines: said,
        }
    }

    /// Presses an input of a device with `--keys`, or lets it go.
    fn press(&mut self, input: &str) {
        writeln!(self.process.stdin.as_mut().unwrap(), "{input}").unwrap();
    }

    /// Waits for a line with `what`.
    fn wait_for(&self, what: &str) {
        let mut others = Vec::new();
        loop {
            match self.lines.recv_timeout(PATIENCE) {
                Ok(line) if line.contains(what) => return,
                Ok(line) => others.push(line),
                Err(error) => panic!("no {what:?}: {error}: {others:?}"),
            }
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A sender.
struct Sender {
    stream: TcpStream,
    bytes: Vec<u8>,
}

/// State, place in mm and degrees, feed in mm/min and S of a report.
#[derive(Clone, Debug)]
struct Report {
    state: String,
    place: [f64; 3],
    feed: f64,
    power: f64,
    text: String,
}

impl Sender {
    fn connect(server: &Server) -> Self {
        let start = Instant::now();
        loop {
            let stream = TcpStream::connect(&server.address).unwrap();
            let timeout = Some(Duration::from_millis(20));
            stream.set_read_timeout(timeout).unwrap();
            let mut sender = Self {
                stream,
                bytes: Vec::new(),
            };
            match sender.line() {
                Some(line) if line.starts_with("Grbl") => {
                    assert_eq!(line, "Grbl 1.1h ['$' for help]");
                    return sender;
                }
                // The one before is not gone yet.
                other => assert!(start.elapsed() < PATIENCE, "{other:?}"),
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// A sender of a machine that is on.
    fn unlocked(server: &Server) -> Self {
        let mut sender = Self::connect(server);
        sender.send("$X\n");
        sender.answer("ok");
        sender
    }

    fn send(&mut self, text: &str) {
        let bytes: Vec<u8> = text.chars().map(|c| c as u8).collect();
        self.stream.write_all(&bytes).unwrap();
    }

    /// Next line that is not empty. `None`: the far end has closed the line.
    fn line(&mut self) -> Option<String> {
        let start = Instant::now();
        loop {
            if let Some(end) = self.bytes.iter().position(|byte| *byte == b'\n') {
                let line: Vec<u8> = self.bytes.drain(..=end).collect();
                let line = String::from_utf8(line).unwrap().trim().to_owned();
                if !line.is_empty() {
                    return Some(line);
                }
                continue;
            }
            assert!(start.elapsed() < PATIENCE, "nothing comes");
            let mut bytes = [0; 512];
            match self.stream.read(&mut bytes) {
                Ok(0) => return None,
                Ok(length) => self.bytes.extend_from_slice(&bytes[..length]),
                Err(error) if is_passing(&error) => {}
                Err(_) => return None,
            }
        }
    }

    /// Lines up to one that is `what`.
    fn wait_for(&mut self, what: &str) -> Vec<String> {
        let mut lines = Vec::new();
        while lines.last().is_none_or(|line| line != what) {
            lines.push(
                self.line()
                    .unwrap_or_else(|| panic!("closed after {lines:?}")),
            );
        }
        lines
    }

    /// Lines up to an answer, which has to be `what`.
    fn answer(&mut self, what: &str) -> Vec<String> {
        let mut lines = Vec::new();
        loop {
            let line = self.line().expect("an answer");
            let is_answer = line == "ok" || line.starts_with("error:");
            lines.push(line);
            if is_answer {
                assert_eq!(lines.last().unwrap(), what, "{lines:?}");
                return lines;
            }
        }
    }

    fn report(&mut self) -> Report {
        self.send("?");
        let text = loop {
            let line = self.line().expect("a report");
            if line.starts_with('<') {
                break line;
            }
        };
        let inside = text.trim_matches(['<', '>']);
        let (state, _) = inside.split_once('|').unwrap();
        let numbers = |key: &str| -> Vec<f64> {
            let field = inside.split('|').find_map(|field| field.strip_prefix(key));
            field
                .unwrap()
                .split(',')
                .map(|each| each.parse().unwrap())
                .collect()
        };
        let (place, speed) = (numbers("MPos:"), numbers("FS:"));
        Report {
            state: state.into(),
            place: [place[0], place[1], place[3]],
            feed: speed[0],
            power: speed[1],
            text: text.clone(),
        }
    }

    /// Asks until a report is as wanted.
    fn until(&mut self, wanted: impl Fn(&Report) -> bool) -> Report {
        let start = Instant::now();
        loop {
            let report = self.report();
            if wanted(&report) {
                return report;
            }
            assert!(start.elapsed() < PATIENCE, "{report:?}");
        }
    }

    fn idle(&mut self) -> [f64; 3] {
        self.until(|report| report.state == "Idle").place
    }

    /// Sends lines as senders do that count the bytes of the receive buffer.
    fn stream(&mut self, program: &str) {
        let mut sent = std::collections::VecDeque::new();
        for line in program.lines() {
            while sent.iter().sum::<usize>() + line.len() + 1 > 127 {
                self.answer("ok");
                sent.pop_front();
            }
            self.send(&format!("{line}\n"));
            sent.push_back(line.len() + 1);
        }
        sent.iter().for_each(|_| drop(self.answer("ok")));
    }
}

fn is_passing(error: &std::io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
}

/// A thousandth of a millimetre: the last digit of a report.
fn near(place: [f64; 3], wanted: [f64; 3]) {
    let off = |i: usize| (place[i] - wanted[i]).abs();
    assert!((0..3).all(|i| off(i) < 2e-3), "{place:?} is not {wanted:?}");
}

/// Start of the scene's job, mm and degrees.
const START: [f64; 3] = [250.0, 245.0, 22.918];

fn from_start(x: f64, y: f64) -> [f64; 3] {
    [START[0] + x, START[1] + y, START[2]]
}

#[test]
fn nothing_moves_before_it_is_unlocked() {
    let server = Server::start(&[]);
    let mut sender = Sender::connect(&server);
    assert_eq!(sender.report().state, "Alarm");
    for (line, number) in [
        ("G0 X260", "error:9"),
        ("$J=G91 X1 F100", "error:8"),
        ("M3 S100", "error:9"),
    ] {
        sender.send(&format!("{line}\n"));
        let said = sender.answer(number);
        assert!(said.concat().contains("locked"), "{said:?}");
    }
    assert_eq!(sender.report().state, "Alarm");
    sender.send("$X\n");
    assert!(
        sender
            .answer("ok")
            .contains(&"[MSG:Caution: Unlocked]".to_owned())
    );
    near(sender.idle(), START);
}

#[test]
fn a_job_is_played_to_its_end_and_the_tool_with_it() {
    let server = Server::start(&["--ignore-z"]);
    let mut sender = Sender::unlocked(&server);
    sender.stream("G21 G90\nG10 L20 P1 X0 Y0\nM4 S0\n");
    // A raster of short moves, back and forth.
    let mut program = String::from("G91 Z1\nG1 F2400\n");
    for row in 0..3 {
        let way = if row % 2 == 0 { 0.4 } else { -0.4 };
        for step in 0..40 {
            program += &format!("X{way} S{}\n", 1000 * (step % 2));
        }
        program += "Y0.5 S0\n";
    }
    program += "G2 X4 Y0 I2 J0 S300\nG90\n";
    sender.stream(&program);
    let report = sender.until(|report| report.state == "Run" && report.power > 1.0);
    assert!(report.feed > 0.0 && report.feed < 2500.0, "{report:?}");
    // Three rows to the right, left, right; then half a circle.
    near(sender.idle(), from_start(16.0 + 4.0, 1.5));
    let report = sender.report();
    assert_eq!((report.feed, report.power), (0.0, 0.0));
    sender.send("G0 X0 Y0\n");
    sender.answer("ok");
    near(sender.idle(), START);
    // The angle of the platform.
    sender.send("G1 A10 F600\n");
    sender.answer("ok");
    near(sender.idle(), [START[0], START[1], 10.0]);
}

#[test]
fn holds_resets_and_overrides_act_at_once() {
    let server = Server::start(&[]);
    let mut sender = Sender::unlocked(&server);
    sender.stream("G91\nG1 X40 F600 M3 S500\nX-40\n");
    sender.until(|report| report.state == "Run" && report.place[0] > START[0] + 1.0);
    sender.send("!");
    let held = sender.until(|report| report.state == "Hold:0");
    assert_eq!(held.power, 0.0, "the tool is off: {held:?}");
    assert_eq!(sender.report().place, held.place);
    sender.send("~");
    sender.until(|report| report.place[0] > held.place[0] + 0.5);
    // Half the speed, by five steps of ten percent.
    sender.send("\u{92}\u{92}\u{92}\u{92}\u{92}");
    sender.until(|report| report.state == "Run" && (report.feed - 300.0).abs() < 20.0);
    sender.until(|report| report.text.contains("|Ov:50,100,100"));
    sender.send("\u{18}");
    sender.wait_for("Grbl 1.1h ['$' for help]");
    let stopped = sender.idle();
    assert!(stopped[0] > START[0] + 1.0 && stopped[0] < START[0] + 40.0);
    near(sender.idle(), stopped);
    // Modes are those of the start, and the path goes on from here.
    sender.send("G1 X250 Y245 F6000\n");
    sender.answer("ok");
    near(sender.idle(), START);
    sender.until(|report| report.text.contains("|Ov:100,100,100"));
}

/// A line that never ends hides nothing, and the line to a board that is lost is told at once.
#[test]
fn real_time_bytes_are_heard_in_a_line_without_an_end_and_while_the_board_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let [mut device, server] = with_valves(folder.path());
    let mut sender = Sender::unlocked(&server);
    let start = sender.report().place[0];
    sender.stream("G91 G21\nG1 X60 F300\n");
    sender.until(|report| report.place[0] > start + 0.5);
    sender.send(&format!("({}", "y".repeat(5000)));
    sender.send("!");
    let held = sender.until(|report| report.state == "Hold:0").place;
    assert!(held[0] < start + 59.0);
    sender.send("~");
    sender.until(|report| report.state == "Run" && report.place[0] > held[0]);
    device.process.kill().unwrap();
    let lines = sender.wait_for("ALARM:1");
    assert!(
        lines
            .iter()
            .any(|line| line.contains("the line to the machine is lost")),
        "{lines:?}"
    );
    assert_eq!(sender.report().state, "Alarm");
    // The line that was never ended is one, and is answered.
    sender.send(")\nG1 X1\n$X\n");
    sender.answer("ok");
    sender.answer("error:9");
    sender.answer("error:9");
    // The sender that goes is noticed, and the next one is taken.
    drop(sender);
    assert_eq!(Sender::connect(&server).report().state, "Alarm");
}

#[test]
fn a_jog_ends_where_it_was_sent_or_where_it_was_cancelled() {
    let server = Server::start(&[]);
    let mut sender = Sender::unlocked(&server);
    sender.stream("G20 G91\n$J=G21 G91 X2.5 F600\n$J=G21G90Y250F600\n");
    near(sender.idle(), from_start(2.5, 5.0));
    sender.send("$J=G21 G91 X-30 F600\n");
    sender.answer("ok");
    sender.until(|report| report.state == "Jog" && report.place[0] < START[0]);
    sender.send("\u{85}");
    let stopped = sender.idle();
    assert!(
        stopped[0] < START[0] && stopped[0] > START[0] - 27.0,
        "{stopped:?}"
    );
    // The modes of the program are what they were: inches, and distances.
    sender.send("$G\n");
    assert!(sender.answer("ok")[0].contains("G20 G91"));
    sender.send("$J=G21 G91 X400 F600\n");
    sender.answer("error:15");
    sender.send("$J=X1\n");
    sender.answer("error:22");
    sender.send("$H\n");
    sender.answer("ok");
    near(sender.idle(), START);
}

#[test]
fn each_wrong_line_gets_a_number_and_a_reason_and_moves_nothing() {
    let server = Server::start(&[]);
    let mut sender = Sender::unlocked(&server);
    for (line, number, reason) in [
        ("G1 X260", "error:22", "no feed"),
        ("G41 X260 F100", "error:20", "G41"),
        ("G1 X", "error:2", "X"),
        ("G1 X20,5 F100", "error:1", "X20.5"),
        ("G1 X900 F100", "error:15", "in the frame of the machine"),
        ("G1 Z-1 F100", "error:20", "Z"),
        ("$32=0", "error:3", "laser mode"),
        ("$101=80", "error:3", "scene"),
        ("$N0=G0 X1", "error:3", "by itself"),
        ("$Q", "error:2", "no such command"),
    ] {
        sender.send(&format!("{line}\n"));
        let said = sender.answer(number);
        let message = said.iter().find(|line| line.starts_with("[MSG:"));
        assert!(
            message.is_some_and(|text| text.contains(reason)),
            "{line}: {said:?}"
        );
    }
    near(sender.idle(), START);
}

#[test]
fn a_sender_that_goes_away_leaves_a_machine_at_rest_for_the_next_one() {
    let server = Server::start(&[]);
    let mut first = Sender::unlocked(&server);
    first.stream("G91\nG1 X40 F300\n");
    first.until(|report| report.state == "Run" && report.place[0] > START[0] + 0.5);
    let mut other = TcpStream::connect(&server.address).unwrap();
    let mut said = String::new();
    other.read_to_string(&mut said).unwrap();
    assert!(said.contains("another sender is connected"), "{said}");
    drop(first);
    let mut second = Sender::connect(&server);
    // The machine is on and locked, and comes to rest.
    assert_eq!(second.report().state, "Alarm");
    second.send("G1 X250 F3000\n");
    second.answer("error:9");
    second.send("$X\n");
    second.answer("ok");
    let place = second.idle();
    assert!(place[0] < START[0] + 39.0, "{place:?}");
    near(second.idle(), place);
    second.send("G90 G1 X250 F3000\n");
    second.answer("ok");
    near(second.idle(), START);
    drop(second);
    // A page of the web is no sender.
    let mut web = Sender::connect(&server);
    web.send("POST / HTTP/1.1\r\nHost: x\r\n\r\nG0 X260\n");
    let said: Vec<String> = std::iter::from_fn(|| web.line()).collect();
    assert!(said.concat().contains("no page of the web"), "{said:?}");
    near(Sender::unlocked(&server).idle(), START);
}

/// Sessions in the manner of LightBurn and LaserGRBL, written from their documentation: settings first, polls in between.
#[test]
fn sessions_of_well_known_senders_run_through() {
    let server = Server::start(&["--ignore-z"]);
    let mut sender = Sender::unlocked(&server);
    // LightBurn: header, M4 with power per line, framing jogs.
    sender.send("$I\n");
    sender.answer("ok");
    sender.send("$$\n");
    assert!(sender.answer("ok").iter().any(|line| line == "$30=1000"));
    sender.stream(
        "G00 G17 G40 G21 G54\nG90\nM4\nM8\nG0 X250Y245\nG91\nG1X5S300F1500\nG1Y5\nG1X-5\nG1Y-5\nM9\nG1S0\nM5\nG90\nM2\n",
    );
    near(sender.idle(), START);
    // LaserGRBL: M3, a pass of lines without spaces, and G0 X0 Y0 in coordinates that G92 has set.
    sender.stream("G92X0Y0\nM3 S0\nG90\nG0X1Y1\nS200\nG1X6F1200\nG1X6Y6\nS0\nM5\nG0X0Y0\n");
    near(sender.idle(), START);
    sender.send("$#\n");
    let offsets = sender.answer("ok");
    assert!(
        offsets
            .iter()
            .any(|line| line.starts_with("[G92:250.000,245.000"))
    );
}

/// The engraving scene with a probe, and beside it a device with a wall 3 mm from its start.
#[test]
fn a_wall_is_probed_and_left() {
    let engraving = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/engraving.toml");
    let text = std::fs::read_to_string(&engraving).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let text = text.replacen(
        "[service]",
        "[inputs.probe]\n\n[service]\nplans_paths = true",
        1,
    );
    std::fs::write(&scene, text).unwrap();
    let scene = scene.to_str().unwrap();
    let device = Server::of(&[
        "device",
        scene,
        "--listen",
        "tcp:127.0.0.1:0",
        "--touch",
        "x=0.253",
    ]);
    let port = format!("tcp:{}", device.address);
    let server = Server::of(&[
        "grbl",
        scene,
        "--listen",
        "tcp:127.0.0.1:0",
        "--port",
        &port,
    ]);
    let mut sender = Sender::unlocked(&server);
    let contact = |lines: &[String]| {
        let line = lines.iter().find(|line| line.starts_with("[PRB:"));
        line.expect("a contact").clone()
    };
    // Beside the wall.
    sender.send("G91 G38.3 Y1 F200\n");
    assert!(contact(&sender.answer("ok")).ends_with(":0]"));
    sender.send("G1 Y-1\nG38.2 X6 F200\n");
    sender.answer("ok");
    let felt = contact(&sender.answer("ok"));
    assert!(
        felt.starts_with("[PRB:253.0") && felt.ends_with(":1]"),
        "{felt}"
    );
    let [x, ..] = sender.idle();
    assert!((253.0..254.0).contains(&x), "{x}");
    // It touches still.
    sender.send("G38.2 X6 F200\n");
    assert!(sender.wait_for("ALARM:4").len() > 1);
    sender.answer("ok");
    sender.send("$X\n");
    sender.answer("ok");
    sender.send("G38.4 X-3 F200\n");
    let left = contact(&sender.answer("ok"));
    let at: f64 = left["[PRB:".len()..]
        .split(',')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    // In the tick after the wall, or at it to a micrometre.
    assert!(
        (252.9..=253.0).contains(&at) && left.ends_with(":1]"),
        "{left}"
    );
    sender.send("G38.2 X-1 F200\n");
    sender.wait_for("ALARM:5");
    assert!(contact(&sender.answer("ok")).ends_with(":0]"));
    sender.send("$X\n");
    sender.answer("ok");
    sender.send("$#\n");
    assert!(contact(&sender.answer("ok")).ends_with(":0]"));
}

/// The scene with two spare outputs and an input on a device that plans paths, and the machine for senders.
fn with_valves(folder: &Path) -> [Server; 2] {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let text = std::fs::read_to_string(scenes.join("inputs/valves.toml")).unwrap();
    let file = folder.join("scene.toml");
    let machine = format!("{:?}", scenes.join("thesis.toml"));
    let text = text.replace("\"../thesis.toml\"", &machine);
    std::fs::write(
        &file,
        text.replace("[service]", "[service]\nplans_paths = true"),
    )
    .unwrap();
    let scene = file.to_str().unwrap();
    let listen = ["--listen", "tcp:127.0.0.1:0"];
    let device = Server::of(&[&["device", scene, "--keys"], &listen[..]].concat());
    let port = format!("tcp:{}", device.address);
    let server = Server::of(&[&["grbl", scene, "--port", &port], &listen[..]].concat());
    [device, server]
}

#[test]
fn a_sender_waits_for_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let [mut device, server] = with_valves(folder.path());
    let mut sender = Sender::unlocked(&server);
    // Start of the scene's job: at rest.
    let start = sender.report().place;
    let from_start = |x| [start[0] + x, start[1], start[2]];
    sender.send("M66 P1 L3 Q1\n");
    let said = sender.answer("error:20").concat();
    assert!(said.contains("they have the numbers 0 to 0"), "{said}");
    // The machine stands behind the first motion until the sheet is there, and goes on.
    let wait = "M66 P0 L3 Q1000\nG1 X10\n";
    sender.stream("G91 G21\nG1 X10 F3000\n");
    sender.send(wait);
    let stands = |report: &Report| report.feed == 0.0 && report.place[0] > start[0] + 9.9;
    let standing = sender.until(stands);
    near(standing.place, from_start(10.0));
    assert_eq!(standing.state, "Run");
    device.press("sheet");
    sender.answer("ok");
    sender.answer("ok");
    near(sender.idle(), from_start(20.0));
    // Now it is there, and does not come again in time.
    sender.send("M66 P0 L1 Q0.3\nG1 X-20\n");
    let said = sender.answer("error:9").concat();
    let expected = "input 0 has not gone on within 0.3 s";
    assert!(
        said.contains(expected) && said.contains("ALARM:5"),
        "{said}"
    );
    let alarm = sender.until(|report| report.state == "Alarm");
    near(alarm.place, from_start(20.0));
}

#[test]
fn a_sender_switches_outputs() {
    let folder = tempfile::tempdir().unwrap();
    let [device, server] = with_valves(folder.path());
    let mut sender = Sender::unlocked(&server);
    sender.send("M64 P2\n");
    let said = sender.answer("error:20").concat();
    assert!(said.contains("they have the numbers 0 to 1"), "{said}");
    // Air is an output of jobs: it falls at each stand, and comes back until the program ends.
    sender.stream(
        "G91 G21\nM62 P0\nG1 X10 F3000\nM64 P1\nG1 X10\nM65 P1\nM63 P0\nX-10\nM62 P0\nX-10\nM2\n",
    );
    for on in [
        "air",
        "none",
        "vacuum",
        "air, vacuum",
        "vacuum",
        "none",
        "air",
        "none",
    ] {
        device.wait_for(&format!("outputs on: {on}; inputs"));
    }
    sender.idle();
    // That of the program before is not on.
    sender.stream("G91\nM64 P1\nG1 X5 F3000\nM62 P1\nX-5\nM65 P1\n");
    for on in ["vacuum", "none"] {
        device.wait_for(&format!("outputs on: {on}; inputs"));
    }
}
