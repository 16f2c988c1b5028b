//! Kinds of files that hold a job.

use std::path::Path;

/// Kind of a job's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JobKind {
    Gcode,
    Table,
    Drawing,
    Image,
}

impl JobKind {
    /// Kind of `file`, by its extension.
    pub(super) fn of(file: &Path) -> Self {
        let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str().unwrap_or_default() {
            "svg" | "svgz" | "dxf" => Self::Drawing,
            "png" | "jpg" | "jpeg" | "bmp" => Self::Image,
            "csv" => Self::Table,
            _ => Self::Gcode,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Gcode => "G-code",
            Self::Table => "a table",
            Self::Drawing => "a drawing",
            Self::Image => "an image",
        }
    }
}
