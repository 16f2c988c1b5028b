//! Image files, and their tones.

use super::density::density;
use super::{Raster, Tones};
use crate::PathFault;
use image::imageops::{self, FilterType};
use image::metadata::Orientation;
use image::{DynamicImage, ImageBuffer, ImageDecoder, ImageReader, Limits, Luma, LumaA};
use std::io::Cursor;

/// Most pixels of a side of a file.
const SIDE_MAX: u32 = 30_000;

/// Most pixels of a file: those of the largest cameras.
const FILE_PIXELS_MAX: u64 = 100_000_000;

/// Most pixels on the machine.
const PIXELS_MAX: f64 = 1e8;

fn fault(reason: String) -> PathFault {
    PathFault {
        line: 0,
        word: String::new(),
        reason,
    }
}

/// Image in grey, from 0 for black to 1 for white.
#[derive(Clone, Debug, PartialEq)]
pub struct GreyImage {
    pixels: ImageBuffer<Luma<f32>, Vec<f32>>,
    /// Pixels by m along x and y, if the file names them.
    density: Option<[f64; 2]>,
}

/// Reads an image: PNG, JPEG, BMP, TIFF, WebP or GIF; of several pictures in a file, the first. It stands as its file says that it
/// is to be seen (orientation of EXIF). Colours become grey by their luma (BT.709, as the file has them); what is
/// transparent shows white.
///
/// # Errors
/// A damaged file, or one with more than 30,000 pixels a side or 1e8 in all. The latter is known before its pixels are read.
pub fn read_image(bytes: &[u8]) -> Result<GreyImage, PathFault> {
    let unread = |error: &dyn std::fmt::Display| fault(format!("no image: {error}"));
    let opened = || {
        ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|error| unread(&error))
    };
    // Of a file without a size the decoder says why.
    if let Ok((columns, rows)) = opened()?.into_dimensions()
        && u64::from(columns) * u64::from(rows) > FILE_PIXELS_MAX
    {
        return Err(fault(format!(
            "the image has {columns} by {rows} pixels, at most {FILE_PIXELS_MAX} in all are read; make it smaller"
        )));
    }
    let mut reader = opened()?;
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(SIDE_MAX), Some(SIDE_MAX));
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(|error| unread(&error))?;
    // A file whose remarks are damaged stands as its pixels do.
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let mut image = DynamicImage::from_decoder(decoder).map_err(|error| unread(&error))?;
    image.apply_orientation(orientation);
    let image = image.into_luma_alpha8();
    let pixels = ImageBuffer::from_fn(image.width(), image.height(), |column, row| {
        let LumaA([luma, alpha]) = *image.get_pixel(column, row);
        let [luma, alpha] = [luma, alpha].map(|value| f32::from(value) / 255.0);
        Luma([1.0 - alpha * (1.0 - luma)])
    });
    let is_turned = matches!(
        orientation,
        Orientation::Rotate90
            | Orientation::Rotate270
            | Orientation::Rotate90FlipH
            | Orientation::Rotate270FlipH
    );
    let density = density(bytes).map(|[x, y]| if is_turned { [y, x] } else { [x, y] });
    Ok(GreyImage { pixels, density })
}

impl GreyImage {
    /// Height over width.
    pub fn aspect(&self) -> f64 {
        f64::from(self.pixels.height()) / f64::from(self.pixels.width())
    }

    /// Length of a pixel as the file says, m.
    ///
    /// # Errors
    /// The file says nothing about it, or its pixels are no squares.
    pub fn pitch_m(&self) -> Result<f64, PathFault> {
        let refused = |reason: String| PathFault {
            word: "--pitch file".into(),
            ..fault(reason)
        };
        match self.density {
            Some([x, y]) if (x / y - 1.0).abs() < 0.01 => Ok(1.0 / x),
            Some(sides) => {
                let [x, y] = sides.map(|pixels| 0.0254 * pixels);
                Err(refused(format!(
                    "the pixels of the file are no squares: {x:.1} and {y:.1} on an inch; take --pitch MM"
                )))
            }
            None => Err(refused(
                "the file does not say how large its pixels are; take --pitch MM or --width MM"
                    .into(),
            )),
        }
    }

    /// Pixels of a row of the file.
    pub fn columns(&self) -> u32 {
        self.pixels.width()
    }

    /// Powers for an image of `width` pitches on the machine. Where a pixel of the machine holds several of the file, it
    /// has their mean; between pixels of the file tones go evenly.
    ///
    /// # Errors
    /// The image has no row or column on the machine, more than 1e8 pixels, or nothing to burn.
    pub fn raster(&self, width: f64, tones: Tones) -> Result<Raster, PathFault> {
        let [columns, rows] = [width, width * self.aspect()].map(|side| side.round().max(1.0));
        if columns * rows > PIXELS_MAX {
            return Err(fault(format!(
                "the image has {columns} by {rows} pixels on the machine, at most {PIXELS_MAX} are read; take a larger --pitch"
            )));
        }
        let (columns, rows) = (columns as u32, rows as u32);
        let same = (columns, rows) == self.pixels.dimensions();
        let mut pixels = match same {
            true => self.pixels.clone(),
            false => imageops::resize(&self.pixels, columns, rows, FilterType::Triangle),
        };
        // A file has its rows from above, the machine from below.
        imageops::flip_vertical_in_place(&mut pixels);
        let mut burnt = pixels.into_raw();
        if !tones.negative {
            burnt.iter_mut().for_each(|tone| *tone = 1.0 - *tone);
        }
        let full = (tones.count.clamp(2, 256) - 1) as u8;
        let columns = columns as usize;
        let levels: Vec<u8> = match tones.dither {
            true => dithered(burnt, columns, full),
            false => burnt.into_iter().map(|tone| level(tone, full)).collect(),
        };
        match levels.iter().any(|&level| level > 0) {
            true => Ok(Raster {
                columns,
                levels,
                full,
            }),
            false => Err(fault(
                "nothing in the image is burnt: all of it is as bright as a level of power allows; see --negative".into(),
            )),
        }
    }
}

fn level(tone: f32, full: u8) -> u8 {
    // Casts of numbers beyond a byte take the nearest one.
    (tone.clamp(0.0, 1.0) * f32::from(full)).round() as u8
}

/// Levels whose mean over some pixels is that of `tones`, by the weights of Floyd and Steinberg; every other row goes backwards.
fn dithered(mut tones: Vec<f32>, columns: usize, full: u8) -> Vec<u8> {
    let mut levels = vec![0; tones.len()];
    for start in (0..tones.len()).step_by(columns) {
        let is_back = (start / columns) % 2 == 1;
        for step in 0..columns {
            let column = if is_back { columns - 1 - step } else { step };
            let at = start + column;
            let found = level(tones[at], full);
            levels[at] = found;
            let lost = tones[at] - f32::from(found) / f32::from(full);
            let ahead = if is_back { -1 } else { 1 };
            for (row, side, weight) in [(0, 1, 7.0), (1, -1, 3.0), (1, 0, 5.0), (1, 1, 1.0)] {
                let column = column.checked_add_signed(ahead * side);
                let Some(column) = column.filter(|&column| column < columns) else {
                    continue;
                };
                if let Some(tone) = tones.get_mut(start + row * columns + column) {
                    *tone += lost * weight / 16.0;
                }
            }
        }
    }
    levels
}
