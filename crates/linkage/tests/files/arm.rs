//! The serial arm's inverse and the loads of drives, against textbook formulas.

use crate::{link, parse, shipped, shipped_text};
use trirrr_linkage::assur::{
    ArmError, EndMotion, Linkage, Position, SerialArm, drive_loads, study, track,
};

/// Lengths of the shipped arm.
const LENGTHS: [f64; 3] = [0.4, 0.3, 0.1];

fn near(value: f64, expected: f64, bound: f64, what: &str) {
    assert!(
        (value - expected).abs() <= bound,
        "{what}: {value} for {expected}"
    );
}

/// Motion of the end by the textbook's Jacobian, for joint angles that count from the link before.
fn forward(q: [f64; 3], dq: [f64; 3], ddq: [f64; 3]) -> EndMotion {
    let mut end = EndMotion::default();
    let (mut angle, mut rate, mut acceleration) = (0.0, 0.0, 0.0);
    for i in 0..3 {
        (angle, rate, acceleration) = (angle + q[i], rate + dq[i], acceleration + ddq[i]);
        let (sin, cos) = f64::sin_cos(angle);
        let l = LENGTHS[i];
        end.pose[0] += l * cos;
        end.pose[1] += l * sin;
        end.velocity[0] -= l * sin * rate;
        end.velocity[1] += l * cos * rate;
        end.acceleration[0] -= l * (sin * acceleration + cos * rate * rate);
        end.acceleration[1] += l * (cos * acceleration - sin * rate * rate);
    }
    (end.pose[2], end.velocity[2], end.acceleration[2]) = (angle, rate, acceleration);
    end
}

#[test]
fn both_branches_are_those_of_the_cosine_law_and_lead_back() {
    let linkage = shipped("serial-arm");
    let arm = SerialArm::of(&linkage).unwrap();
    let [l1, l2, l3] = LENGTHS;
    for k in 0..40 {
        let t = f64::from(k);
        let q = [0.37 * t, 0.5 + 2.0 * (0.11 * t).sin().abs(), 1.0 - 0.23 * t];
        let (dq, ddq) = ([0.7, -1.3, 0.4 * t.sin()], [2.0, 1.0 - 0.1 * t, -3.0]);
        let end = forward(q, dq, ddq);
        let found = arm.inverse(&linkage, &end).unwrap();
        let [x, y, angle] = end.pose;
        let wrist = [x - l3 * angle.cos(), y - l3 * angle.sin()];
        let d = wrist[0].hypot(wrist[1]);
        let bend = ((d * d - l1 * l1 - l2 * l2) / (2.0 * l1 * l2)).acos();
        for branch in &found {
            // With the elbow on the left the outer link turns to the right.
            let q2 = -branch.elbow * bend;
            let q1 = wrist[1].atan2(wrist[0]) - (l2 * q2.sin()).atan2(l1 + l2 * q2.cos());
            for (value, expected) in branch.drives.iter().zip([q1, q2, angle - q1 - q2]) {
                near((value[0] - expected).sin(), 0.0, 1e-13, "angle");
                assert!(
                    (value[0] - expected).cos() > 0.0 && value[0].abs() <= std::f64::consts::PI
                );
            }
            near(branch.distance, bend.sin(), 1e-14, "distance");
            assert!(branch.residual_m < 1e-15);
            // Rates and accelerations lead back to those of the end.
            let of = |order: usize| branch.drives.map(|drive| drive[order]);
            let back = forward(of(0), of(1), of(2));
            for i in 0..3 {
                let scale = 1.0 / branch.distance.powi(3);
                near(back.velocity[i], end.velocity[i], 1e-14 * scale, "velocity");
                near(
                    back.acceleration[i],
                    end.acceleration[i],
                    1e-13 * scale,
                    "acceleration",
                );
            }
        }
        // One of both is where it came from.
        let own = found
            .iter()
            .filter(|branch| (branch.drives[1][0] - q[1]).abs() < 1e-12);
        let own: Vec<_> = own.collect();
        let [own] = own.as_slice() else {
            panic!("{}", own.len())
        };
        for i in 0..3 {
            near(own.drives[i][1], dq[i], 1e-12, "rate");
            near(own.drives[i][2], ddq[i], 1e-11, "acceleration");
        }
    }
}

/// Torques by Newton and Euler: moments about each pin of everything beyond it.
#[test]
fn torques_of_the_arm_are_those_of_newton_and_euler() {
    let linkage = shipped("serial-arm");
    let arm = SerialArm::of(&linkage).unwrap();
    let (masses, g) = ([1.2, 0.8, 0.3], [0.0, -9.81]);
    let end = EndMotion {
        pose: [0.35, 0.3, 0.9],
        velocity: [0.5, -0.4, 2.0],
        acceleration: [3.0, 1.0, -6.0],
    };
    for branch in arm.inverse(&linkage, &end).unwrap() {
        let mut absolute = [0.0; 3];
        let mut pin = [[0.0; 2]; 3];
        let (mut tip, mut tip_acceleration) = ([0.0; 2], [0.0; 2]);
        let mut torques = [0.0; 3];
        for i in 0..3 {
            for (sum, part) in absolute.iter_mut().zip(branch.drives[i]) {
                *sum += part;
            }
            let [angle, rate, acceleration] = absolute;
            let (sin, cos) = angle.sin_cos();
            // A point at `along` on the link.
            let at = |along: f64| [tip[0] + along * cos, tip[1] + along * sin];
            let a = |along: f64| {
                [
                    tip_acceleration[0] - along * (sin * acceleration + cos * rate * rate),
                    tip_acceleration[1] + along * (cos * acceleration - sin * rate * rate),
                ]
            };
            pin[i] = tip;
            let (centre, of_centre) = (at(0.5 * LENGTHS[i]), a(0.5 * LENGTHS[i]));
            let force = [
                masses[i] * (of_centre[0] - g[0]),
                masses[i] * (of_centre[1] - g[1]),
            ];
            let inertia = masses[i] * LENGTHS[i] * LENGTHS[i] / 12.0;
            for j in 0..=i {
                let arm = [centre[0] - pin[j][0], centre[1] - pin[j][1]];
                torques[j] += arm[0] * force[1] - arm[1] * force[0] + inertia * acceleration;
            }
            (tip, tip_acceleration) = (at(LENGTHS[i]), a(LENGTHS[i]));
        }
        for (value, expected) in branch.torques_nm.unwrap().iter().zip(torques) {
            near(*value, expected, 1e-12, "torque");
        }
    }
}

/// Kinetic and potential energy of all links.
fn energy(linkage: &Linkage, position: &Position) -> f64 {
    let links = linkage.links.iter().zip(&position.states);
    let each = links.map(|(link, state)| {
        let centre = state.motion.point(link.mass.com_m);
        let (v, r) = (centre.velocity, centre.position);
        let g = linkage.gravity_m_s2;
        0.5 * link.mass.mass_kg * (v.x * v.x + v.y * v.y)
            - link.mass.mass_kg * (g.x * r.x + g.y * r.y)
            + 0.5 * link.mass.inertia_kgm2 * state.motion.rate * state.motion.rate
    });
    each.sum()
}

/// The power of the drives is the rate of the energy, in every kind of group.
#[test]
fn the_drives_give_the_power_that_the_energy_takes() {
    for file in [
        "four-bar",
        "slider-crank",
        "quick-return",
        "shaper",
        "five-bar",
        "fairbairn",
        "tetrad",
    ] {
        let text = shipped_text(file);
        // Every link but the frame gets another mass.
        let mut parts = text.split("[[link]]\n");
        let mut heavy = format!(
            "gravity_m_s2 = [1.0, -9.81]\n{}[[link]]\n{}",
            parts.next().unwrap(),
            parts.next().unwrap()
        );
        for (index, part) in parts.enumerate() {
            let mass = 0.3 + 0.2 * index as f64;
            heavy += &format!(
                "[[link]]\nmass_kg = {mass:?}\ncom_m = [0.03, 0.01]\ninertia_kgm2 = 0.002\n{part}"
            );
        }
        let mut linkage = parse(&heavy);
        linkage.motion.steps = 1440;
        let motion = track(&linkage);
        assert!(motion.stop.is_none());
        let h = linkage.motion.duration / 1440.0;
        let energies: Vec<f64> = motion
            .positions
            .iter()
            .map(|at| energy(&linkage, at))
            .collect();
        let powers: Vec<f64> = motion
            .positions
            .iter()
            .map(|position| {
                let loads = drive_loads(&linkage, position).unwrap();
                let drives = linkage.drives.iter().zip(loads);
                drives
                    .map(|(drive, load)| load * drive.at(position.t)[1])
                    .sum()
            })
            .collect();
        let largest = powers
            .iter()
            .fold(0.0, |most, power: &f64| f64::max(most, power.abs()));
        for (at, power) in powers.iter().enumerate().take(1439).skip(2) {
            let e = |k: usize| energies[k];
            let taken = (8.0 * (e(at + 1) - e(at - 1)) - (e(at + 2) - e(at - 2))) / (12.0 * h);
            near(*power, taken, 1e-6 * largest, file);
        }
        let study = study(&linkage, &motion);
        assert_eq!(study.loads.len(), linkage.drives.len());
        let work: f64 = powers[..1440].iter().sum::<f64>() * h;
        // Over a whole turn everything comes back; the five-bar has two drives.
        near(work, 0.0, 1e-6 * largest, file);
    }
}

#[test]
fn frames_anywhere_and_drives_that_count_inwards_change_nothing() {
    let plain = shipped("serial-arm");
    let arm = SerialArm::of(&plain).unwrap();
    let end = EndMotion {
        pose: [0.5, 0.2, 0.7],
        velocity: [0.1, 0.2, -0.3],
        acceleration: [1.0, 0.0, 2.0],
    };
    // The fore link turned by a right angle in its frame, its drive counted from it to the upper link.
    let text = shipped_text("serial-arm");
    let text = text.replace(
        "length_m = 0.3\nends = [\"E\", \"W\"]",
        "points_m = { E = [0.05, 0.02], W = [0.05, 0.32] }",
    );
    let text = text.replace("com_m = [0.15, 0.0]", "com_m = [0.05, 0.17]");
    let text = text.replace(
        "at = [\"upper.E\", \"fore.E\"]",
        "at = [\"fore.E\", \"upper.E\"]",
    );
    let other = parse(&text);
    let turned = SerialArm::of(&other).unwrap();
    let pairs = arm
        .inverse(&plain, &end)
        .unwrap()
        .into_iter()
        .zip(turned.inverse(&other, &end).unwrap());
    for (one, other_branch) in pairs {
        // The file's angle of the fore link is a quarter turn less; its drive has the other sign.
        let quarter = std::f64::consts::FRAC_PI_2;
        let expected = [
            one.drives[0],
            one.drives[1].map(|value| -value),
            one.drives[2],
        ];
        let shifts = [0.0, quarter, quarter];
        for ((value, expected), shift) in other_branch.drives.iter().zip(expected).zip(shifts) {
            near((value[0] - expected[0] - shift).sin(), 0.0, 1e-13, "angle");
            near(value[1], expected[1], 1e-13, "rate");
            near(value[2], expected[2], 1e-12, "acceleration");
        }
        let (a, b) = (one.torques_nm.unwrap(), other_branch.torques_nm.unwrap());
        for ((a, b), sign) in a.iter().zip(b).zip([1.0, -1.0, 1.0]) {
            near(b, sign * a, 1e-12, "torque");
        }
        let fore = link(&other, "fore");
        assert!(other_branch.position.states[fore].motion.is_finite());
    }
}

#[test]
fn what_has_no_inverse_says_why() {
    let linkage = shipped("serial-arm");
    let arm = SerialArm::of(&linkage).unwrap();
    let at = |x: f64, angle: f64| {
        let end = EndMotion {
            pose: [x, 0.0, angle],
            ..EndMotion::default()
        };
        arm.inverse(&linkage, &end).map(|_| ())
    };
    // The wrist is 0.1 m behind the point; the arm reaches from 0.1 m to 0.7 m.
    let Err(ArmError::OutOfReach {
        distance_m,
        too_far: true,
        by_m,
    }) = at(0.95, 0.0)
    else {
        panic!()
    };
    near(distance_m, 0.85, 1e-15, "distance");
    near(by_m, 0.15, 1e-15, "too far");
    let Err(ArmError::OutOfReach {
        too_far: false,
        by_m,
        ..
    }) = at(0.14, 0.0)
    else {
        panic!()
    };
    near(by_m, 0.06, 1e-15, "too near");
    let said = at(0.95, 0.0).unwrap_err().to_string();
    assert!(
        said.contains("0.850000 m from the base, farther than the arm can; by 0.150000 m"),
        "{said}"
    );
    for (file, reason) in [
        ("four-bar", "4 links and 4 joints"),
        ("slider-crank", "no serial arm"),
        ("shaper", "no serial arm"),
    ] {
        let error = SerialArm::of(&shipped(file)).unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
    let text = shipped_text("serial-arm").replace("trace = [\"tool.T\"]\n", "");
    let error = SerialArm::of(&parse(&text)).unwrap_err();
    assert!(error.to_string().contains("end link `tool`"), "{error}");
    // Two links side by side on the first one.
    let text = shipped_text("serial-arm").replace(
        "at = [\"fore.W\", \"tool.W\"]",
        "at = [\"upper.E\", \"tool.W\"]",
    );
    let error = SerialArm::of(&parse(&text)).unwrap_err();
    assert!(
        error.to_string().contains("branch instead of following"),
        "{error}"
    );
}

#[test]
fn masses_are_refused_in_words() {
    use crate::refusals::refused;
    refused(
        "serial-arm",
        "mass_kg = 1.2",
        "mass_kg = -1.2",
        "link[2].mass_kg = -1.2: must not be negative (kg)",
    );
    refused(
        "serial-arm",
        "com_m = [0.2, 0.0]\n",
        "",
        "link[2].com_m: missing",
    );
    refused(
        "serial-arm",
        "com_m = [0.2, 0.0]",
        "com_m = [1e9, 0.0]",
        "must be within 1000000 of the origin (m)",
    );
    refused(
        "serial-arm",
        "points_m = { S = [0.0, 0.0] }",
        "points_m = { S = [0.0, 0.0] }\nmass_kg = 1",
        "link[1].mass_kg = 1: the first link is the frame",
    );
    refused(
        "serial-arm",
        "gravity_m_s2 = [0.0, -9.81]",
        "gravity_m_s2 = 9.81",
        "gravity_m_s2 = 9.81: expected [x, y]",
    );
}
