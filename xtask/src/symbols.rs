//! Contents of an image, read from its symbols: a scene pays only for what it uses.
//!
//! Symbols are mangled as version v0 (`.cargo/config.toml`), so that the name of a function says for
//! which types it was made: the whole service carries its number type, payload and links, inlined or
//! not. What has no type of its own is seen by its functions, as far as they are not inlined: the
//! formatting of values, and floats that are computed in software. Each mark has to be there in an image
//! that uses it, too: a mark that nothing leaves would show nothing.

use crate::elf::{Elf, with_elf};
use anyhow::{Result, ensure};
use object::{Object, ObjectSymbol};
use std::path::Path;
use trirrr_core::model::ModelKind;
use trirrr_core::torque::{links::LinksKind, payload::PayloadKind};
use trirrr_image::generate::{kind, of_scene};
use trirrr_scene::Scene;

/// Something that an image holds or not.
struct Mark {
    /// Name of the thing, for messages.
    what: &'static str,
    /// Parts of the symbol names that come with it; any of them counts.
    names: &'static [&'static str],
    /// Test that is true for a scene that has use for it.
    used: fn(&Scene) -> bool,
}

/// Symbol that only images for an emulator hold, with the feature `ruled-switches`.
pub(crate) const RULED_SWITCHES: &str = "13RuledSwitches";

/// Symbol that only images hold whose line is USB, by the build.
pub(crate) const USB_LINE: &str = "14UsbTransmitter";

/// Part of the names in an image without a host.
const OWN_JOB: &str = "7own_job";

/// Returns true if a host talks to the machine of the scene.
fn has_host(scene: &Scene) -> bool {
    scene.service.autonomous.is_none()
}

const MARKS: &[Mark] = &[
    Mark {
        what: "torques",
        names: &["7Centred", "6Offset", "7torques", "7Balance", "7Dynamic"],
        used: |scene| scene.torque,
    },
    Mark {
        what: "an offset payload",
        names: &["6Offset"],
        used: |scene| matches!(scene.model(), ModelKind::Dynamic(PayloadKind::Offset, _)),
    },
    Mark {
        what: "link inertia",
        names: &["7Massive"],
        used: |scene| {
            use LinksKind::{MassiveHorizontal, MassiveInPlane};
            let kind = scene.model();
            matches!(
                kind,
                ModelKind::Dynamic(_, MassiveHorizontal | MassiveInPlane)
            )
        },
    },
    Mark {
        what: "gravity on the links",
        names: &["7InPlane"],
        used: |scene| {
            matches!(
                scene.model(),
                ModelKind::Dynamic(_, LinksKind::MassiveInPlane)
            )
        },
    },
    Mark {
        what: "rotor inertia without links",
        names: &["6Rotors"],
        used: |scene| matches!(scene.model(), ModelKind::Dynamic(_, LinksKind::Rotors)),
    },
    Mark {
        what: "fixed point",
        names: &["5Fixed"],
        used: |scene| of_scene(scene.number) == "fixed",
    },
    Mark {
        what: "steppers",
        names: &["6drives7stepper5build"],
        used: |scene| kind(scene) == "stepper",
    },
    Mark {
        what: "brushless motors",
        names: &["6drives4bldc5build"],
        used: |scene| kind(scene) == "bldc",
    },
    Mark {
        what: "CAN drives",
        names: &["6drives3can5build"],
        used: |scene| matches!(kind(scene), "odrive" | "mit" | "moteus"),
    },
    Mark {
        what: "a tool",
        names: &["4duty5build", "4tool5level5build"],
        used: |scene| scene.tool.is_some(),
    },
    Mark {
        what: "homing",
        names: &["5Cycle", "14HomingSwitches"],
        used: |scene| scene.homing.is_some(),
    },
    Mark {
        what: "interlocks",
        names: &["10Interlocks"],
        used: |scene| scene.inputs.are_named(),
    },
    Mark {
        what: "contacts",
        names: &["13GuardedInputs"],
        used: |scene| scene.inputs.have_contacts(),
    },
    Mark {
        what: "a job of its own",
        names: &[OWN_JOB],
        used: |scene| scene.service.autonomous.is_some(),
    },
    Mark {
        what: "an admission",
        names: &["11TaylorModel"],
        used: has_host,
    },
    Mark {
        what: "a background",
        names: &["10background"],
        used: has_host,
    },
    Mark {
        what: "frames of a line",
        names: &["4wire"],
        used: has_host,
    },
    Mark {
        what: "a log",
        names: &["_defmt_write"],
        used: has_host,
    },
    Mark {
        what: "a status lamp",
        names: &["7LampPin"],
        used: |scene| scene.has_lamp,
    },
    Mark {
        what: "spare outputs or inputs",
        names: &["13DigitalPlayer", "12SpareOutputs"],
        used: |scene| scene.spare_pins.are_named(),
    },
    Mark {
        what: "a probe",
        names: &["10ProbeLatch", "11apply_probe"],
        used: |scene| scene.inputs.interlocks.probe.is_some(),
    },
    Mark {
        what: "power lists",
        names: &["10MoveLevels", "11LevelPlayer"],
        used: |scene| scene.service.power_lists > 0,
    },
    Mark {
        what: "a scene that clients may change",
        names: &["10Adjustable", "10background5parts"],
        used: |scene| scene.service.adjustable,
    },
    Mark {
        what: "a scene from the line",
        names: &["12stored_scene"],
        used: |scene| scene.service.scene_over_line,
    },
    Mark {
        what: "feedback",
        names: &["10DriveWatch", "12sends_drives"],
        used: |scene| scene.feedback.is_some(),
    },
    Mark {
        what: "contact detection",
        names: &["12ContactModel", "12ContactWatch"],
        used: |scene| scene.contact.is_some(),
    },
    Mark {
        what: "switches that close by rule",
        names: &[RULED_SWITCHES],
        used: |_| false,
    },
    Mark {
        what: "a line over USB",
        names: &[USB_LINE, "10usb_device"],
        used: |_| false,
    },
    Mark {
        what: "values as text",
        names: &["9Formatter", "7Display3fmt", "5Debug3fmt", "7flt2dec"],
        used: |_| false,
    },
];

/// Routines for binary64, by their names in the run-time ABI for Arm: arithmetic, comparisons and
/// conversions.
const DOUBLE_PRECISION: &[&str] = &[
    "__aeabi_d",
    "__aeabi_f2d",
    "__aeabi_i2d",
    "__aeabi_ui2d",
    "__aeabi_l2d",
    "__aeabi_ul2d",
];

/// The same for binary32, but for conversions of 64-bit integers, which no FPU has.
const SINGLE_PRECISION: &[&str] = &["__aeabi_f", "__aeabi_i2f", "__aeabi_ui2f"];

/// Checks the image of `scene`: its parts, and its arithmetic. Nothing computes in software what the FPU
/// does, if there is one (`has_fpu`); without one binary32 is computed so, in which moves are admitted there.
///
/// # Errors
/// What it holds without use, with a symbol that says so; what it should hold and nothing shows.
pub(crate) fn check(elf: &Elf, scene: &Scene, has_fpu: bool) -> Result<()> {
    let names = names(elf);
    check_names(&names, scene)?;
    // Without an admission nothing is in binary32 but numbers of that type.
    let has_floats = has_host(scene) || of_scene(scene.number) != "fixed";
    check_routines(&names, has_fpu || !has_floats, scene.service.adjustable)
}

fn names<'data>(elf: &Elf<'data>) -> Vec<&'data str> {
    let symbols = elf.symbols();
    symbols.filter_map(|symbol| symbol.name().ok()).collect()
}

fn check_routines(names: &[&str], has_fpu: bool, is_adjustable: bool) -> Result<()> {
    let is_of = |name: &str, routines: &[&str]| routines.iter().any(|part| name.starts_with(part));
    let double = names.iter().find(|name| is_of(name, DOUBLE_PRECISION));
    // A conversion to binary64 begins as a routine for binary32 does.
    let single = names
        .iter()
        .find(|name| is_of(name, SINGLE_PRECISION) && !is_of(name, DOUBLE_PRECISION));
    // An adjustable board computes its coefficients from lengths and masses in binary64, between jobs.
    if let Some(symbol) = double
        && !is_adjustable
    {
        anyhow::bail!("no board computes in binary64: {symbol}");
    }
    match (single, has_fpu) {
        (Some(symbol), true) => {
            anyhow::bail!("there is an FPU, and binary32 is computed in software: {symbol}")
        }
        (None, false) => anyhow::bail!(
            "there is no FPU, and no symbol shows binary32: {}",
            SINGLE_PRECISION.join(", ")
        ),
        (Some(_), false) | (None, true) => Ok(()),
    }
}

/// Checks that the image in `file` has what `mark` shows, and that this would be seen in one that should not have it.
///
/// # Errors
/// No symbol shows it.
pub(crate) fn check_mark(file: &Path, mark: &str) -> Result<()> {
    with_elf(file, |elf| {
        let is_shown = names(elf).iter().any(|name| name.contains(mark));
        ensure!(is_shown, "no symbol shows {mark}");
        Ok(())
    })
}

fn check_names(names: &[&str], scene: &Scene) -> Result<()> {
    for mark in MARKS {
        let is_marked = |name: &&&str| mark.names.iter().any(|part| name.contains(part));
        let found = names.iter().find(is_marked);
        match (found, (mark.used)(scene)) {
            (Some(symbol), false) => {
                anyhow::bail!(
                    "scene {} has no use for {}: {symbol}",
                    scene.name,
                    mark.what
                )
            }
            // The tick of a small image is one function: what it holds shows in images with a host.
            (None, true) if !has_host(scene) && !mark.names.contains(&OWN_JOB) => {}
            (found, true) => ensure!(
                found.is_some(),
                "scene {} uses {}, which no symbol shows: {}",
                scene.name,
                mark.what,
                mark.names.join(", ")
            ),
            (None, false) => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repository::scenes_named;

    fn complaint(scene: &str, names: &[&str]) -> Option<String> {
        let files = scenes_named(&[scene.into()]).expect("a shipped scene");
        let scene = Scene::read(&files[0].path).expect("a good scene");
        check_names(names, &scene)
            .err()
            .map(|error| error.to_string())
    }

    #[test]
    fn what_is_held_without_use_is_named_with_its_symbol() {
        let centred = "_RNv7payload7CentredNtB2_";
        let own: Vec<&str> = [centred].into_iter().chain(OF_HOST).collect();
        assert_eq!(complaint("thesis", &own), None);
        for (symbol, what) in [
            ("_RNv5links7Massive", "link inertia"),
            ("_RNv7payload6Offset", "an offset payload"),
            ("_RNv6number5fixed5Fixed", "fixed point"),
            ("_RNv6drives4bldc5build", "brushless motors"),
            ("_RNv4duty5build", "a tool"),
            ("_RNv6homing5cycle5Cycle7advance", "homing"),
            ("_RNv9interlock10Interlocks5sense", "interlocks"),
            ("_RNv5interlock5probe10ProbeLatch4read", "a probe"),
            ("_RNv4lamp7LampPin4show", "a status lamp"),
            (
                "_RNv7digital6player13DigitalPlayer5begin",
                "spare outputs or inputs",
            ),
            ("_RNv6levels4list10MoveLevels", "power lists"),
            ("_RNv3app12stored_scene6played", "a scene from the line"),
            (
                "_RNv8switches13RuledSwitches6closed",
                "switches that close by rule",
            ),
            ("_RNv4core3num7flt2dec", "values as text"),
            (
                "_RNvXs_NtNtNt4core3fmt3num3impmNtB_7Display3fmt",
                "values as text",
            ),
        ] {
            let said = complaint("thesis", &[&own[..], &[symbol]].concat()).expect(what);
            assert!(said.contains(what) && said.contains(symbol), "{said}");
        }
    }

    /// Symbols of an image whose machine a host talks to.
    const OF_HOST: [&str; 4] = [
        "_RNv5model11TaylorModel3add",
        "_RNv7service10background4step",
        "_RNv8protocol4wire6encode",
        "_defmt_write",
    ];

    #[test]
    fn an_image_without_a_host_has_nothing_of_one() {
        let own = "_RNv7service7own_job15take_own_order";
        let scene = "autonomous/thesis-alone";
        assert_eq!(complaint(scene, &[own]), None);
        assert!(complaint(scene, &[]).is_some_and(|said| said.contains("a job of its own")));
        for symbol in OF_HOST {
            let said = complaint(scene, &[own, symbol]).expect(symbol);
            assert!(said.contains(symbol), "{said}");
        }
    }

    #[test]
    fn floats_in_software_are_named_by_their_routine() {
        let complaint = |names: &[&str], has_fpu| {
            let found = check_routines(names, has_fpu, false).err();
            found.map(|error| error.to_string())
        };
        let other = [
            "__aeabi_memcpy4",
            "__aeabi_lmul",
            "__aeabi_l2f",
            "_R6offset",
        ];
        assert_eq!(complaint(&other, true), None);
        assert!(complaint(&other, false).is_some());
        for single in ["__aeabi_fmul", "__aeabi_fcmpge", "__aeabi_ui2f"] {
            let names = [other[0], single];
            assert_eq!(complaint(&names, false), None);
            let said = complaint(&names, true).expect(single);
            assert!(said.contains("binary32") && said.contains(single), "{said}");
        }
        for double in [
            "__aeabi_dcmplt",
            "__aeabi_f2d",
            "__aeabi_l2d",
            "__aeabi_ddiv",
        ] {
            let said = complaint(&["__aeabi_fadd", double], false).expect(double);
            assert!(said.contains("binary64") && said.contains(double), "{said}");
        }
    }

    #[test]
    fn a_mark_that_nothing_leaves_is_an_error() {
        let said = complaint("thesis-links", &["_RNv7payload7Centred"]).expect("links");
        assert!(
            said.contains("link inertia, which no symbol shows"),
            "{said}"
        );
    }
}
