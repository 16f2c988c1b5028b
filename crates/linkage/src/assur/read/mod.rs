//! Reads and checks a linkage file. `docs/linkage-files.md` describes the keys.

mod check;
mod joints;
mod links;
mod motion;

use super::description::Linkage;
use nalgebra::Vector2;
use std::path::Path;
use trirrr_scene::SceneError;
use trirrr_scene::read::{Document, Place, Section, text_of, with_root};

const TOP_KEYS: &[&str] = &["name", "description", "trace", "gravity_m_s2"];

/// Coordinates and lengths up to this size, m: beyond it squares would leave the format long
/// before anything of use is described.
const FARTHEST: f64 = 1e6;

/// A value with the place where it is given.
type Placed<T> = (Place, T);
/// The points of a link, by name.
type Points = Vec<(String, Vector2<f64>)>;

impl Linkage {
    /// Reads and checks the linkage in `file`.
    ///
    /// # Errors
    /// [`SceneError`] with everything found wrong.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, SceneError> {
        let file = file.as_ref();
        Self::parse(&text_of(file)?, &file.display().to_string())
    }

    /// Checks the linkage in `text`; `file` is only named in errors.
    ///
    /// # Errors
    /// [`SceneError::Refused`] with everything found wrong. Degrees of freedom and groups are only
    /// looked at once nothing else is wrong.
    pub fn parse(text: &str, file: &str) -> Result<Self, SceneError> {
        let document = Document::new(text, TOP_KEYS);
        let read = with_root(&document, text, |root| {
            let name = root.folder_name("name");
            let gravity_m_s2 = root.vector("gravity_m_s2", Some([0.0; 2]));
            let description = root.optional_text("description").unwrap_or_default();
            let links = links::read(root);
            let joints = joints::read(root, links.as_deref());
            let drives = motion::read_drives(root, links.as_deref(), joints.as_deref());
            let traces = links::read_traces(root, links.as_deref());
            let motion = motion::read(root, drives.as_deref());
            let (mut links, mut drives) = (links?, drives?);
            let joints = joints::add_blocks(&mut links, joints?, &mut drives);
            let (link, links) = links.into_iter().unzip();
            let (joint, joints) = joints.into_iter().unzip();
            let places = check::Places {
                links: root.place_of("link"),
                drives: root.place_of("drive"),
                joint,
                link,
            };
            let linkage = Linkage {
                name: name?,
                description: description.into_owned(),
                links,
                joints,
                drives: drives.into_iter().map(|(_, drive)| drive).collect(),
                traces: traces?,
                gravity_m_s2: gravity_m_s2?.into(),
                motion: motion?,
                groups: Vec::new(),
            };
            Some((linkage, places))
        });
        let Some((mut linkage, places)) = read.filter(|_| document.is_clean()) else {
            return Err(document.into_error(file));
        };
        check::check(&document, &mut linkage, &places);
        match document.is_clean() {
            true => Ok(linkage),
            false => Err(document.into_error(file)),
        }
    }
}

/// The values of `sections`, each read with its index; `None` if any is refused. Of two that are the
/// `same`, the second is refused at `key` for `reason`.
fn read_each<T>(
    sections: &[Section],
    read: impl Fn(usize, &Section) -> Option<T>,
    same: impl Fn(&T, &T) -> bool,
    [key, reason]: [&str; 2],
) -> Option<Vec<Placed<T>>> {
    let mut all: Vec<Placed<T>> = Vec::with_capacity(sections.len());
    for (index, section) in sections.iter().enumerate() {
        let Some(value) = read(index, section) else {
            continue;
        };
        if all.iter().any(|(_, other)| same(other, &value)) {
            section.refuse(key, reason);
        } else {
            all.push((section.place(), value));
        }
    }
    (all.len() == sections.len()).then_some(all)
}

/// The `name` of a link or of a joint.
fn read_name(section: &Section) -> Option<String> {
    let name = section.text("name")?;
    if !is_name(&name) {
        section.refuse("name", NAME_DEMAND);
        return None;
    }
    Some(name.into_owned())
}

/// Returns `true` for a name that can be a part of `link.point` and of a column of the table.
fn is_name(name: &str) -> bool {
    (1..=40).contains(&name.chars().count())
        && name
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_')
}

const NAME_DEMAND: &str = "must be 1 to 40 letters, digits, `-` or `_`";
