//! Raster images: powers, rows and runs, against what the pixels say.

use image::codecs::jpeg::{JpegEncoder, PixelDensity};
use image::codecs::png::PngEncoder;
use image::codecs::webp::WebPEncoder;
use image::{DynamicImage, GrayImage, ImageEncoder, ImageFormat, Luma, LumaA, Rgb, RgbImage};
use std::io::Cursor;
use trirrr_toolpath::raster::{GreyImage, Raster, RasterSetup, Tones, read_image};
use trirrr_toolpath::{Act, Element, ToolPlace, ToolWork};

const TONES: Tones = Tones {
    count: 256,
    dither: false,
    negative: false,
};

const SETUP: RasterSetup = RasterSetup {
    origin: ToolPlace {
        position_m: [0.2, 0.1],
        alpha_rad: 0.3,
    },
    pitch_m: 1e-3,
    feed_m_s: 0.1,
    work: ToolWork {
        power: 0.8,
        follows_speed: true,
    },
    overscan_m: 0.0,
    one_way: false,
    list: None,
};

/// An image of `columns` with these tones, row by row from above.
fn image(columns: usize, tones: &[u8]) -> GreyImage {
    let rows = (tones.len() / columns) as u32;
    let pixels = GrayImage::from_raw(columns as u32, rows, tones.to_vec()).unwrap();
    let mut file = Vec::new();
    pixels
        .write_to(&mut Cursor::new(&mut file), ImageFormat::Png)
        .unwrap();
    read_image(&file).expect("an image")
}

fn raster(columns: usize, tones: &[u8], how: Tones) -> Raster {
    image(columns, tones)
        .raster(columns as f64, how)
        .expect("something to burn")
}

/// End of each element in mm of the image, its power, and true where it has a feed.
fn steps(elements: &[Element]) -> Vec<([f64; 2], f64, bool)> {
    let step = |each: &Element| {
        let Act::Motion(motion) = each.act else {
            panic!("no motion");
        };
        assert_eq!(motion.to.alpha_rad, 0.3);
        let [x, y] = motion.to.position_m;
        let place = [x - 0.2, y - 0.1].map(|metres| (1e9 * metres).round() / 1e6);
        let power = each.tool.map_or(0.0, |tool| tool.power);
        (
            place,
            (1e6 * power).round() / 1e6,
            motion.feed_m_s.is_some(),
        )
    };
    elements.iter().map(step).collect()
}

#[test]
fn rows_are_runs_of_equal_power_from_below_and_to_and_fro() {
    let tones = [
        255, 255, 255, 255, 255, // from above: nothing,
        255, 0, 0, 255, 255, // a bar,
        0, 255, 153, 153, 255, // and two tones with a gap.
    ];
    let path = raster(5, &tones, TONES).path(&SETUP).unwrap();
    let expected = [
        ([0.0, 0.5], 0.0, false),
        ([0.0, 0.5], 0.0, true),
        ([1.0, 0.5], 0.8, true),
        ([2.0, 0.5], 0.0, true),
        ([4.0, 0.5], 0.32, true),
        ([4.0, 0.5], 0.0, true),
        ([3.0, 1.5], 0.0, false),
        ([3.0, 1.5], 0.0, true),
        ([1.0, 1.5], 0.8, true),
        ([1.0, 1.5], 0.0, true),
    ];
    assert_eq!(steps(&path.elements), expected);
    let lines: Vec<u32> = path.elements.iter().map(|each| each.line).collect();
    assert_eq!(lines, (1..=10).collect::<Vec<_>>());
    assert_eq!(path.place_of(6), "row 1 from below");
    assert_eq!(path.place_of(7), "row 2 from below");
    let one_way = RasterSetup {
        one_way: true,
        ..SETUP
    };
    let path = raster(5, &tones, TONES).path(&one_way).unwrap();
    assert_eq!(steps(&path.elements)[8], ([3.0, 1.5], 0.8, true));
}

/// A machine that plays lists: a row is one motion, or a few, with a level for each pixel.
#[test]
fn rows_of_lists_have_the_pixels_in_the_sense_in_which_they_are_burnt() {
    let mut tones = vec![255, 0, 51, 0, 204, 255];
    tones.extend([0; 5]);
    tones.push(255);
    let setup = RasterSetup {
        list: Some(2),
        ..SETUP
    };
    let path = raster(6, &tones, TONES).path(&setup).unwrap();
    let expected = [
        ([0.0, 0.5], 0.0, false),
        ([0.0, 0.5], 0.0, true),
        ([2.0, 0.5], 0.8, true),
        ([4.0, 0.5], 0.8, true),
        ([5.0, 0.5], 0.8, true),
        ([5.0, 0.5], 0.0, true),
        ([5.0, 1.5], 0.0, false),
        ([5.0, 1.5], 0.0, true),
        ([3.0, 1.5], 0.8, true),
        ([1.0, 1.5], 0.8, true),
        ([1.0, 1.5], 0.0, true),
    ];
    assert_eq!(steps(&path.elements), expected);
    let lists = [
        (3, vec![255, 255]),
        (4, vec![255, 255]),
        (5, vec![255]),
        (9, vec![51, 255]),
        (10, vec![204, 255]),
    ];
    assert_eq!(path.lists, lists);
    // Few levels are parts of 255 as well, and a wide gap ends a list.
    let mut tones = [255; 12];
    (tones[0], tones[1], tones[11]) = (0, 128, 0);
    let few = Tones { count: 4, ..TONES };
    let path = raster(12, &tones, few).path(&RasterSetup {
        list: Some(100),
        overscan_m: 1e-3,
        ..SETUP
    });
    let lists = [(3, vec![255, 85]), (7, vec![255])];
    assert_eq!(path.unwrap().lists, lists);
}

#[test]
fn the_machine_has_its_speed_along_the_overscan_and_hurries_across_wide_gaps() {
    let mut tones = [255; 12];
    (tones[0], tones[11]) = (0, 0);
    let setup = RasterSetup {
        overscan_m: 2e-3,
        ..SETUP
    };
    let path = raster(12, &tones, TONES).path(&setup).unwrap();
    let expected = [
        ([-2.0, 0.5], 0.0, false),
        ([0.0, 0.5], 0.0, true),
        ([1.0, 0.5], 0.8, true),
        ([3.0, 0.5], 0.0, true),
        ([9.0, 0.5], 0.0, false),
        ([11.0, 0.5], 0.0, true),
        ([12.0, 0.5], 0.8, true),
        ([14.0, 0.5], 0.0, true),
    ];
    assert_eq!(steps(&path.elements), expected);
    let Act::Motion(last) = path.elements[7].act else {
        panic!("no motion");
    };
    assert!(last.stops);
}

/// Sum of the powers over all pixels.
fn burnt(raster: &Raster) -> f64 {
    let path = raster.path(&SETUP).unwrap();
    let mut at = [0.0; 2];
    let mut sum = 0.0;
    for (to, power, _) in steps(&path.elements) {
        sum += power / 0.8 * (to[0] - at[0]).abs();
        at = to;
    }
    sum
}

#[test]
fn few_levels_keep_the_mean_tone_where_they_are_dithered() {
    let (columns, rows) = (120, 90);
    let tones: Vec<u8> = (0..columns * rows)
        .map(|at| (at % columns * 255 / (columns - 1)) as u8)
        .collect();
    let mean: f64 = tones
        .iter()
        .map(|tone| 1.0 - f64::from(*tone) / 255.0)
        .sum();
    for count in [2, 3, 8] {
        let how = Tones {
            count,
            dither: true,
            negative: false,
        };
        let found = burnt(&raster(columns, &tones, how));
        assert!((found / mean - 1.0).abs() < 0.01, "{count}: {found} {mean}");
        // The darker half has as much in itself.
        let half: Vec<u8> = tones
            .chunks(columns)
            .flat_map(|row| &row[..columns / 2])
            .copied()
            .collect();
        let part = burnt(&raster(columns / 2, &half, how));
        assert!((part / mean - 0.75).abs() < 0.01, "{count}: {part}");
    }
    // Without it, two levels are black and white.
    let plain = Tones { count: 2, ..TONES };
    assert_eq!(burnt(&raster(columns, &tones, plain)), (rows * 60) as f64);
    let inverse = Tones {
        negative: true,
        ..TONES
    };
    let both = burnt(&raster(columns, &tones, inverse)) + burnt(&raster(columns, &tones, TONES));
    assert!(
        (both - (columns * rows) as f64).abs() < 1e-6 * both,
        "{both}"
    );
}

#[test]
fn an_image_is_brought_to_the_pitch() {
    // Stripes of 2 pixels; four of the file on one of the machine are their mean.
    let tones: Vec<u8> = (0..64 * 8)
        .map(|at| if at / 2 % 2 == 0 { 0 } else { 255 })
        .collect();
    let small = image(64, &tones).raster(16.0, TONES).unwrap();
    let path = small.path(&SETUP).unwrap();
    let inner = steps(&path.elements)
        .into_iter()
        .filter(|([x, _], power, _)| *power > 0.0 && (2.0..15.0).contains(x));
    for (_, power, _) in inner {
        assert!((power - 0.4).abs() < 0.02, "{power}");
    }
    assert!(path.place_of(u32::MAX).starts_with("row 2 "));
    assert_eq!(image(64, &tones).aspect(), 0.125);
}

#[test]
fn an_image_that_is_too_large_is_refused_by_its_head() {
    let mut file = Vec::new();
    GrayImage::from_pixel(2, 2, Luma([0_u8]))
        .write_to(&mut Cursor::new(&mut file), ImageFormat::Png)
        .unwrap();
    // Width and height in the head of a PNG. The pixels are missing, which is not looked at.
    for side in [16, 20] {
        file[side..side + 4].copy_from_slice(&20_000_u32.to_be_bytes());
    }
    let sum = crc(&file[12..29]);
    file[29..33].copy_from_slice(&sum.to_be_bytes());
    let refused = read_image(&file).unwrap_err();
    assert!(
        refused.reason.contains("20000 by 20000 pixels"),
        "{refused:?}"
    );
}

/// Checksum of a PNG's chunk.
fn crc(bytes: &[u8]) -> u32 {
    let fold = |mut sum: u32, byte: &u8| {
        sum ^= u32::from(*byte);
        for _ in 0..8 {
            sum = (sum >> 1) ^ (0xEDB8_8320 & (sum & 1).wrapping_neg());
        }
        sum
    };
    !bytes.iter().fold(!0, fold)
}

#[test]
fn colours_are_luma_and_what_is_transparent_is_white() {
    let mut file = Vec::new();
    RgbImage::from_pixel(2, 2, Rgb([0, 255, 0]))
        .write_to(&mut Cursor::new(&mut file), ImageFormat::Bmp)
        .unwrap();
    let green = read_image(&file).unwrap().raster(2.0, TONES).unwrap();
    // BT.709: green is 0.7152 of white.
    assert!((burnt(&green) / 4.0 - 0.2848).abs() < 0.005);
    let mut file = Vec::new();
    let glass = image::ImageBuffer::from_fn(2, 1, |column, _| LumaA([0_u8, 255 * column as u8]));
    glass
        .write_to(&mut Cursor::new(&mut file), ImageFormat::Png)
        .unwrap();
    let path = read_image(&file).unwrap().raster(2.0, TONES).unwrap();
    assert!((burnt(&path) - 1.0).abs() < 1e-6);
    let mut file = Vec::new();
    GrayImage::from_pixel(16, 16, Luma([128_u8]))
        .write_to(&mut Cursor::new(&mut file), ImageFormat::Jpeg)
        .unwrap();
    let grey = read_image(&file).unwrap().raster(16.0, TONES).unwrap();
    assert!((burnt(&grey) / 256.0 - 0.5).abs() < 0.02);
}

#[test]
fn what_is_no_image_is_refused() {
    for (bytes, word) in [
        (&b"GIF89a"[..], "image"),
        (b"", "image"),
        (b"\x89PNG\r\n\x1a\n", "image"),
    ] {
        let fault = read_image(bytes).expect_err("no image");
        assert!(fault.reason.contains(word), "{fault}");
    }
    let white = image(4, &[255; 16]);
    let fault = white.raster(4.0, TONES).expect_err("nothing");
    assert!(fault.reason.contains("--negative"), "{fault}");
    let fault = white.raster(1e6, TONES).expect_err("too fine");
    assert!(fault.reason.contains("--pitch"), "{fault}");
    // A whole file with any byte changed, or cut off, gives an image or a fault.
    let mut file = Vec::new();
    GrayImage::from_fn(9, 9, |x, y| Luma([(x * y) as u8]))
        .write_to(&mut Cursor::new(&mut file), ImageFormat::Png)
        .unwrap();
    for place in 0..file.len() {
        let mut damaged = file.clone();
        damaged[place] ^= 0xff;
        let _ = read_image(&damaged).map(|image| image.raster(9.0, TONES));
        // The last chunk only says that it is the last one.
        let is_cut = place < file.len() - 12;
        assert!(
            !is_cut || read_image(&file[..place]).is_err(),
            "cut at {place}"
        );
    }
}

/// EXIF data: its orientation, and a density by inch.
fn exif(orientation: u16, dpi: u32) -> Vec<u8> {
    let mut data = b"MM\0\x2A\0\0\0\x08\0\x04".to_vec();
    let long = |value: u32| value.to_be_bytes();
    let mut tag = |number: u16, kind: u16, value: [u8; 4]| {
        data.extend(number.to_be_bytes());
        data.extend(kind.to_be_bytes());
        data.extend(long(1));
        data.extend(value);
    };
    let [high, low] = orientation.to_be_bytes();
    tag(274, 3, [high, low, 0, 0]);
    tag(282, 5, long(62));
    tag(283, 5, long(62));
    tag(296, 3, [0, 2, 0, 0]);
    data.extend([long(0), long(dpi), long(1)].concat());
    data
}

/// Corner of an image of 16 by 8 that is burnt, in the eight ways of EXIF: what is black of the file comes to stand there.
#[test]
fn an_image_stands_as_its_exif_says() {
    // Black: the left half of the upper half.
    let pixels = GrayImage::from_fn(32, 16, |column, row| {
        Luma([if column < 16 && row < 8 { 0 } else { 255 }])
    });
    // As a viewer shows it, black is above (true) or below, left (true) or right.
    let shown = [
        (true, true),
        (true, false),
        (false, false),
        (false, true),
        (true, true),
        (true, false),
        (false, false),
        (false, true),
    ];
    for (orientation, (above, left)) in (1..=8).zip(shown) {
        let data = exif(orientation, 254);
        let mut png = Vec::new();
        let mut encoder = PngEncoder::new(&mut png);
        encoder.set_exif_metadata(data.clone()).unwrap();
        pixels.write_with_encoder(encoder).unwrap();
        let mut jpeg = Vec::new();
        let mut encoder = JpegEncoder::new_with_quality(&mut jpeg, 100);
        encoder.set_exif_metadata(data.clone()).unwrap();
        pixels.write_with_encoder(encoder).unwrap();
        let mut webp = Vec::new();
        let mut encoder = WebPEncoder::new_lossless(&mut webp);
        encoder.set_exif_metadata(data).unwrap();
        pixels.write_with_encoder(encoder).unwrap();
        for file in [png, jpeg, webp] {
            let found = read_image(&file).expect("an image");
            let sides = if orientation < 5 { [32, 16] } else { [16, 32] };
            assert_eq!(
                [
                    found.columns(),
                    (f64::from(found.columns()) * found.aspect()) as u32
                ],
                sides,
                "{orientation}"
            );
            let two = Tones { count: 2, ..TONES };
            let path = found
                .raster(f64::from(sides[0]), two)
                .unwrap()
                .path(&SETUP)
                .unwrap();
            for ([x, y], power, _) in steps(&path.elements) {
                let is_left = x <= 0.5 * f64::from(sides[0]) + 1e-9;
                let is_above = y > 0.5 * f64::from(sides[1]);
                assert!(power == 0.0 || is_left || !left, "{orientation}: {x}");
                assert!(power == 0.0 || is_above == above, "{orientation}: {y}");
            }
            assert!(
                steps(&path.elements)
                    .iter()
                    .any(|(_, power, _)| *power > 0.0)
            );
        }
    }
}

#[test]
fn stills_of_every_kind_are_read() {
    let pixels = GrayImage::from_fn(5, 3, |column, row| {
        Luma([if column < row { 0 } else { 255 }])
    });
    let by = |format: ImageFormat| {
        let mut file = Vec::new();
        let image = DynamicImage::ImageLuma8(pixels.clone());
        let image = match format {
            ImageFormat::Gif => DynamicImage::ImageRgba8(image.into_rgba8()),
            _ => image,
        };
        image.write_to(&mut Cursor::new(&mut file), format).unwrap();
        file
    };
    let expected = read_image(&by(ImageFormat::Png))
        .unwrap()
        .raster(5.0, TONES)
        .unwrap();
    for format in [
        ImageFormat::Bmp,
        ImageFormat::Gif,
        ImageFormat::Tiff,
        ImageFormat::WebP,
    ] {
        let found = read_image(&by(format)).unwrap_or_else(|fault| panic!("{format:?}: {fault}"));
        assert_eq!(found.raster(5.0, TONES).unwrap(), expected, "{format:?}");
    }
}

#[test]
fn the_size_of_pixels_is_that_of_the_file() {
    let pixels = GrayImage::from_pixel(8, 8, Luma([0]));
    let near = |file: &[u8], pitch_mm: f64| {
        let found = 1e3 * read_image(file).unwrap().pitch_m().unwrap();
        assert!((found - pitch_mm).abs() < 1e-5, "{found} is not {pitch_mm}");
    };
    let mut jpeg = Vec::new();
    let mut encoder = JpegEncoder::new(&mut jpeg);
    encoder.set_pixel_density(PixelDensity::dpi(254));
    pixels.write_with_encoder(encoder).unwrap();
    near(&jpeg, 0.1);
    let mut jpeg = Vec::new();
    let mut encoder = JpegEncoder::new(&mut jpeg);
    encoder.set_exif_metadata(exif(1, 508)).unwrap();
    pixels.write_with_encoder(encoder).unwrap();
    near(&jpeg, 0.05);
    let mut png = Vec::new();
    pixels
        .write_to(&mut Cursor::new(&mut png), ImageFormat::Png)
        .unwrap();
    let fault = read_image(&png).unwrap().pitch_m().expect_err("no size");
    assert!(fault.to_string().contains("--pitch MM"), "{fault}");
    for (sides, pitch_mm) in [([10_000_u32, 10_000], Some(0.1)), ([10_000, 20_000], None)] {
        let mut chunk = b"pHYs".to_vec();
        chunk.extend(sides.map(u32::to_be_bytes).as_flattened());
        chunk.push(1);
        let sum = crc(&chunk).to_be_bytes();
        // Behind the head of 33 bytes.
        let file = [&png[..33], &9_u32.to_be_bytes(), &chunk, &sum, &png[33..]].concat();
        match pitch_mm {
            Some(pitch_mm) => near(&file, pitch_mm),
            None => {
                let fault = read_image(&file)
                    .unwrap()
                    .pitch_m()
                    .expect_err("no squares");
                assert!(fault.to_string().contains("no squares"), "{fault}");
            }
        }
    }
}
