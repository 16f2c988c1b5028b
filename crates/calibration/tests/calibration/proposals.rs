//! Proposed poses, against poses that are drawn.

use crate::accuracy::{NOISE, scene};
use crate::blind::{Bench, spread};
use crate::true_machine::Draw;
use trirrr_calibration::{CalibrationSetup, MARGIN, PlannedReading, SafeRegion, propose};

#[test]
fn proposed_poses_tell_more_than_any_that_are_drawn() {
    let bench = Bench::new(31, 30);
    let setup = CalibrationSetup::default();
    let planned = (PlannedReading::Pose, NOISE);
    let machine = &bench.nominal;
    let candidates = spread(&bench.places, 120);
    let proposal = propose(machine, &setup, None, planned, &candidates, 8);
    assert_eq!(proposal.poses.len(), 8);
    assert!(proposal.after.rms_m < 0.2 * proposal.before.rms_m);
    let mut draw = Draw(5);
    for _ in 0..20 {
        let drawn: Vec<[f64; 3]> = (0..8)
            .map(|_| {
                let part = 0.5 * (draw.even() + 1.0);
                candidates[((part * candidates.len() as f64) as usize).min(candidates.len() - 1)]
            })
            .collect();
        // All of them: a proposal of eight among these eight.
        let other = propose(machine, &setup, None, planned, &drawn, 8);
        assert!(
            proposal.gain > other.gain,
            "{} {}",
            proposal.gain,
            other.gain
        );
    }
    // Measurements that there are count: the next poses add less.
    let known = bench.calibrate(&setup).expect("a calibration");
    let next = propose(machine, &setup, Some(&known), planned, &candidates, 8);
    assert!(next.gain < 0.5 * proposal.gain && next.gain > 0.0);
    assert!(next.after.rms_m < next.before.rms_m);
}

/// Every way of a tour stays in places from which each pose is reached, by the machine itself.
#[test]
fn ways_of_a_tour_keep_the_distances() {
    use nalgebra::Vector3;
    use trirrr_core::setpoint::{Pose, Setpoint};
    use trirrr_core::units::Units;
    for name in ["thesis.toml", "vertical.toml"] {
        let scene = scene(name);
        let turn = 10_f64.to_radians();
        let region = SafeRegion::of(&scene, turn, MARGIN).expect("a region");
        let machine = trirrr_scene::pipeline::of_scene::<f64>(&scene, Units::SI).expect("one");
        let tour = region.tour(&spread(&region.poses(), 40));
        assert_eq!(tour.len(), 40);
        let mut here = region.start();
        for (way, pose) in tour {
            for to in way.into_iter().chain([[pose[0], pose[1]]]) {
                for step in 0..=20 {
                    let part = f64::from(step) / 20.0;
                    let x = here[0] + part * (to[0] - here[0]);
                    let y = here[1] + part * (to[1] - here[1]);
                    for angle in [here[2], pose[2]] {
                        let setpoint = Setpoint {
                            pose: Pose::from_f64(x, y, angle),
                            velocity: Vector3::zeros(),
                            acceleration: Vector3::zeros(),
                        };
                        let record = machine.evaluate(0.0, &setpoint).expect("a pose");
                        assert!(record.parallel >= MARGIN[1], "{name} {x} {y}");
                        assert!(record.legs.iter().all(|leg| leg.serial >= MARGIN[0]));
                    }
                }
                here = [to[0], to[1], here[2]];
            }
            here = pose;
        }
    }
}
