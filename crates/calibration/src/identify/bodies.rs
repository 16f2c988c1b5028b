//! Parameters that the torques are linear in.

use trirrr_core::machine::{LinkParameters, Parameters};

/// Parameters of a leg: first moment and inertia of the proximal link about A; mass, first moment and inertia of the distal link about B.
pub(crate) const PER_BODY_LEG: usize = 5;

/// First parameter of the platform: mass, first moments along x and y, inertia about D.
pub(crate) const PLATFORM: usize = 3 * PER_BODY_LEG;

/// First parameter of friction: viscous and Coulomb's of each motor.
pub(crate) const FRICTION: usize = PLATFORM + 4;

/// First parameter of friction in the other joints: viscous and Coulomb's of the elbows, then of the platform's joints.
pub(crate) const PASSIVE: usize = FRICTION + 6;

/// First parameter of the readings of torque: the part in proportion to the rate, of each motor.
pub(crate) const READING: usize = PASSIVE + 4;

/// Number of parameters.
pub const BODY_COUNT: usize = READING + 3;

/// Parameters that are identified or held together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyGroup {
    /// Masses and inertias of the links, with the rotors.
    Links,
    /// Mass, centre of mass and inertia of the platform.
    Platform,
    /// Friction of the motors and their gears.
    Motors,
    /// Friction of elbows and platform joints: one number for all three of a kind.
    Joints,
    /// Parts of the told torques that come from the place in the tick at which a drive that holds a position tells them. Such a part is
    /// in proportion to the rate, of either sign: viscous friction of the motors cannot be told from it, and is held.
    Readings,
}

impl BodyGroup {
    /// All groups.
    pub const ALL: [Self; 5] = [
        Self::Links,
        Self::Platform,
        Self::Motors,
        Self::Joints,
        Self::Readings,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Links => "links",
            Self::Platform => "platform",
            Self::Motors => "motors",
            Self::Joints => "joints",
            Self::Readings => "readings",
        }
    }

    /// Group of parameter `index`.
    pub fn of(index: usize) -> Self {
        match index {
            READING.. => Self::Readings,
            PASSIVE.. => Self::Joints,
            FRICTION.. => Self::Motors,
            PLATFORM.. => Self::Platform,
            _ => Self::Links,
        }
    }
}

/// Name of parameter `index` for a person.
pub fn body_name(index: usize) -> String {
    const OF_LEG: [&str; PER_BODY_LEG] = [
        "first moment of the proximal link",
        "inertia of the proximal link about A with the rotor",
        "mass of the distal link",
        "first moment of the distal link",
        "inertia of the distal link about B",
    ];
    const OF_PLATFORM: [&str; 4] = [
        "mass of the platform",
        "first moment of the platform along x",
        "first moment of the platform along y",
        "inertia of the platform about D",
    ];
    const OF_JOINTS: [&str; 4] = [
        "viscous friction of the elbows",
        "Coulomb friction of the elbows",
        "viscous friction of the platform joints",
        "Coulomb friction of the platform joints",
    ];
    match index {
        READING.. => format!("rate in the told torque of motor {}", index - READING + 1),
        PASSIVE.. => OF_JOINTS[index - PASSIVE].into(),
        FRICTION.. => {
            let kind = ["viscous", "Coulomb"][(index - FRICTION) % 2];
            format!("{kind} friction of motor {}", (index - FRICTION) / 2 + 1)
        }
        PLATFORM.. => OF_PLATFORM[index - PLATFORM].into(),
        _ => format!(
            "leg {} {}",
            index / PER_BODY_LEG + 1,
            OF_LEG[index % PER_BODY_LEG]
        ),
    }
}

/// Unit of parameter `index`.
pub fn body_unit(index: usize) -> &'static str {
    match index {
        READING.. => "N m s/rad",
        FRICTION.. if (index - FRICTION).is_multiple_of(2) => "N m s/rad",
        FRICTION.. => "N m",
        PLATFORM.. => ["kg", "kg m", "kg m", "kg m^2"][index - PLATFORM],
        _ => ["kg m", "kg m^2", "kg", "kg m", "kg m^2"][index % PER_BODY_LEG],
    }
}

/// Returns true for a parameter that cannot be negative: masses, inertias, friction.
pub(crate) fn is_positive(index: usize) -> bool {
    match index {
        READING.. => false,
        FRICTION.. => true,
        PLATFORM.. => matches!(index - PLATFORM, 0 | 3),
        _ => matches!(index % PER_BODY_LEG, 1 | 2 | 4),
    }
}

/// Returns true for the viscous friction of a motor.
pub(crate) fn is_viscous_of_motor(index: usize) -> bool {
    (FRICTION..PASSIVE).contains(&index) && (index - FRICTION).is_multiple_of(2)
}

/// Values of all parameters, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyVector(pub [f64; BODY_COUNT]);

fn inertia_about_joint(link: &LinkParameters) -> f64 {
    link.inertia_kgm2 + link.mass_kg * link.com_m * link.com_m
}

impl BodyVector {
    /// Those of a machine, with the viscous and Coulomb friction of each motor.
    pub fn of(parameters: &Parameters, friction: [[f64; 2]; 3]) -> Self {
        let mut values = [0.0; BODY_COUNT];
        for (leg, own) in parameters.legs.iter().zip(values.chunks_mut(PER_BODY_LEG)) {
            let (one, two) = (&leg.proximal, &leg.distal);
            own.copy_from_slice(&[
                one.mass_kg * one.com_m,
                inertia_about_joint(one) + leg.rotor_inertia_kgm2,
                two.mass_kg,
                two.mass_kg * two.com_m,
                inertia_about_joint(two),
            ]);
        }
        let body = &parameters.platform;
        let (mass, com) = (body.mass_kg, body.com_m);
        values[PLATFORM..FRICTION].copy_from_slice(&[
            mass,
            mass * com.x,
            mass * com.y,
            body.inertia_kgm2 + mass * (com.x * com.x + com.y * com.y),
        ]);
        for (own, motor) in values[FRICTION..PASSIVE].chunks_mut(2).zip(friction) {
            own.copy_from_slice(&motor);
        }
        Self(values)
    }

    /// `parameters` with these masses, and the bodies that cannot be, in words. The mass of a proximal link itself, which moves nothing, stays; where
    /// it is 0, the link's first moment is that of a mass in its middle.
    pub fn put_into(&self, parameters: &Parameters) -> (Parameters, Vec<String>) {
        let (mut put, mut faults) = (*parameters, Vec::new());
        let mut body = |name: String, mass: f64, inertia: f64| {
            if mass < 0.0 || inertia < 0.0 {
                faults.push(format!(
                    "{name}: mass {mass:.4e} kg, inertia about its centre of mass {inertia:.4e} kg m^2"
                ));
            }
        };
        for ((number, leg), own) in (1..).zip(&mut put.legs).zip(self.0.chunks(PER_BODY_LEG)) {
            let [moment, about_a, mass, moment_b, about_b] =
                [own[0], own[1], own[2], own[3], own[4]];
            let half = 0.5 * leg.proximal_m;
            let kept = leg.proximal.mass_kg;
            let own_mass = if kept > 0.0 {
                kept
            } else {
                moment.abs() / half
            };
            leg.proximal = link(own_mass, moment, about_a - leg.rotor_inertia_kgm2);
            leg.distal = link(mass, moment_b, about_b);
            for (name, link) in [("proximal", leg.proximal), ("distal", leg.distal)] {
                body(
                    format!("{name} link of leg {number}"),
                    link.mass_kg,
                    link.inertia_kgm2,
                );
            }
        }
        let [mass, x, y, about_d] = [0, 1, 2, 3].map(|part| self.0[PLATFORM + part]);
        let com = if mass > 0.0 {
            [x / mass, y / mass]
        } else {
            [0.0; 2]
        };
        put.platform.mass_kg = mass;
        put.platform.com_m = com.into();
        put.platform.inertia_kgm2 = about_d - (x * com[0] + y * com[1]);
        body("platform".into(), mass, put.platform.inertia_kgm2);
        (put, faults)
    }

    /// Viscous (N m s/rad) and Coulomb friction (N m) of each motor.
    pub fn friction(&self) -> [[f64; 2]; 3] {
        [0, 1, 2].map(|motor| {
            [
                self.0[FRICTION + 2 * motor],
                self.0[FRICTION + 2 * motor + 1],
            ]
        })
    }
}

/// Link of a mass, a first moment and an inertia about its inner joint.
fn link(mass: f64, moment: f64, about_joint: f64) -> LinkParameters {
    let com = if mass > 0.0 { moment / mass } else { 0.0 };
    LinkParameters {
        mass_kg: mass,
        com_m: com,
        // Rounding leaves less than nothing of a link without any.
        inertia_kgm2: match about_joint - moment * com {
            rest if rest.abs() < 1e-15 => 0.0,
            rest => rest,
        },
    }
}
