//! TOML with places: tables read key by key, every fault collected with its line, key and value.
//!
//! Scenes are read with it, and so are the project's other TOML files.

mod bound;
mod document;
pub mod files;
mod other_unit;
mod parts;
mod section;
mod setting;
mod suggest;
mod values;

pub use bound::Bound;
pub use document::{Document, Place};
pub use other_unit::{Conversion, in_other_unit};
pub use section::Section;
pub use setting::{KeyStep, ListElement, Setting, SettingError};

pub(crate) use document::TextPart;
pub use parts::{SceneText, machine_file_of, machine_path};
pub(crate) use suggest::did_you_mean;

use crate::error::SceneError;
use std::path::Path;
use toml::de::DeTable;

/// Reads the text of a scene, or of another file in TOML.
///
/// # Errors
/// [`SceneError::Unreadable`] with the file and the reason.
pub fn text_of(file: &Path) -> Result<String, SceneError> {
    files::text_in(file, files::LONGEST_SCENE).map_err(|reason| SceneError::Unreadable {
        file: file.to_owned(),
        reason,
    })
}

/// Gives the text of the file of a machine, or the reason why there is none.
pub type MachineTexts<'a> = dyn Fn(&Path) -> Result<String, String> + 'a;

/// Reads the text of the file of a machine from the disk.
///
/// # Errors
/// The file and the reason.
pub fn on_disk(file: &Path) -> Result<String, String> {
    let text = files::regular_text(file, files::LONGEST_MACHINE);
    let unreadable = |reason| SceneError::Unreadable {
        file: file.to_owned(),
        reason,
    };
    text.map_err(|reason| unreadable(reason).to_string())
}

/// Parses the scene in `text`, with what it takes from the file of its machine and from `settings`, and hands document and
/// root table to `read`. `file` is named in errors; `top_keys` are the keys that stand before the first table.
///
/// # Errors
/// [`SceneError::Refused`] with everything found wrong. `read` returns `None` only after it has refused something.
pub fn with_scene<T>(
    text: &str,
    file: &str,
    settings: &[Setting],
    top_keys: &'static [&'static str],
    read: impl FnOnce(&Document, &Section, &SceneText) -> Option<T>,
) -> Result<T, SceneError> {
    with_scene_from(text, file, settings, top_keys, &on_disk, read)
}

/// Parses as [`with_scene`], and takes the file of the machine from `machines`.
///
/// # Errors
/// As there.
pub(crate) fn with_scene_from<T>(
    text: &str,
    file: &str,
    settings: &[Setting],
    top_keys: &'static [&'static str],
    machines: &MachineTexts,
    read: impl FnOnce(&Document, &Section, &SceneText) -> Option<T>,
) -> Result<T, SceneError> {
    let (root, faults) = DeTable::parse_recoverable(text);
    let whole = SceneText::new(text, file, root.get_ref(), settings, machines);
    let document = Document::new(&whole.text, top_keys).with_parts(whole.parts.clone());
    refuse_faults(&document, &faults);
    if !document.is_clean() {
        return Err(document.into_error(file));
    }
    let padded = whole.padded(settings);
    let mut root = root.into_inner();
    whole.merge(&document, &mut root, &padded, settings);
    if !document.is_clean() {
        return Err(document.into_error(file));
    }
    let scene = read(&document, &Section::root(&document, &root), &whole);
    match scene.filter(|_| document.is_clean()) {
        Some(scene) => Ok(scene),
        None => Err(document.into_error(file)),
    }
}

/// Parses `text` and hands its root table to `read`. Text that is no TOML becomes problems of the
/// document, all that the parser could recover from, and `read` is not called: half a tree would
/// only give follow-up errors.
pub fn with_root<'t, T>(
    document: &Document<'t>,
    text: &'t str,
    read: impl FnOnce(&Section<'_, 't>) -> Option<T>,
) -> Option<T> {
    let root = root_of(document, text)?;
    read(&Section::root(document, &root))
}

/// Parses as [`with_root`], and returns the table.
fn root_of<'t>(document: &Document, text: &'t str) -> Option<DeTable<'t>> {
    let (root, faults) = DeTable::parse_recoverable(text);
    refuse_faults(document, &faults);
    faults.is_empty().then(|| root.into_inner())
}

/// Makes problems of what the parser found.
fn refuse_faults(document: &Document, faults: &[toml::de::Error]) {
    for fault in faults {
        // A file of another kind has a fault in each line.
        if document.counts_on() {
            continue;
        }
        let offset = fault.span().map_or(0, |span| span.start);
        let place = Place {
            line: document.line(offset),
            column: document.column(offset),
            key: String::new(),
            value: None,
        };
        let mut message = fault.message().trim_end().replace('\n', ", ");
        // The parser leaves the name out.
        if let ("duplicate key", Some(span)) = (message.as_str(), fault.span()) {
            message = format!("duplicate key `{}`", document.quote(span));
        }
        let hint = match document.has_decimal_comma(place.line) {
            true => "; a number has a decimal point: 0.5, not 0,5",
            false => "",
        };
        document.refuse(&place, format!("not TOML: {message}{hint}"));
    }
}

#[cfg(test)]
mod tests {
    use crate::Scene;

    /// Each of its lines is a fault, and the work grows with the lines alone.
    #[test]
    fn a_long_file_of_another_kind_is_refused_by_its_first_faults() {
        let error = Scene::parse(&"G1 X1,5\n".repeat(40_000), "a.nc").expect_err("no scene");
        let text = error.to_string();
        assert_eq!(text.lines().count(), 101);
        assert!(text.ends_with("and 39900 more like these"), "{text}");
    }
}
