//! The machine as simulators want it: bodies with masses, and where they stand.

use super::ExportFormat;
use std::fmt::Write;
use trirrr_core::machine::{LegParameters, LinkParameters};
use trirrr_design::assembly::working_modes;
use trirrr_scene::Scene;

/// Mass and moment of inertia of a link that the scene gives none, kg and kg m^2: simulators refuse a body without.
const LEAST_KG: f64 = 1e-6;
const LEAST_KGM2: f64 = 1e-9;

/// Thickness of a drawn link, as a part of its length.
const THICKNESS: f64 = 0.03;

/// A body that moves in the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExportedBody {
    pub(super) mass_kg: f64,
    /// Centre of mass in the frame of the body, m.
    pub(super) com_m: [f64; 2],
    /// About the centre of mass and the axis z, kg m^2.
    pub(super) inertia_kgm2: f64,
}

/// A leg where it stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExportedLeg {
    pub(super) base_m: [f64; 2],
    pub(super) proximal_m: f64,
    pub(super) distal_m: f64,
    /// From its base joint along the link.
    pub(super) proximal: ExportedBody,
    /// From its elbow along the link.
    pub(super) distal: ExportedBody,
    /// Inertia of the rotor at the base joint, kg m^2.
    pub(super) rotor_kgm2: f64,
    /// Platform joint in the frame of the platform, m.
    pub(super) joint_m: [f64; 2],
    /// Angles of both links from the axis x, rad.
    pub(super) angles_rad: [f64; 2],
    /// Greatest torque of the motor, N m, and its rate, rad/s.
    pub(super) torque_nm: Option<f64>,
    pub(super) rate_rad_s: Option<f64>,
}

/// A machine where it stands.
#[derive(Clone, Debug)]
pub(super) struct ExportedMachine {
    pub(super) name: String,
    pub(super) gravity_m_s2: [f64; 2],
    pub(super) legs: [ExportedLeg; 3],
    pub(super) platform: ExportedBody,
    /// x, y (m) and alpha (rad) of the platform.
    pub(super) pose: [f64; 3],
    /// Links that have a mass by [`LEAST_KG`] only.
    massless: usize,
    has_wrench: bool,
}

impl ExportedBody {
    fn of(link: &LinkParameters) -> Self {
        Self {
            mass_kg: link.mass_kg.max(LEAST_KG),
            com_m: [link.com_m, 0.0],
            inertia_kgm2: link.inertia_kgm2.max(LEAST_KGM2),
        }
    }

    /// The same with the `inertia_kgm2` of a rotor that turns with the body about the origin of its frame.
    pub(super) fn with_rotor(self, inertia_kgm2: f64) -> Self {
        Self {
            inertia_kgm2: self.inertia_kgm2 + inertia_kgm2,
            ..self
        }
    }
}

impl ExportedLeg {
    /// Radius of a drawn link of that length, m.
    pub(super) fn radius_m(length_m: f64) -> f64 {
        THICKNESS * length_m
    }
}

impl ExportedMachine {
    /// The machine of `scene` at the start of its job.
    ///
    /// # Errors
    /// Reason why it cannot stand there.
    pub(super) fn of(scene: &Scene) -> Result<Self, String> {
        let parameters = &scene.parameters;
        let start = scene.job.start;
        let own = parameters.legs.map(|leg| leg.elbow);
        let modes = working_modes(parameters, start)?;
        let standing = modes.iter().find(|(elbows, _)| *elbows == own);
        let (_, standing) = standing.ok_or("no working mode has its elbows")?;
        let leg = |index: usize| {
            let leg: &LegParameters = &parameters.legs[index];
            let (sin, cos) = leg.joint_angle_rad.sin_cos();
            ExportedLeg {
                base_m: leg.base_m.into(),
                proximal_m: leg.proximal_m,
                distal_m: leg.distal_m,
                proximal: ExportedBody::of(&leg.proximal),
                distal: ExportedBody::of(&leg.distal),
                rotor_kgm2: leg.rotor_inertia_kgm2,
                joint_m: [leg.joint_radius_m * cos, leg.joint_radius_m * sin],
                angles_rad: [standing.legs[index].th1, standing.legs[index].th2],
                torque_nm: scene.limits.torque_nm.map(|limits| limits[index]),
                rate_rad_s: scene.limits.rate_rad_s.map(|limits| limits[index]),
            }
        };
        let platform = &parameters.platform;
        let links = parameters.legs.iter();
        let links = links.flat_map(|leg| [leg.proximal, leg.distal]);
        let wrench = parameters.wrench_force_n.norm() + parameters.wrench_torque_nm.abs();
        Ok(Self {
            name: scene.name.clone(),
            gravity_m_s2: parameters.gravity_m_s2.into(),
            legs: [leg(0), leg(1), leg(2)],
            platform: ExportedBody {
                mass_kg: platform.mass_kg.max(LEAST_KG),
                com_m: platform.com_m.into(),
                inertia_kgm2: platform.inertia_kgm2.max(LEAST_KGM2),
            },
            pose: [start.position.x, start.position.y, start.angle],
            massless: links.filter(|link| link.mass_kg < LEAST_KG).count(),
            has_wrench: wrench > 0.0,
        })
    }

    /// Sentences about what the file does not have, or has beyond the scene; a line each.
    pub(super) fn notes(&self, format: ExportFormat) -> String {
        let mut notes = String::new();
        // Writing to a String does not fail.
        if self.massless > 0 {
            let _ = writeln!(
                notes,
                "{} links without a mass have 1e-6 kg and 1e-9 kg m^2: simulators refuse a body without",
                self.massless
            );
        }
        if self.has_wrench {
            let _ = writeln!(notes, "the wrench of the scene is left out");
        }
        if format == ExportFormat::Urdf {
            let [x, y] = self.gravity_m_s2;
            let _ = writeln!(
                notes,
                "URDF has no gravity: give the simulator ({x}, {y}, 0) m/s^2\n\
                 it knows no loops: the frames leg2_end and leg2_joint have to meet, and leg3_end and leg3_joint"
            );
        }
        notes
    }
}
