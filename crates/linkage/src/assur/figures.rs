//! Figures of a linkage over its motion, in words.

use super::description::Linkage;
use super::study::{ChainKind, CrankChain, LinkageStudy, Travel, Traveller};
use crate::four_bar::Grashof;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Class in words: which links turn fully.
pub(super) fn grashof_in_words(class: Grashof) -> &'static str {
    match class {
        Grashof::CrankRocker => "crank-rocker",
        Grashof::RockerCrank => "rocker-crank (the fourth link turns fully, the second swings)",
        Grashof::DoubleCrank => "double crank",
        Grashof::DoubleRocker => "double rocker (the third link turns fully)",
        Grashof::ChangePoint => "change point",
        Grashof::TripleRocker => "triple rocker (no link turns fully)",
    }
}

/// Degrees with sign and without negative zero.
fn degrees(angle: f64) -> String {
    format!("{:.3}", angle.to_degrees() + 0.0)
}

/// A load with five digits or more; an exponent where zeros would hide the size.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-2..1e6).contains(&size) => format!("{value:.5}"),
        _ => format!("{value:.4e}"),
    }
}

/// Values of the drives at a time, short; angles within a turn.
fn at(linkage: &Linkage, t: f64) -> String {
    let values = linkage.drives.iter().map(|drive| {
        let [value, ..] = drive.at(t);
        let name = &linkage.joints[drive.joint].name;
        match drive.slides {
            true => format!("{name} = {value:.6} m"),
            false => {
                // Rounding must not turn the start into a whole turn.
                let turned = value.rem_euclid(TAU);
                let turned = if TAU - turned < 1e-9 { 0.0 } else { turned };
                format!("{name} = {} deg", degrees(turned))
            }
        }
    });
    values.collect::<Vec<_>>().join(", ")
}

/// Loops and unknowns, Newton-Raphson, loops with a crank, swings and strokes: lines of the summary.
pub(super) fn figures(linkage: &Linkage, study: &LinkageStudy) -> String {
    let mut text = String::new();
    let loops = study.loops.len();
    if loops > 0 {
        let mut unknowns: Vec<String> = Vec::new();
        for links in &study.unknowns.angles {
            unknowns.push(format!(
                "angle of {}",
                linkage.link_names(links).replace(", ", " + ")
            ));
        }
        for &joint in &study.unknowns.slides {
            unknowns.push(format!("way along {}", linkage.joints[joint].name));
        }
        let count = study.unknowns.count();
        let _ = writeln!(
            text,
            "loops    {loops} independent: 2 * {loops} = {} equations, {count} unknowns: {}",
            2 * loops,
            unknowns.join(", ")
        );
    }
    for each in &study.newton {
        let ((most, most_t), (residual, residual_t)) = (each.iterations, each.residual_m);
        let _ = writeln!(
            text,
            "Newton   group {}: at most {most} iterations, at {}; residual at most {residual:.1e} m, at {}",
            each.group + 1,
            at(linkage, most_t),
            at(linkage, residual_t)
        );
    }
    for chain in &study.chains {
        text.push_str(&of_chain(linkage, chain));
    }
    for travel in &study.travels {
        text.push_str(&of_travel(linkage, travel));
    }
    for load in &study.loads {
        let drive = &linkage.drives[load.drive];
        let (what, unit) = match drive.slides {
            true => ("force", "N"),
            false => ("torque", "N m"),
        };
        let (peak, t) = load.peak;
        let _ = writeln!(
            text,
            "{what:<8} {}: at most {} {unit}, at {}; root mean square {} {unit}",
            linkage.joints[drive.joint].name,
            short(peak),
            at(linkage, t),
            short(load.rms)
        );
    }
    text
}

fn of_chain(linkage: &Linkage, chain: &CrankChain) -> String {
    let links = linkage.link_names(&chain.links);
    let mut text = match chain.kind {
        ChainKind::FourBar { class, .. } => {
            format!("four-bar {links}: {}\n", grashof_in_words(class))
        }
        ChainKind::SliderCrank { .. } => {
            let turns = match chain.turns_fully() {
                true => "the crank turns fully",
                false => "the crank does not turn fully",
            };
            format!("slider-crank {links}: {turns}\n")
        }
    };
    let dead = chain.dead.iter().map(|point| {
        let how = match point.is_stretched {
            true => "stretched",
            false => "folded",
        };
        format!("{} ({how})", at(linkage, point.t_s))
    });
    let dead: Vec<String> = dead.collect();
    if !dead.is_empty() {
        let _ = writeln!(text, "         dead points at {}", dead.join(", "));
    }
    if !chain.singular_rad.is_empty() {
        let place = match (chain.singular_drive_rad.is_empty(), chain.kind) {
            (false, _) => format!("{} =", linkage.joints[chain.joints[0]].name),
            (true, ChainKind::FourBar { .. }) => "crank from ground".into(),
            (true, ChainKind::SliderCrank { .. }) => "crank from guide".into(),
        };
        let angles = match chain.singular_drive_rad.is_empty() {
            true => &chain.singular_rad,
            false => &chain.singular_drive_rad,
        };
        let angles: Vec<String> = angles.iter().map(|angle| degrees(*angle)).collect();
        let _ = writeln!(
            text,
            "         singular at {place} {} deg",
            angles.join(", ")
        );
    }
    if let Some((angle, t)) = chain.transmission {
        let _ = writeln!(
            text,
            "         transmission angle at least {} deg, at {}",
            degrees(angle),
            at(linkage, t)
        );
    }
    text
}

fn of_travel(linkage: &Linkage, travel: &Travel) -> String {
    let ratio = match travel.time_ratio {
        Some(ratio) => format!("; time ratio {ratio:.4}"),
        None => String::new(),
    };
    let [(least, least_t), (most, most_t)] = travel.ends;
    let (least_at, most_at) = (at(linkage, least_t), at(linkage, most_t));
    match &travel.of {
        Traveller::Links(links) => {
            let names = linkage.link_names(links).replace(", ", " + ");
            match travel.turns {
                // Without whole turns of one drive: by how much at all.
                0 if travel.turning_s.is_empty() && travel.range() >= TAU - 1e-9 => {
                    let sign = if least_t <= most_t { 1.0 } else { -1.0 };
                    let turns = sign * travel.range() / TAU;
                    format!("turns    {names}, {turns:.3} in all\n")
                }
                0 => format!(
                    "swing    {names} {} deg, from {} at {least_at} to {} at {most_at}{ratio}\n",
                    degrees(travel.range()),
                    degrees(least),
                    degrees(most)
                ),
                turns => format!("turns    {names}, {turns} in all\n"),
            }
        }
        Traveller::Slide(joint) => format!(
            "stroke   {} {:.6} m, from {least:.6} at {least_at} to {most:.6} at {most_at}{ratio}\n",
            linkage.joints[*joint].name,
            travel.range()
        ),
    }
}
