//! `[io]`: what a board shows of the machine.

use crate::read::Section;

/// Reads `[io]`. Returns true if the machine has a status lamp.
pub(crate) fn read_lamp(root: &Section) -> Option<bool> {
    match root.has("io") {
        true => root.section("io")?.boolean("lamp"),
        false => Some(false),
    }
}
