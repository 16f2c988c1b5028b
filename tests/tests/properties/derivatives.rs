//! Rates and accelerations are the derivatives of the positions, power is that of the energy.
//!
//! The positions and energies are the independent model's, in 31 digits, on the path of constant
//! acceleration through the state. Central differences at h and h/2 are combined (Richardson), so
//! that the truncation error goes with h^4: with h = 4e-5 of the time in which the machine moves by
//! its distance to the next singularity it is some 1e-17, and the rounding error of a second
//! difference some 1e-31 / 1e-9. Both are far below the bound of the core's f64.

use core::f64::consts::TAU;
use nalgebra::Vector3;
use proptest::strategy::Strategy;
use std::cell::RefCell;
use trirrr_core::number::Arithmetic;
use trirrr_tests::bound::Worst;
use trirrr_tests::double_double::DoubleDouble;
use trirrr_tests::evaluate::{distances, evaluate};
use trirrr_tests::inputs::Inputs;
use trirrr_tests::model::Kinematics;
use trirrr_tests::random::{Case, case, for_all};
use trirrr_tests::results;
use trirrr_tests::scalar::Scalar;

/// h in s, see above. Distances to a serial singularity are square roots of path lengths. From
/// rest the path goes with h^2, which leaves half the powers: the step is shorter there.
fn step(case: &Case) -> f64 {
    let (serial, _) = distances(&case.parameters, &case.setpoint.pose);
    let path = serial.into_iter().fold(1.0, f64::min).powi(2);
    let relative = |v: Vector3<f64>| v.x.hypot(v.y) / case.size + v.z.abs();
    let speed = relative(case.setpoint.velocity);
    let acceleration = relative(case.setpoint.acceleration);
    (4e-5 * path / speed).min((2e-9 * path / acceleration).sqrt())
}

/// First and second derivatives of several functions at 0.
fn derivatives<const K: usize>(
    f: impl Fn(DoubleDouble) -> [DoubleDouble; K],
    h: f64,
) -> [[f64; 2]; K] {
    let number = DoubleDouble::constant;
    let now = f(number(0.0));
    let central = |h: f64| {
        let (before, after, h) = (f(number(-h)), f(number(h)), number(h));
        core::array::from_fn::<_, K, _>(|i| {
            let (to, from) = (after[i] - now[i], now[i] - before[i]);
            [(to + from) / (h + h), (to - from) / (h * h)]
        })
    };
    let (coarse, fine) = (central(h), central(h / 2.0));
    core::array::from_fn(|i| {
        [0, 1]
            .map(|order| ((number(4.0) * fine[i][order] - coarse[i][order]) / number(3.0)).value())
    })
}

/// Less the whole turns of the platform: at 1000 rad the 31 digits are 28 in its sine.
fn unwound(mut case: Case) -> Case {
    case.setpoint.pose.angle %= TAU;
    case
}

/// The model at times around the state's.
fn at(case: &Case) -> impl Fn(DoubleDouble) -> (Inputs<DoubleDouble>, Kinematics<DoubleDouble>) {
    let inputs = Inputs::exact(&case.parameters, &case.setpoint);
    move |time| {
        let inputs = inputs.later(time);
        (inputs, inputs.kinematics())
    }
}

/// Differences of an angle that passes from pi to -pi count a whole turn too many; the model's
/// theta_i1 is continuous, its theta_i2 passes for one case in some 1e9.
#[test]
fn rates_and_accelerations_are_derivatives_of_the_angles() {
    let worst = RefCell::new(Worst::default());
    for_all(2000, case().prop_map(unwound), |case| {
        let motion = evaluate(&case.parameters, &case.setpoint).expect("a motion");
        let conditions = results::isotropic_conditions(&case.parameters, &case.setpoint);
        let condition = |stem: &str, leg: usize| {
            let names = results::names();
            let index = names
                .iter()
                .position(|name| name.stem == stem && name.leg == Some(leg));
            conditions[index.expect("a result")]
        };
        let at = at(&case);
        let angles = |time| {
            let legs = at(time).1.legs;
            let angle = |i: usize| legs[i / 2].angles[i % 2];
            core::array::from_fn::<_, 6, _>(angle)
        };
        let differences = derivatives(angles, step(&case));
        for (leg, motion) in motion.legs.iter().enumerate() {
            let (rates, acc) = (&motion.rates, &motion.accelerations);
            let of_links = [
                ("dth1", "ddth1", rates.proximal, acc.proximal),
                ("dth2", "ddth2", rates.distal, acc.distal),
            ];
            for (link, (rate_name, acc_name, rate, acceleration)) in
                of_links.into_iter().enumerate()
            {
                let [of_angle, of_rate] = differences[2 * leg + link];
                for (stem, found, difference) in [
                    (rate_name, rate, of_angle),
                    (acc_name, acceleration, of_rate),
                ] {
                    let bound = 2.0 * f64::UNIT_ROUNDOFF * condition(stem, leg);
                    worst.borrow_mut().compare(
                        || format!("{stem} of leg {leg} of {case:?}"),
                        found - difference,
                        bound,
                    );
                }
            }
        }
    });
    worst.into_inner().assert_within("derivatives", 0.4..=1.0);
}

/// The motors' power is the rate of change of the machine's energy less the wrench's power: the
/// check that catches a wrong torque. The bound is the sum of those of the three powers.
#[test]
fn power_goes_into_energy() {
    let worst = RefCell::new(Worst::default());
    for_all(2000, case().prop_map(unwound), |case| {
        let motion = evaluate(&case.parameters, &case.setpoint).expect("a motion");
        let conditions = results::isotropic_conditions(&case.parameters, &case.setpoint);
        let sum_of_powers = |values: &[f64]| -> f64 {
            let of_power = results::names().into_iter().zip(values);
            of_power
                .filter(|(name, _)| name.stem == "P")
                .map(|(_, value)| value)
                .sum()
        };
        let found =
            results::of_core(&case.parameters, &case.setpoint, &motion).expect("finite results");
        let power = sum_of_powers(&found);
        let bound = 2.0 * f64::UNIT_ROUNDOFF * sum_of_powers(&conditions);
        let at = at(&case);
        let energy = |time| {
            let (inputs, kinematics) = at(time);
            [inputs.energy(&kinematics)]
        };
        let [[energy_rate, _]] = derivatives(energy, step(&case));
        let wrench_power = Inputs::exact(&case.parameters, &case.setpoint)
            .wrench_power()
            .value();
        worst.borrow_mut().compare(
            || format!("{case:?}"),
            power - (energy_rate - wrench_power),
            bound,
        );
    });
    worst.into_inner().assert_within("power", 0.1..=1.0);
}
