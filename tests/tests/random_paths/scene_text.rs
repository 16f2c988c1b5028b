//! Drawn jobs as text of a scene.

use crate::drawn::{DrawnJob, PLACES};
use core::f64::consts::TAU;
use core::fmt::Write as _;
use nalgebra::Vector2;
use trirrr_core::machine::Parameters;
use trirrr_tests::draw::Draw;
use trirrr_tests::instant::{Instant, State};

/// The largest torque of a motor in states of rest along the path, and for an acceleration at its start.
fn torque_sizes(job: &DrawnJob, acceleration: [f64; 3]) -> [f64; 2] {
    let mut from = job.start;
    let mut standing: f64 = 0.0;
    let torque = |pose, acceleration| {
        let state = State {
            pose,
            acceleration,
            ..State::default()
        };
        let torques = Instant::of(&job.parameters, &state).torque;
        torques
            .into_iter()
            .fold(0.0, |most: f64, torque| most.max(torque.abs()))
    };
    for piece in &job.pieces {
        for place in 0..=PLACES {
            let at = piece.at(from, f64::from(place) / f64::from(PLACES));
            standing = standing.max(torque(at, [0.0; 3]));
        }
        from = piece.end(from);
    }
    let moving = torque(job.start, acceleration);
    [
        standing,
        (moving - torque(job.start, [0.0; 3]))
            .abs()
            .max(0.1 * moving),
    ]
}

/// Number type and tick rate.
pub(crate) fn header(draw: &mut Draw) -> String {
    let number = if draw.chance(0.5) { "f32" } else { "f64" };
    let rate = draw.log_within(100.0, 2000.0).round();
    format!("name = \"random\"\ntick_rate_hz = {rate:?}\nnumber = \"{number}\"\n")
}

/// Machine and loads.
pub(crate) fn machine_text(parameters: &Parameters) -> String {
    let vector = |v: Vector2<f64>| format!("[{:?}, {:?}]", v.x, v.y);
    let mut text = format!("gravity_m_s2 = {}\n", vector(parameters.gravity_m_s2));
    for leg in &parameters.legs {
        let _ = write!(
            text,
            "[[machine.leg]]\nbase_m = {}\nproximal_m = {:?}\ndistal_m = {:?}\njoint_radius_m = {:?}\n\
             joint_angle_rad = {:?}\nelbow = {}\n",
            vector(leg.base_m),
            leg.proximal_m,
            leg.distal_m,
            leg.joint_radius_m,
            leg.joint_angle_rad,
            leg.elbow.sign()
        );
        if leg.proximal.mass_kg > 0.0 || leg.distal.mass_kg > 0.0 {
            text += "[machine.leg.links]\n";
            for (name, link) in [("proximal", &leg.proximal), ("distal", &leg.distal)] {
                let _ = writeln!(
                    text,
                    "{name} = {{ mass_kg = {:?}, com_m = {:?}, inertia_kgm2 = {:?} }}",
                    link.mass_kg, link.com_m, link.inertia_kgm2
                );
            }
        }
    }
    let platform = &parameters.platform;
    let _ = write!(
        text,
        "[platform]\nmass_kg = {:?}\ninertia_kgm2 = {:?}\ncom_m = {}\n[wrench]\nforce_n = {}\ntorque_nm = {:?}\n",
        platform.mass_kg,
        platform.inertia_kgm2,
        vector(platform.com_m),
        vector(parameters.wrench_force_n),
        parameters.wrench_torque_nm
    );
    text
}

/// Random limits that suit the job, and settings of the service.
pub(crate) fn limits_text(
    job: &DrawnJob,
    draw: &mut Draw,
    reach: f64,
    distances: [f64; 2],
) -> String {
    let acceleration = reach * draw.log_within(1.0, 30.0);
    let way = draw.within(0.0, TAU);
    let [standing, moving] = torque_sizes(
        job,
        [
            acceleration * way.cos(),
            acceleration * way.sin(),
            acceleration / reach,
        ],
    );
    let rate = draw.log_within(0.5, 20.0);
    let sizes = [
        ("rate_rad_s", 0.6, rate),
        ("acceleration_rad_s2", 0.5, draw.log_within(5.0, 500.0)),
        ("torque_nm", 0.5, 1.2 * standing + moving),
        (
            "power_w",
            0.25,
            (1.2 * standing + moving) * rate * draw.log_within(0.1, 1.0),
        ),
    ];
    let mut text = format!(
        "[limits]\nserial_distance_min = {:?}\nparallel_distance_min = {:?}\n",
        distances[0], distances[1]
    );
    let mut none = true;
    for (index, (name, part, size)) in sizes.into_iter().enumerate() {
        // One at least.
        if draw.chance(part) || (none && index == 2) {
            none = false;
            let values = match draw.chance(0.5) {
                true => [size; 3],
                false => [(); 3].map(|()| size * draw.within(1.0, 2.0)),
            };
            let _ = writeln!(text, "{name} = {values:?}");
        }
    }
    // From numbers of its own: the rest of a job is the same with and without.
    let mut own = Draw::new(rate.to_bits());
    if own.chance(0.4) {
        let jerk = own.log_within(5.0, 500.0) * own.log_within(5.0, 300.0);
        let _ = writeln!(text, "jerk_rad_s3 = {jerk:?}");
    }
    let _ = write!(
        text,
        "[service]\nhold_ramp_s = {:?}\n",
        draw.log_within(0.02, 1.0)
    );
    text
}

/// `[job]` and its pieces.
pub(crate) fn job_text(job: &DrawnJob, [tolerance_m, tolerance_rad]: [f64; 2]) -> String {
    let [x, y, alpha] = job.start;
    let mut text = format!(
        "[job]\ntiming = \"shortest\"\nstart = {{ x_m = {x:?}, y_m = {y:?}, alpha_rad = {alpha:?} }}\n\
         tolerance_m = {tolerance_m:?}\ntolerance_rad = {tolerance_rad:?}\n"
    );
    if let Some(corner_m) = job.corner_m {
        let _ = writeln!(text, "corner_tolerance_m = {corner_m:?}");
    }
    if job.free_alpha.is_some() {
        text += "alpha = \"free\"\n";
    }
    for (piece, feed) in job.pieces.iter().zip(&job.feeds) {
        text += "[[job.path]]\n";
        text += &piece.text(job.free_alpha);
        if let Some(feed) = feed {
            let _ = writeln!(text, "feed_m_s = {feed:?}");
        }
    }
    text
}
