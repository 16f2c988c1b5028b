//! The service: any commands at any ticks.

use super::bytes::Bytes;
use super::watch::{self, Reached, Watched, leave};
use crate::device::{Device, DeviceChannels, answer, hello, home};
use std::collections::HashMap;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::scene::{Limits, Platform, Section};
use trirrr_protocol::message::{
    AnyMove, Command, DriveFault, FaultCode, LEVEL_PARTS, LevelPiece, LevelRange, ListedMove, Move,
    Recovery, Refusal, Reply, Request, State, WINDOW,
};

/// Silence after which the machine stops, ticks.
const SILENCE: u32 = 500;

/// Begins an input whose commands come before a hello.
const NO_HELLO: u8 = 0xFF;

/// Commands one after the other, as the bytes say, with ticks and background work in between.
pub fn commands(data: &[u8]) {
    play(data);
}

/// The same; what was reached.
pub fn play(data: &[u8]) -> Reached {
    let mut channels = DeviceChannels::new();
    let mut session = Session {
        watched: Watched::new(Device::enabled(&mut channels, watch::limits(), SILENCE)),
        changed: false,
        sequence: 0,
        level: 0,
        last: None,
        kept: HashMap::new(),
    };
    if data.first() != Some(&NO_HELLO) {
        session.greet();
    }
    let mut bytes = Bytes::new(data);
    while session.act(&mut bytes).is_some() {}
    session.leave()
}

/// A machine, and what it has to keep.
struct Session<'q> {
    watched: Watched<'q>,
    /// The scene is not the first any more.
    changed: bool,
    sequence: u32,
    /// Number of the next level.
    level: u32,
    /// The last request that counted, with its answer.
    last: Option<(Request<f64>, Reply<f64>)>,
    /// Requests that wait for one before them.
    kept: HashMap<u32, Request<f64>>,
}

impl Session<'_> {
    /// Does what the next bytes say; none when there are no more.
    fn act(&mut self, bytes: &mut Bytes) -> Option<()> {
        let act = bytes.byte()?;
        match act % 16 {
            0 | 1 => {
                for _ in 0..=bytes.byte()? {
                    self.watched.tick();
                }
            }
            2 | 3 => {
                for _ in 0..u32::from(bytes.byte()?) * 16 {
                    self.watched.device.service.step();
                }
            }
            4 => {
                let chained = self.chained_move(bytes)?;
                match act / 16 {
                    15 => self.listed(chained, bytes.byte()?),
                    _ => self.ask(Command::Move(chained)),
                }
            }
            5 => self.ask(Command::Start),
            6 => self.ask(Command::Hold),
            7 => self.ask(Command::Resume),
            8 => self.ask(Command::Stop),
            9 => self.ask(match self.watched.device.service.state() {
                State::Fault => Command::ClearFault,
                State::Disabled => Command::Enable,
                _ => Command::Disable,
            }),
            10 => {
                let to = pose(bytes)?;
                let ticks = u32::from(bytes.u16()?);
                self.ask(Command::Recover(Recovery { to, ticks }));
            }
            11 => {
                let code = [
                    FaultCode::Drive(DriveFault::Reported),
                    FaultCode::Overrun,
                    FaultCode::Board,
                ];
                let code = code[usize::from(bytes.byte()?) % 3];
                self.watched.device.service.raise(code, None, 0.0, 0.0);
            }
            12 => self.repeat(),
            13 => {
                let section = section(bytes)?;
                self.ask(Command::Replace(section));
            }
            14 => {
                let every = bytes.u16()?;
                self.ask(Command::telemetry(every));
                while let Some(sample) = self.watched.device.sample() {
                    assert!(
                        sample.tool == 0.0 || sample.state.is_running(),
                        "{sample:?}"
                    );
                }
            }
            _ => self.raw(bytes)?,
        }
        Some(())
    }

    /// A move with levels, of which the machine may have been given others before.
    fn listed(&mut self, each: Move<f64>, list: u8) {
        const COUNT: u16 = 64;
        let levels = [list; COUNT as usize];
        self.ask(Command::Levels(LevelPiece::new(self.level, &levels)));
        match &self.last {
            Some((_, Reply::Done)) => self.level = self.level.wrapping_add(COUNT.into()),
            Some((_, Reply::Refused(Refusal::LevelNumber { expected }))) => self.level = *expected,
            _ => {}
        }
        let range = LevelRange {
            first: self.level.wrapping_sub(COUNT.into()),
            count: COUNT,
            offset: u16::from(list) << 8,
            span: (u32::from(COUNT) - 1) * LEVEL_PARTS,
        };
        let stands = AnyMove::Cubic(each).end();
        let start = self.watched.device.service.status().end.unwrap_or(stands);
        let listed = ListedMove::new(each.number, &start, &AnyMove::Cubic(each), range);
        self.ask(Command::Listed(listed));
    }

    /// A command with the next sequence number.
    fn ask(&mut self, command: Command<f64>) {
        let request = Request {
            sequence: self.sequence,
            command,
        };
        self.request(&request);
    }

    fn request(&mut self, request: &Request<f64>) {
        let reply = answer(&mut self.watched.device, request);
        let refuses_number = matches!(
            reply,
            Reply::Refused(
                Refusal::HelloFirst
                    | Refusal::Protocol { .. }
                    | Refusal::Schema { .. }
                    | Refusal::Scene { .. }
                    | Refusal::Sequence { .. }
                    | Refusal::SequenceReused
            )
        );
        let ahead = request.sequence.wrapping_sub(self.sequence) as i32;
        match reply {
            Reply::Hello(identity) => {
                self.sequence = identity.next_sequence;
                self.last = None;
                self.kept.clear();
            }
            Reply::Kept { missing } => {
                assert_eq!(missing, self.sequence);
                assert!((1..WINDOW as i32).contains(&ahead), "{request:?} is kept");
                self.kept.insert(request.sequence, *request);
            }
            _ if refuses_number => {}
            reply if ahead == 0 => self.executed(request, reply),
            _ => assert!((-(WINDOW as i32)..0).contains(&ahead), "out of sequence"),
        }
        while let Some((sequence, reply)) = self.watched.device.service.answer_kept() {
            let kept = self
                .kept
                .remove(&sequence)
                .expect("a request that was kept");
            assert_eq!(sequence, self.sequence);
            self.executed(&kept, reply);
        }
    }

    /// Takes note of a request that the machine has executed, as the next one.
    fn executed(&mut self, request: &Request<f64>, reply: Reply<f64>) {
        self.kept.remove(&request.sequence);
        self.sequence = self.sequence.wrapping_add(1);
        if let (Command::Replace(section), Reply::Done) = (&request.command, &reply) {
            self.changed = true;
            if let Section::Limits(limits) = section {
                self.watched.limits = limits.into();
            }
        }
        self.last = Some((*request, reply));
    }

    /// The last request again: the same answer, unless it was a question.
    fn repeat(&mut self) {
        if let Some((request, reply)) = &self.last {
            let again = answer(&mut self.watched.device, request);
            if matches!(reply, Reply::Done | Reply::Refused(_)) {
                // As text: what is not a number is not equal to itself.
                assert_eq!(format!("{again:?}"), format!("{reply:?}"));
            }
        }
    }

    /// A move from where the last one ends.
    fn chained_move(&mut self, bytes: &mut Bytes) -> Option<Move<f64>> {
        let status = self.watched.device.service.status();
        let (from, start_velocity) = match status.end {
            Some(end) => (end.pose, end.velocity.into()),
            None => (home(), [0.0; 3]),
        };
        let flags = bytes.byte()?;
        let end_velocity = match flags & 1 {
            0 => [0.0; 3],
            _ => [bytes.number(0.1)?, bytes.number(0.1)?, bytes.number(0.5)?],
        };
        let tool = f64::from(flags >> 4) / 15.0;
        Some(Move {
            number: status.next,
            from: if flags & 14 == 14 { pose(bytes)? } else { from },
            to: pose(bytes)?,
            start_velocity,
            end_velocity,
            ticks: u32::from(bytes.u16()? % 1024),
            tool_power: tool,
            tool_speed: 0.05,
        })
    }

    /// A request as it would come from the line, sequence number and all.
    fn raw(&mut self, bytes: &mut Bytes) -> Option<()> {
        let payload = bytes.some()?;
        if let Ok(request) = postcard::from_bytes::<Request<f64>>(payload) {
            self.request(&request);
        }
        Some(())
    }

    /// Whatever happened: the machine can be brought to rest, idle. (On the first machine: another
    /// one may not reach the pose to recover at.)
    fn leave(mut self) -> Reached {
        self.greet();
        if !self.changed {
            leave(&mut self.watched, self.sequence);
        }
        self.watched.reached()
    }

    fn greet(&mut self) {
        let hello = Request {
            sequence: 0,
            command: Command::Hello(hello()),
        };
        match answer(&mut self.watched.device, &hello) {
            Reply::Hello(identity) => self.sequence = identity.next_sequence,
            other => panic!("a right hello: {other:?}"),
        }
    }
}

/// A pose about the middle of the workspace, mostly within reach.
fn pose(bytes: &mut Bytes) -> Option<Pose<f64>> {
    let [x, y, alpha] = [bytes.number(0.1)?, bytes.number(0.1)?, bytes.number(0.5)?];
    Some(Pose::from_f64(0.25 + x, 0.25 + y, 0.157 + alpha))
}

/// A part of the scene with some values.
fn section(bytes: &mut Bytes) -> Option<Section> {
    Some(match bytes.byte()? % 2 {
        0 => {
            let mut limit = || {
                let value = bytes.number(4.0)?;
                Some((value != 0.0).then_some([value; 3]))
            };
            Section::Limits(Limits {
                rate_rad_s: limit()?,
                acceleration_rad_s2: limit()?.map(|limits| limits.map(|limit| 100.0 * limit)),
                torque_nm: limit()?,
                power_w: limit()?,
                jerk_rad_s3: limit()?.map(|limits| limits.map(|limit| 1e4 * limit)),
                serial_distance_min: bytes.number(0.5)?,
                parallel_distance_min: bytes.number(0.5)?,
            })
        }
        _ => Section::Platform(Platform {
            mass_kg: bytes.number(2.0)?,
            inertia_kgm2: bytes.number(0.1)?,
            com_m: [bytes.number(0.1)?, bytes.number(0.1)?],
            gravity_m_s2: [bytes.number(10.0)?, bytes.number(10.0)?],
            wrench_force_n: [bytes.number(5.0)?, bytes.number(5.0)?],
            wrench_torque_nm: bytes.number(1.0)?,
            tool_point_m: [bytes.number(0.1)?, bytes.number(0.1)?],
        }),
    })
}
