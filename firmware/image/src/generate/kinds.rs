//! Which of the core's types a machine needs, so that its image holds nothing else.

use trirrr_core::machine::Parameters;

/// Kind of platform, a type of `trirrr_core::torque::payload`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PayloadKind {
    /// The centre of mass is the reference point.
    Centred,
    /// It is not.
    Offset,
}

/// Kind of links, a type of `trirrr_core::torque::links`.
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
    /// The least that `parameters` need.
    pub fn of(parameters: &Parameters) -> Self {
        let com = parameters.platform.com_m;
        if com.x == 0.0 && com.y == 0.0 {
            Self::Centred
        } else {
            Self::Offset
        }
    }

    /// The Rust type for the number type `scalar`.
    pub fn path(self, scalar: &str) -> String {
        format!("trirrr_core::torque::payload::{self:?}<{scalar}>")
    }
}

impl LinksKind {
    /// The least that `parameters` need.
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

    /// The Rust type for the number type `scalar`.
    pub fn path(self, scalar: &str) -> String {
        let links = "trirrr_core::torque::links";
        match self {
            Self::Massless => format!("{links}::Massless"),
            Self::Rotors => format!("{links}::Rotors<{scalar}>"),
            Self::MassiveHorizontal => format!("{links}::Massive<{scalar}, {links}::Horizontal>"),
            Self::MassiveInPlane => {
                format!("{links}::Massive<{scalar}, {links}::InPlane<{scalar}>>")
            }
        }
    }
}
