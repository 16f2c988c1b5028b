//! One case in one number type: how far off the results are, whether the loops close, or why
//! there are none.

use super::cases::{CaseMotion, ExtremeCase};
use crate::exact::{in_state, motors, on_move};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::units::Units;
use trirrr_scene::pipeline;
use trirrr_scene::record::Record;
use trirrr_truth::double_double::DoubleDouble;
use trirrr_truth::inputs::{Input, Inputs, Quantity};
use trirrr_truth::results::{angle_error, names, uncertainties};
use trirrr_truth::rounding::Rounding;
use trirrr_truth::scalar::{difference, scaled, sum, turned};

/// Outcome of a case.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CaseOutcome {
    /// There are results.
    Motion {
        /// Worst error of the motors' twelve results over u cond: over what a rounding of every
        /// input does, to first order.
        forward: f64,
        /// Name of the result with the worst error.
        worst: String,
        /// Worst error of an angle, rad, or of a rate, an acceleration or a torque over the largest of
        /// the three motors.
        relative: f64,
        /// Largest gap of the loops with the computed angles of both links, in units in the last
        /// place of the machine's size.
        closure: f64,
    },
    /// The type has results where there are none: rounding brought the pose into reach.
    BeyondReach,
    /// Reason why there are no results.
    Status(String),
}

/// Evaluates `case` in `N`.
pub(crate) fn measure<N: Number>(case: &ExtremeCase) -> CaseOutcome {
    match record::<N>(case) {
        Err(status) => CaseOutcome::Status(status),
        Ok((record, units)) => compare(case, &record, Rounding::of::<N>(units)),
    }
}

fn record<N: Number>(case: &ExtremeCase) -> Result<(Record, Units), String> {
    let refused = |error: String| format!("does not fit: {error}");
    let (machine, setpoint, units) = match &case.motion {
        CaseMotion::State(state) => {
            let units = match N::PROPAGATES_NON_FINITE {
                true => Units::SI,
                false => trirrr_scene::units_of_setpoints(&case.parameters, [state])
                    .map_err(|error| refused(error.to_string()))?,
            };
            let state = units.setpoint(state);
            let (position, angle) = (state.pose.position, state.pose.angle);
            let setpoint = Setpoint {
                pose: Pose::from_f64(position.x, position.y, angle),
                velocity: state.velocity.map(N::from_f64),
                acceleration: state.acceleration.map(N::from_f64),
            };
            let machine = pipeline::build_in::<N>(&case.parameters, units)
                .map_err(|error| refused(error.to_string()))?;
            (machine, setpoint, units)
        }
        CaseMotion::Move { scene, tick } => {
            let played = pipeline::scene::<N>(scene).map_err(refused)?;
            (played.machine, played.player.at(*tick), played.units)
        }
    };
    machine
        .evaluate(0.0, &setpoint)
        .map(|record| (record, units))
        .map_err(|status| status.to_string())
}

fn compare(case: &ExtremeCase, record: &Record, rounding: Rounding) -> CaseOutcome {
    let inputs = exact_inputs(case);
    if !is_in_reach(&inputs) {
        return CaseOutcome::BeyondReach;
    }
    let truth = motors(&inputs);
    let explained = explained(case, &rounding);
    let (mut forward, mut relative, mut worst): (f64, f64, _) = (0.0, 0.0, String::new());
    let largest = [0, 1, 2, 3].map(|stage| match stage {
        0 => 1.0,
        _ => (0..3).fold(0.0, |largest: f64, leg| {
            largest.max(truth[leg][stage].value().abs())
        }),
    });
    let listed = names().into_iter().zip(explained);
    for (name, explained) in listed {
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
        // A result without any error needs no explanation.
        let ratio = match error.abs() {
            0.0 => 0.0,
            error => error / explained,
        };
        if error != 0.0 {
            relative = relative.max(error.abs() / largest[stage]);
        }
        // What is not a number must not pass for small.
        let ratio = if ratio.is_nan() { f64::INFINITY } else { ratio };
        if ratio > forward {
            forward = ratio;
            worst = name.column();
        }
    }
    CaseOutcome::Motion {
        forward,
        worst,
        relative,
        closure: closure(&inputs, record, &rounding),
    }
}

fn exact_inputs(case: &ExtremeCase) -> Inputs<DoubleDouble> {
    match &case.motion {
        CaseMotion::State(state) => Inputs::exact(&case.parameters, state),
        CaseMotion::Move { scene, tick } => {
            let state = on_move(&scene.job.moves[0], scene.tick_rate_hz, *tick);
            in_state(&case.parameters, state)
        }
    }
}

/// Returns `true` if every leg reaches, computed in 31 digits.
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

/// Returns what the rounding of the inputs does to every result. It rounds the state's inputs, or
/// the ends of the move. The rounding of the ends goes into the displacement. From there it goes into
/// velocity and acceleration.
fn explained(case: &ExtremeCase, rounding: &Rounding) -> Vec<f64> {
    match &case.motion {
        CaseMotion::State(state) => uncertainties(&case.parameters, state, |input| {
            rounding.half_unit(input.quantity, input.length)
        }),
        CaseMotion::Move { scene, tick } => {
            let each = &scene.job.moves[0];
            let state = on_move(each, scene.tick_rate_hz, *tick);
            let value = |row: usize| state[row].map(DoubleDouble::value);
            let [x, y, alpha] = value(0);
            let setpoint = Setpoint {
                pose: Pose::from_f64(x, y, alpha),
                velocity: value(1).into(),
                acceleration: value(2).into(),
            };
            let duration = f64::from(each.duration_ticks) / scene.tick_rate_hz;
            let size = |of: fn(&Pose<f64>) -> f64| of(&each.from).abs() + of(&each.to).abs();
            let place = size(|pose| pose.position.x).hypot(size(|pose| pose.position.y));
            let place = rounding.half_unit(Quantity::Position, place);
            let angle = rounding.half_unit(Quantity::Angle, size(|pose| pose.angle));
            // The greatest of the cubic's derivatives: 3 h / 2 T, and 6 h / T^2.
            let (first, second) = (1.5 / duration, 6.0 / (duration * duration));
            let off = |input: Input| {
                let own = rounding.half_unit(input.quantity, input.length);
                match input.quantity {
                    Quantity::Position => place,
                    Quantity::Velocity => own + place * first,
                    Quantity::Acceleration => own + place * second,
                    Quantity::Angle => angle,
                    Quantity::AngleRate => own + angle * first,
                    Quantity::AngleAcceleration => own + angle * second,
                    _ => own,
                }
            };
            uncertainties(&case.parameters, &setpoint, off)
        }
    }
}

/// The largest gap A + l1 e(theta_1) + l2 e(theta_2) - D - c of the three legs, at the pose as the
/// type holds it.
fn closure(inputs: &Inputs<DoubleDouble>, record: &Record, rounding: &Rounding) -> f64 {
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
        let gap = gap[0].value().hypot(gap[1].value()) / rounding.last_place(size);
        largest = if gap <= largest { largest } else { gap };
    }
    largest
}
