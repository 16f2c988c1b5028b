//! A linkage, its track and its figures as JSON, SI units and radians.

use serde_json::{Map, Value, json};
use trirrr_linkage::assur::{
    ChainKind, CrankChain, Linkage, LinkageStudy, Mobility, Track, Travel, Traveller, stopped,
};

/// A time with the values of the drives then.
fn at(linkage: &Linkage, t: f64) -> Value {
    let drives = linkage.drives.iter().map(|drive| {
        let name = linkage.joints[drive.joint].name.clone();
        (name, json!(drive.at(t)[0]))
    });
    json!({ "t_s": t, "drives": drives.collect::<Map<String, Value>>() })
}

fn link_names(linkage: &Linkage, links: &[usize]) -> Vec<String> {
    let names = links.iter().map(|&link| linkage.links[link].name.clone());
    names.collect()
}

fn joint_name(linkage: &Linkage, joint: usize) -> &str {
    &linkage.joints[joint].name
}

/// The object that `trirrr linkage --json` prints.
pub(super) fn as_json(linkage: &Linkage, track: &Track, study: &LinkageStudy) -> Value {
    let mobility = Mobility::count(linkage.links.len(), &linkage.joints);
    let groups = linkage.groups.iter().zip(&track.nearest).map(|(group, (distance, t))| {
        json!({
            "kind": group.title(),
            "links": link_names(linkage, &group.links),
            "joints": group.joints.iter().map(|&joint| joint_name(linkage, joint)).collect::<Vec<_>>(),
            "distance_min": distance.is_finite().then_some(distance),
            "at": at(linkage, *t),
        })
    });
    let newton = study.newton.iter().map(|figures| {
        json!({
            "group": figures.group + 1,
            "iterations_max": figures.iterations.0,
            "iterations_at": at(linkage, figures.iterations.1),
            "residual_max_m": figures.residual_m.0,
            "residual_at": at(linkage, figures.residual_m.1),
        })
    });
    let unknowns = &study.unknowns;
    json!({
        "name": linkage.name,
        "links": mobility.links,
        "joints": mobility.joints,
        "pins_in_slots": mobility.slots,
        "freedoms": mobility.freedoms(),
        "drives": linkage.drives.len(),
        "groups": groups.collect::<Vec<_>>(),
        "positions": track.positions.len(),
        "positions_asked": u64::from(linkage.motion.steps) + 1,
        "closure_m": track.closure,
        "stopped": track.stop.as_ref().map(|stop| stopped(linkage, stop)),
        "loops": study.loops.iter().map(|each| {
            let links: Vec<usize> = each.steps.iter().map(|step| step.0).collect();
            link_names(linkage, &links)
        }).collect::<Vec<_>>(),
        "unknowns": {
            "count": unknowns.count(),
            "angles": unknowns.angles.iter().map(|links| link_names(linkage, links)).collect::<Vec<_>>(),
            "slides": unknowns.slides.iter().map(|&joint| joint_name(linkage, joint)).collect::<Vec<_>>(),
        },
        "newton": newton.collect::<Vec<_>>(),
        "crank_loops": study.chains.iter().map(|chain| of_chain(linkage, chain)).collect::<Vec<_>>(),
        "loads": study.loads.iter().map(|load| json!({
            "drive": joint_name(linkage, linkage.drives[load.drive].joint),
            "unit": if linkage.drives[load.drive].slides { "N" } else { "N m" },
            "peak": load.peak.0,
            "peak_at": at(linkage, load.peak.1),
            "rms": load.rms,
        })).collect::<Vec<_>>(),
        "travels": study.travels.iter().map(|travel| of_travel(linkage, travel)).collect::<Vec<_>>(),
    })
}

fn of_chain(linkage: &Linkage, chain: &CrankChain) -> Value {
    let (kind, class, lengths) = match chain.kind {
        ChainKind::FourBar { lengths, class } => (
            "four-bar",
            Some(format!("{class:?}")),
            json!({
                "ground": lengths.ground,
                "crank": lengths.crank,
                "coupler": lengths.coupler,
                "rocker": lengths.rocker,
            }),
        ),
        ChainKind::SliderCrank {
            crank,
            coupler,
            offset,
        } => (
            "slider-crank",
            None,
            json!({ "crank": crank, "coupler": coupler, "offset": offset }),
        ),
    };
    json!({
        "kind": kind,
        "links": link_names(linkage, &chain.links),
        "class": class,
        "lengths_m": lengths,
        "turns_fully": chain.turns_fully(),
        "dead_points": chain.dead.iter().map(|point| json!({
            "stretched": point.is_stretched,
            "at": at(linkage, point.t_s),
        })).collect::<Vec<_>>(),
        "singular_crank_rad": chain.singular_rad,
        "singular_drive_rad": chain.singular_drive_rad,
        "transmission_min_rad": chain.transmission.map(|(angle, _)| angle),
        "transmission_at": chain.transmission.map(|(_, t)| at(linkage, t)),
    })
}

fn of_travel(linkage: &Linkage, travel: &Travel) -> Value {
    let (links, joint, unit) = match &travel.of {
        Traveller::Links(links) => (Some(link_names(linkage, links)), None, "rad"),
        Traveller::Slide(joint) => (None, Some(joint_name(linkage, *joint)), "m"),
    };
    let [(least, least_t), (most, most_t)] = travel.ends;
    json!({
        "links": links,
        "joint": joint,
        "unit": unit,
        "turns": travel.turns,
        "range": travel.range(),
        "least": least,
        "least_at": at(linkage, least_t),
        "most": most,
        "most_at": at(linkage, most_t),
        "turning": travel.turning_s.iter().map(|t| at(linkage, *t)).collect::<Vec<_>>(),
        "time_ratio": travel.time_ratio,
    })
}
