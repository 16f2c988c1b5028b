//! A host at the line, in the time of the board: the client of `trirrr stream`, frames byte by byte at the baud rate.

use crate::cpu::Board;
use crate::time::{MS, SECOND, Time, seconds};
use anyhow::{Result, anyhow, bail};
use std::time::Duration;
use trirrr_client::{Dialogue, JobClient, Patience, Turn, UserCommand};
use trirrr_line::Frames;
use trirrr_protocol::message::{Message, Request, Telemetry, TelemetryFields};
use trirrr_scene::Scene;

/// Baud rate of the line.
pub(crate) const BAUD: f64 = 921_600.0;

/// The host looks at the line so often, as a USB adapter does.
pub(crate) const LOOK: Time = MS / 4;

/// Content of the samples: at a sample in each of 1000 ticks a second the line has no room for all.
const FIELDS: TelemetryFields =
    TelemetryFields(TelemetryFields::ANGLES.0 | TelemetryFields::TOOL.0);

/// Host's end of the line: frames in the time of the board.
#[derive(Default)]
pub(crate) struct HostLine {
    frames: Frames,
    /// Bytes of the board that were read.
    read: usize,
    /// End of the last byte to the board.
    wire_free: Time,
}

impl HostLine {
    /// Drops what has come so far.
    pub(crate) fn drop_all(&mut self, board: &mut Board) {
        if let Some(plug) = &mut board.chip().plug {
            plug.take();
        }
        self.read = board.chip().line().sent.len();
    }

    /// Returns the messages that have come.
    pub(crate) fn hear(&mut self, board: &mut Board) -> Vec<Message<f32>> {
        let now = board.now();
        let mut messages: Vec<Message<f32>> = Vec::new();
        if let Some(plug) = &mut board.chip().plug {
            for (_, byte) in plug.take() {
                self.frames
                    .receive(&[*byte], |message| messages.push(message));
            }
            return messages;
        }
        let line = board.chip().line();
        while let Some((time, byte)) = line.sent.get(self.read).copied()
            && time <= now
        {
            self.read += 1;
            self.frames
                .receive(&[byte], |message| messages.push(message));
        }
        messages
    }

    /// Sends a request behind those before.
    pub(crate) fn say(&mut self, board: &mut Board, request: &Request<f32>) {
        let now = board.now();
        let mut bytes = Vec::new();
        Frames::append(request, &mut bytes);
        if let Some(plug) = &mut board.chip().plug {
            return plug.send(&bytes);
        }
        for byte in bytes {
            let start = self.wire_free.max(now);
            self.wire_free = start + (10.0 * SECOND as f64 / BAUD) as Time;
            board.chip().line().coming.push_back((self.wire_free, byte));
        }
    }
}

pub(crate) struct Host {
    client: JobClient<f32>,
    line: HostLine,
    pub(crate) samples: Vec<Telemetry<f32>>,
    /// End of the job.
    pub(crate) ended: Option<Result<(), String>>,
    /// The cable is pulled, or the program at it has stopped.
    is_cut: bool,
}

impl Host {
    /// Creates a host with the scene's job.
    pub(crate) fn new(scene: &Scene) -> Result<Self> {
        Self::in_conversation(scene, 7)
    }

    fn in_conversation(scene: &Scene, conversation: u32) -> Result<Self> {
        let units = trirrr_scene::units::<f32>(scene).map_err(|error| anyhow!("{error}"))?;
        let hello = trirrr_client::local::hello::<f32>(scene);
        let moves = trirrr_scene::offer::moves::<f32>(scene, &units);
        let client = JobClient::new(moves, hello, 1, Patience::default(), conversation);
        let client = client.with_outputs(&scene.job.outputs);
        Ok(Self {
            client: client.with_fields(FIELDS),
            line: HostLine::default(),
            samples: Vec::new(),
            ended: None,
            is_cut: false,
        })
    }

    /// Creates the next host of a board: it acknowledges what is latched, and brings the machine to the start of the job in `seconds`.
    pub(crate) fn recovering(
        scene: &Scene,
        board: &mut Board,
        conversation: u32,
        seconds: f64,
    ) -> Result<Self> {
        let mut host = Self::in_conversation(scene, conversation)?;
        host.client = host.client.with_recovery(seconds);
        host.line.drop_all(board);
        Ok(host)
    }

    /// Gives the machine a command of the user.
    pub(crate) fn command(&mut self, command: UserCommand) {
        self.client.command(command);
    }

    /// Returns the client of the job.
    pub(crate) fn client(&self) -> &JobClient<f32> {
        &self.client
    }

    /// Lets the board and the host run until `end`, or until the job has ended.
    pub(crate) fn run(&mut self, board: &mut Board, end: Time) -> Result<()> {
        while board.now() < end && self.ended.is_none() {
            board.run((board.now() + LOOK).min(end))?;
            self.talk(board);
        }
        Ok(())
    }

    /// Pulls the cable.
    pub(crate) fn cut(&mut self, board: &mut Board) {
        self.is_cut = true;
        if let Some(plug) = &mut board.chip().plug {
            plug.plug(false);
        }
    }

    /// The program stops: it neither takes nor gives bytes.
    pub(crate) fn stop(&mut self, board: &mut Board) {
        self.is_cut = true;
        if let Some(plug) = &mut board.chip().plug {
            plug.carry(false);
        }
    }

    /// Plays the job to its end.
    pub(crate) fn play(&mut self, board: &mut Board, longest: Time) -> Result<()> {
        self.run(board, board.now() + longest)?;
        match &self.ended {
            Some(Ok(())) => Ok(()),
            Some(Err(why)) => bail!("the job: {why}"),
            None => bail!("the job does not end within {} s", seconds(longest)),
        }
    }

    fn talk(&mut self, board: &mut Board) {
        if self.is_cut {
            return match board.chip().plug.is_some() {
                // Nobody takes what is kept for the program.
                true => {}
                false => self.line.drop_all(board),
            };
        }
        let clock = Duration::from_secs_f64(seconds(board.now()));
        for message in self.line.hear(board) {
            if let Message::Telemetry(sample) = &message {
                self.samples.push(*sample);
            }
            self.client.receive(&message, clock);
        }
        loop {
            match self.client.poll(clock) {
                Turn::Send(request) => self.line.say(board, &request),
                Turn::Wait(_) => return,
                Turn::Reconnect => self.client.reconnected(),
                Turn::Done(result) => {
                    let result = result.map_err(|failure| self.client.describe(&failure));
                    self.ended = Some(result);
                    return;
                }
            }
        }
    }
}
