//! The plant: what of the real machine a simulation is to show besides its rigid bodies, and how it is
//! integrated.

use crate::controller::{Controller, Timing, refuse_continuous};
use crate::drive::{Drive, DriveKind};
use crate::push::{Push, read_push};
use crate::read::{Bound, Place, Section};

/// Settings of the simulated plant. A part that is `None` has no place in its equations.
#[derive(Clone, Debug, PartialEq)]
pub struct Plant {
    /// Method of integration.
    pub method: Method,
    /// Time that is simulated after the end of the job, s.
    pub settle_s: f64,
    /// Time between two rows of the table, s.
    pub record_s: f64,
    /// Following error of a joint at which the run ends, rad.
    pub following_error_rad: Option<f64>,
    /// Friction in the joints.
    pub friction: JointFriction,
    /// Elastic transmission between rotor and joint, of each motor.
    pub transmission: Option<[Transmission; 3]>,
    /// Push on the platform.
    pub push: Option<Push>,
    /// Masses and inertias of links and platform over those of the scene, which the torques are computed from.
    pub mass_factor: f64,
}

/// Method of integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Chosen by the stiffness that is found.
    Auto {
        /// Tolerance; the method's own where it is left out.
        tolerance: Option<f64>,
    },
    /// Semi-implicit Euler with a fixed step in s.
    SemiImplicitEuler {
        /// The step.
        step_s: f64,
    },
    /// Runge-Kutta of order 4 with a fixed step in s.
    Rk4 {
        /// The step.
        step_s: f64,
    },
    /// Dormand and Prince's adaptive explicit pair.
    DormandPrince {
        /// Tolerance; the method's own where it is left out.
        tolerance: Option<f64>,
    },
    /// Radau IIA, implicit and adaptive.
    RadauIia {
        /// Tolerance; the method's own where it is left out.
        tolerance: Option<f64>,
    },
}

/// Friction of the three kinds of joint, alike in all legs.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct JointFriction {
    /// At the motors, their gears included.
    pub motor: Option<Friction>,
    /// At the elbows.
    pub elbow: Option<Friction>,
    /// At the platform's joints.
    pub platform: Option<Friction>,
}

/// Friction of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Viscous, N m s/rad, not negative.
    pub viscous_nm_s_rad: f64,
    /// Coulomb's, N m, not negative.
    pub coulomb_nm: f64,
    /// Rate below which the joint sticks, rad/s, positive.
    pub stick_rad_s: f64,
}

/// An elastic transmission, seen at the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmission {
    /// Stiffness, N m/rad, positive.
    pub stiffness_nm_rad: f64,
    /// Damping, N m s/rad, not negative.
    pub damping_nm_s_rad: f64,
}

/// Plant and the places of its keys in the file, for the checks with the job.
pub(crate) struct PlacedPlant {
    pub(crate) plant: Plant,
    step: Place,
    push: Place,
}

/// Rate below which a joint with Coulomb friction sticks where the scene does not say, rad/s.
const STICK_RAD_S: f64 = 1e-3;
/// Rows of the table are this far apart where the scene does not say, s.
const RECORD_S: f64 = 1e-3;

/// Reads `[plant]`: `Some(None)` where there is none. `drives` and `controller` are `None` where
/// they were refused.
pub(crate) fn read_plant(
    root: &Section,
    drives: Option<Option<[Drive; 3]>>,
    controller: Option<Option<Controller>>,
) -> Option<Option<PlacedPlant>> {
    if !root.has("plant") {
        return Some(None);
    }
    let section = root.section("plant")?;
    let method = read_method(&section);
    let settle_s = section.number_or("settle_s", Bound::NotNegative, 0.0);
    let record_s = section.number_or("record_s", Bound::Positive, RECORD_S);
    let following_error_rad = section.optional_number("following_error_rad", Bound::Positive);
    let friction = read_friction(&section);
    let transmission = read_transmission(&section, drives);
    let push = read_push(&section);
    let mass_factor = section.number_or("mass_factor", Bound::Within(0.01, 100.0), 1.0);
    let plant = Plant {
        method: method?,
        settle_s: settle_s?,
        record_s: record_s?,
        following_error_rad,
        friction: friction?,
        transmission: transmission?,
        push: push?,
        mass_factor: mass_factor?,
    };
    check_drives(root, controller?, drives?)?;
    Some(Some(PlacedPlant {
        plant,
        step: section.place_of("step_s"),
        push: section.place_of("push"),
    }))
}

impl PlacedPlant {
    /// Refuses a step longer than the run, and a push behind its end; the plant.
    pub(crate) fn checked(self, root: &Section, job_s: f64) -> Option<Plant> {
        let run_s = job_s + self.plant.settle_s;
        if let Method::SemiImplicitEuler { step_s } | Method::Rk4 { step_s } = self.plant.method
            && step_s > run_s
        {
            let reason = format!("a step longer than the run, which lasts {run_s} s");
            root.refuse_at(&self.step, reason);
            return None;
        }
        if let Some(push) = self.plant.push
            && push.at_s >= run_s
        {
            let reason = format!("at_s lies behind the run, which lasts {run_s} s");
            root.refuse_at(&self.push, reason);
            return None;
        }
        Some(self.plant)
    }
}

fn read_method(section: &Section) -> Option<Method> {
    #[derive(Clone, Copy)]
    enum MethodName {
        Auto,
        Euler,
        Rk4,
        Pair,
        Implicit,
    }
    let kinds = [
        ("auto", MethodName::Auto),
        ("semi-implicit-euler", MethodName::Euler),
        ("rk4", MethodName::Rk4),
        ("dormand-prince", MethodName::Pair),
        ("radau-iia", MethodName::Implicit),
    ];
    let kind = match section.has("method") {
        true => section.choice("method", &kinds),
        false => Some(MethodName::Auto),
    };
    // Both are known, also where another method has them.
    let _ = (section.has("step_s"), section.has("tolerance"));
    let kind = kind?;
    let (is_stepped, other, methods) = match kind {
        MethodName::Euler | MethodName::Rk4 => (
            true,
            "tolerance",
            "\"dormand-prince\", \"radau-iia\", or none for the one that suits",
        ),
        _ => (false, "step_s", "\"semi-implicit-euler\" or \"rk4\""),
    };
    if section.has(other) {
        section.refuse(other, format!("belongs to method = {methods}"));
        return None;
    }
    if is_stepped {
        let step_s = section.number("step_s", Bound::Positive)?;
        return Some(match kind {
            MethodName::Euler => Method::SemiImplicitEuler { step_s },
            _ => Method::Rk4 { step_s },
        });
    }
    let tolerance = section.optional_number("tolerance", Bound::Within(1e-14, 0.1));
    if section.has("tolerance") && tolerance.is_none() {
        return None;
    }
    Some(match kind {
        MethodName::Pair => Method::DormandPrince { tolerance },
        MethodName::Implicit => Method::RadauIia { tolerance },
        _ => Method::Auto { tolerance },
    })
}

fn read_friction(section: &Section) -> Option<JointFriction> {
    if !section.has("friction") {
        return Some(JointFriction::default());
    }
    let section = section.section("friction")?;
    let joint = |key| {
        if !section.has(key) {
            return Some(None);
        }
        let joint = section.section(key)?;
        let viscous = joint.number_or("viscous_nm_s_rad", Bound::NotNegative, 0.0);
        let coulomb = joint.number_or("coulomb_nm", Bound::NotNegative, 0.0);
        let stick = joint.number_or("stick_rad_s", Bound::Positive, STICK_RAD_S);
        Some(Some(Friction {
            viscous_nm_s_rad: viscous?,
            coulomb_nm: coulomb?,
            stick_rad_s: stick?,
        }))
    };
    let (motor, elbow, platform) = (joint("motor"), joint("elbow"), joint("platform"));
    Some(JointFriction {
        motor: motor?,
        elbow: elbow?,
        platform: platform?,
    })
}

fn read_transmission(
    section: &Section,
    drives: Option<Option<[Drive; 3]>>,
) -> Option<Option<[Transmission; 3]>> {
    if !section.has("transmission") {
        return Some(None);
    }
    let place = section.place_of("transmission");
    let inner = section.section("transmission")?;
    if !inner.has("stiffness_nm_rad") {
        inner.refuse("stiffness_nm_rad", "missing, expected a number in N m/rad");
    }
    let stiffness = inner.number_or_three("stiffness_nm_rad", Bound::Positive);
    let damping = match inner.has("damping_nm_s_rad") {
        true => inner.number_or_three("damping_nm_s_rad", Bound::NotNegative),
        false => Some([0.0; 3]),
    };
    let (stiffness, damping) = (stiffness?, damping?);
    let rotors = drives?.map(|drives| drives.map(|drive| drive.rotor_inertia_kgm2));
    if !rotors.is_some_and(|rotors| rotors.iter().all(|inertia| *inertia > 0.0)) {
        let reason = "an elastic transmission needs a rotor to turn against: every [[drive]] \
                      needs a rotor_inertia_kgm2 greater than 0";
        section.refuse_at(
            &Place {
                value: None,
                ..place
            },
            reason,
        );
        return None;
    }
    Some(Some([0, 1, 2].map(|i| Transmission {
        stiffness_nm_rad: stiffness[i],
        damping_nm_s_rad: damping[i],
    })))
}

/// Checks that the plant can simulate the drives, and that they have the controller they need.
fn check_drives(
    root: &Section,
    controller: Option<Controller>,
    drives: Option<[Drive; 3]>,
) -> Option<()> {
    let kinds = drives.map(|drives| drives.map(|drive| drive.kind));
    let mut by_torque = kinds.is_none();
    let mut sampled = None;
    for kind in kinds.iter().flatten() {
        match kind {
            DriveKind::Bldc(_) => by_torque = true,
            DriveKind::Stepper(stepper) => {
                sampled = Some("steppers are commanded step by step");
                if stepper.holding_torque_nm.is_none() {
                    let reason = "a [plant] needs the holding_torque_nm of its steppers";
                    root.refuse_list("drive", reason);
                    return None;
                }
            }
            DriveKind::Can(_) => {
                by_torque = true;
                sampled = Some("a drive on the CAN bus computes in samples");
            }
        }
    }
    match controller {
        None if by_torque => {
            let reason = "missing, expected [controller]: a [plant] whose motors are driven by torque needs one";
            root.refuse("controller", reason);
            None
        }
        Some(controller) if controller.timing == Timing::Continuous => {
            let Some(why) = sampled else {
                return Some(());
            };
            refuse_continuous(root, why);
            None
        }
        _ => Some(()),
    }
}
