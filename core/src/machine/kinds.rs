//! The tick's types that a machine needs: one rule, used when an image is built and at run time.

use super::Parameters;

/// Kind of platform: one of the types of [`torque::payload`](crate::torque::payload).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PayloadKind {
    /// The centre of mass is the reference point.
    Centred,
    /// The centre of mass lies elsewhere.
    Offset,
}

/// Kind of links: one of the types of [`torque::links`](crate::torque::links).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinksKind {
    /// No mass, no rotor inertia.
    Massless,
    /// No mass, but rotor inertia.
    Rotors,
    /// Mass, no gravity in the plane.
    MassiveHorizontal,
    /// Mass, and gravity in the plane.
    MassiveInPlane,
}

impl PayloadKind {
    /// The simplest kind that has room for `parameters`.
    pub fn of(parameters: &Parameters) -> Self {
        let com = parameters.platform.com_m;
        if com.x == 0.0 && com.y == 0.0 {
            Self::Centred
        } else {
            Self::Offset
        }
    }
}

impl LinksKind {
    /// The simplest kind that has room for `parameters`.
    pub fn of(parameters: &Parameters) -> Self {
        let g = parameters.gravity_m_s2;
        let rotors = parameters
            .legs
            .iter()
            .any(|leg| leg.rotor_inertia_kgm2 != 0.0);
        match (parameters.links_are_massless(), rotors) {
            (true, false) => Self::Massless,
            (true, true) => Self::Rotors,
            (false, _) if g.x == 0.0 && g.y == 0.0 => Self::MassiveHorizontal,
            (false, _) => Self::MassiveInPlane,
        }
    }
}
