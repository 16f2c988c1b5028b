//! One case in one number type: how far off the results are, whether the loops close, or why
//! there are none.

use super::cases::{Case, Motion};
use crate::evaluator;
use crate::record::Record;
use crate::report::exact::{in_state, motors, on_move};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, RestToRest, Setpoint};
use trirrr_truth::double_double::DoubleDouble;
use trirrr_truth::inputs::{Input, Inputs, Quantity};
use trirrr_truth::results::{angle_error, names, uncertainties};
use trirrr_truth::scalar::{difference, scaled, sum, turned};

/// What becomes of a case.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outcome {
    /// There are results.
    Motion {
        /// Worst error of the motors' twelve results over u cond: over what a rounding of every
        /// input does, to first order.
        forward: f64,
        /// Which result that is.
        worst: String,
        /// How far the loops are from closing with the computed angles of both links, in units in
        /// the last place of the machine's size.
        closure: f64,
    },
    /// The type has results where there are none: rounding brought the pose into reach.
    BeyondReach,
    /// Why there are none.
    Status(String),
}

/// Evaluates `case` in `N`.
pub(crate) fn measure<N: Number>(case: &Case) -> Outcome {
    let unit = N::UNIT_ROUNDOFF.to_f64();
    match record::<N>(case) {
        Err(status) => Outcome::Status(status),
        Ok(record) => compare(case, &record, unit),
    }
}

fn record<N: Number>(case: &Case) -> Result<Record, String> {
    let machine =
        evaluator::build::<N>(&case.parameters).map_err(|error| format!("refused: {error}"))?;
    let pose = |pose: &Pose<f64>| Pose::<N>::from_f64(pose.position.x, pose.position.y, pose.angle);
    let setpoint = match &case.motion {
        Motion::State(state) => Setpoint {
            pose: pose(&state.pose),
            velocity: state.velocity.map(N::from_f64),
            acceleration: state.acceleration.map(N::from_f64),
        },
        Motion::Move {
            each,
            rate_hz,
            tick,
        } => {
            let period = N::factor_from_f64(1.0 / rate_hz);
            let (from, to) = (pose(&each.from), pose(&each.to));
            RestToRest::new(from, to, each.duration_ticks, period).at(*tick)
        }
    };
    machine
        .evaluate(0.0, &setpoint)
        .map_err(|status| status.to_string())
}

fn compare(case: &Case, record: &Record, unit: f64) -> Outcome {
    let inputs = exact_inputs(case);
    if !is_in_reach(&inputs) {
        return Outcome::BeyondReach;
    }
    let truth = motors(&inputs);
    let conditions = conditions(case);
    let (mut forward, mut worst) = (0.0, String::new());
    let listed = names().into_iter().zip(conditions);
    for (name, condition) in listed {
        let (Some(leg), Some(stage)) = (
            name.leg,
            ["th1", "dth1", "ddth1", "tau"]
                .iter()
                .position(|stem| *stem == name.stem),
        ) else {
            continue;
        };
        let of_leg = &record.legs[leg];
        let found = [of_leg.th1, of_leg.dth1, of_leg.ddth1, of_leg.torque][stage];
        let error = match stage {
            0 => angle_error(truth[leg][stage], found),
            _ => truth[leg][stage].error_of(found),
        };
        // A result without any error meets a condition of zero.
        let ratio = match error.abs() {
            0.0 => 0.0,
            error => error / (unit * condition),
        };
        // What is not a number must not pass for small.
        let ratio = if ratio.is_nan() { f64::INFINITY } else { ratio };
        if ratio > forward {
            forward = ratio;
            worst = name.column();
        }
    }
    Outcome::Motion {
        forward,
        worst,
        closure: closure(&inputs, record, unit),
    }
}

fn exact_inputs(case: &Case) -> Inputs<DoubleDouble> {
    match &case.motion {
        Motion::State(state) => Inputs::exact(&case.parameters, state),
        Motion::Move {
            each,
            rate_hz,
            tick,
        } => in_state(&case.parameters, on_move(each, *rate_hz, *tick)),
    }
}

/// Whether every leg reaches, in 31 digits.
fn is_in_reach(inputs: &Inputs<DoubleDouble>) -> bool {
    inputs.legs.iter().all(|leg| {
        let c = turned([leg.h, DoubleDouble::new(0.0)], inputs.angle + leg.lambda);
        let d = difference(sum(inputs.position, c), leg.base);
        let square = d[0] * d[0] + d[1] * d[1];
        let (most, least) = (leg.l1 + leg.l2, leg.l1 - leg.l2);
        let (below, above) = (most * most - square, square - least * least);
        below.value() > 0.0 && above.value() > 0.0
    })
}

/// The condition of every result: against the state, or against the ends of the move. What these
/// are rounded by goes into the displacement, from there into velocity and acceleration.
fn conditions(case: &Case) -> Vec<f64> {
    match &case.motion {
        Motion::State(state) => uncertainties(&case.parameters, state, |input| input.length),
        Motion::Move {
            each,
            rate_hz,
            tick,
        } => {
            let state = on_move(each, *rate_hz, *tick);
            let value = |row: usize| state[row].map(DoubleDouble::value);
            let [x, y, alpha] = value(0);
            let setpoint = Setpoint {
                pose: Pose::from_f64(x, y, alpha),
                velocity: value(1).into(),
                acceleration: value(2).into(),
            };
            let duration = f64::from(each.duration_ticks) / rate_hz;
            let size = |of: fn(&Pose<f64>) -> f64| of(&each.from).abs() + of(&each.to).abs();
            let place = size(|pose| pose.position.x).hypot(size(|pose| pose.position.y));
            let angle = size(|pose| pose.angle);
            // The greatest of the cubic's derivatives: 3 h / 2 T, and 6 h / T^2.
            let (first, second) = (1.5 / duration, 6.0 / (duration * duration));
            let off = |input: Input| match input.quantity {
                Quantity::Position => place,
                Quantity::Velocity => place * first,
                Quantity::Acceleration => place * second,
                Quantity::Angle => angle,
                Quantity::AngleRate => angle * first,
                Quantity::AngleAcceleration => angle * second,
                _ => input.length,
            };
            uncertainties(&case.parameters, &setpoint, off)
        }
    }
}

/// The largest gap A + l1 e(theta_1) + l2 e(theta_2) - D - c of the three legs, at the pose as the
/// type holds it.
fn closure(inputs: &Inputs<DoubleDouble>, record: &Record, unit: f64) -> f64 {
    let [x, y, alpha] = record.pose.map(DoubleDouble::new);
    let mut largest: f64 = 0.0;
    for (leg, found) in inputs.legs.iter().zip(&record.legs) {
        let along = |length, angle: f64| {
            let (sin, cos) = DoubleDouble::new(angle).sin_cos();
            scaled([cos, sin], length)
        };
        let c = turned([leg.h, DoubleDouble::new(0.0)], alpha + leg.lambda);
        let links = sum(along(leg.l1, found.th1), along(leg.l2, found.th2));
        let gap = difference(sum(leg.base, links), sum([x, y], c));
        let size = leg.base[0].value().hypot(leg.base[1].value()) + leg.l1.value() + leg.l2.value();
        let last_place = 2.0 * unit * size.log2().floor().exp2();
        let gap = gap[0].value().hypot(gap[1].value()) / last_place;
        largest = if gap <= largest { largest } else { gap };
    }
    largest
}
