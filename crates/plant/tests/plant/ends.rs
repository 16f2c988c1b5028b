//! Every case ends in a checked result or in a refusal that names the cause.

use crate::reference::run;
use crate::scenes::{attempt, edited, parse, text};
use trirrr_plant::watch::Cause;
use trirrr_plant::{PlantEnd, Refusal};
use trirrr_scene::Scene;

pub(crate) fn reference(edits: &[(&str, &str)]) -> Scene {
    parse(&edited(&text("plant-reference"), edits))
}

pub(crate) fn sampled(edits: &[(&str, &str)]) -> Scene {
    parse(&edited(&text("plant-reference-zoh"), edits))
}

fn refusal(scene: &Scene) -> Refusal {
    match attempt(scene) {
        Err(refusal) => refusal,
        Ok((outcome, _)) => panic!("not refused: {:?}", outcome.end),
    }
}

#[test]
fn gains_that_cannot_be_followed_are_refused() {
    // Sampled every 10 ms, a joint of 0.004 kg m^2 with 2000 N m/rad turns on its head.
    let slow = sampled(&[
        ("tick_rate_hz = 10000", "tick_rate_hz = 100"),
        ("rate_hz = 10000", "rate_hz = 100"),
    ]);
    let message = refusal(&slow).to_string();
    println!("{message}");
    assert!(message.contains("controller.kp_nm_rad"), "{message}");
    assert!(
        message.contains("sampled at 100 Hz is unstable"),
        "{message}"
    );
    // Continuous, with more gain than the winding's inductance allows and no damping.
    let stiff = reference(&[
        ("kp_nm_rad = 2000.0", "kp_nm_rad = 1e6"),
        ("kd_nm_s_rad = 5.0", "kd_nm_s_rad = 0"),
    ]);
    let message = refusal(&stiff).to_string();
    println!("{message}");
    assert!(message.contains("is unstable at the start"), "{message}");
}

#[test]
fn a_step_that_is_too_long_is_warned_of_and_named() {
    let long = reference(&[(
        "settle_s = 0.2",
        "method = \"rk4\"\nstep_s = 1e-3\nsettle_s = 0.2",
    )]);
    let (outcome, _) = run(&long);
    println!("{:?}", outcome.warnings);
    assert!(
        outcome
            .warnings
            .iter()
            .any(|warning| warning.contains("cannot be stable"))
    );
    // Between the limits of the voltage the motors shake, and energy is lost.
    let PlantEnd::EnergyLost(loss) = &outcome.end else {
        panic!("{:?}", outcome.end);
    };
    assert!(loss.to_string().contains("rk4 cannot be stable"), "{loss}");
    // The known limit of this case, 5.62e-4 s: below it no word.
    let short = reference(&[(
        "settle_s = 0.2",
        "method = \"rk4\"\nstep_s = 5e-4\nsettle_s = 0.2",
    )]);
    let (outcome, _) = run(&short);
    assert_eq!(
        (outcome.end, outcome.warnings.len()),
        (PlantEnd::Complete, 0)
    );
}

#[test]
fn saturation_is_located_and_reported() {
    // 0.04 A are less than the 0.1 A that the move takes.
    let weak = reference(&[("current_limit_a = 20.0", "current_limit_a = 0.04")]);
    let (outcome, rows) = run(&weak);
    assert_eq!(outcome.end, PlantEnd::Complete);
    let limited = outcome.statistics.motors.map(|motor| motor.current_limit);
    println!("{limited:?}");
    assert!(limited[2].first.is_some_and(|t| t < 0.05) && limited[2].total > 0.05);
    for row in &rows {
        // The winding follows its command within L / R; it does not overshoot.
        assert!(
            row.currents.iter().all(|current| current.abs() < 0.0401),
            "{row:?}"
        );
    }
    // A supply that the back-EMF of 0.9 rad/s uses up: 10 * 0.05 * 0.9 = 0.45 V.
    let low = reference(&[("supply_v = 48.0", "supply_v = 0.2")]);
    let (outcome, rows) = run(&low);
    assert_eq!(outcome.end, PlantEnd::Complete);
    let motor = outcome.statistics.motors[2];
    println!("{:?}", motor.voltage_limit);
    assert!(motor.voltage_limit.total > 0.05);
    for row in &rows {
        assert!(
            row.voltages
                .iter()
                .all(|voltage| voltage.abs() < 0.2 * (1.0 + 1e-6)),
            "{row:?}"
        );
    }
}

/// A sampled drive's command is held from sample to sample: it comes to a limit at a sample, and the
/// instant that is reported is that sample's.
#[test]
fn a_sampled_drive_saturates_at_a_sample() {
    let weak = sampled(&[("current_limit_a = 20.0", "current_limit_a = 0.04")]);
    let (outcome, rows) = run(&weak);
    assert_eq!(outcome.end, PlantEnd::Complete);
    let limit = outcome.statistics.motors[2].current_limit;
    println!("{limit:?}");
    let sample = limit.first.unwrap() * 1e4;
    assert!((sample - sample.round()).abs() < 1e-9 && sample > 1.0);
    assert!(limit.total > 0.05);
    // In steps of a sample's period there is no current beyond the limit in between, either: the
    // winding goes to its command and not past it, but for the motor's turning in 0.1 ms.
    for row in &rows {
        assert!(
            row.currents.iter().all(|current| current.abs() < 0.0401),
            "{row:?}"
        );
    }
}

#[test]
fn a_machine_without_inertia_is_refused() {
    // Massless links and no rotors: the platform is all that could resist.
    let thesis = text("plant-thesis");
    let edits = [
        ("rotor_inertia_kgm2 = 1e-5", "rotor_inertia_kgm2 = 0"),
        ("mass_kg = 0.5", "mass_kg = 0"),
    ];
    for last in [
        (
            "inertia_kgm2 = 0.0025000000000000005",
            "inertia_kgm2 = 0.0025",
        ),
        ("inertia_kgm2 = 0.0025000000000000005", "inertia_kgm2 = 0"),
    ] {
        let scene = parse(&edited(&thesis, &[edits[0], edits[1], last]));
        let message = refusal(&scene).to_string();
        println!("{message}");
        assert!(
            message.contains("platform.mass_kg, inertia_kgm2"),
            "{message}"
        );
        assert!(message.contains("has no inertia"), "{message}");
    }
}

#[test]
fn a_following_error_ends_the_run_where_it_is_reached() {
    let limits = [("settle_s", "following_error_rad = 1e-5\nsettle_s")];
    for scene in [reference(&limits), sampled(&limits)] {
        let (outcome, rows) = run(&scene);
        let PlantEnd::Ended(ending) = &outcome.end else {
            panic!("{:?}", outcome.end);
        };
        println!("{ending}");
        assert!(matches!(ending.cause, Cause::FollowingError { .. }));
        assert!(ending.t > 0.0 && ending.t < 0.05);
        for row in rows {
            for (angle, reference) in row.angles.iter().zip(row.references) {
                assert!((angle - reference).abs() <= 1.0001e-5);
            }
        }
    }
}

#[test]
fn a_machine_that_passes_a_parallel_singularity_says_so() {
    // Hardly controlled and pulled by a wrench, the platform turns away until it is loose.
    let pulled = reference(&[
        ("[[drive]]", "[wrench]\ntorque_nm = -0.6\n[[drive]]"),
        ("kp_nm_rad = 2000.0", "kp_nm_rad = 1.0"),
        ("kd_nm_s_rad = 5.0", "kd_nm_s_rad = 0.01"),
    ]);
    let (outcome, _) = run(&pulled);
    let PlantEnd::Ended(ending) = outcome.end else {
        panic!("{:?}", outcome.end);
    };
    println!("{ending}");
    assert!(
        ending
            .to_string()
            .starts_with("the machine passes a parallel singularity at t = ")
    );
    assert!(
        outcome.balance.error().abs() < 1e-6,
        "{:?}",
        outcome.balance
    );
}

#[test]
fn encoders_and_sampling_leave_their_mark() {
    let counted = sampled(&[("gear_ratio", "encoder_counts_per_rev = 4096\ngear_ratio")]);
    let (outcome, _) = run(&counted);
    assert_eq!(outcome.end, PlantEnd::Complete);
    let (exact, _) = run(&sampled(&[]));
    // One count is 2 pi / 40960 = 1.5e-4 rad at the joint: errors become of that order.
    for (with, without) in outcome
        .statistics
        .motors
        .iter()
        .zip(exact.statistics.motors)
    {
        assert!(with.error.peak > without.error.peak);
        assert!(with.error.peak < 5e-4, "{}", with.error.peak);
    }
}

/// The thesis machine on steppers.
pub(crate) fn steppers(holding: f64) -> Scene {
    let thesis = text("plant-thesis");
    let start = thesis.find("[[drive]]").unwrap();
    let end = thesis.find("[plant]").unwrap();
    let drive = format!(
        "[[drive]]\nkind = \"stepper\"\ngear_ratio = 5.0\nrotor_inertia_kgm2 = 2e-6\nsteps_per_rev \
         = 200\nmicrosteps = 16\nholding_torque_nm = {holding}\ndetent_torque_nm = {}\n\
         pull_out_torque_nm = {}\npull_out_rate_rad_s = 40\n",
        0.02 * holding,
        0.5 * holding,
    );
    let text = format!("{}{drive}{}", &thesis[..start], &thesis[end..]);
    let edits = [
        (
            "[controller]",
            "[plant.friction]\nmotor = { viscous_nm_s_rad = 0.01 }\n[controller]",
        ),
        ("[plant]\n", "[plant]\nmethod = \"rk4\"\nstep_s = 2e-5\n"),
    ];
    parse(&edited(&text, &edits))
}

#[test]
fn steppers_follow_within_their_steps_and_lose_them_when_overloaded() {
    let (outcome, rows) = run(&steppers(0.2));
    assert_eq!(outcome.end, PlantEnd::Complete);
    // A microstep is 2 pi / 16000 = 3.9e-4 rad at the joint; the rotor lags by its load and rings.
    for motor in &outcome.statistics.motors {
        println!("{:.2e} rad, {} slips", motor.error.peak, motor.slips);
        assert_eq!((motor.slips, motor.first_slip), (0, None));
        // The joints are a tick late, as on a board: 10 ms at up to 0.74 rad/s.
        assert!(motor.error.peak < 8e-3);
    }
    // Where the ticks wanted them a tick ago, ten rows.
    for (row, earlier) in rows[10..].iter().zip(&rows) {
        for (angle, reference) in row.angles.iter().zip(earlier.references) {
            assert!((angle - reference).abs() < 2e-3, "{row:?}");
        }
    }
    let last = rows.last().unwrap();
    for (rotor, reference) in last.angles.iter().zip(last.references) {
        // Half a microstep, and the rotor still rings by about one.
        assert!((rotor - reference).abs() < 8e-4, "{last:?}");
    }

    // 1e-3 N m times 5 are not enough for the 0.03 N m of the move.
    let (outcome, _) = run(&steppers(1e-3));
    let motors = &outcome.statistics.motors;
    let slips: Vec<_> = motors
        .iter()
        .map(|motor| (motor.slips, motor.lost_steps))
        .collect();
    println!("{:?} {slips:?}", outcome.end);
    assert!(
        motors
            .iter()
            .any(|motor| motor.slips > 0 && motor.first_slip.is_some())
    );
    assert!(motors.iter().all(|motor| motor.lost_steps % 4 == 0));
}

/// Counts make a motion chaotic: errors of the method that decide a count become errors of counts.
#[test]
#[ignore = "a minute of run time; cargo xtask nightly runs it, optimised"]
fn counts_of_encoders_amplify_what_a_tolerance_leaves() {
    let vertical = text("plant-vertical");
    let without = edited(&vertical, &[("encoder_counts_per_rev = 16384", "")]);
    let [with, without] = [vertical, without].map(|text| {
        let rows = |tolerance: &str| {
            let (outcome, rows) = run(&parse(&edited(&text, &[("tolerance = 1e-7", tolerance)])));
            assert_eq!(outcome.end, PlantEnd::Complete);
            rows
        };
        let (shipped, tight) = (rows("tolerance = 1e-7"), rows("tolerance = 1e-11"));
        let pairs = shipped.iter().zip(&tight);
        pairs.fold(0.0, |most: f64, (one, other)| {
            let poses = one.pose.iter().zip(other.pose);
            poses.fold(most, |most, (one, other)| most.max((one - other).abs()))
        })
    });
    println!("pose at 1e-7 and 1e-11: {with:.1e} m or rad with encoders, {without:.1e} without");
    assert!(without < 1e-7 && with > without && with < 1e-3);
}
