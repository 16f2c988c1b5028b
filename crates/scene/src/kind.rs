//! Kind of machine that a scene describes.

use crate::read::{Section, Setting, text_of, with_scene};
use std::path::Path;

/// Key of the kind, at the top of a scene.
const KIND: &str = "kind";

/// A machine of the source's table 1.1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MachineKind {
    /// 3-RRR: three legs, three motors. [`Scene`](crate::Scene) describes it.
    ThreeRrr,
    /// 4-RRR: a fourth leg with a motor.
    FourRrr,
    /// 6-RRR: six legs with a motor each.
    SixRrr,
    /// PRRR+2RRR: one base joint on a slider.
    PrrrTwoRrr,
    /// 2PRRR+RRR: two base joints on sliders.
    TwoPrrrRrr,
    /// 3PRRR: three base joints on sliders.
    ThreePrrr,
}

impl MachineKind {
    /// All kinds by the names that scenes use.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("3rrr", Self::ThreeRrr),
        ("4rrr", Self::FourRrr),
        ("6rrr", Self::SixRrr),
        ("prrr-2rrr", Self::PrrrTwoRrr),
        ("2prrr-rrr", Self::TwoPrrrRrr),
        ("3prrr", Self::ThreePrrr),
    ];

    /// Name in scenes.
    pub fn name(self) -> &'static str {
        let named = Self::NAMES.iter().find(|(_, kind)| *kind == self);
        named.map_or("", |(name, _)| name)
    }

    /// Number of legs, each with a motor.
    pub fn legs(self) -> usize {
        match self {
            Self::FourRrr => 4,
            Self::SixRrr => 6,
            _ => 3,
        }
    }

    /// Number of legs whose base joint rides on a slider.
    pub fn sliders(self) -> usize {
        match self {
            Self::PrrrTwoRrr => 1,
            Self::TwoPrrrRrr => 2,
            Self::ThreePrrr => 3,
            _ => 0,
        }
    }

    /// Returns true for a machine with more motors or sliders than the platform has freedoms.
    pub fn is_redundant(self) -> bool {
        self != Self::ThreeRrr
    }

    /// Kind of the machine in `file`, with `settings` in place of its own values. A file that is refused is taken for
    /// a 3-RRR, whose reader says why.
    pub fn of_file(file: &Path, settings: &[Setting]) -> Self {
        let text = text_of(file).unwrap_or_default();
        let name = file.display().to_string();
        let kind = with_scene(&text, &name, settings, &[], |_, root, _| {
            root.ignore_rest();
            read_kind(root)
        });
        kind.unwrap_or(Self::ThreeRrr)
    }
}

/// Reads `kind`: the 3-RRR where it is left out.
pub fn read_kind(root: &Section) -> Option<MachineKind> {
    match root.has(KIND) {
        true => root.choice(KIND, &MachineKind::NAMES),
        false => Some(MachineKind::ThreeRrr),
    }
}

/// Refuses a redundant machine, for a reader that knows the 3-RRR alone.
pub(crate) fn refuse_redundant(root: &Section) -> Option<()> {
    let kind = read_kind(root)?;
    if kind.is_redundant() {
        let reason = "is a redundant machine: `trirrr run` and `trirrr check` play and check its job; \
                      boards, streams, planning, designs, calibration and identification are for a 3-RRR";
        root.refuse(KIND, reason);
        root.ignore_rest();
        return None;
    }
    Some(())
}
