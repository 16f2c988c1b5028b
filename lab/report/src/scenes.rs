//! The scenes that a report is about. They are in the program: a report does not depend on where
//! it is called.

use crate::error::ReportError;
use trirrr_scene::Scene;

/// File name and text.
const SHIPPED: [(&str, &str); 4] = [
    ("thesis.toml", include_str!("../../../scenes/thesis.toml")),
    (
        "thesis-links.toml",
        include_str!("../../../scenes/thesis-links.toml"),
    ),
    (
        "vertical.toml",
        include_str!("../../../scenes/vertical.toml"),
    ),
    ("chained.toml", include_str!("../../../scenes/chained.toml")),
];

/// The shipped scenes with a job, the source's own machine and move first.
pub(crate) fn shipped() -> Result<Vec<Scene>, ReportError> {
    SHIPPED
        .iter()
        .map(|(file, text)| {
            Scene::parse(text, file).map_err(|error| ReportError::Refused(error.to_string()))
        })
        .collect()
}
