//! The cases of the study: the reference case, and what makes it stiff, sudden or singular.

use crate::error::ReportError;
use trirrr_scene::Scene;

/// The reference case, which all others are changes of.
const REFERENCE: &str = include_str!("../../../../scenes/plant-reference.toml");

/// One case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its name in tables and file names.
    pub name: &'static str,
    /// Description of the case, in a few words.
    pub what: &'static str,
    /// Parts of the scene file that are replaced.
    changes: &'static [(&'static str, &'static str)],
    /// The job instead of the reference case's.
    job: Option<&'static str>,
}

const INDUCTANCE: &str = "inductance_h = 1e-4";
const KP: &str = "kp_nm_rad = 2000.0";
const KD: &str = "kd_nm_s_rad = 5.0";
const FEED_FORWARD: &str = "feed_forward = false";
const FED: &str = "feed_forward = true";
const ROTOR: &str = "rotor_inertia_kgm2 = 1e-5";
const CONTROLLER: &str = "[controller]";
/// Limits of the motors, which no case is a matter of.
const MOTORS: &str = "rate_rad_s = 12.0\ntorque_nm = 4.0\n";
/// Allows moves close to singularities.
const NEAR: &str = "parallel_distance_min = 1e-4\nserial_distance_min = 1e-4\n";
const MASS: &str = "mass_kg = 0.5\ninertia_kgm2 = 0.0025000000000000005";

/// All cases.
pub const CASES: [Case; 10] = [
    Case {
        name: "reference",
        what: "the reference case",
        changes: &[],
        job: None,
    },
    Case {
        name: "inductance",
        what: "L = 1e-6 H: a stiff current loop",
        changes: &[(INDUCTANCE, "inductance_h = 1e-6")],
        job: None,
    },
    Case {
        name: "gain",
        what: "kp 100 times larger",
        changes: &[(KP, "kp_nm_rad = 2e5")],
        job: None,
    },
    Case {
        name: "gains",
        what: "kp 100 times and kd 30 times larger: a stiff position loop",
        changes: &[(KP, "kp_nm_rad = 2e5"), (KD, "kd_nm_s_rad = 150.0")],
        job: None,
    },
    Case {
        name: "elastic",
        what: "transmission of 1e4 N m/rad, rotor of 1e-8 kg m^2",
        changes: &[
            (ROTOR, "rotor_inertia_kgm2 = 1e-8"),
            (
                CONTROLLER,
                "[plant.transmission]\nstiffness_nm_rad = 1e4\n\n[controller]",
            ),
        ],
        job: None,
    },
    Case {
        name: "stick-slip",
        what: "0.5 N m of Coulomb friction at the motors, 1 mm in 1 s",
        changes: &[(
            CONTROLLER,
            "[plant.friction]\nmotor = { coulomb_nm = 0.5 }\n\n[controller]",
        )],
        job: Some(
            "start = { x_m = 0.25, y_m = 0.25, alpha_rad = 0.15 }\n\n\
             [[job.move]]\n\
             to = { x_m = 0.251, y_m = 0.25, alpha_rad = 0.15 }\n\
             duration_s = 1.0\n",
        ),
    },
    Case {
        name: "light",
        what: "platform of 1e-4 of its mass and inertia",
        changes: &[(MASS, "mass_kg = 0.5e-4\ninertia_kgm2 = 0.25e-6")],
        job: None,
    },
    Case {
        name: "heavy",
        what: "platform of 1e3 times its mass and inertia",
        changes: &[(MASS, "mass_kg = 500.0\ninertia_kgm2 = 2.5"), (MOTORS, "")],
        job: None,
    },
    Case {
        name: "parallel",
        what: "to 1e-3 rad from a parallel singularity and back, feed-forward on",
        changes: &[(FEED_FORWARD, FED), (MOTORS, NEAR)],
        job: Some(
            "start = { x_m = 0.245, y_m = 0.25, alpha_rad = -0.45 }\n\n\
             [[job.move]]\n\
             to = { x_m = 0.245, y_m = 0.25, alpha_rad = -0.752418931929448511 }\n\
             duration_s = 0.5\n\n\
             [[job.move]]\n\
             to = { x_m = 0.245, y_m = 0.25, alpha_rad = -0.45 }\n\
             duration_s = 0.5\n",
        ),
    },
    Case {
        name: "stretched",
        what: "leg 3 to 0.1 mm from its full length and back",
        changes: &[(MOTORS, NEAR)],
        job: Some(
            "start = { x_m = 0.25, y_m = 0.3, alpha_rad = 0.0 }\n\n\
             [[job.move]]\n\
             to = { x_m = 0.25, y_m = 0.4199, alpha_rad = 0.0 }\n\
             duration_s = 0.5\n\n\
             [[job.move]]\n\
             to = { x_m = 0.25, y_m = 0.3, alpha_rad = 0.0 }\n\
             duration_s = 0.5\n",
        ),
    },
];

impl Case {
    /// Its scene.
    ///
    /// # Errors
    /// Refused: the reference case has changed so that this is no change of it any more.
    pub fn scene(&self) -> Result<Scene, ReportError> {
        let refused =
            |reason: String| ReportError::Refused(format!("case {}: {reason}", self.name));
        let mut text = REFERENCE.to_owned();
        for (old, new) in self.changes {
            if !text.contains(old) {
                return Err(refused(format!("no `{old}` in the reference case")));
            }
            text = text.replace(old, new);
        }
        if let Some(job) = self.job {
            let Some(start) = text.find("[job]\n") else {
                return Err(refused("no `[job]` in the reference case".into()));
            };
            text.truncate(start);
            text.push_str("[job]\n");
            text.push_str(job);
        }
        Scene::parse(&text, &format!("{}.toml", self.name))
            .map_err(|error| refused(error.to_string()))
    }
}
