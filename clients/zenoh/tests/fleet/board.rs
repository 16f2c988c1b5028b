//! A board of the test: a machine behind a TCP port whose line is cut.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use trirrr_client::local::{self, LocalService};
use trirrr_line::{Frames, Listener, ServedLink};
use trirrr_protocol::message::{Command, Message, Reply, Request};
use trirrr_scene::Scene;

/// Requests that the board has got.
#[derive(Clone, Debug, Default)]
pub(crate) struct Heard {
    /// Requests whose line was cut in place of an answer, by number.
    pub(crate) cut: BTreeSet<u32>,
    /// Of these, those that came again under their number.
    pub(crate) repeated: BTreeSet<u32>,
    /// Times that an enable was executed: each number counts once.
    pub(crate) enabled: BTreeSet<u32>,
    pub(crate) retargets: BTreeSet<u32>,
}

pub(crate) struct Board {
    pub(crate) port: String,
    heard: Arc<Mutex<Heard>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Board {
    /// Starts the machine of `scene`. The first time that the board gets an enable, a feed or a retarget, it executes it, and cuts its line in place of an
    /// answer.
    pub(crate) fn start(scene: Scene) -> Self {
        let listener = Listener::bind("127.0.0.1:0").unwrap();
        let port = format!("tcp:{}", listener.address());
        let heard = Arc::new(Mutex::new(Heard::default()));
        let stop = Arc::new(AtomicBool::new(false));
        let (theirs, ends) = (heard.clone(), stop.clone());
        let thread = std::thread::Builder::new()
            .stack_size(16 << 20)
            .spawn(move || {
                let rate_hz = scene.tick_rate_hz;
                local::with_machine::<f64, _>(&scene, |machine| {
                    serve(machine, rate_hz, &listener, &theirs, &ends);
                })
                .unwrap();
            })
            .unwrap();
        Self {
            port,
            heard,
            stop,
            thread: Some(thread),
        }
    }

    pub(crate) fn heard(&self) -> Heard {
        self.heard.lock().unwrap().clone()
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn serve(
    machine: &mut dyn LocalService<f64>,
    rate_hz: f64,
    listener: &Listener,
    heard: &Mutex<Heard>,
    stop: &AtomicBool,
) {
    let start = Instant::now();
    let mut ticks = 0;
    let mut link: Option<(ServedLink, Frames)> = None;
    while !stop.load(Ordering::Relaxed) {
        if let Some((new, _)) = listener.accept().unwrap() {
            link = Some((new, Frames::default()));
        }
        let mut out = Vec::new();
        if start.elapsed().as_secs_f64() * rate_hz >= f64::from(ticks) {
            machine.tick();
            ticks += 1;
        }
        while machine.step() {}
        while let Some(message) = machine.outgoing() {
            Frames::append(&message, &mut out);
        }
        let is_open = link.as_mut().is_some_and(|(link, frames)| {
            let mut bytes = [0; 4096];
            let Ok(length) = link.receive_now(&mut bytes) else {
                return false;
            };
            let mut requests: Vec<Request<f64>> = Vec::new();
            frames.receive(&bytes[..length], |request| requests.push(request));
            for request in requests {
                let sequence = request.sequence;
                let reply = machine.answer(&request);
                if cuts(&request, &reply, &mut heard.lock().unwrap()) {
                    return false;
                }
                Frames::append(&Message::Reply { sequence, reply }, &mut out);
            }
            let mut rest = out.as_slice();
            while !rest.is_empty() {
                match link.send_now(rest) {
                    Ok(sent) => rest = &rest[sent..],
                    Err(_) => return false,
                }
            }
            link.flush_now().is_ok()
        });
        if !is_open {
            link = None;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Takes note of a request. Returns true if the line is cut in place of an answer.
fn cuts(request: &Request<f64>, reply: &Reply<f64>, heard: &mut Heard) -> bool {
    let number = request.sequence;
    if *reply != Reply::Done {
        return false;
    }
    match request.command {
        Command::Enable => heard.enabled.insert(number),
        // A goal comes again under another number: its pose is the same. Each second one gets through.
        Command::Retarget(_) => {
            heard.retargets.insert(number);
            if heard.retargets.len().is_multiple_of(2) {
                return false;
            }
            true
        }
        Command::FeedOverride { .. } => true,
        _ => return false,
    };
    if heard.cut.contains(&number) {
        heard.repeated.insert(number);
        return false;
    }
    heard.cut.insert(number)
}
