//! Reads and checks a linkage file. `docs/linkage-files.md` describes the keys.

mod check;
mod joints;
mod links;
mod motion;

use super::description::Linkage;
use std::path::Path;
use trirrr_scene::SceneError;
use trirrr_scene::read::{Document, Place, text_of, with_root};

const TOP_KEYS: &[&str] = &["name", "description", "trace"];

/// Coordinates and lengths up to this size, m: beyond it squares would leave the format long
/// before anything of use is described.
const FARTHEST: f64 = 1e6;

/// A name with the place where it is given.
type Placed<T> = (Place, T);

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
            let description = root.optional_text("description").unwrap_or_default();
            let links = links::read(root);
            let links_read = links.as_deref().unwrap_or_default();
            let joints = joints::read(root, links_read, links.is_some());
            let joints_read = joints.as_deref().unwrap_or_default();
            let drives = motion::read_drives(root, links_read, joints_read, joints.is_some());
            let traces = links::read_traces(root, links_read, links.is_some());
            let motion = motion::read(root, drives.as_deref());
            let places = check::Places {
                links: root.place_of("link"),
                drives: root.place_of("drive"),
                joint: joints_read.iter().map(|(place, _)| place.clone()).collect(),
                link: links_read.iter().map(|(place, _)| place.clone()).collect(),
            };
            let second = |(_, value)| value;
            let linkage = Linkage {
                name: name?,
                description: description.into_owned(),
                links: links?.into_iter().map(second).collect(),
                joints: joints?.into_iter().map(|(_, joint)| joint).collect(),
                drives: drives?,
                traces: traces?,
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

/// Returns `true` for a name that can be a part of `link.point` and of a column of the table.
fn is_name(name: &str) -> bool {
    (1..=40).contains(&name.chars().count())
        && name
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_')
}

const NAME_DEMAND: &str = "must be 1 to 40 letters, digits, `-` or `_`";
