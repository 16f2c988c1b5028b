//! Density of pixels that an image file names.

/// Units of TIFF and EXIF: lengths of an inch and of a centimetre, m.
const UNITS_M: [(u16, f64); 2] = [(2, 0.0254), (3, 0.01)];

/// Pixels by m along x and y. None: the file names none.
pub(super) fn density(file: &[u8]) -> Option<[f64; 2]> {
    let found = match file {
        [0x89, b'P', b'N', b'G', ..] => of_png(file),
        [0xFF, 0xD8, ..] => of_jpeg(file),
        [b'B', b'M', ..] => of_bmp(file),
        [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => of_tiff(file),
        _ => None,
    };
    found.filter(|sides| sides.iter().all(|side| side.is_finite() && *side > 0.0))
}

fn bytes<const N: usize>(file: &[u8], at: usize) -> Option<[u8; N]> {
    file.get(at..at.checked_add(N)?)?.try_into().ok()
}

/// Chunk `pHYs`.
fn of_png(file: &[u8]) -> Option<[f64; 2]> {
    let mut at = 8;
    loop {
        let length = u32::from_be_bytes(bytes(file, at)?) as usize;
        let kind: [u8; 4] = bytes(file, at + 4)?;
        match &kind {
            b"pHYs" if length == 9 && file.get(at + 16) == Some(&1) => {
                let side = |at| bytes(file, at).map(|side| f64::from(u32::from_be_bytes(side)));
                return Some([side(at + 8)?, side(at + 12)?]);
            }
            b"IDAT" | b"IEND" => return None,
            _ => at = at.checked_add(length)?.checked_add(12)?,
        }
    }
}

/// Head of JFIF, or else that of EXIF.
fn of_jpeg(file: &[u8]) -> Option<[f64; 2]> {
    let mut at = 2;
    let mut exif = None;
    while let Some([0xFF, marker, high, low]) = bytes(file, at) {
        let length = usize::from(u16::from_be_bytes([high, low]));
        let part = file.get(at + 4..at.checked_add(length)?.checked_add(2)?)?;
        match marker {
            0xE0 if part.starts_with(b"JFIF\0") => {
                let side = |at| bytes(part, at).map(|side| f64::from(u16::from_be_bytes(side)));
                let unit_m = match part.get(7)? {
                    1 => Some(0.0254),
                    2 => Some(0.01),
                    _ => None,
                };
                if let Some(unit_m) = unit_m {
                    return Some([side(8)? / unit_m, side(10)? / unit_m]);
                }
            }
            0xE1 if part.starts_with(b"Exif\0\0") => exif = exif.or_else(|| of_tiff(&part[6..])),
            // The pixels.
            0xDA => break,
            _ => {}
        }
        at += length + 2;
    }
    exif
}

fn of_bmp(file: &[u8]) -> Option<[f64; 2]> {
    let side = |at| bytes(file, at).map(|side| f64::from(i32::from_le_bytes(side)));
    (u32::from_le_bytes(bytes(file, 14)?) >= 40).then_some([side(38)?, side(42)?])
}

/// First directory of TIFF, of which EXIF is one.
fn of_tiff(file: &[u8]) -> Option<[f64; 2]> {
    let is_little = file.starts_with(b"II");
    let short = |at| {
        bytes(file, at).map(|pair| match is_little {
            true => u16::from_le_bytes(pair),
            false => u16::from_be_bytes(pair),
        })
    };
    let long = |at| {
        bytes(file, at).map(|word| match is_little {
            true => u32::from_le_bytes(word),
            false => u32::from_be_bytes(word),
        })
    };
    let first = long(4)? as usize;
    let (mut sides, mut unit) = ([None; 2], 2);
    for index in 0..usize::from(short(first)?) {
        let at = first.checked_add(2 + 12 * index)?;
        let ratio = || {
            let at = long(at + 8)? as usize;
            Some(f64::from(long(at)?) / f64::from(long(at.checked_add(4)?)?))
        };
        match short(at)? {
            282 => sides[0] = ratio(),
            283 => sides[1] = ratio(),
            296 => unit = short(at + 8)?,
            _ => {}
        }
    }
    let (_, unit_m) = UNITS_M.iter().find(|(number, _)| *number == unit)?;
    Some([sides[0]? / unit_m, sides[1]? / unit_m])
}
