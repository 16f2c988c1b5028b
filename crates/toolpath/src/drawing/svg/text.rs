//! Bytes of a file to its text.

use crate::PathFault;
use flate2::read::MultiGzDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Most bytes of a compressed file, unpacked.
const UNPACKED_MAX: u64 = 1 << 28;

/// Characters of the bytes 0x80 to 0x9F in windows-1252, which Latin-1 means on the web.
const WINDOWS_1252: [char; 32] = [
    '\u{20AC}', '\u{81}', '\u{201A}', '\u{192}', '\u{201E}', '\u{2026}', '\u{2020}', '\u{2021}',
    '\u{2C6}', '\u{2030}', '\u{160}', '\u{2039}', '\u{152}', '\u{8D}', '\u{17D}', '\u{8F}',
    '\u{90}', '\u{2018}', '\u{2019}', '\u{201C}', '\u{201D}', '\u{2022}', '\u{2013}', '\u{2014}',
    '\u{2DC}', '\u{2122}', '\u{161}', '\u{203A}', '\u{153}', '\u{9D}', '\u{17E}', '\u{178}',
];

fn fault(line: u32, word: &str, reason: String) -> PathFault {
    PathFault {
        line,
        word: word.to_owned(),
        reason,
    }
}

/// Text of a file: UTF-8, UTF-16, Latin-1 or windows-1252, plain or packed by gzip.
///
/// # Errors
/// Another encoding, a byte that its encoding does not have, a damaged archive.
pub(super) fn decode(file: &[u8]) -> Result<Cow<'_, str>, PathFault> {
    if !file.starts_with(&[0x1f, 0x8b]) {
        return plain(file);
    }
    let mut unpacked = Vec::new();
    let read = MultiGzDecoder::new(file)
        .take(UNPACKED_MAX + 1)
        .read_to_end(&mut unpacked);
    match read {
        Err(error) => Err(fault(
            0,
            "",
            format!("the packed SVG (svgz) is damaged: {error}"),
        )),
        Ok(length) if length as u64 > UNPACKED_MAX => Err(fault(
            0,
            "",
            format!("the packed SVG (svgz) has more than {UNPACKED_MAX} bytes"),
        )),
        Ok(_) => plain(&unpacked).map(|text| Cow::Owned(text.into_owned())),
    }
}

fn plain(file: &[u8]) -> Result<Cow<'_, str>, PathFault> {
    match file {
        [0xEF, 0xBB, 0xBF, text @ ..] => utf8(text, None),
        [0xFF, 0xFE, text @ ..] => utf16(text, u16::from_le_bytes),
        [0xFE, 0xFF, text @ ..] => utf16(text, u16::from_be_bytes),
        [b'<', 0, ..] => utf16(file, u16::from_le_bytes),
        [0, b'<', ..] => utf16(file, u16::from_be_bytes),
        _ => {
            let name = declared(file).unwrap_or_default();
            match name.to_ascii_lowercase().as_str() {
                "" => utf8(file, None),
                "utf-8" | "utf8" | "us-ascii" | "ascii" => utf8(file, Some(&name)),
                "iso-8859-1" | "iso8859-1" | "latin1" | "latin-1" | "l1" | "windows-1252"
                | "cp1252" => Ok(Cow::Owned(file.iter().map(|&byte| latin(byte)).collect())),
                // Letters of other encodings are in names alone, if the file has any.
                _ if file.is_ascii() => utf8(file, None),
                _ => Err(fault(
                    1,
                    &name,
                    "the file is in an encoding that is not read; save it as UTF-8".into(),
                )),
            }
        }
    }
}

fn latin(byte: u8) -> char {
    match byte {
        0x80..=0x9F => WINDOWS_1252[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

/// Encoding that the XML declaration names.
fn declared(file: &[u8]) -> Option<String> {
    let head = &file[..file.len().min(256)];
    let head: String = head.iter().map(|&byte| char::from(byte)).collect();
    let head = head.trim_start().strip_prefix("<?xml")?;
    let head = &head[..head.find("?>")?];
    let value = head.split_once("encoding")?.1.trim_start();
    let value = value.strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|c| "\"'".contains(*c))?;
    Some(value[1..].split(quote).next()?.to_owned())
}

fn utf8<'f>(file: &'f [u8], declared: Option<&str>) -> Result<Cow<'f, str>, PathFault> {
    str::from_utf8(file).map(Cow::Borrowed).map_err(|error| {
        let at = error.valid_up_to();
        let line = 1 + file[..at].iter().filter(|&&byte| byte == b'\n').count();
        let name = match declared {
            Some(name) => format!("the file says that it is {name}"),
            None => "the file names no other encoding".to_owned(),
        };
        fault(
            u32::try_from(line).unwrap_or(u32::MAX),
            &format!("byte 0x{:02X}", file[at]),
            format!("no UTF-8 at byte {at} of the file, and {name}; save it as UTF-8"),
        )
    })
}

fn utf16(file: &[u8], unit: fn([u8; 2]) -> u16) -> Result<Cow<'_, str>, PathFault> {
    let (pairs, rest) = file.as_chunks::<2>();
    let text = char::decode_utf16(pairs.iter().map(|pair| unit(*pair))).collect::<Result<_, _>>();
    match (text, rest) {
        (Ok(text), []) => Ok(Cow::Owned(text)),
        _ => Err(fault(
            0,
            "",
            "the file is damaged UTF-16; save it as UTF-8".into(),
        )),
    }
}
