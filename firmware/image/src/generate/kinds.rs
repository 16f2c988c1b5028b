//! The Rust types of the kinds that a machine needs, so that its image holds nothing else.

use super::constant::constant;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{BuildError, LinksKind, Parameters, PayloadKind};
use trirrr_core::torque::links::{Horizontal, InPlane, Links, Massive, Massless, Rotors};
use trirrr_core::torque::payload::{Centred, Offset, Payload, PositionOnly};
use trirrr_service::Coefficients;
use trirrr_service::admission::Enclose;

/// What the coefficients are built from, in the machine's units.
pub(super) struct Machine<'a> {
    pub(super) torque: bool,
    pub(super) parameters: &'a Parameters,
    pub(super) limits: &'a LimitParameters,
    pub(super) ramp_ticks: u16,
    pub(super) period: f64,
}

impl Machine<'_> {
    /// The Rust type of its payload for the number type `scalar`.
    pub(super) fn payload_path(&self, scalar: &str) -> String {
        let payload = "trirrr_core::torque::payload";
        match PayloadKind::of(self.parameters) {
            _ if !self.torque => format!("{payload}::PositionOnly"),
            kind => format!("{payload}::{kind:?}<{scalar}>"),
        }
    }

    /// The Rust type of its links for the number type `scalar`.
    pub(super) fn links_path(&self, scalar: &str) -> String {
        let links = "trirrr_core::torque::links";
        match LinksKind::of(self.parameters) {
            _ if !self.torque => format!("{links}::Massless"),
            LinksKind::Massless => format!("{links}::Massless"),
            LinksKind::Rotors => format!("{links}::Rotors<{scalar}>"),
            LinksKind::MassiveHorizontal => {
                format!("{links}::Massive<{scalar}, {links}::Horizontal>")
            }
            LinksKind::MassiveInPlane => {
                format!("{links}::Massive<{scalar}, {links}::InPlane<{scalar}>>")
            }
        }
    }

    /// The coefficients of its service in those types, as Rust source.
    ///
    /// # Errors
    /// The first quantity that does not fit the number type.
    pub(super) fn coefficients<N: Enclose>(&self) -> Result<String, BuildError> {
        match PayloadKind::of(self.parameters) {
            _ if !self.torque => self.with::<N, PositionOnly, Massless>(),
            PayloadKind::Centred => self.with_payload::<N, Centred<N>>(),
            PayloadKind::Offset => self.with_payload::<N, Offset<N>>(),
        }
    }

    fn with_payload<N: Enclose, P: Payload<N>>(&self) -> Result<String, BuildError> {
        match LinksKind::of(self.parameters) {
            LinksKind::Massless => self.with::<N, P, Massless>(),
            LinksKind::Rotors => self.with::<N, P, Rotors<N>>(),
            LinksKind::MassiveHorizontal => self.with::<N, P, Massive<N, Horizontal>>(),
            LinksKind::MassiveInPlane => self.with::<N, P, Massive<N, InPlane<N>>>(),
        }
    }

    fn with<N: Enclose, P: Payload<N>, L: Links<N>>(&self) -> Result<String, BuildError> {
        Coefficients::<N, P, L>::build(self.parameters, self.limits, self.ramp_ticks, self.period)
            .map(|coefficients| constant(&coefficients))
    }
}
