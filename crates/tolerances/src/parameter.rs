//! The uncertain parameters of a machine: one variable of the [box models](crate::model) for each.

use crate::model::{BoxModel, VARIABLES};
use std::fmt;
use trirrr_scene::Scene;

/// Variable of time; the parameters follow.
pub(crate) const TIME: usize = 0;
const FIRST: usize = 1;

/// Parameters of a leg, in the order of their variables.
#[derive(Clone, Copy, Debug)]
pub(crate) enum OfLeg {
    BaseX,
    BaseY,
    JointX,
    JointY,
    Proximal,
    Distal,
    MotorAngle,
    ProximalMass,
    ProximalCentre,
    ProximalInertia,
    DistalMass,
    DistalCentre,
    DistalInertia,
    Rotor,
}

/// Names and units of [`OfLeg`].
const LEG: [(&str, &str); 14] = [
    ("base joint x", "m"),
    ("base joint y", "m"),
    ("platform joint x", "m"),
    ("platform joint y", "m"),
    ("proximal length", "m"),
    ("distal length", "m"),
    ("motor angle", "rad"),
    ("proximal mass", "kg"),
    ("proximal centre of mass", "m"),
    ("proximal inertia", "kg m^2"),
    ("distal mass", "kg"),
    ("distal centre of mass", "m"),
    ("distal inertia", "kg m^2"),
    ("rotor inertia", "kg m^2"),
];

/// Parameters of the platform and its loads, in the order of their variables.
#[derive(Clone, Copy, Debug)]
pub(crate) enum OfPlatform {
    Mass,
    Inertia,
    CentreX,
    CentreY,
    ForceX,
    ForceY,
    Torque,
}

/// Names and units of [`OfPlatform`].
const PLATFORM: [(&str, &str); 7] = [
    ("mass", "kg"),
    ("inertia", "kg m^2"),
    ("centre of mass x", "m"),
    ("centre of mass y", "m"),
    ("force x", "N"),
    ("force y", "N"),
    ("torque", "N m"),
];

const _: () = assert!(VARIABLES == FIRST + 3 * LEG.len() + PLATFORM.len());

/// An uncertain parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Its variable in a box model.
    variable: usize,
}

impl Parameter {
    pub(crate) fn of_leg(leg: usize, of: OfLeg) -> Self {
        Self {
            variable: FIRST + LEG.len() * leg + of as usize,
        }
    }

    pub(crate) fn of_platform(of: OfPlatform) -> Self {
        Self {
            variable: FIRST + 3 * LEG.len() + of as usize,
        }
    }

    /// Returns all parameters.
    pub fn all() -> impl Iterator<Item = Self> {
        (FIRST..VARIABLES).map(|variable| Self { variable })
    }

    /// Slope of `model` in this parameter: its change for one half-width.
    pub(crate) fn slope(self, model: &BoxModel) -> f64 {
        model.linear[self.variable]
    }

    /// Returns the leg, 0 to 2, of a leg's parameter.
    pub fn leg(self) -> Option<usize> {
        self.entry().0
    }

    /// Returns the parameter's name without its leg.
    pub fn name(self) -> &'static str {
        self.entry().1
    }

    /// Returns the parameter's unit.
    pub fn unit(self) -> &'static str {
        self.entry().2
    }

    /// Leg, 0 to 2, of a leg's parameter; name and unit.
    fn entry(self) -> (Option<usize>, &'static str, &'static str) {
        let number = self.variable - FIRST;
        match number.checked_sub(3 * LEG.len()) {
            Some(of_platform) => {
                let (name, unit) = PLATFORM[of_platform];
                (None, name, unit)
            }
            None => {
                let (name, unit) = LEG[number % LEG.len()];
                (Some(number / LEG.len()), name, unit)
            }
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.entry() {
            (Some(leg), name, _) => write!(f, "leg {} {name}", leg + 1),
            (None, name, _) => write!(f, "platform {name}"),
        }
    }
}

/// Half-widths of all parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfWidths([f64; VARIABLES]);

impl HalfWidths {
    /// Those of `scene`; `None` where it has no tolerances.
    pub(crate) fn of(scene: &Scene) -> Option<Self> {
        let tolerances = scene.tolerances?;
        let resolution = scene.motor_resolution_rad();
        let mut half_widths = Self([0.0; VARIABLES]);
        for (index, leg) in scene.parameters.legs.iter().enumerate() {
            let links = &tolerances.links;
            for (of, half_width) in [
                (OfLeg::BaseX, tolerances.base_m[index]),
                (OfLeg::BaseY, tolerances.base_m[index]),
                (OfLeg::JointX, tolerances.joint_m[index]),
                (OfLeg::JointY, tolerances.joint_m[index]),
                (OfLeg::Proximal, tolerances.proximal_m[index]),
                (OfLeg::Distal, tolerances.distal_m[index]),
                (
                    OfLeg::MotorAngle,
                    tolerances.motor_angle_rad[index] + resolution[index],
                ),
                (
                    OfLeg::ProximalMass,
                    links.mass_fraction * leg.proximal.mass_kg,
                ),
                (OfLeg::ProximalCentre, links.com_m),
                (
                    OfLeg::ProximalInertia,
                    links.inertia_fraction * leg.proximal.inertia_kgm2,
                ),
                (OfLeg::DistalMass, links.mass_fraction * leg.distal.mass_kg),
                (OfLeg::DistalCentre, links.com_m),
                (
                    OfLeg::DistalInertia,
                    links.inertia_fraction * leg.distal.inertia_kgm2,
                ),
                (
                    OfLeg::Rotor,
                    tolerances.rotor_inertia_fraction[index] * leg.rotor_inertia_kgm2,
                ),
            ] {
                half_widths.0[Parameter::of_leg(index, of).variable] = half_width;
            }
        }
        let platform = &scene.parameters.platform;
        let of_platform = &tolerances.platform;
        for (of, half_width) in [
            (
                OfPlatform::Mass,
                of_platform.mass_fraction * platform.mass_kg,
            ),
            (
                OfPlatform::Inertia,
                of_platform.inertia_fraction * platform.inertia_kgm2,
            ),
            (OfPlatform::CentreX, of_platform.com_m),
            (OfPlatform::CentreY, of_platform.com_m),
            (OfPlatform::ForceX, tolerances.force_n),
            (OfPlatform::ForceY, tolerances.force_n),
            (OfPlatform::Torque, tolerances.torque_nm),
        ] {
            half_widths.0[Parameter::of_platform(of).variable] = half_width;
        }
        Some(half_widths)
    }

    /// Half-width of `parameter` in its unit.
    pub(crate) fn half_width(&self, parameter: Parameter) -> f64 {
        self.0[parameter.variable]
    }

    /// The parameter with the nominal value `nominal`. The half-width may have been rounded.
    pub(crate) fn around(&self, nominal: f64, parameter: Parameter) -> BoxModel {
        let half_width = self.half_width(parameter);
        BoxModel::variable(nominal, parameter.variable, half_width).with_roundings_of(half_width)
    }

    /// Deviation of the parameter from its nominal value, divided by `unit`.
    pub(crate) fn deviation(&self, parameter: Parameter, unit: f64) -> BoxModel {
        let half_width = self.half_width(parameter) / unit;
        BoxModel::variable(0.0, parameter.variable, half_width).with_roundings_of(half_width)
    }
}
