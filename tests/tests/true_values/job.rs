//! The thesis's move as the core runs it: its own setpoints, and the torques of those.

use crate::{MOVE, is_f32, moves};
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::setpoint::{Pose, RestToRest};
use trirrr_tests::bound::Worst;
use trirrr_tests::evaluate::evaluate;
use trirrr_tests::table::Table;

fn thesis_ends<N: Number>() -> (Pose<N>, Pose<N>) {
    use core::f64::consts::PI;
    (
        Pose::from_f64(0.21, 0.22, PI / 20.0),
        Pose::from_f64(0.28, 0.28, PI / 15.0),
    )
}

/// The job as it is run: the core's own setpoints, from the ends of the move, then the tick. The
/// conditions in the files are against those ends.
fn job_as_run<N: Number>() -> Worst {
    let mut worst = Worst::default();
    let ((from, to), period) = (thesis_ends(), N::factor_from_f64(0.01));
    let job = RestToRest::<N>::new(from, to, 100, period);
    for (file, parameters) in moves() {
        for (tick, row) in (0..).zip(Table::read(file).rows()) {
            let motion = evaluate(&parameters, &job.at(tick))
                .unwrap_or_else(|status| panic!("{file} {tick}: {status}"));
            let truth = row.three("tau");
            let largest = truth.iter().fold(0.0f64, |most, tau| most.max(tau.abs()));
            let floor = if is_f32::<N>() { 1e-7 * largest } else { 0.0 };
            for leg in 0..3 {
                let exact = row.exact(&format!("tau{}", leg + 1)).expect("a torque");
                let cond = row.number(&format!("cond_tau{}", leg + 1));
                let bound = 2.0 * N::UNIT_ROUNDOFF.to_f64() * cond + floor;
                let error = exact.error_of(motion.motors[leg].torque.to_f64());
                worst.compare(
                    || format!("{file} tick {tick} tau{}", leg + 1),
                    error,
                    bound,
                );
            }
        }
    }
    worst
}

#[test]
fn the_job_as_run() {
    job_as_run::<f64>().assert_within("job, f64", 0.2..=1.0);
    job_as_run::<f32>().assert_within("job, f32", 0.2..=1.0);
}

/// The core's own setpoints of the move against the files' exact ones.
///
/// q = q0 + h b(s): the displacement h = q1 - q0 carries one rounding, b(s) and the product five
/// more, the sum one of q: |error| <= 6 u |h| + 2 u |q|, since the farther end is never used.
/// Velocity is (6 h / T) s (1 - s): eight roundings of itself. Acceleration (6 h / T^2)(1 - 2 s):
/// eight roundings of its greatest value, since 1 - 2 s cancels. The file's times are the f64
/// nearest to 0.01 k as a program adds them up, so they differ from tick k by their own rounding.
#[test]
fn setpoints_of_the_move() {
    let table = Table::read("true_massless.csv");
    let u = f64::UNIT_ROUNDOFF;
    let (from, to) = thesis_ends();
    let job = RestToRest::<f64>::new(from, to, 100, 0.01);
    let ends = |pose: Pose<f64>| [pose.position.x, pose.position.y, pose.angle];
    let greatest: [f64; 3] = core::array::from_fn(|i| 6.0 * (ends(to)[i] - ends(from)[i]).abs());
    let mut worst = Worst::default();
    for (tick, row) in (0..).zip(table.rows()) {
        let setpoint = job.at(tick);
        let pose = ends(setpoint.pose);
        let late = (row.number("t") - f64::from(tick) / 100.0).abs() + u;
        for i in 0..3 {
            let h = greatest[i] / 6.0;
            let quantities = [
                (
                    ["x", "y", "alpha"][i],
                    pose[i],
                    6.0 * u * h + 2.0 * u * pose[i].abs() + late * setpoint.velocity[i].abs(),
                ),
                (
                    ["vx", "vy", "valpha"][i],
                    setpoint.velocity[i],
                    8.0 * u * setpoint.velocity[i].abs() + late * setpoint.acceleration[i].abs(),
                ),
                (
                    MOVE[i],
                    setpoint.acceleration[i],
                    8.0 * u * greatest[i] + 2.0 * late * greatest[i],
                ),
            ];
            for (column, result, bound) in quantities {
                let truth = row.exact(column).expect("a column of the state");
                worst.compare(
                    || format!("{column} at {tick}"),
                    truth.error_of(result),
                    bound,
                );
            }
        }
    }
    assert_eq!(worst.compared, 101 * 9);
    worst.assert_within("setpoints", 0.2..=1.0);
    for (tick, end) in [(0, from), (100, to)] {
        assert_eq!(job.at(tick).pose, end);
        assert_eq!(job.at(tick).velocity.as_slice(), [0.0; 3]);
    }
}
