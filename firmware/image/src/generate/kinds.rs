//! The Rust types of the kinds that a machine needs, so that its image holds nothing else.

use trirrr_core::machine::{LinksKind, PayloadKind};

/// The Rust type of a payload for the number type `scalar`.
pub(super) fn payload_path(kind: PayloadKind, scalar: &str) -> String {
    format!("trirrr_core::torque::payload::{kind:?}<{scalar}>")
}

/// The Rust type of links for the number type `scalar`.
pub(super) fn links_path(kind: LinksKind, scalar: &str) -> String {
    let links = "trirrr_core::torque::links";
    match kind {
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
