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
            "png" | "jpg" | "jpeg" | "bmp" | "gif" | "webp" | "tif" | "tiff" => Self::Image,
            "csv" => Self::Table,
            _ => Self::Gcode,
        }
    }

    /// Kind of a file that is no job, by its extension, and what to make of it.
    pub(super) fn foreign(file: &Path) -> Option<(&'static str, &'static str)> {
        let extension = file.extension()?.to_ascii_lowercase();
        let image = "save it as PNG, JPEG, BMP, TIFF, WebP or GIF";
        let drawing = "save it as SVG or DXF";
        Some(match extension.to_str()? {
            "heic" | "heif" | "avif" | "jxl" | "jp2" | "ico" | "psd" | "xcf" | "raw" | "dng" => {
                ("an image of another kind", image)
            }
            "pdf" | "ai" | "eps" | "ps" | "cdr" | "emf" | "wmf" | "odg" | "vsdx" => {
                ("a drawing of another kind", drawing)
            }
            "dwg" | "dwf" | "lbrn" | "lbrn2" => ("a drawing of another kind", drawing),
            "stl" | "obj" | "step" | "stp" | "iges" | "igs" | "3mf" | "f3d" | "fcstd" => (
                "a solid",
                "save an outline of it as SVG or DXF, or G-code by a CAM program",
            ),
            _ => return None,
        })
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
