//! Encodings of files.

use super::{SEEN, length, page};
use flate2::{Compression, write::GzEncoder};
use std::io::Write;
use trirrr_toolpath::drawing::read_svg;

#[test]
fn files_of_every_encoding_are_read() {
    let latin = b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"100mm\" viewBox=\"0 0 100 100\"><title>gr\xFC\xDFe</title><path id=\"\xE4\" d=\"M10 10H90\" stroke=\"#000\"/></svg>";
    let text = page(SEEN);
    let utf16 = |mark: &[u8], unit: fn(u16) -> [u8; 2]| {
        let mut bytes = mark.to_vec();
        bytes.extend(text.encode_utf16().flat_map(unit));
        bytes
    };
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(text.as_bytes()).unwrap();
    let packed = packed.finish().unwrap();
    for bytes in [
        latin.to_vec(),
        [b"\xEF\xBB\xBF", text.as_bytes()].concat(),
        utf16(b"\xFF\xFE", u16::to_le_bytes),
        utf16(b"\xFE\xFF", u16::to_be_bytes),
        utf16(b"", u16::to_le_bytes),
        packed.clone(),
        text.replace('\n', "\r\n").into_bytes(),
        format!("<?xml version='1.0' encoding='windows-1250'?>{text}").into_bytes(),
    ] {
        let found = read_svg(&bytes).unwrap_or_else(|fault| panic!("{fault}: {bytes:?}"));
        assert!((length(&found.strokes) - 80.0).abs() < 1e-9);
    }
    assert_eq!(read_svg(latin).unwrap().place_of(2), "shape 1 (\u{e4})");
    for (bytes, line, word, reason) in [
        (
            b"<svg>\n<title>gr\xFC\xDFe</title></svg>".to_vec(),
            2,
            "byte 0xFC",
            "save it as UTF-8",
        ),
        (
            b"<?xml version='1.0' encoding='windows-1251'?><svg>\xE4</svg>".to_vec(),
            1,
            "windows-1251",
            "save it as UTF-8",
        ),
        (packed[..packed.len() / 2].to_vec(), 0, "", "damaged"),
        (b"\xFF\xFE<".to_vec(), 0, "", "UTF-16"),
        (b"PK\x03\x04".to_vec(), 1, "", "no SVG"),
        (Vec::new(), 1, "", "no SVG"),
    ] {
        let fault = read_svg(&bytes).expect_err(reason);
        assert_eq!((fault.line, fault.word.as_str()), (line, word), "{fault}");
        assert!(fault.reason.contains(reason), "{fault}");
    }
}
