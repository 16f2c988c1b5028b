//! Links, their points, and references to them.

use super::{FARTHEST, NAME_DEMAND, Placed, Points, is_name, read_each, read_name};
use crate::assur::description::{LinkBody, PointRef, names};
use crate::assur::parts::BodyMass;
use nalgebra::Vector2;
use trirrr_scene::read::{Bound, Section};

/// More links than this are refused: what the search for groups takes grows with their cube.
const MOST_LINKS: usize = 100;

/// The links; `None` if any is refused.
pub(super) fn read(root: &Section) -> Option<Vec<Placed<LinkBody>>> {
    let sections = root.sections("link")?;
    if !(2..=MOST_LINKS).contains(&sections.len()) {
        let reason = format!(
            "expected 2 to {MOST_LINKS} tables [[link]], the frame first, found {}",
            sections.len()
        );
        root.refuse_list("link", reason);
        return None;
    }
    let read = |index: usize, section: &Section| read_link(section, index == 0);
    let same = |a: &LinkBody, b: &LinkBody| a.name == b.name;
    let reason = "there is another link of this name";
    read_each(&sections, read, same, ["name", reason])
}

fn read_link(section: &Section, is_frame: bool) -> Option<LinkBody> {
    let name = read_name(section);
    let points = match section.has("length_m") {
        true => read_rod(section),
        false => read_points(section),
    };
    let guess = match section.optional_section("guess") {
        Some(_) if is_frame => {
            section.refuse(
                "guess",
                "the first link is the frame: it stands where it is",
            );
            None
        }
        Some(guess) => read_guess(&guess).map(Some),
        None if section.has("guess") => None,
        None => Some(None),
    };
    let mass = read_mass(section, is_frame);
    Some(LinkBody {
        name: name?,
        points: points?,
        guess: guess?,
        mass: mass?,
        is_block: false,
    })
}

/// Mass, centre of mass and inertia of a link; the frame has none.
fn read_mass(section: &Section, is_frame: bool) -> Option<BodyMass> {
    const KEYS: [&str; 3] = ["mass_kg", "com_m", "inertia_kgm2"];
    if is_frame {
        let given: Vec<&str> = KEYS.into_iter().filter(|key| section.has(key)).collect();
        for key in &given {
            section.refuse(
                key,
                "the first link is the frame: it stands still, and no drive moves its mass",
            );
        }
        return given.is_empty().then_some(BodyMass::NONE);
    }
    let mass_kg = section.number_or(KEYS[0], Bound::NotNegative, 0.0);
    // A mass needs a place.
    let com_m = section.vector(KEYS[1], (!section.has(KEYS[0])).then_some([0.0; 2]));
    let inertia_kgm2 = section.number_or(KEYS[2], Bound::NotNegative, 0.0);
    let (mass_kg, [x, y], inertia_kgm2) = (mass_kg?, com_m?, inertia_kgm2?);
    if x.abs() > FARTHEST || y.abs() > FARTHEST {
        section.refuse(KEYS[1], too_far());
        return None;
    }
    Some(BodyMass {
        mass_kg,
        com_m: Vector2::new(x, y),
        inertia_kgm2,
    })
}

fn read_guess(guess: &Section) -> Option<[f64; 3]> {
    let at = guess.vector("at_m", Some([0.0; 2]));
    let angle = guess.number("angle_rad", Bound::Within(-100.0, 100.0));
    let [x, y] = at?;
    let far = x.abs() > FARTHEST || y.abs() > FARTHEST;
    if far {
        guess.refuse("at_m", too_far());
    }
    (!far).then_some([x, y, angle?])
}

fn too_far() -> String {
    format!("must be within {FARTHEST} of the origin (m)")
}

/// `length_m` and the names of the two `ends`.
fn read_rod(section: &Section) -> Option<Points> {
    let length = section
        .optional_number("length_m", Bound::Positive)
        .filter(|length| {
            let good = *length <= FARTHEST;
            if !good {
                section.refuse("length_m", format!("must be at most {FARTHEST} (m)"));
            }
            good
        });
    let ends = section.texts("ends").and_then(|ends| match &ends[..] {
        [(_, a), (_, b)] if a != b && is_name(a) && is_name(b) => {
            Some([(*a).to_owned(), (*b).to_owned()])
        }
        _ => {
            let reason = format!("expected two different names, each of which {NAME_DEMAND}");
            section.refuse("ends", reason);
            None
        }
    });
    // More points than the ends, where they are given too.
    let more = match section.has("points_m") {
        true => read_points(section),
        false => Some(Vec::new()),
    };
    let (length, [from, to], more) = (length?, ends?, more?);
    for (name, _) in &more {
        if *name == from || *name == to {
            section.refuse("ends", format!("`{name}` is in points_m too"));
            return None;
        }
    }
    let mut points = vec![(from, Vector2::zeros()), (to, Vector2::new(length, 0.0))];
    points.extend(more);
    Some(points)
}

fn read_points(section: &Section) -> Option<Points> {
    let table = section.section("points_m")?;
    let mut points = Vec::new();
    let mut good = true;
    for name in table.names() {
        let Some(at) = table.vector(name, None) else {
            good = false;
            continue;
        };
        if at.iter().any(|coordinate| coordinate.abs() > FARTHEST) {
            table.refuse(name, too_far());
            good = false;
        } else if !is_name(name) {
            table.refuse(name, format!("the name {NAME_DEMAND}"));
            good = false;
        }
        points.push((name.to_owned(), at.into()));
    }
    if points.is_empty() && good {
        section.refuse("points_m", "a link needs a point to be joined at");
        return None;
    }
    good.then_some(points)
}

/// The link of a name, or why there is none.
pub(super) fn find_link(links: &[Placed<LinkBody>], name: &str) -> Result<usize, String> {
    links
        .iter()
        .position(|(_, link)| link.name == name)
        .ok_or_else(|| {
            let known = names(links.iter().map(|(_, link)| link.name.as_str()));
            format!("there is no link `{name}`; the links are {known}")
        })
}

/// The point that `link.point` names, or why there is none.
pub(super) fn find_point(links: &[Placed<LinkBody>], text: &str) -> Result<PointRef, String> {
    let (link, point) = text.split_once('.').ok_or("expected \"link.point\"")?;
    let link = find_link(links, link)?;
    let points = &links[link].1.points;
    let found = points.iter().position(|(name, _)| name == point);
    let point = found.ok_or_else(|| {
        let known = names(points.iter().map(|(name, _)| name.as_str()));
        format!("the link has no point `{point}`; its points are {known}")
    })?;
    Ok(PointRef { link, point })
}

/// The points whose curves are wanted. Without links nothing is looked up.
pub(super) fn read_traces(
    root: &Section,
    links: Option<&[Placed<LinkBody>]>,
) -> Option<Vec<PointRef>> {
    if !root.has("trace") {
        return Some(Vec::new());
    }
    let texts = root.texts("trace")?;
    let links = links?;
    let mut traces = Vec::with_capacity(texts.len());
    for (place, text) in &texts {
        match find_point(links, text) {
            Ok(point) if traces.contains(&point) => {
                root.refuse_at(place, "the point is listed twice");
            }
            Ok(point) => traces.push(point),
            Err(reason) => root.refuse_at(place, reason),
        }
    }
    (traces.len() == texts.len()).then_some(traces)
}
