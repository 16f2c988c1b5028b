//! Slices of states: the bits of the tick, whatever stands beside a state.

use nalgebra::{Vector2, Vector3};
use std::collections::BTreeSet;
use trirrr_batch::{
    BatchMachine, BatchReactions, FailedRow, Float, LengthError, MotorRows, StateRows,
};
use trirrr_core::machine::{LinkParameters, Parameters, example};
use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_core::reaction::Reactions;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::status::Status;
use trirrr_core::tick::{Motor, Tick};

type Rows<F> = Vec<[F; 3]>;

/// Numbers without a pattern, evenly within -1 and 1 (splitmix64).
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as i64 as f64 / 2f64.powi(63)
    }

    fn rows<F: Float>(&mut self, count: usize, middle: [f64; 3], half: [f64; 3]) -> Rows<F> {
        let mut value = |column: usize| F::from_f64(middle[column] + half[column] * self.next());
        (0..count).map(|_| [value(0), value(1), value(2)]).collect()
    }
}

/// Evaluates one state by the tick of the model that is visited: that of an image.
struct Single<F: Float>(Parameters, Setpoint<F>);

impl<F: Float> ModelVisitor<F> for Single<F> {
    type Output = Result<[Motor<F>; 3], Status>;

    fn visit<M: Model<N = F>>(self) -> Self::Output {
        let tick: Tick<M> = Tick::build(&self.0).expect("a machine");
        tick.evaluate(&self.1).map(|motion| motion.motors)
    }
}

/// Value of rows without results.
const LEFT: f64 = 7.5;

/// Evaluates all states at once and each by itself. Returns the statuses that occurred.
fn compare<F: Float>(
    parameters: &Parameters,
    torque: bool,
    states: [&Rows<F>; 3],
) -> Vec<FailedRow> {
    let [poses, velocities, accelerations] = states;
    let mut results = [(); 4].map(|()| vec![[F::from_f64(LEFT); 3]; poses.len()]);
    let [angles, rates, motor_accelerations, torques] = &mut results;
    let failed = BatchMachine::<F>::build(parameters, torque)
        .expect("a machine")
        .evaluate(
            StateRows {
                poses,
                velocities,
                accelerations,
            },
            MotorRows {
                angles,
                rates,
                accelerations: motor_accelerations,
                torques,
            },
        )
        .expect("equal lengths");
    let mut failures = failed.iter();
    for row in 0..poses.len() {
        let [x, y, alpha] = poses[row];
        let setpoint = Setpoint {
            pose: Pose {
                position: Vector2::new(x, y),
                angle: alpha,
            },
            velocity: Vector3::from(velocities[row]),
            acceleration: Vector3::from(accelerations[row]),
        };
        let kind = ModelKind::of(parameters, torque);
        let bits = |values: [F; 3]| values.map(|value| value.to_f64().to_bits());
        let found = results.each_ref().map(|rows| bits(rows[row]));
        match kind.visit_image(Single(*parameters, setpoint)) {
            Ok(motors) => {
                let expected = [
                    bits(motors.map(|motor| motor.angle)),
                    bits(motors.map(|motor| motor.rate)),
                    bits(motors.map(|motor| motor.acceleration)),
                    bits(motors.map(|motor| motor.torque)),
                ];
                assert_eq!(found, expected, "row {row}");
            }
            Err(status) => {
                assert_eq!(failures.next(), Some(&FailedRow { row, status }));
                assert_eq!(found, [bits([F::from_f64(LEFT); 3]); 4]);
            }
        }
    }
    assert_eq!(failures.next(), None);
    failed
}

/// The thesis machine and one with everything: all kinds of payloads and links.
fn machines() -> Vec<Parameters> {
    let massless = example();
    let mut rotors = massless;
    rotors.legs[1].rotor_inertia_kgm2 = 3e-4;
    let mut links = massless;
    for leg in &mut links.legs {
        leg.proximal = LinkParameters::uniform_rod(0.05, leg.proximal_m);
        leg.distal = LinkParameters::uniform_rod(0.04, leg.distal_m);
    }
    let mut vertical = links;
    vertical.gravity_m_s2 = Vector2::new(0.5, -9.8);
    vertical.wrench_force_n = Vector2::new(1.0, -2.0);
    let centred = [massless, rotors, links, vertical];
    let offset = centred.map(|mut machine| {
        machine.platform.com_m = Vector2::new(0.01, -0.02);
        machine
    });
    centred.into_iter().chain(offset).collect()
}

fn has_the_bits_of_the_tick<F: Float>() {
    let mut draws = Draws(5);
    let mut statuses = BTreeSet::new();
    for parameters in machines() {
        // Two chunks and a rest: inside the workspace, and all around its edge.
        let mut poses = draws.rows::<F>(6003, [0.25, 0.25, 0.2], [0.2, 0.2, 2.0]);
        let velocities = draws.rows::<F>(6003, [0.0; 3], [1.0; 3]);
        let mut accelerations = draws.rows::<F>(6003, [0.0; 3], [1.0; 3]);
        // In the middle of lanes that have results.
        poses[2402] = poses[2400];
        poses[2402][0] = F::from_f64(f64::NAN);
        accelerations[4001][1] = F::from_f64(f64::INFINITY);
        for torque in [true, false] {
            let failed = compare(&parameters, torque, [&poses, &velocities, &accelerations]);
            assert!((500..5500).contains(&failed.len()), "{}", failed.len());
            statuses.extend(failed.iter().map(|row| row.status.to_string()));
        }
    }
    assert!(statuses.len() >= 4, "{statuses:?}");
}

#[test]
fn rows_of_f64_have_the_bits_of_the_tick() {
    has_the_bits_of_the_tick::<f64>();
}

#[test]
fn rows_of_f32_have_the_bits_of_the_tick() {
    has_the_bits_of_the_tick::<f32>();
}

/// Three equal legs: the distal links share one line in every pose.
#[test]
fn a_parallel_singularity_is_seen_in_every_lane() {
    let mut machine = example();
    machine.legs = [machine.legs[0]; 3];
    let poses = Draws(9).rows::<f64>(8, [0.25, 0.3, 0.0], [0.02; 3]);
    let still = vec![[0.0; 3]; 8];
    let failed = compare(&machine, true, [&poses, &still, &still]);
    assert_eq!(failed.len(), 8);
    let singular = |row: &FailedRow| row.status == Status::ParallelSingular;
    assert!(failed.iter().all(singular), "{failed:?}");
    assert!(compare(&machine, false, [&poses, &still, &still]).is_empty());
}

/// Every number of rows up to some groups of lanes, each with a row that fails at every place.
#[test]
fn a_failing_row_spoils_none_beside_it() {
    let parameters = example();
    for rows in 0..11 {
        for bad in 0..=rows {
            let mut draws = Draws(rows as u64);
            let mut poses = draws.rows::<f64>(rows, [0.245, 0.25, 0.2], [0.01; 3]);
            let still = vec![[0.0; 3]; rows];
            if let Some(pose) = poses.get_mut(bad) {
                pose[0] = 3.0;
            }
            let failed = compare(&parameters, true, [&poses, &still, &still]);
            let expected: Vec<usize> = (bad..rows).take(1).collect();
            assert_eq!(
                failed.iter().map(|row| row.row).collect::<Vec<_>>(),
                expected
            );
        }
    }
}

#[test]
fn slices_of_different_lengths_are_refused() {
    let machine = BatchMachine::<f64>::build(&example(), true).unwrap();
    let (two, three) = (vec![[0.0; 3]; 2], vec![[0.0; 3]; 3]);
    let mut results = [(); 4].map(|()| three.clone());
    let [angles, rates, accelerations, torques] = &mut results;
    let states = StateRows {
        poses: &three,
        velocities: &two,
        accelerations: &three,
    };
    let refused = machine.evaluate(
        states,
        MotorRows {
            angles,
            rates,
            accelerations,
            torques,
        },
    );
    let error = LengthError {
        slice: "velocities",
        found: 2,
        expected: 3,
    };
    assert_eq!(refused, Err(error));
    assert!(results.iter().all(|rows| *rows == three));
}

/// The record and the joint forces of one state, by the tick itself.
struct SingleRecord(Parameters, Setpoint<f64>);

impl ModelVisitor<f64> for SingleRecord {
    type Output = Result<[[f64; 2]; 9], Status>;

    fn visit<M: Model<N = f64>>(self) -> Self::Output {
        let tick: Tick<M> = Tick::build(&self.0).expect("a machine");
        let motion = tick.evaluate(&self.1)?;
        let legs = Reactions::build(&self.0).forces(&motion)?;
        let joints = legs.map(|leg| [leg.base, leg.elbow, leg.platform]);
        let mut joints = joints.as_flattened().iter().map(|force| (*force).into());
        Ok([(); 9].map(|()| joints.next().expect("nine joints")))
    }
}

#[test]
fn distances_and_joint_forces_are_those_of_single_states() {
    // More than a chunk.
    let count = 4096 + 5;
    for parameters in machines() {
        let mut draws = Draws(7);
        // Some poses are out of reach.
        let poses = draws.rows::<f64>(count, [0.25, 0.25, 0.2], [0.2, 0.2, 0.5]);
        let velocities = draws.rows(count, [0.0; 3], [0.2; 3]);
        let accelerations = draws.rows(count, [0.0; 3], [1.0; 3]);
        let states = StateRows {
            poses: &poses,
            velocities: &velocities,
            accelerations: &accelerations,
        };
        let mut distances = vec![[LEFT; 4]; count];
        let mut forces = vec![[[[LEFT; 2]; 3]; 3]; count];
        let machine = BatchMachine::build(&parameters, true).expect("a machine");
        let lost = machine.distances(&poses, &mut distances).expect("lengths");
        let reactions = BatchReactions::build(&parameters).expect("a machine");
        let failed = reactions.evaluate(states, &mut forces).expect("lengths");
        assert!(!lost.is_empty() && lost.len() < count);
        let pipeline = trirrr_scene::pipeline::build::<f64>(&parameters).expect("a machine");
        let kind = ModelKind::of(&parameters, true);
        let mut failures = failed.iter();
        for row in 0..count {
            let [x, y, alpha] = poses[row];
            let setpoint = Setpoint {
                pose: Pose::from_f64(x, y, alpha),
                velocity: Vector3::from(velocities[row]),
                acceleration: Vector3::from(accelerations[row]),
            };
            match kind.visit_image(SingleRecord(parameters, setpoint)) {
                Ok(expected) => {
                    assert_eq!(forces[row].as_flattened(), expected, "row {row}");
                    let record = pipeline.evaluate(0.0, &setpoint).expect("a motion");
                    let [a, b, c] = record.legs.map(|leg| leg.serial);
                    assert_eq!(distances[row], [a, b, c, record.parallel], "row {row}");
                }
                Err(status) => {
                    assert_eq!(failures.next(), Some(&FailedRow { row, status }));
                    assert_eq!(forces[row], [[[LEFT; 2]; 3]; 3]);
                }
            }
        }
    }
}

#[test]
fn slices_for_distances_and_forces_have_equal_lengths() {
    let poses = [[0.25, 0.25, 0.2]; 2];
    let machine = BatchMachine::<f64>::build(&example(), true).expect("a machine");
    let short = machine.distances(&poses, &mut [[0.0; 4]]);
    assert_eq!(
        short.map_err(|error| (error.found, error.expected)),
        Err((1, 2))
    );
    let states = StateRows {
        poses: &poses,
        velocities: &poses[..1],
        accelerations: &poses,
    };
    let reactions = BatchReactions::build(&example()).expect("a machine");
    let short = reactions.evaluate(states, &mut [[[[0.0; 2]; 3]; 3]; 2]);
    assert_eq!(short.map_err(|error| error.slice), Err("velocities"));
}
