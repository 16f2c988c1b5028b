//! Reads the machine and its loads into the core's [`Parameters`].

use crate::drive::Drive;
use crate::read::{Bound, Section};
use crate::tools::{ToolRack, read_tools};
use nalgebra::Vector2;
use trirrr_core::machine::{Elbow, LegParameters, LinkParameters, Parameters, PlatformParameters};

/// A centre of mass further from its joint than this many link lengths, or from the platform's
/// reference point than this many reaches of the longest leg, is a slip of the unit.
const FARTHEST_CENTRE_OF_MASS: f64 = 10.0;

/// A link as the file gives it; what is left out depends on the link's length.
#[derive(Clone, Copy)]
struct GivenLink {
    mass_kg: f64,
    com_m: Option<f64>,
    inertia_kgm2: Option<f64>,
}

/// The links of a leg, each `None` where the file does not say.
#[derive(Clone, Copy, Default)]
struct GivenLinks {
    proximal: Option<GivenLink>,
    distal: Option<GivenLink>,
}

/// A machine with any number of legs, and its loads.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineTables {
    /// Legs in the order of the file, about the tool point. Rotor inertias are 0.
    pub legs: Vec<LegParameters>,
    /// The platform, about its tool point.
    pub platform: PlatformParameters,
    /// Gravity in the plane, m/s^2.
    pub gravity_m_s2: [f64; 2],
    /// Force on the platform at D, N.
    pub wrench_force_n: [f64; 2],
    /// Moment on the platform, N m.
    pub wrench_torque_nm: f64,
}

/// Reads `[machine]`, `[platform]`, `[[tools]]`, `[links]`, `gravity_m_s2` and `[wrench]`. `drives` gives the
/// rotor inertias. The platform carries the tool that is mounted.
pub(crate) fn read_parameters(
    root: &Section,
    drives: Option<[Drive; 3]>,
) -> Option<(Parameters, Option<ToolRack>)> {
    let tables = read_machine(root, 3, |_, _| ());
    let rack = read_tools(root);
    let tables = tables?;
    let mut legs: [LegParameters; 3] = tables.legs.try_into().ok()?;
    for (leg, drive) in legs.iter_mut().zip(drives.iter().flatten()) {
        leg.rotor_inertia_kgm2 = drive.inertia_at_joint_kgm2();
    }
    let bare = Parameters {
        legs,
        platform: tables.platform,
        gravity_m_s2: tables.gravity_m_s2.into(),
        wrench_force_n: tables.wrench_force_n.into(),
        wrench_torque_nm: tables.wrench_torque_nm,
    };
    Some(match rack? {
        Some((tools, mounted)) => {
            let rack = ToolRack::new(bare.platform, tools, mounted);
            (rack.put_into(&bare, rack.mounted()), Some(rack))
        }
        None => (bare, None),
    })
}

/// Reads `[machine]` with `count` legs, `[platform]`, `[links]`, `gravity_m_s2` and `[wrench]`. `each` reads what a leg has
/// besides; its first argument is the number of the leg, from 0.
pub fn read_machine(
    root: &Section,
    count: usize,
    each: impl FnMut(usize, &Section),
) -> Option<MachineTables> {
    let common = read_links(root, "links");
    let legs = read_legs(root, common.unwrap_or_default(), count, each);
    let platform = read_platform(root, legs.as_deref());
    let gravity = root.vector("gravity_m_s2", Some([0.0; 2]));
    let (force, torque) = match root.optional_section("wrench") {
        Some(wrench) => (
            wrench.vector("force_n", Some([0.0; 2])),
            wrench.number_or("torque_nm", Bound::Finite, 0.0),
        ),
        None => (Some([0.0; 2]), Some(0.0)),
    };
    let (legs, platform) = (legs?, platform?);
    let by = platform.tool_point_m;
    // The bits of a machine without a tool point of its own stay.
    let legs = match by == Vector2::zeros() {
        true => legs,
        false => legs
            .iter()
            .map(|leg| leg.with_reference_moved(by))
            .collect(),
    };
    Some(MachineTables {
        legs,
        platform,
        gravity_m_s2: gravity?,
        wrench_force_n: force?,
        wrench_torque_nm: torque?,
    })
}

fn read_legs(
    root: &Section,
    common: GivenLinks,
    count: usize,
    mut each: impl FnMut(usize, &Section),
) -> Option<Vec<LegParameters>> {
    let machine = root.section("machine")?;
    let sections = machine.sections("leg")?;
    let mut legs = Vec::with_capacity(sections.len());
    for (index, section) in sections.iter().enumerate() {
        legs.push(read_leg(section, common));
        each(index, section);
    }
    if sections.len() != count {
        let numbers = [(3, "three"), (4, "four"), (6, "six")];
        let number = numbers.iter().find(|(number, _)| *number == count);
        let number = number.map_or_else(|| count.to_string(), |(_, word)| (*word).into());
        let found = sections.len();
        let reason = format!("expected {number} [[machine.leg]], found {found}");
        machine.refuse_list("leg", reason);
        return None;
    }
    legs.into_iter().collect()
}

fn read_leg(section: &Section, common: GivenLinks) -> Option<LegParameters> {
    let base = section.vector("base_m", None);
    let proximal_m = section.number("proximal_m", Bound::Positive);
    let distal_m = section.number("distal_m", Bound::Positive);
    let joint_radius = section.number("joint_radius_m", Bound::NotNegative);
    let joint_angle = section.number("joint_angle_rad", Bound::TwoTurns);
    let elbow = read_elbow(section);
    let own = read_links(section, "links")?;
    let proximal = own.proximal.or(common.proximal);
    let distal = own.distal.or(common.distal);
    let (proximal_m, distal_m) = (proximal_m?, distal_m?);
    let proximal = build_link(section, "proximal_m", proximal, proximal_m);
    let distal = build_link(section, "distal_m", distal, distal_m);
    Some(LegParameters {
        base_m: base?.into(),
        proximal_m,
        distal_m,
        joint_radius_m: joint_radius?,
        joint_angle_rad: joint_angle?,
        elbow: elbow?,
        proximal: proximal?,
        distal: distal?,
        rotor_inertia_kgm2: 0.0,
    })
}

fn read_elbow(section: &Section) -> Option<Elbow> {
    let sign = section.sign("elbow")?;
    Some(match sign > 0.0 {
        true => Elbow::Positive,
        false => Elbow::Negative,
    })
}

/// Reads a table of links; all massless where it is left out.
fn read_links(section: &Section, key: &'static str) -> Option<GivenLinks> {
    if !section.has(key) {
        return Some(GivenLinks::default());
    }
    let links = section.section(key)?;
    let (proximal, distal) = (read_link(&links, "proximal"), read_link(&links, "distal"));
    Some(GivenLinks {
        proximal: proximal?,
        distal: distal?,
    })
}

/// `Some(None)`: the link is not mentioned.
fn read_link(links: &Section, key: &'static str) -> Option<Option<GivenLink>> {
    if !links.has(key) {
        return Some(None);
    }
    let section = links.section(key)?;
    let mass = section.number("mass_kg", Bound::NotNegative);
    let com_m = section.optional_number("com_m", Bound::Finite);
    let inertia_kgm2 = section.optional_number("inertia_kgm2", Bound::NotNegative);
    Some(Some(GivenLink {
        mass_kg: mass?,
        com_m,
        inertia_kgm2,
    }))
}

/// Fills in what the file leaves out as a uniform rod of `length` has it; massless where the file
/// does not mention the link. `key` is the length's, to point at.
fn build_link(
    leg: &Section,
    key: &'static str,
    link: Option<GivenLink>,
    length: f64,
) -> Option<LinkParameters> {
    let Some(link) = link else {
        return Some(LinkParameters::default());
    };
    let rod = LinkParameters::uniform_rod(link.mass_kg, length);
    let built = LinkParameters {
        mass_kg: link.mass_kg,
        com_m: link.com_m.unwrap_or(rod.com_m),
        inertia_kgm2: link.inertia_kgm2.unwrap_or(rod.inertia_kgm2),
    };
    if built.com_m.abs() > FARTHEST_CENTRE_OF_MASS * length {
        let reason = format!(
            "the centre of mass of this link, com_m = {:?}, is more than \
             {FARTHEST_CENTRE_OF_MASS} link lengths from its joint (m)",
            built.com_m
        );
        leg.refuse(key, reason);
        return None;
    }
    if !built.inertia_kgm2.is_finite() {
        leg.refuse(key, "the link's moment of inertia is not a finite number");
        return None;
    }
    Some(built)
}

fn read_platform(root: &Section, legs: Option<&[LegParameters]>) -> Option<PlatformParameters> {
    let section = root.section("platform")?;
    let mass = section.number("mass_kg", Bound::NotNegative);
    let inertia = section.number("inertia_kgm2", Bound::NotNegative);
    let com: Vector2<f64> = section.vector("com_m", Some([0.0; 2]))?.into();
    let tool: Vector2<f64> = section.vector("tool_point_m", Some([0.0; 2]))?.into();
    if section.has("tool_point_m") && root.has("tools") {
        let reason = "each of [[tools]] has a point_m of its own: leave this out";
        section.refuse("tool_point_m", reason);
        return None;
    }
    if let Some(legs) = legs {
        let reaches = legs.iter().map(|leg| leg.proximal_m + leg.distal_m);
        let reach = reaches.fold(0.0, f64::max);
        for (key, place) in [("com_m", com), ("tool_point_m", tool)] {
            if place.x.abs().max(place.y.abs()) > FARTHEST_CENTRE_OF_MASS * reach {
                let reason = format!(
                    "is more than {FARTHEST_CENTRE_OF_MASS} times the reach of the longest leg, \
                     {reach:?} m, from the reference point (m)"
                );
                section.refuse(key, reason);
                return None;
            }
        }
    }
    let platform = PlatformParameters {
        mass_kg: mass?,
        inertia_kgm2: inertia?,
        com_m: com,
        tool_point_m: Vector2::zeros(),
    };
    Some(platform.at_tool_point(tool))
}
