//! A job of hours between a host and a machine. The cable is pulled, the host is killed, the machine loses its power.

mod engraving;
mod host;
mod witness;

use engraving::Engraving;
use host::{Host, JOURNAL_EVERY, Turn};
use trirrr_bench::device::{Device, DeviceRoom, RAMP_TICKS, message_frame};
use trirrr_bench::faulty_link::Random;
use trirrr_bench::slow_link::SlowLink;
use trirrr_client::{JobPlace, JobRest};
use trirrr_core::limits::LimitParameters;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Acting, Message, State, Telemetry};
use witness::{Witness, period};

/// Places of the queue: fewer than on a board, so that it runs dry before the machine misses its host, or after.
const MOVES: usize = 23;

/// Ticks of silence after which the machine waits.
const SILENCE: u32 = 800;

/// Slices of background work between two ticks.
const STEPS_PER_TICK: usize = 200;

/// The line: 2 ms each way, 1 MB/s.
const DELAY: u64 = 2;
const BYTES_PER_TICK: usize = 1000;

/// Longest interruption in ticks, as a power of ten; the shortest is one tick.
const LONGEST_LOG10: f64 = 4.0;

/// Ticks within which a second interruption follows, now and then.
const SOON: u64 = 3000;

/// An interruption.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cut {
    /// Bytes in both directions are lost. The port says so, or not.
    Cable,
    /// The host is killed; another one begins with the journal.
    Host,
    /// The machine loses its power and stands where it was. It has lost the job.
    Power,
}

/// Counts of a job.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Count {
    /// Ticks with a sample, and ticks in which the machine was off or had no host yet.
    pub(crate) ticks: u64,
    pub(crate) unseen_ticks: u64,
    /// Whole ticks of the job's path that were played, the start of the path with them,
    pub(crate) path_ticks: u64,
    /// those of them that a ramp has passed between two ticks,
    pub(crate) between: u64,
    /// and those that were played a second time, because what the host knew was lost with the power.
    pub(crate) again: u64,
    /// Ticks on the way back to a place, with the tool off.
    pub(crate) led_ticks: u64,
    pub(crate) tool_ticks: u64,
    /// Ticks in which the machine stood on its path.
    pub(crate) held_ticks: u64,
    /// Holds because the host was silent, and because the queue was empty.
    pub(crate) silences: u64,
    pub(crate) dry: u64,
    pub(crate) cables: u32,
    pub(crate) hosts: u32,
    pub(crate) powers: u32,
    /// Times that the client has found out by itself that nothing answers.
    pub(crate) lost: u64,
    /// Requests that were repeated.
    pub(crate) repeated: u64,
    state: Option<(State, Acting)>,
}

impl Count {
    fn take(&mut self, sample: &Telemetry<f32>, stands: bool) {
        self.tool_ticks += u64::from(sample.tool != 0.0);
        self.held_ticks += u64::from(sample.state == State::Holding && stands);
        let now = (sample.state, sample.acting);
        if self.state.replace(now) != Some(now) && sample.state == State::Slowing {
            self.silences += u64::from(sample.acting == Acting::Silence);
            self.dry += u64::from(sample.acting == Acting::QueueDry);
        }
    }

    /// Ticks were played again after the power was lost: those that the journal does not have, and those without a host.
    fn repeat(&mut self, ticks: u64) {
        let most = JOURNAL_EVERY + u64::from(SILENCE) + 2 * DELAY + u64::from(RAMP_TICKS);
        assert!(ticks <= most, "{ticks} ticks are played again");
        self.again += ticks;
    }
}

/// Plays a job of `ticks` with so many interruptions of the line or of the host, and so many of the power.
///
/// # Panics
/// Something is other than the job asks for, in any tick, or the job does not end.
pub(crate) fn play(ticks: u64, interruptions: usize, power_cuts: usize, seed: u64) -> Count {
    let job = Engraving::lasting(ticks);
    let mut random = Random::new(seed);
    let mut plan: Vec<_> = (0..interruptions + power_cuts)
        .map(|index| {
            let cut = match index < interruptions {
                true => [Cut::Cable, Cut::Host][random.below(2) as usize],
                false => Cut::Power,
            };
            (random.below(job.ticks()), cut)
        })
        .collect();
    plan.sort_by_key(|(place, _)| std::cmp::Reverse(*place));
    let line = SlowLink::new(DELAY, BYTES_PER_TICK);
    let session = Session {
        job,
        host: Host::new(rest(&job, JobPlace::default())),
        witness: Witness::new(job),
        there: line.clone(),
        back: line,
        random,
        plan,
        again: None,
        now: 0,
        longest: 3 * job.ticks() + 100_000,
        is_pulled: Span::default(),
        port_fails: Span::default(),
        host_is_off: Span::default(),
    };
    session.play()
}

/// The rest of the job from a place on. Its moves are made anew, as by a host that reads the scene again.
fn rest(job: &Engraving, from: JobPlace) -> JobRest<f32> {
    JobRest::new(&job.all(), from, period())
}

/// A span of time that ends at a tick.
#[derive(Clone, Copy, Debug, Default)]
struct Span(Option<u64>);

impl Span {
    fn is_on(self) -> bool {
        self.0.is_some()
    }

    fn extend(&mut self, until: u64) {
        self.0 = self.0.max(Some(until));
    }

    /// Returns true in the tick in which it ends.
    fn ends(&mut self, now: u64) -> bool {
        self.0.take_if(|until| *until <= now).is_some()
    }
}

/// End of a time that the machine was switched on.
enum End {
    /// It has lost its power where it stood.
    Power(Pose<f32>),
    Complete,
}

/// Both ends of the line.
struct Session {
    job: Engraving,
    host: Host,
    witness: Witness,
    there: SlowLink,
    back: SlowLink,
    random: Random,
    /// Interruptions ahead, and ticks of the path at which they come, the first one last.
    plan: Vec<(u64, Cut)>,
    /// Tick in which another one follows.
    again: Option<u64>,
    now: u64,
    longest: u64,
    is_pulled: Span,
    port_fails: Span,
    host_is_off: Span,
}

impl Session {
    fn play(mut self) -> Count {
        let mut stands = self.job.get(0).common().from;
        while let End::Power(pose) = self.life(stands) {
            stands = pose;
            self.witness.power_cut();
            let off = self.now + self.duration();
            while self.now < off {
                self.now += 1;
                self.lose();
                assert!(!self.host_turn(), "the job ends without a machine");
            }
        }
        // Each tick, and the start.
        assert_eq!(self.witness.furthest(), self.job.ticks());
        assert_eq!(self.witness.count.path_ticks, self.job.ticks() + 1);
        assert!(self.plan.is_empty(), "not all interruptions came");
        Count {
            repeated: self.host.repeated(),
            ..self.witness.count
        }
    }

    /// The machine is switched on where it stands.
    fn life(&mut self, stands: Pose<f32>) -> End {
        let mut channels = Box::new(DeviceRoom::<f32, MOVES>::new());
        let limits = LimitParameters::default();
        let mut device = Device::standing(&mut channels, limits, SILENCE, stands);
        let mut pose = stands;
        loop {
            self.now += 1;
            assert!(self.now < self.longest, "the job does not end");
            self.machine_turn(&mut device, &mut pose);
            if self.host_turn() {
                assert_eq!(device.service.state(), State::Idle);
                return End::Complete;
            }
            if self.interrupt() == Some(Cut::Power) {
                return End::Power(pose);
            }
        }
    }

    /// One tick of the machine, and what is below it.
    fn machine_turn(&mut self, device: &mut Device<f32>, pose: &mut Pose<f32>) {
        let Self {
            host,
            witness,
            there,
            back,
            ..
        } = self;
        let output = device.tick();
        for _ in 0..STEPS_PER_TICK {
            if !device.service.step() {
                break;
            }
        }
        let mut is_seen = false;
        let first = device.service.status().job.map(|job| job.first_move);
        while let Some(message) = device.service.outgoing() {
            if let Message::Telemetry(sample) = &message {
                is_seen = true;
                assert_eq!(sample.tool, output.tool);
                assert_eq!(sample.angles, output.motors.map(|motor| motor.angle));
                witness.see(sample, host.rest(), first);
                *pose = sample.setpoint.pose;
            }
            back.send(&message_frame(&message));
        }
        if !is_seen {
            witness.count.unseen_ticks += 1;
            assert_eq!(output.tool, 0.0, "the tool is on before the job");
        }
        while let Some(bytes) = there.receive(self.now) {
            device.receive(&bytes, |_| {}, |message| back.send(&message_frame(message)));
        }
    }

    /// The host's part of a tick, and the line's. Returns true if the job is complete.
    fn host_turn(&mut self) -> bool {
        let now = self.now;
        if self.is_pulled.is_on() {
            self.lose();
        }
        if self.host_is_off.ends(now) {
            self.host.restart();
        }
        if self.port_fails.ends(now) {
            self.host.reopen();
        }
        if self.host_is_off.is_on() || self.port_fails.is_on() {
            // Nobody reads.
            self.back.clear();
        } else {
            match self.host.turn(now, &mut self.there, &mut self.back) {
                Turn::Listens => {}
                Turn::OpensAnew => {
                    self.witness.count.lost += 1;
                    self.lose();
                }
                Turn::Ended(Ok(())) => return true,
                Turn::Ended(Err(failure)) => {
                    let why = self.host.describe(&failure);
                    let lost = self.witness.count.powers > 0 && failure.loses_job();
                    assert!(lost, "the job fails: {why}");
                    let job = self.job;
                    self.host.go_back(|from| rest(&job, from));
                }
            }
        }
        self.there.tick(now);
        self.back.tick(now);
        if self.is_pulled.ends(now) {
            self.lose();
        }
        false
    }

    /// Bytes on the line are lost.
    fn lose(&mut self) {
        self.there.clear();
        self.back.clear();
    }

    /// Duration of an interruption: as often between 1 and 10 ms as between 1 and 10 s.
    fn duration(&mut self) -> u64 {
        10_f64.powf(LONGEST_LOG10 * self.random.fraction()) as u64
    }

    /// Begins an interruption whose time has come.
    fn interrupt(&mut self) -> Option<Cut> {
        let here = self.witness.furthest();
        let cut = match self.plan.pop_if(|(place, _)| *place <= here) {
            Some((_, cut)) => cut,
            None => {
                self.again.take_if(|tick| *tick <= self.now)?;
                [Cut::Cable, Cut::Host][self.random.below(2) as usize]
            }
        };
        if self.random.below(4) == 0 {
            self.again = Some(self.now + self.random.below(SOON));
        }
        let until = self.now + self.duration();
        let count = &mut self.witness.count;
        match cut {
            Cut::Cable => {
                count.cables += 1;
                self.is_pulled.extend(until);
                if self.random.below(2) == 0 {
                    self.port_fails.extend(until);
                }
            }
            Cut::Host => {
                count.hosts += 1;
                self.host_is_off.extend(until);
            }
            Cut::Power => count.powers += 1,
        }
        Some(cut)
    }
}
