//! Devices and streams as processes, and scenes for them.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use trirrr_line::{Frames, Link};
use trirrr_protocol::message::{Command as Ask, Message, Reply, Request, Telemetry};

/// Longer than anything takes on a machine that is busy with other things; a test that waits for
/// this has failed.
const LIMIT: Duration = Duration::from_secs(120);

pub(crate) fn trirrr() -> Command {
    Command::new(env!("CARGO_BIN_EXE_trirrr"))
}

/// A folder with the scene `name`, changed by `edits` (what is there once, and what takes its
/// place). Its host may be silent for long: the test may have to wait for the processor.
pub(crate) fn scene(name: &str, edits: &[(&str, &str)]) -> TempDir {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenes")
        .join(name)
        .with_extension("toml");
    let mut text = fs::read_to_string(file).unwrap();
    let patient = ("[job]\n", "[service]\nsilence_timeout_s = 600\n[job]\n");
    for (from, to) in edits.iter().chain([&patient]) {
        assert_eq!(text.matches(from).count(), 1, "{from:?} in {name}");
        text = text.replace(from, to);
    }
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    folder
}

/// `ticks.csv` as `trirrr run` writes it for the scene in `folder`.
pub(crate) fn run(folder: &TempDir) -> String {
    let out = folder.path().join("run");
    let output = trirrr()
        .args(["run", "scene.toml", "--fast", "--out", "run"])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    ticks(&out)
}

pub(crate) fn ticks(out: &Path) -> String {
    fs::read_to_string(out.join("ticks.csv")).unwrap()
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// The lines that a process writes, as they come.
pub(crate) struct Lines {
    lines: Receiver<String>,
    seen: String,
}

impl Lines {
    pub(crate) fn of(pipe: impl Read + Send + 'static) -> Self {
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in BufReader::new(pipe).lines() {
                let Ok(line) = line else { return };
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        Self {
            lines,
            seen: String::new(),
        }
    }

    /// Waits for a line that holds `part`.
    pub(crate) fn wait_for(&mut self, part: &str) -> String {
        let end = Instant::now() + LIMIT;
        loop {
            // Other lines, of which there may be one a second, give no more time.
            let left = end.saturating_duration_since(Instant::now());
            let Ok(line) = self.lines.recv_timeout(left) else {
                panic!("{part:?} did not come, but\n{}", self.seen);
            };
            self.seen += &format!("{line}\n");
            if line.contains(part) {
                return line;
            }
        }
    }

    /// Everything up to the end of the process.
    pub(crate) fn rest(mut self) -> String {
        for line in self.lines.iter() {
            self.seen += &format!("{line}\n");
        }
        self.seen
    }
}

/// A process that is ended with the test.
pub(crate) struct Process(pub(crate) Child);

impl Process {
    /// Ctrl-C.
    #[cfg(unix)]
    pub(crate) fn interrupt(&self) {
        let kill = Command::new("kill")
            .args(["-INT", &self.0.id().to_string()])
            .status();
        assert!(kill.unwrap().success());
    }

    /// Waits for its end; the exit code.
    pub(crate) fn code(mut self) -> Option<i32> {
        self.0.wait().unwrap().code()
    }

    pub(crate) fn kill(mut self) {
        self.0.kill().unwrap();
        self.0.wait().unwrap();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A device that plays `scene.toml` in `folder`.
pub(crate) struct Device {
    pub(crate) process: Process,
    pub(crate) lines: Lines,
    /// Where it listens.
    pub(crate) address: String,
}

impl Device {
    pub(crate) fn start(folder: &TempDir, more: &[&str]) -> Self {
        let device = ["device", "scene.toml", "--listen", "tcp:127.0.0.1:0"];
        Self::start_as(folder, &[&device, more].concat())
    }

    /// A bridge in the place of a device, to the board at `port`.
    pub(crate) fn bridge(folder: &TempDir, port: &str) -> Self {
        let arguments = ["bridge", "--port", port, "--listen", "tcp:127.0.0.1:0"];
        Self::start_as(folder, &arguments)
    }

    /// `trirrr` with these arguments: a device, or a bridge in its place.
    pub(crate) fn start_as(folder: &TempDir, arguments: &[&str]) -> Self {
        let mut child = trirrr()
            .args(arguments)
            .current_dir(folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = Lines::of(child.stdout.take().unwrap());
        let first = lines.wait_for("tcp:127.0.0.1:");
        let (address, _) = first.split_once(' ').unwrap();
        Self {
            process: Process(child),
            lines,
            address: address.into(),
        }
    }
}

/// `trirrr stream` of `scene.toml` in `folder` into the folder `out` there.
pub(crate) fn stream_command(folder: &TempDir, port: &str, out: &str, more: &[&str]) -> Command {
    let mut command = trirrr();
    command
        .args(["stream", "scene.toml", "--port", port, "--out", out])
        .args(more)
        .current_dir(folder);
    command
}

/// Streams to the end.
pub(crate) fn stream(folder: &TempDir, port: &str, more: &[&str]) -> Output {
    stream_command(folder, port, "out", more).output().unwrap()
}

/// A stream under way.
pub(crate) struct Streaming {
    pub(crate) process: Process,
    /// Its standard error.
    pub(crate) lines: Lines,
    pub(crate) out: PathBuf,
}

impl Streaming {
    pub(crate) fn start(folder: &TempDir, port: &str, more: &[&str]) -> Self {
        let mut child = stream_command(folder, port, "out", more)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        Self {
            lines: Lines::of(child.stderr.take().unwrap()),
            process: Process(child),
            out: folder.path().join("out"),
        }
    }
}

/// Somebody who asks an f64 machine, one request after the other.
pub(crate) struct Asker {
    link: Box<dyn Link>,
    frames: Frames,
}

impl Asker {
    pub(crate) fn new(address: &str) -> Self {
        Self {
            link: trirrr_line::open(&address.parse().unwrap(), 0).unwrap(),
            frames: Frames::default(),
        }
    }

    /// Sends bytes that may be no request. The far end may have closed the link.
    pub(crate) fn send(&mut self, bytes: &[u8]) -> bool {
        self.link.send(bytes).is_ok()
    }

    /// The answer to a request; none where the far end closes the link.
    pub(crate) fn ask(&mut self, sequence: u32, command: Ask<f64>) -> Option<Reply<f64>> {
        let mut bytes = Vec::new();
        Frames::append(&Request { sequence, command }, &mut bytes);
        self.link.send(&bytes).ok()?;
        self.answer(sequence)
    }

    /// Waits for a sample of telemetry.
    pub(crate) fn sample(&mut self) -> Telemetry<f64> {
        loop {
            let mut bytes = [0; 4096];
            let length = self.link.receive(&mut bytes, LIMIT).unwrap();
            assert!(length > 0, "no sample");
            let mut sample = None;
            let take = |message: Message<f64>| {
                if let Message::Telemetry(of_tick) = message {
                    sample = Some(of_tick);
                }
            };
            self.frames.receive(&bytes[..length], take);
            if let Some(sample) = sample {
                return sample;
            }
        }
    }

    /// Waits for the answer to a request.
    pub(crate) fn answer(&mut self, sequence: u32) -> Option<Reply<f64>> {
        loop {
            let mut bytes = [0; 4096];
            let length = self.link.receive(&mut bytes, LIMIT).ok()?;
            assert!(length > 0, "no answer to {sequence}");
            let mut answer = None;
            let take = |message: Message<f64>| {
                if let Message::Reply {
                    sequence: to,
                    reply,
                } = message
                    && to == sequence
                {
                    answer = Some(reply);
                }
            };
            self.frames.receive(&bytes[..length], take);
            if answer.is_some() {
                return answer;
            }
        }
    }
}
