//! binary32: how much of what the admission counts for rounding the tick really rounds.

use crate::dense::segment;
use crate::judge::Setting;
use crate::moves::{in_type, random_move};
use nalgebra::Vector3;
use trirrr_core::limits::LimitParameters;
use trirrr_core::model::{Model, ModelVisitor};
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Hermite, Pose, RestToRest, Segment};
use trirrr_core::singularity::Distances;
use trirrr_core::tick::Tick;
use trirrr_protocol::message::Move;
use trirrr_service::admission::{AngleModel, TaylorModel};
use trirrr_service::paces::Ramp;
use trirrr_tests::draw::{Draw, machines, within_a_turn};
use trirrr_tests::random::share;

type Wide = TaylorModel<f32>;

/// Random moves, and instants of each.
const MOVES: usize = share(4000) as usize;
const SAMPLES: u32 = 64;

struct Visit<'a> {
    setting: &'a Setting,
    offered: &'a Move<f32>,
    shares: &'a mut Vec<f64>,
}

impl ModelVisitor<f32> for Visit<'_> {
    type Output = ();

    /// Notes the rounding error of each value that has a limit, in parts of what is counted for it.
    fn visit<M: Model<N = f32>>(self) {
        let Self {
            setting,
            offered,
            shares,
        } = self;
        let machine = setting.kind().with(&setting.parameters);
        let own = Tick::<M>::build(machine).expect("a good machine");
        let wide = Tick::<M::Over<Wide>>::build(machine).expect("a good machine");
        let distances = Distances::<f32>::build(&setting.parameters);
        let wide_distances = Distances::<Wide>::build(&setting.parameters);
        let pose = |pose: &Pose<f32>| Pose::<Wide> {
            position: pose.position.map(Wide::of),
            angle: AngleModel::of(pose.angle),
        };
        let velocity = |velocity: [f32; 3]| Vector3::from(velocity.map(Wide::of));
        let (from, to) = (pose(&offered.from), pose(&offered.to));
        let (ticks, period) = (offered.ticks, Wide::from_f64(setting.period_s));
        let wide_segment: Segment<Wide> = if offered.is_rest_to_rest() {
            Segment::RestToRest(RestToRest::new(from, to, ticks, period))
        } else {
            let [start, end] = [offered.start_velocity, offered.end_velocity].map(velocity);
            Segment::Hermite(Hermite::new(from, start, to, end, ticks, period))
        };
        let segment = segment(offered, setting.period_s);
        for sample in 0..=SAMPLES {
            // Exact, and a point of time: what a model is wide then is rounding.
            let s = f32::ratio(sample, SAMPLES);
            let (setpoint, wide_setpoint) = (
                segment.at_fraction(s),
                wide_segment.at_fraction(Wide::point(s)),
            );
            let (Ok(motion), Ok(wide_motion)) =
                (own.evaluate(&setpoint), wide.evaluate(&wide_setpoint))
            else {
                return;
            };
            let mut note = |own: f32, wide: Wide| {
                let error = (f64::from(own) - wide.to_f64()).abs();
                if error > 0.0 {
                    shares.push(error / f64::from(wide.radius()));
                }
            };
            for (own, wide) in motion.motors.iter().zip(&wide_motion.motors) {
                note(own.rate, wide.rate);
                note(own.acceleration, wide.acceleration);
                note(own.torque, wide.torque);
                note(own.torque * own.rate, wide.torque * wide.rate);
            }
            let (Ok(position), Ok(wide_position)) = (
                own.geometry().position(&setpoint.pose),
                wide.geometry().position(&wide_setpoint.pose),
            ) else {
                return;
            };
            let serial = distances.serial(&position);
            for (own, wide) in serial
                .into_iter()
                .zip(wide_distances.serial(&wide_position))
            {
                note(own, wide);
            }
            note(
                distances.parallel(&position),
                wide_distances.parallel(&wide_position),
            );
        }
    }
}

/// The allowance is a part of the most that the tick may round: most values need less of it, few need more, and none
/// nearly all that may be rounded.
#[test]
fn few_values_are_rounded_by_more_than_the_allowance() {
    let mut draw = Draw::new(47);
    let mut shares = Vec::new();
    for case in machines(47).take(MOVES) {
        let case = within_a_turn(&case);
        let (offered, period_s, ramp_ticks) = random_move(&case, &mut draw);
        let setting = Setting {
            parameters: case.parameters,
            limits: LimitParameters::default(),
            ramp: Ramp::fixed(ramp_ticks),
            period_s,
        };
        setting.kind().visit(Visit {
            setting: &setting,
            offered: in_type(&(&offered).into()).common(),
            shares: &mut shares,
        });
    }
    shares.sort_by(f64::total_cmp);
    let at = |part: f64| shares[((shares.len() - 1) as f64 * part) as usize];
    println!(
        "{} values of {MOVES} moves, in parts of the allowance: median {:.2}, 90 % {:.2}, 99.9 % {:.1}, most {:.1}",
        shares.len(),
        at(0.5),
        at(0.9),
        at(0.999),
        at(1.0)
    );
    assert!(shares.len() > 100 * MOVES);
    assert!(at(0.5) < 0.5 && at(1.0) < 32.0);
}
