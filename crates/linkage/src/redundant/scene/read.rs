//! Reads a scene of a redundant machine.

use super::check::{check_job, check_machine};
use super::sliders::{RedundantSlider, read_slider};
use super::{RedundantLimits, RedundantLoop, RedundantScene, TICKS_MAX};
use std::path::Path;
use trirrr_core::limits::LimitParameters;
use trirrr_scene::read::{Bound, Document, Section, Setting, text_of, with_scene};
use trirrr_scene::tables::{PlacedJob, read_job_with, read_kind, read_machine, read_rate};
use trirrr_scene::{MachineKind, SceneError};

const TOP_KEYS: &[&str] = &[
    "kind",
    "name",
    "description",
    "machine",
    "tick_rate_hz",
    "gravity_m_s2",
];

/// Keys and tables that only a 3-RRR has, with the reason.
const OF_3RRR: [(&str, &str); 11] = [
    ("number", "a redundant machine is computed in f64"),
    ("torque", "a redundant machine always has torques"),
    ("drive", DRIVES),
    ("controller", LOOPS),
    ("service", SERVICE),
    ("power", SERVICE),
    ("faults", SERVICE),
    ("feedback", SERVICE),
    ("contact", SERVICE),
    ("homing", SERVICE),
    (
        "tolerances",
        "bounds for inexact parts are those of a 3-RRR",
    ),
];
const DRIVES: &str =
    "no board drives a redundant machine; give rotor_inertia_kgm2 in [[machine.leg]]";
const LOOPS: &str = "loops of a redundant machine stand in [plant]";
const SERVICE: &str = "a redundant machine has no service on a board";

impl RedundantScene {
    /// Reads and checks the scene in `file`, with `settings` in place of its own values.
    ///
    /// # Errors
    /// [`SceneError`] with everything found wrong.
    pub fn read_set(file: impl AsRef<Path>, settings: &[Setting]) -> Result<Self, SceneError> {
        let file = file.as_ref();
        Self::parse_set(&text_of(file)?, &file.display().to_string(), settings)
    }

    /// Checks the scene in `text`; `file` is named in errors.
    ///
    /// # Errors
    /// [`SceneError::Refused`] with everything found wrong. The job is only looked at once nothing else is wrong.
    pub fn parse_set(text: &str, file: &str, settings: &[Setting]) -> Result<Self, SceneError> {
        with_scene(text, file, settings, TOP_KEYS, |document, root, _| {
            let (mut scene, placed) = read(document, root)?;
            if document.is_clean() && check_machine(root, &mut scene) {
                check_job(document, &scene, &placed);
            }
            Some(scene)
        })
    }
}

fn read(document: &Document, root: &Section) -> Option<(RedundantScene, PlacedJob)> {
    for (key, reason) in OF_3RRR {
        if root.has(key) {
            root.refuse_list(key, reason);
        }
    }
    let kind = read_kind(root);
    if kind == Some(MachineKind::ThreeRrr) {
        root.refuse("kind", "is no redundant machine");
    }
    let Some(kind) = kind else {
        // Numbers of legs and sliders depend on it.
        root.ignore_rest();
        return None;
    };
    let name = root.folder_name("name");
    let description = root.optional_text("description").unwrap_or_default();
    let rate = read_rate(root);
    let mut own = Vec::new();
    let machine = read_machine(root, kind.legs(), |_, leg| own.push(read_leg(leg)));
    let with_slider = own.iter().flatten().filter(|leg| leg.slider.is_some());
    let found = with_slider.count();
    if machine.is_some() && own.iter().all(Option::is_some) && found != kind.sliders() {
        let reason = match kind.sliders() {
            0 => "a machine of this kind has no slider".into(),
            1 => "a machine of this kind has one leg with a slider".into(),
            count => format!("a machine of this kind has {count} legs with a slider"),
        };
        root.refuse("kind", format!("{reason}, found {found}"));
    }
    let limits = read_redundant_limits(root, kind.legs());
    let plant = read_loop(root);
    let mut ends = Vec::new();
    let count = kind.sliders();
    let placed = match is_path(root) {
        true => None,
        false => read_job_with(document, root, rate, |each| {
            ends.push(read_slider_ends(each, count));
            if each.has("tool") {
                each.refuse("tool", SERVICE);
            }
            Default::default()
        }),
    };
    let own: Vec<OwnLeg> = own.into_iter().collect::<Option<_>>()?;
    let ends: Vec<_> = ends.into_iter().collect::<Option<_>>()?;
    let (machine, placed) = (machine?, placed?);
    let sliders: Vec<_> = own.iter().map(|leg| leg.slider).collect();
    let slider_moves = slider_positions(document, &placed, &sliders, &ends)?;
    if placed.job.ticks() > TICKS_MAX {
        let reason = format!(
            "the moves take {} ticks together, at most {TICKS_MAX} are allowed: each is checked",
            placed.job.ticks()
        );
        root.refuse_list("job", reason);
        return None;
    }
    let mut legs = machine.legs;
    for (leg, own) in legs.iter_mut().zip(&own) {
        leg.rotor_inertia_kgm2 = own.rotor_inertia_kgm2;
    }
    let scene = RedundantScene {
        kind,
        name: name?,
        description: description.into_owned(),
        tick_rate_hz: rate?,
        legs,
        sliders,
        preload_nm: own.iter().map(|leg| leg.preload_nm).collect(),
        platform: machine.platform,
        gravity_m_s2: machine.gravity_m_s2,
        wrench_force_n: machine.wrench_force_n,
        wrench_torque_nm: machine.wrench_torque_nm,
        limits: limits?,
        job: placed.job.clone(),
        slider_moves,
        placement: None,
        plant: plant?,
    };
    Some((scene, placed))
}

/// Keys of a leg that the leg of a 3-RRR does not have.
struct OwnLeg {
    rotor_inertia_kgm2: f64,
    preload_nm: f64,
    slider: Option<RedundantSlider>,
}

fn read_leg(leg: &Section) -> Option<OwnLeg> {
    let rotor = leg.number_or("rotor_inertia_kgm2", Bound::NotNegative, 0.0);
    let preload = leg.number_or("preload_nm", Bound::Finite, 0.0);
    let slider = read_slider(leg);
    Some(OwnLeg {
        rotor_inertia_kgm2: rotor?,
        preload_nm: preload?,
        slider: slider?,
    })
}

fn read_redundant_limits(root: &Section, legs: usize) -> Option<RedundantLimits> {
    let section = match root.has("limits") {
        true => Some(root.section("limits")?),
        false => None,
    };
    let motors = |key| match &section {
        Some(section) if section.has(key) => {
            section.number_or_each(key, Bound::Positive, legs).map(Some)
        }
        _ => Some(None),
    };
    let least = |key, default| match &section {
        Some(section) => section.number_or(key, Bound::Fraction, default),
        None => Some(default),
    };
    let rate = motors("rate_rad_s");
    let acceleration = motors("acceleration_rad_s2");
    let torque = motors("torque_nm");
    let power = motors("power_w");
    let serial = least("serial_distance_min", LimitParameters::SERIAL_DISTANCE_MIN);
    let parallel = least(
        "parallel_distance_min",
        LimitParameters::PARALLEL_DISTANCE_MIN,
    );
    Some(RedundantLimits {
        rate_rad_s: rate?,
        acceleration_rad_s2: acceleration?,
        torque_nm: torque?,
        power_w: power?,
        serial_distance_min: serial?,
        parallel_distance_min: parallel?,
    })
}

/// Reads `[plant]`: `Some(None)` where it is left out.
fn read_loop(root: &Section) -> Option<Option<RedundantLoop>> {
    if !root.has("plant") {
        return Some(None);
    }
    let section = root.section("plant")?;
    let gain = |key| section.number_or(key, Bound::NotNegative, 0.0);
    let [kp, kd] = ["kp_nm_rad", "kd_nm_s_rad"].map(gain);
    let [slider_kp, slider_kd] = ["slider_kp_n_m", "slider_kd_n_s_m"].map(gain);
    let feed_forward = match section.has("feed_forward") {
        true => section.boolean("feed_forward"),
        false => Some(true),
    };
    let [friction, slider_friction] = ["friction_nm_s_rad", "slider_friction_n_s_m"].map(gain);
    let extra = gain("extra_mass_kg");
    Some(Some(RedundantLoop {
        kp_nm_rad: kp?,
        kd_nm_s_rad: kd?,
        slider_kp_n_m: slider_kp?,
        slider_kd_n_s_m: slider_kd?,
        feed_forward: feed_forward?,
        friction_nm_s_rad: friction?,
        slider_friction_n_s_m: slider_friction?,
        extra_mass_kg: extra?,
    }))
}

/// Refuses a job that is a path, and returns true for one.
fn is_path(root: &Section) -> bool {
    let Some(job) = root.optional_section("job") else {
        return false;
    };
    job.ignore_rest();
    let found = ["timing", "path"].into_iter().find(|key| job.has(key));
    if let Some(key) = found {
        let reason = "paths are planned for a 3-RRR alone: give [[job.move]] with durations";
        job.refuse_list(key, reason);
    }
    found.is_some()
}

/// Positions of the sliders at the end of a move, one for each leg that has a slider: `Some(None)` where they stay.
fn read_slider_ends(each: &Section, count: usize) -> Option<Option<Vec<f64>>> {
    if !each.has("sliders_m") {
        return Some(None);
    }
    if count == 0 {
        each.refuse("sliders_m", "the machine has no sliders");
        return None;
    }
    each.number_or_each("sliders_m", Bound::Finite, count)
        .map(Some)
}

/// Position of each leg's slider at the end of each move.
fn slider_positions(
    document: &Document,
    placed: &PlacedJob,
    sliders: &[Option<RedundantSlider>],
    ends: &[Option<Vec<f64>>],
) -> Option<Vec<Vec<f64>>> {
    let mut at: Vec<f64> = sliders
        .iter()
        .map(|slider| slider.map_or(0.0, |slider| slider.position_m))
        .collect();
    let mut all = Vec::with_capacity(ends.len());
    let mut good = true;
    for (end, place) in ends.iter().zip(&placed.moves) {
        let given = end.iter().flatten();
        let legs = sliders.iter().enumerate();
        let moved = legs.filter_map(|(leg, slider)| Some((leg, (*slider)?)));
        let mut is_refused = false;
        for ((leg, slider), &position) in moved.zip(given) {
            let reason = match slider.is_placed {
                true => Some("place = \"best\" holds the slider over the whole job".into()),
                false => slider.outside(position),
            };
            // One number stands for all sliders: it is refused once.
            if let Some(reason) = reason.filter(|_| !is_refused) {
                is_refused = true;
                let mut place = place.whole.clone();
                place.key += ".sliders_m";
                place.value = Some(format!("{position:?}"));
                document.refuse(&place, format!("slider of leg {}: {reason}", leg + 1));
            }
            at[leg] = position;
        }
        good &= !is_refused;
        all.push(at.clone());
    }
    good.then_some(all)
}
