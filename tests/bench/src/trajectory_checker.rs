//! Watches what a machine does with a job from tick to tick, from the samples that it sends.
//!
//! Every tick has a sample. Each has to be where the path goes on from the one before, at a speed
//! along the path that a ramp allows, with the setpoint that the offered move has there: the same
//! bits, on the way to and from a hold too.

use postcard::to_slice;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Ends, Quintics, Segment, Setpoint};
use trirrr_core::tick::Motor;
use trirrr_protocol::message::{AnyMove, State, Telemetry, Transmit};

/// Levels by which the pace changes at most in a tick: a machine's ramp has so many for each of its ticks.
const FULL: u32 = 128;

/// Watches one job.
pub struct TrajectoryChecker<N: Transmit> {
    segments: Vec<Segment<N, Quintics>>,
    /// Ticks of the job before each move, and of the whole job.
    starts: Vec<u64>,
    /// The machine's number of the first move.
    base: u32,
    /// The level of the pace at normal speed.
    top: u32,
    /// To take fractions of: the level, the part of a tick, the change of the level in a tick.
    counts: [N::Count; 3],
    /// Greatest change of the pace per time.
    slope: N::Factor,
    before: Option<Before>,
    samples: u64,
    is_over: bool,
    /// Ticks may have gone by unseen.
    is_blind: bool,
}

/// The sample before.
struct Before {
    tick: u32,
    index: u32,
    at: u32,
    part: u32,
    state: State,
    /// What the level of the pace can be. More than one only where the path ended within a tick.
    levels: Vec<u32>,
}

impl<N: Transmit> TrajectoryChecker<N> {
    /// Of a job of `moves`, the first of which the machine calls `base`, on a machine that takes
    /// `ramp` ticks from normal speed to rest and ticks every `period`.
    pub fn new(moves: &[AnyMove<N>], base: u32, ramp: u16, period: N::Factor) -> Self {
        let top = FULL * u32::from(ramp);
        let mut starts = vec![0];
        for each in moves {
            starts.push(starts[starts.len() - 1] + u64::from(each.common().ticks));
        }
        Self {
            segments: moves.iter().map(|each| segment(each, period)).collect(),
            starts,
            base,
            top,
            counts: [top, 2 * top, FULL].map(N::count),
            slope: N::factor_over(N::quotient(1, u32::from(ramp)), period),
            before: None,
            samples: 0,
            is_over: false,
            is_blind: false,
        }
    }

    /// Ticks go by unseen until the next sample; the machine is at normal speed then.
    pub fn skip(&mut self) {
        self.is_blind = self.before.is_some();
    }

    /// Samples of the job so far.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Takes the sample of the next tick. `motors`: what the scene's machine computes for a
    /// setpoint.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn see(
        &mut self,
        sample: &Telemetry<N>,
        motors: impl Fn(&Setpoint<N>) -> Option<[Motor<N>; 3]>,
    ) -> Result<(), String> {
        self.check(sample, motors)
            .map_err(|why| format!("{why}: {sample:?}"))
    }

    fn check(
        &mut self,
        sample: &Telemetry<N>,
        motors: impl Fn(&Setpoint<N>) -> Option<[Motor<N>; 3]>,
    ) -> Result<(), String> {
        if sample.lost != 0 {
            return Err(format!("{} samples were lost", sample.lost));
        }
        let computed = motors(&sample.setpoint).ok_or("the setpoint has no motion")?;
        if !same(&told(sample), &parts(&computed)) {
            return Err(format!("the scene's motors would be {computed:?}"));
        }
        match sample.state {
            State::Running | State::Slowing | State::Holding | State::Stopping => {}
            State::Idle => return self.rests(sample),
            _ => return Err("neither idle nor on the path".into()),
        }
        if self.is_over {
            return Err("a job that was over goes on".into());
        }
        let index = sample.number.wrapping_sub(self.base);
        let segment = self
            .segments
            .get(index as usize)
            .ok_or("no move of the job")?;
        if sample.at > segment.ticks() {
            return Err(format!("beyond the move's {} ticks", segment.ticks()));
        }
        let levels = match &self.before {
            None if (index, sample.at, sample.part) == (0, 0, 0) => self.begins(segment, sample)?,
            None => return Err("not the start of the job".into()),
            // Moves came too slowly: it stood at the end of what it had, and starts again.
            Some(before) if before.state == State::Idle => {
                if (index, sample.at, sample.part) != (before.index + 1, 0, 0) {
                    return Err("not the start of the next move".into());
                }
                self.begins(segment, sample)?
            }
            Some(_) if self.is_blind => vec![self.top],
            Some(before) => self.go_on(before, index, sample)?,
        };
        if self.is_blind && !same(&sample.setpoint, &segment.at(sample.at)) {
            return Err("not at normal speed after what was not seen".into());
        }
        self.is_blind = false;
        let last = index as usize + 1 == self.segments.len();
        self.is_over = last && sample.at == segment.ticks();
        self.samples += 1;
        self.before = Some(Before {
            tick: sample.tick,
            index,
            at: sample.at,
            part: sample.part,
            state: sample.state,
            levels,
        });
        Ok(())
    }

    /// Nothing is played: before the job, between moves that came too slowly, after it.
    fn rests(&mut self, sample: &Telemetry<N>) -> Result<(), String> {
        let Some(before) = &mut self.before else {
            return Ok(());
        };
        let stopped = before.state == State::Stopping;
        before.state = State::Idle;
        let Some(before) = self.before.as_ref().filter(|_| stopped) else {
            return Ok(());
        };
        // A stop drops the job and with it the place on it: it is where the last tick led.
        let segment = &self.segments[before.index as usize];
        let stops = |&level: &u32| {
            let passed = before.part + level;
            let (at, part) = (passed / (2 * self.top), passed % (2 * self.top));
            let at = before.at + at;
            let sample = &Telemetry {
                at,
                part,
                ..*sample
            };
            let expected = self.setpoint(segment, sample, 0, -i64::from(level));
            level <= FULL && same(&expected, &sample.setpoint)
        };
        match before.levels.iter().any(stops) {
            true => Ok(()),
            false => Err(format!(
                "the stop does not end where move {}, tick {} and {} parts at {:?} lead",
                before.index, before.at, before.part, before.levels
            )),
        }
    }

    /// Levels at which a path may begin: normal speed, a part of it that the host asked for, or, where the queue leaves no room to
    /// stop, rest.
    fn begins(
        &self,
        segment: &Segment<N, Quintics>,
        sample: &Telemetry<N>,
    ) -> Result<Vec<u32>, String> {
        let goals = (0..=100).map(|percent| (self.top * percent / 100) & !1);
        let levels = goals.filter(|level| {
            let expected = self.setpoint(segment, sample, *level, 0);
            same(&expected, &sample.setpoint)
        });
        let levels: Vec<u32> = levels.collect();
        match levels.is_empty() {
            false => Ok(levels),
            true => Err(format!("the move starts at {:?}", segment.at(0))),
        }
    }

    /// The speeds along the path that lead from the sample before to this one with its setpoint.
    fn go_on(
        &self,
        before: &Before,
        index: u32,
        sample: &Telemetry<N>,
    ) -> Result<Vec<u32>, String> {
        if sample.tick != before.tick.wrapping_add(1) {
            return Err(format!("not the tick after {}", before.tick));
        }
        let [then, now] = [
            self.place(before.index, before.at, before.part),
            self.place(index, sample.at, sample.part),
        ];
        let segment = &self.segments[index as usize];
        // A path that ends at rest ends there, even if the tick would have gone further.
        let at_end = sample.at == segment.ticks() && sample.part == 0;
        let mut levels = Vec::new();
        for &level in &before.levels {
            for next in level.saturating_sub(FULL)..=(level + FULL).min(self.top) {
                let beyond = then + u64::from(level + next);
                let cut = at_end && beyond > now && then <= now;
                if beyond != now && !cut {
                    continue;
                }
                let slope = i64::from(next) - i64::from(level);
                let expected = self.setpoint(segment, sample, next, slope);
                if same(&expected, &sample.setpoint) {
                    // At the end of the path it becomes even.
                    levels.push(if at_end { next & !1 } else { next });
                }
            }
        }
        match levels.is_empty() {
            false => Ok(levels),
            true => Err(format!(
                "the path does not go on from move {}, tick {} and {} parts at the speeds {:?} of {}",
                before.index, before.at, before.part, before.levels, self.top
            )),
        }
    }

    /// Place on the whole job in parts of a tick.
    fn place(&self, index: u32, at: u32, part: u32) -> u64 {
        (self.starts[index as usize] + u64::from(at)) * u64::from(2 * self.top) + u64::from(part)
    }

    /// The setpoint of `segment` where the sample is, passed at `level`, to which `slope` led.
    fn setpoint(
        &self,
        segment: &Segment<N, Quintics>,
        sample: &Telemetry<N>,
        level: u32,
        slope: i64,
    ) -> Setpoint<N> {
        let part = (sample.part != 0).then(|| N::fraction(sample.part, &self.counts[1]));
        let on_path = segment.between(sample.at, part);
        if sample.part == 0 && level == self.top && slope == 0 {
            return on_path;
        }
        let speed = match level == self.top {
            true => N::ONE,
            false => N::fraction(level, &self.counts[0]),
        };
        let mut acceleration = on_path.acceleration * speed * speed;
        if slope != 0 {
            let change = if slope > 0 { self.slope } else { -self.slope };
            let levels = slope.unsigned_abs() as u32;
            let share = (levels != FULL).then(|| N::fraction(levels, &self.counts[2]));
            acceleration += on_path.velocity.map(|velocity| {
                let whole = velocity.scaled(change);
                share.map_or(whole, |share| whole * share)
            });
        }
        Setpoint {
            pose: on_path.pose,
            velocity: on_path.velocity * speed,
            acceleration,
        }
    }

    /// Whether the whole job was seen.
    ///
    /// # Errors
    /// Where it was seen last.
    pub fn complete(&self) -> Result<(), String> {
        match (&self.before, self.is_over) {
            (_, true) => Ok(()),
            (Some(before), false) => Err(format!(
                "the job of {} moves ended in move {}, tick {}",
                self.segments.len(),
                before.index,
                before.at
            )),
            (None, false) => Err("the job never began".into()),
        }
    }
}

/// The setpoints of a move, as the machine computes them.
fn segment<N: Transmit>(each: &AnyMove<N>, period: N::Factor) -> Segment<N, Quintics> {
    let common = each.common();
    let ends = Ends {
        from: common.from,
        to: common.to,
        velocities: [common.start_velocity, common.end_velocity].map(Into::into),
        accelerations: each.accelerations(),
    };
    Segment::new(&ends, common.ticks, period)
}

/// Angle, rate, acceleration and torque of each motor.
type Motors<N> = [(<N as Arithmetic>::Angle, N, N, N); 3];

/// The motors that a sample tells of.
fn told<N: Transmit>(sample: &Telemetry<N>) -> Motors<N> {
    [0, 1, 2].map(|i| {
        (
            sample.angles[i],
            sample.rates[i],
            sample.accelerations[i],
            sample.torques[i],
        )
    })
}

fn parts<N: Transmit>(motors: &[Motor<N>; 3]) -> Motors<N> {
    motors
        .each_ref()
        .map(|motor| (motor.angle, motor.rate, motor.acceleration, motor.torque))
}

/// Most bytes of what is compared: fifteen numbers of ten bytes.
const COMPARED: usize = 256;

/// Whether two values are the same bits, for -0 and 0 are equal and not the same.
fn same<T: serde::Serialize>(a: &T, b: &T) -> bool {
    let mut rooms = [[0; COMPARED]; 2];
    let [one, other] = &mut rooms;
    match (to_slice(a, one), to_slice(b, other)) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::{Device, DeviceChannels, RAMP_TICKS, TICK_RATE_HZ, answer, hello, home};
    use crate::faulty_link::Random;
    use crate::job::random_job;
    use trirrr_core::limits::LimitParameters;
    use trirrr_core::machine::example;
    use trirrr_core::model::Dynamic;
    use trirrr_core::tick::Tick;
    use trirrr_protocol::message::{Command, Reply, Request};

    fn motors(setpoint: &Setpoint<f64>) -> Option<[Motor<f64>; 3]> {
        let tick = Tick::<Dynamic<f64>>::build(&example()).ok()?;
        Some(tick.evaluate(setpoint).ok()?.motors)
    }

    /// A short job, and its samples with a command at some ticks.
    fn played(commands: &[(u32, Command<f64>)]) -> (Vec<AnyMove<f64>>, Vec<Telemetry<f64>>) {
        let mut random = Random::new(7);
        let mut job = random_job(&mut random, home(), true);
        while !(3..8).contains(&job.len()) {
            job = random_job(&mut random, home(), true);
        }
        let mut channels = DeviceChannels::new();
        let mut device = Device::new(&mut channels, LimitParameters::default(), 0);
        let mut sequence = 0;
        let mut ask = |device: &mut Device, command| {
            let request = Request { sequence, command };
            sequence += u32::from(!matches!(command, Command::Hello(_)));
            let reply = answer(device, &request);
            assert!(!matches!(reply, Reply::Refused(_)), "{reply:?}");
        };
        ask(&mut device, Command::Hello(hello()));
        ask(&mut device, Command::Telemetry { every: 1 });
        for (number, each) in (0..).zip(&job) {
            ask(&mut device, each.numbered(number).command());
        }
        while device.service.step() {}
        device.tick();
        while device.service.poll().is_some() {}
        ask(&mut device, Command::Start);
        let mut samples = Vec::new();
        for tick in 0..2000 {
            for (_, command) in commands.iter().filter(|(at, _)| *at == tick) {
                ask(&mut device, *command);
            }
            device.tick();
            while device.service.step() {}
            samples.extend(device.sample());
            while device.service.poll().is_some() {}
        }
        (job, samples)
    }

    fn watch(job: &[AnyMove<f64>], samples: &[Telemetry<f64>]) -> Result<(), String> {
        let mut checker = TrajectoryChecker::new(job, 0, RAMP_TICKS, 1.0 / TICK_RATE_HZ);
        for sample in samples {
            checker.see(sample, motors)?;
        }
        checker.complete()
    }

    #[test]
    fn a_job_with_a_hold_is_what_it_should_be() {
        let (job, samples) = played(&[(30, Command::Hold), (60, Command::Resume)]);
        watch(&job, &samples).expect("as the service plays it");
    }

    #[test]
    fn a_stop_ends_where_it_should_and_the_job_is_not_complete() {
        let (job, samples) = played(&[(30, Command::Stop)]);
        let error = watch(&job, &samples).expect_err("not played to its end");
        assert!(error.contains("ended in move"), "{error}");
    }

    #[test]
    fn whatever_is_other_than_it_should_is_seen() {
        let (job, samples) = played(&[(30, Command::Hold), (60, Command::Resume)]);
        type Change = fn(&mut Telemetry<f64>);
        fn next(value: f64) -> f64 {
            f64::from_bits(value.to_bits() + 1)
        }
        let changes: [Change; 10] = [
            |sample| sample.setpoint.pose.position.x = next(sample.setpoint.pose.position.x),
            |sample| sample.setpoint.velocity.y = next(sample.setpoint.velocity.y),
            |sample| sample.setpoint.acceleration.z = next(sample.setpoint.acceleration.z),
            |sample| sample.angles[0] = next(sample.angles[0]),
            |sample| sample.rates[1] = next(sample.rates[1]),
            |sample| sample.accelerations[2] = next(sample.accelerations[2]),
            |sample| sample.torques[0] = next(sample.torques[0]),
            |sample| sample.at += 1,
            |sample| sample.tick += 1,
            |sample| sample.lost = 1,
        ];
        // At normal speed, on the way to the hold, on the way back.
        for tick in [10, 33, 64] {
            for (which, change) in changes.iter().enumerate() {
                let mut samples = samples.clone();
                change(&mut samples[tick]);
                assert!(watch(&job, &samples).is_err(), "{which} of tick {tick}");
            }
        }
        let mut missing = samples.clone();
        missing.remove(20);
        assert!(watch(&job, &missing).is_err(), "a sample is missing");
        assert!(watch(&job, &samples[..50]).is_err(), "the end is missing");
    }
}
