//! Watches what the machine puts out in every tick, over all times that it was switched on.

use super::Count;
use super::engraving::Engraving;
use std::rc::Rc;
use trirrr_bench::device::{RAMP_TICKS, TICK_RATE_HZ};
use trirrr_bench::trajectory_checker::TrajectoryChecker;
use trirrr_client::records::is_of_a_job;
use trirrr_client::{JobPlace, JobRest};
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_core::number::WideArithmetic;
use trirrr_core::setpoint::{Ends, Quintics, Segment, Setpoint};
use trirrr_core::tick::Tick;
use trirrr_protocol::message::{Acting, Move, State, Telemetry};

/// Moves that the checker knows beyond the one under way.
const AHEAD: usize = 4;

/// Rounding of the tool's power in f32, and of the two parts of a move that was cut, in m, m/s, m/s^2.
const POWER_ERROR: f64 = 1e-5;
const CUT_ERROR: [f64; 3] = [1e-6, 1e-4, 1e-1];

/// Account of the whole job.
pub(super) struct Witness {
    job: Engraving,
    tick: Tick<Dynamic<f32>>,
    /// Ticks of the job's path behind which nothing was played; none before the first.
    furthest: Option<u64>,
    life: Option<Life>,
    pub(super) count: Count,
}

/// One way of the machine along the path, from where it begins it to the end or a loss of power.
struct Life {
    rest: Rc<JobRest<f32>>,
    /// Number by which the machine calls the first move of the rest.
    first: u32,
    checker: TrajectoryChecker<f32>,
    /// Moves that the checker was told.
    told: u32,
    /// The move of the job that was under way last, as its setpoints.
    segment: Option<(u32, Segment<f32, Quintics>)>,
    before: Option<(u64, u32)>,
}

impl Witness {
    pub(super) fn new(job: Engraving) -> Self {
        Self {
            job,
            tick: Tick::build(&example()).expect("the thesis machine"),
            furthest: None,
            life: None,
            count: Count::default(),
        }
    }

    /// The machine has lost its power.
    pub(super) fn power_cut(&mut self) {
        self.life = None;
    }

    /// Ticks of the job's path that were played.
    pub(super) fn furthest(&self) -> u64 {
        self.furthest.unwrap_or(0)
    }

    /// Takes the sample of the next tick. The machine plays `rest`, and calls its first move `first`.
    ///
    /// # Panics
    /// Something is other than the job asks for.
    pub(super) fn see(
        &mut self,
        sample: &Telemetry<f32>,
        rest: &Rc<JobRest<f32>>,
        first: Option<u32>,
    ) {
        self.count.ticks += 1;
        if self.life.is_none() {
            if !is_of_a_job(sample.state) || first.is_none() {
                assert_eq!(
                    sample.tool, 0.0,
                    "the tool is on beside the job: {sample:?}"
                );
                return;
            }
            self.life = first.map(|first| Life::begin(rest.clone(), first));
        }
        let Self {
            life: Some(life),
            tick,
            job,
            furthest,
            count,
            ..
        } = self
        else {
            return;
        };
        life.tell();
        let motors = |setpoint: &Setpoint<f32>| Some(tick.evaluate(setpoint).ok()?.motors);
        if let Err(why) = life.checker.see(sample, motors) {
            panic!("{why}");
        }
        life.checker.forget_passed();
        let index = sample.number.wrapping_sub(life.first);
        let asked = match is_of_a_job(sample.state) {
            true => life.asked(index, sample),
            false => 0.0,
        };
        let error = (f64::from(sample.tool) - asked).abs();
        assert!(
            error < POWER_ERROR,
            "the tool should be {asked}: {sample:?}"
        );
        let stands = sample.rates == [0.0; 3];
        assert!(!stands || sample.tool == 0.0, "it stands: {sample:?}");
        count.take(sample, stands);
        if is_of_a_job(sample.state) {
            life.play(job, index, sample, furthest, count);
        }
    }
}

impl Life {
    fn begin(rest: Rc<JobRest<f32>>, first: u32) -> Self {
        Self {
            rest,
            first,
            checker: TrajectoryChecker::new(&[], first, RAMP_TICKS, period()),
            told: 0,
            segment: None,
            before: None,
        }
    }

    /// Tells the checker the next moves.
    fn tell(&mut self) {
        let moves = self.rest.moves();
        while self.checker.ahead() <= AHEAD
            && let Some(next) = moves.get(self.told as usize)
        {
            let number = self.first.wrapping_add(self.told);
            self.checker.add(&next.numbered(number));
            self.told += 1;
        }
    }

    /// Power of the tool that the job asks for at the speed of `sample`.
    fn asked(&self, index: u32, sample: &Telemetry<f32>) -> f64 {
        let Move {
            tool_power,
            tool_speed,
            ..
        } = *self.rest.moves()[index as usize].common();
        let power = f64::from(tool_power);
        match sample.state {
            State::Running | State::Slowing if tool_speed == 0.0 => power,
            State::Running | State::Slowing => {
                let [x, y] = [0, 1].map(|i| f64::from(sample.setpoint.velocity[i]));
                (power * x.hypot(y) / f64::from(tool_speed)).min(1.0)
            }
            _ => 0.0,
        }
    }

    /// Counts the place of `sample` on the job's path: each tick of it comes once, and the tick after the one before.
    fn play(
        &mut self,
        job: &Engraving,
        index: u32,
        sample: &Telemetry<f32>,
        furthest: &mut Option<u64>,
        count: &mut Count,
    ) {
        let from = self.rest.from();
        let place = self.rest.place(JobPlace {
            index,
            at: sample.at,
        });
        if index < self.lead(job) {
            count.led_ticks += 1;
            assert_eq!(sample.tool, 0.0, "the tool is on on the way back");
            return;
        }
        self.compare(job, place, sample);
        let here = job.before(place.index) + u64::from(place.at);
        let start = job.before(from.index) + u64::from(from.at);
        match self.before.replace((here, sample.part)) {
            None => {
                assert_eq!(here, start, "the job does not go on where it should");
                let played = furthest.map_or(0, |furthest| furthest + 1);
                assert!(start <= played, "{} ticks are missing", start - played);
                count.repeat(played - start);
            }
            Some((before, part)) => {
                assert!((before, part) <= (here, sample.part), "back from {before}");
                assert!(here - before <= 1, "from {before} to {here}");
                if here == before {
                    return;
                }
            }
        }
        if furthest.is_none_or(|furthest| here > furthest) {
            *furthest = Some(here);
            count.path_ticks += 1;
            count.between += u64::from(sample.part != 0);
        }
    }

    /// Moves of the way back.
    fn lead(&self, job: &Engraving) -> u32 {
        let behind = job.moves() - self.rest.from().index;
        self.rest.moves().len() as u32 - behind
    }

    /// Compares the sample with the setpoint of the job itself, made anew, where the machine is at normal speed.
    fn compare(&mut self, job: &Engraving, place: JobPlace, sample: &Telemetry<f32>) {
        let is_normal = sample.state == State::Running && sample.acting == Acting::Nothing;
        if !is_normal || sample.part != 0 {
            return;
        }
        let index = place.index;
        let segment = match &self.segment {
            Some((made, segment)) if *made == index => segment,
            _ => &self.segment.insert((index, segment(job, index))).1,
        };
        let expected = segment.at(place.at);
        let from = self.rest.from();
        let is_cut = from.at > 0 && index == from.index;
        let is_right = match is_cut {
            true => is_near(&expected, &sample.setpoint),
            false => expected == sample.setpoint,
        };
        assert!(is_right, "the job asks for {expected:?}: {sample:?}");
    }
}

/// The tick period of the machine.
pub(super) fn period() -> <f32 as WideArithmetic>::Factor {
    f32::factor_from_f64(1.0 / TICK_RATE_HZ)
}

/// The setpoints of the move `index`.
fn segment(job: &Engraving, index: u32) -> Segment<f32, Quintics> {
    let each = job.get(index);
    let common = each.common();
    let ends = Ends {
        from: common.from,
        to: common.to,
        velocities: [common.start_velocity, common.end_velocity].map(Into::into),
        accelerations: each.accelerations(),
    };
    Segment::new(&ends, common.ticks, period())
}

fn is_near(one: &Setpoint<f32>, other: &Setpoint<f32>) -> bool {
    let parts = |setpoint: &Setpoint<f32>| {
        let Setpoint {
            pose,
            velocity,
            acceleration,
        } = setpoint;
        let pose = [pose.position.x, pose.position.y, pose.angle];
        [pose, (*velocity).into(), (*acceleration).into()]
    };
    let (one, other) = (parts(one), parts(other));
    one.iter()
        .zip(&other)
        .zip(CUT_ERROR)
        .all(|((one, other), error)| {
            let pairs = one.iter().zip(other);
            pairs
                .into_iter()
                .all(|(one, other)| f64::from(one - other).abs() < error)
        })
}
