//! Retargets one after the other, each from the state in which the last was interrupted.

use crate::drawn::{Setting, setpoint};
use crate::judge::{is_true, largest_part, state};
use trirrr_core::limits::Limits;
use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_core::setpoint::{Quintics, Segment, Setpoint};
use trirrr_protocol::message::QuinticMove;
use trirrr_service::admission::{Blocked, Path, Retarget, Retargeted};
use trirrr_service::paces::Ramp;
use trirrr_tests::draw::Draw;
use trirrr_tests::instant::State;

/// Ticks of a hold where the limits leave room.
pub(crate) const RAMP_TICKS: u16 = 100;

/// More than any retarget takes.
pub(crate) const STEPS: u32 = 200_000;

/// Outcome of so many retargets.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) planned: u32,
    pub(crate) one_move: u32,
    pub(crate) at_once: u32,
    pub(crate) refused: [u32; 5],
    /// Refusals that the judge does not confirm, as text.
    pub(crate) failed: Vec<String>,
    pub(crate) largest: f64,
    pub(crate) steps: Vec<u32>,
}

impl Tally {
    pub(crate) fn join(&mut self, other: Self) {
        self.planned += other.planned;
        self.one_move += other.one_move;
        self.at_once += other.at_once;
        for (mine, other) in self.refused.iter_mut().zip(other.refused) {
            *mine += other;
        }
        self.failed.extend(other.failed);
        self.largest = self.largest.max(other.largest);
        self.steps.extend(other.steps);
    }
}

/// Steps to the end, and counts them.
pub(crate) fn outcome<M: Model<N = f64>>(retarget: &mut Retarget<M>) -> (Retargeted<f64>, u32) {
    for count in 1..STEPS {
        match retarget.step() {
            Retargeted::Undecided => {}
            done => return (done, count),
        }
    }
    panic!("a retarget without an end")
}

pub(crate) fn moves<M: Model<N = f64>>(retarget: &Retarget<M>) -> Vec<QuinticMove<f64>> {
    (0..).map_while(|index| retarget.planned(index)).collect()
}

/// Ends of one session: a machine with its limits.
pub(crate) struct Session<'a> {
    pub(crate) setting: &'a Setting,
    pub(crate) draw: &'a mut Draw,
    pub(crate) count: u32,
    /// Instants at which a motion is judged.
    pub(crate) samples: u32,
}

impl Session<'_> {
    pub(crate) fn run(self) -> Tally {
        ModelKind::of(&self.setting.parameters, true).visit(self)
    }
}

pub(crate) fn path<M: Model<N = f64>>(setting: &Setting) -> Path<M> {
    let limits = Limits::build(&setting.limits).expect("limits");
    Path::build(
        &setting.parameters,
        limits,
        Ramp::within(RAMP_TICKS, None),
        setting.period_s,
    )
    .expect("a machine")
}

/// The state at `tick` of the moves, as the tick plays it.
pub(crate) fn at_tick(moves: &[QuinticMove<f64>], mut tick: u32, period_s: f64) -> Setpoint<f64> {
    for each in moves {
        let common = &each.common;
        if tick <= common.ticks {
            let ends = trirrr_core::setpoint::Ends::<f64, Quintics> {
                from: common.from,
                to: common.to,
                velocities: [common.start_velocity, common.end_velocity].map(Into::into),
                accelerations: Some([each.start_acceleration, each.end_acceleration]),
            };
            return Segment::new(&ends, common.ticks, period_s).at(tick);
        }
        tick -= common.ticks;
    }
    panic!("behind the last move")
}

impl ModelVisitor<f64> for Session<'_> {
    type Output = Tally;

    fn visit<M: Model<N = f64>>(self) -> Tally {
        let Self {
            setting,
            draw,
            count,
            samples,
        } = self;
        let mut tally = Tally::default();
        let rest = State {
            pose: setting.start,
            ..State::default()
        };
        let mut start = setpoint(&rest);
        let mut retarget = Retarget::<M>::over(path::<M>(setting), &start, &start);
        // The motion under way and the tick at which it is.
        let mut under_way: (Vec<QuinticMove<f64>>, u32) = (Vec::new(), 0);
        for index in 0..count {
            let target = match draw.chance(0.03) {
                true => start,
                false => setpoint(&setting.target(state(&start).pose, draw)),
            };
            retarget.aim(&start, &target);
            let (outcome, steps) = outcome(&mut retarget);
            tally.steps.push(steps);
            let case = || {
                format!(
                    "{index}: {outcome:?}\nfrom {start:?}\nto {target:?}\nlimits {:?}, {} s\nmachine {:?}",
                    setting.limits, setting.period_s, setting.parameters
                )
            };
            match outcome {
                Retargeted::Undecided => unreachable!("an end"),
                Retargeted::Planned(length) => {
                    let chain = moves(&retarget);
                    assert_eq!(chain.len(), length);
                    tally.planned += 1;
                    tally.one_move += u32::from(length == 1);
                    if length == 0 {
                        assert_eq!(start, target);
                        tally.at_once += 1;
                        continue;
                    }
                    let part = largest_part(setting, [&start, &target], &chain, samples);
                    tally.largest = tally.largest.max(part);
                    assert!(part <= 1.0, "{part} of a limit: {}", case());
                    under_way = (chain, 0);
                }
                Retargeted::Refused(refusal) => {
                    tally.refused[refusal.blocked as usize] += 1;
                    // The state of a motion that is proven keeps the limits.
                    if refusal.blocked == Blocked::Start
                        || !is_true(setting, [&start, &target], &refusal)
                    {
                        tally.failed.push(case());
                    }
                }
            }
            // The motion under way goes on for a while.
            let (chain, at) = &mut under_way;
            let ticks: u32 = chain.iter().map(|each| each.common.ticks).sum();
            let left = f64::from(ticks - *at);
            *at += match draw.chance(0.7) {
                true => (left * draw.within(0.0, 1.0)) as u32,
                false => ticks - *at,
            };
            if !chain.is_empty() {
                start = at_tick(chain, *at, setting.period_s);
            }
            let stuck = matches!(outcome, Retargeted::Refused(_)) && *at == ticks;
            if stuck {
                start = setpoint(&rest);
                under_way = (Vec::new(), 0);
            }
        }
        tally
    }
}
