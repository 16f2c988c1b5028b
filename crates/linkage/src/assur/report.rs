//! Descriptions of a linkage and of its track, for a reader.

use super::description::Linkage;
use super::figures::figures;
use super::groups::{Group, GroupKind};
use super::mobility::Mobility;
use super::state::Reason;
use super::study::LinkageStudy;
use super::track::{Stop, Track};
use crate::LinkageStatus;
use std::fmt::Write;
use std::path::PathBuf;

/// Describes the linkage in `file`: its degrees of freedom and its groups in solving order.
pub fn header(file: &str, linkage: &Linkage) -> String {
    let mut text = format!("{file}: {}\n", linkage.name);
    if !linkage.description.is_empty() {
        text.push_str(&format!("{}\n", linkage.description));
    }
    let mobility = Mobility::count(linkage.links.len(), &linkage.joints);
    let slots = match mobility.slots {
        0 => String::new(),
        1 => ", 1 pin in a slot".into(),
        slots => format!(", {slots} pins in slots"),
    };
    text.push_str(&format!(
        "{} links, {} joints{slots}; degrees of freedom {mobility}, drives {}\n\n",
        mobility.links,
        mobility.joints,
        linkage.drives.len()
    ));
    text.push_str("groups in solving order:\n");
    text.push_str(&groups(linkage));
    text
}

/// Formats one line for each group.
fn groups(linkage: &Linkage) -> String {
    let titles: Vec<String> = linkage.groups.iter().map(Group::title).collect();
    let widest = titles.iter().map(|title| title.chars().count()).max();
    let mut text = String::new();
    for (number, (group, title)) in linkage.groups.iter().zip(&titles).enumerate() {
        let with = match group.kind {
            GroupKind::Driven => "in",
            _ => "by",
        };
        let width = widest.unwrap_or(0);
        let line = format!(
            "{:>3}  {title:width$}  {} {with} {}",
            number + 1,
            linkage.link_names(&group.links),
            linkage.joint_names(&group.joints),
        );
        // Writing to a string does not fail.
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Describes the track and its figures: closure, least distances from singularities, loops, swings, strokes; and `files` written.
pub fn summary(
    linkage: &Linkage,
    track: &Track,
    study: &LinkageStudy,
    files: &[PathBuf],
) -> String {
    let mut text = String::from("\n");
    let wanted = u64::from(linkage.motion.steps) + 1;
    let solved = track.positions.len();
    if let Some(last) = track.positions.last() {
        text.push_str(&format!(
            "solved   {solved} of {wanted} positions, t = 0 to {:.6} s\n",
            last.t
        ));
        text.push_str(&format!("closure  within {:.1e} m\n", track.closure));
        let nearest = track.nearest.iter().enumerate();
        let nearest = nearest.filter(|(group, _)| linkage.groups[*group].kind != GroupKind::Driven);
        for (group, (distance, t)) in nearest {
            let measure = match linkage.groups[group].is_iterated() {
                true => "reciprocal condition at least",
                false => "distance from singular at least",
            };
            text.push_str(&format!(
                "group {:<2} {measure} {distance:.4}, at {}\n",
                group + 1,
                inputs(linkage, *t)
            ));
        }
        text.push_str(&figures(linkage, study));
    }
    for file in files {
        text.push_str(&format!("wrote    {}\n", file.display()));
    }
    text
}

/// Describes the end of a motion that ended early: place and reason.
pub fn stopped(linkage: &Linkage, stop: &Stop) -> String {
    let group = &linkage.groups[stop.unsolved.group];
    let reason = match stop.unsolved.reason {
        Reason::Dyad(LinkageStatus::Unreachable) => {
            "cannot be assembled beyond: its ends are out of each other's reach (a dead point)"
        }
        Reason::Dyad(LinkageStatus::Singular) | Reason::Singular => {
            "is singular: its links have no defined velocity and its branches meet"
        }
        Reason::Dyad(LinkageStatus::OutOfRange) => "has motions beyond the number format",
        Reason::Diverged => "is not found by Newton-Raphson: no position near the last, or guess",
        Reason::Flipped => "would jump to another branch",
    };
    format!(
        "{}: stopped at {}: group {} ({}; {}) {reason}",
        linkage.name,
        inputs(linkage, stop.t),
        stop.unsolved.group + 1,
        group.title(),
        linkage.link_names(&group.links)
    )
}

/// Formats the values of the drives at a time.
fn inputs(linkage: &Linkage, t: f64) -> String {
    let values = linkage.drives.iter().map(|drive| {
        let [value, ..] = drive.at(t);
        let name = &linkage.joints[drive.joint].name;
        match drive.slides {
            true => format!("{name} = {value:.6} m"),
            false => format!("{name} = {value:.6} rad ({:.3} deg)", value.to_degrees()),
        }
    });
    values.collect::<Vec<_>>().join(", ")
}
