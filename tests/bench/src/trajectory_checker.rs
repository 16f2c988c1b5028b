//! Watches what a machine does with a job from tick to tick, from the samples that it sends.
//!
//! Every tick has a sample. Each has to be where the path goes on from the one before, at a speed
//! along the path that a ramp allows, with the setpoint that the offered move has there: the same
//! bits, on the way to and from a hold too.

use postcard::to_slice;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Ends, Quintics, Segment, Setpoint};
use trirrr_core::tick::Motor;
use trirrr_protocol::message::{AnyMove, Cut, Move, State, Telemetry, Transmit};

/// Levels by which the pace changes at most in a tick: a machine's ramp has so many for each of its ticks.
const FULL: u32 = 128;

/// Watches one job.
pub struct TrajectoryChecker<N: Transmit> {
    /// Moves in the order in which they are played.
    moves: Vec<Checked<N>>,
    period: N::Factor,
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

/// One move of the job.
struct Checked<N: Transmit> {
    /// The machine's number of it.
    number: u32,
    segment: Segment<N, Quintics>,
    /// Ticks that are played: all, unless it is cut.
    ticks: u32,
}

/// The sample before.
struct Before {
    tick: u32,
    index: u32,
    at: u32,
    part: u32,
    state: State,
    /// Levels that the pace can have. More than one only where the path ended within a tick.
    levels: Vec<u32>,
}

impl<N: Transmit> TrajectoryChecker<N> {
    /// Of a job of `moves`, the first of which the machine calls `base`, on a machine that takes
    /// `ramp` ticks from normal speed to rest and ticks every `period`.
    pub fn new(moves: &[AnyMove<N>], base: u32, ramp: u16, period: N::Factor) -> Self {
        let top = FULL * u32::from(ramp);
        let mut checker = Self {
            moves: Vec::new(),
            period,
            top,
            counts: [top, 2 * top, FULL].map(N::count),
            slope: N::factor_over(N::quotient(1, u32::from(ramp)), period),
            before: None,
            samples: 0,
            is_over: false,
            is_blind: false,
        };
        for (index, each) in (0..).zip(moves) {
            checker.add(&each.numbered(base.wrapping_add(index)));
        }
        checker
    }

    /// Adds a move behind the others. It takes the place of one with its number, and of those behind it.
    pub fn add(&mut self, each: &AnyMove<N>) {
        let Move { number, ticks, .. } = *each.common();
        if let Some(index) = self.index(number) {
            self.moves.truncate(index as usize);
        }
        let segment = segment(each, self.period);
        self.moves.push(Checked {
            number,
            segment,
            ticks,
        });
        self.is_over = false;
    }

    /// Cuts a move, and drops those behind it. Returns the setpoint there.
    ///
    /// # Errors
    /// There is no such place ahead.
    pub fn cut(&mut self, cut: &Cut) -> Result<Setpoint<N>, String> {
        let index = self.index(cut.number).ok_or("the cut is in no move")?;
        let place = |before: &Before| (before.index, before.at);
        if self.before.as_ref().map(place) >= Some((index, cut.at)) {
            return Err(format!(
                "the path was at {:?} before {cut:?}",
                self.before.as_ref().map(place)
            ));
        }
        self.moves.truncate(index as usize + 1);
        let last = &mut self.moves[index as usize];
        if cut.at == 0 || cut.at > last.ticks {
            return Err(format!("{cut:?} of {} ticks", last.ticks));
        }
        last.ticks = cut.at;
        Ok(last.segment.at(cut.at))
    }

    /// Forgets the moves that are over: those of a long job come and go.
    pub fn forget_passed(&mut self) {
        if let Some(before) = &mut self.before {
            self.moves.drain(..before.index as usize);
            before.index = 0;
        }
    }

    /// Number of moves that the path has not left behind.
    pub fn ahead(&self) -> usize {
        let passed = self.before.as_ref().map_or(0, |before| before.index);
        self.moves.len() - passed as usize
    }

    /// Drops the moves from a number on that are not begun: the machine has dropped them.
    pub fn drop_from(&mut self, number: u32) {
        let begun = self
            .before
            .as_ref()
            .map_or(0, |before| before.index as usize + 1);
        let is_dropped = |each: &Checked<N>| number.wrapping_sub(each.number) as i32 <= 0;
        let place = self.moves.iter().skip(begun).position(is_dropped);
        if let Some(place) = place {
            self.moves.truncate(begun + place);
        }
    }

    /// Returns true if the pace is not that of normal speed.
    pub fn is_slow(&self) -> bool {
        let levels = self.before.as_ref().map(|before| &before.levels);
        levels.is_some_and(|levels| !levels.contains(&self.top))
    }

    /// Returns true if a move has this number.
    pub fn has(&self, number: u32) -> bool {
        self.index(number).is_some()
    }

    fn index(&self, number: u32) -> Option<u32> {
        let index = self.moves.iter().rposition(|each| each.number == number)?;
        Some(index as u32)
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
        if let State::Disabled | State::Enabling | State::Disabling = sample.state {
            let on_path = self.before.as_ref();
            return match on_path.is_some_and(|before| before.state != State::Idle) {
                true => Err("the drives go off on the path".into()),
                false => Ok(()),
            };
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
        let index = self.index(sample.number).ok_or("no move of the job")?;
        let Checked { segment, ticks, .. } = &self.moves[index as usize];
        if sample.at > *ticks {
            return Err(format!("beyond the move's {ticks} ticks"));
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
            // Behind a rest with too little to stop in the path begins at rest.
            Some(before) => self.go_on(before, index, sample).or_else(|why| {
                let rest = Before {
                    index: before.index + 1,
                    at: 0,
                    part: 0,
                    levels: vec![0],
                    ..*before
                };
                match self.rested(before) && index == rest.index {
                    true => self.go_on(&rest, index, sample),
                    false => Err(why),
                }
            })?,
        };
        if self.is_blind && !same(&sample.setpoint, &segment.at(sample.at)) {
            return Err("not at normal speed after what was not seen".into());
        }
        self.is_blind = false;
        let last = index as usize + 1 == self.moves.len();
        self.is_over = last && sample.at == *ticks;
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
        let Checked { segment, ticks, .. } = &self.moves[before.index as usize];
        let ticks = *ticks;
        let stops = |&level: &u32| {
            let passed = before.part + level;
            let (at, part) = (passed / (2 * self.top), passed % (2 * self.top));
            let at = before.at + at;
            // It may lead into the next move.
            let (segment, at) = match (
                at.checked_sub(ticks),
                self.moves.get(before.index as usize + 1),
            ) {
                (Some(at), Some(next)) => (&next.segment, at),
                _ => (segment, at),
            };
            let sample = &Telemetry {
                at,
                part,
                ..*sample
            };
            let expected = self.setpoint(segment, sample, 0, -i64::from(level));
            level <= FULL && same(&expected, &sample.setpoint)
        };
        // Or the path has ended there.
        let Setpoint { pose, velocity, .. } = &sample.setpoint;
        let stands = self.rested(before)
            && same(&segment.at(before.at).pose, pose)
            && <[N; 3]>::from(*velocity) == [N::ZERO; 3];
        match stands || before.levels.iter().any(stops) {
            true => {
                let led = self.index(sample.number);
                if let (Some(before), Some(index)) = (&mut self.before, led) {
                    before.index = index;
                }
                Ok(())
            }
            false => Err(format!(
                "the stop does not end where move {}, tick {} and {} parts at {:?} lead",
                before.index, before.at, before.part, before.levels
            )),
        }
    }

    /// Returns true if the path was at rest at the end of its move.
    fn rested(&self, before: &Before) -> bool {
        let Checked { segment, ticks, .. } = &self.moves[before.index as usize];
        let end = segment.at(*ticks);
        before.at == *ticks && <[N; 3]>::from(end.velocity) == [N::ZERO; 3]
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
        let Checked { segment, ticks, .. } = &self.moves[index as usize];
        // A path that ends at rest ends there, even if the tick would have gone further.
        let at_end = sample.at == *ticks && sample.part == 0;
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
        let before = &self.moves[..index as usize];
        let start: u64 = before.iter().map(|each| u64::from(each.ticks)).sum();
        (start + u64::from(at)) * u64::from(2 * self.top) + u64::from(part)
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
                self.moves.len(),
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
        let mut device = Device::enabled(&mut channels, LimitParameters::default(), 0);
        let mut sequence = 0;
        let mut ask = |device: &mut Device, command| {
            let request = Request { sequence, command };
            sequence = sequence.wrapping_add(1);
            let reply = answer(device, &request);
            assert!(!matches!(reply, Reply::Refused(_)), "{reply:?}");
            if let Reply::Hello(identity) = reply {
                sequence = identity.next_sequence;
            }
        };
        ask(&mut device, Command::Hello(hello()));
        ask(&mut device, Command::telemetry(1));
        for (number, each) in (0..).zip(&job) {
            ask(&mut device, each.numbered(number).command());
        }
        while device.service.step() {}
        device.tick();
        while device.service.outgoing().is_some() {}
        ask(&mut device, Command::Start);
        let mut samples = Vec::new();
        for tick in 0..2000 {
            for (_, command) in commands.iter().filter(|(at, _)| *at == tick) {
                ask(&mut device, *command);
            }
            device.tick();
            while device.service.step() {}
            samples.extend(device.sample());
            while device.service.outgoing().is_some() {}
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
