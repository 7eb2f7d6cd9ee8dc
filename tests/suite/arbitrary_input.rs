//! Thousands of seeded random inputs through the checks that the targets in `fuzz/` drive, and what those have found.
use std::io::Cursor;

use crate::checks::{
    adaptive_identifier, csv_reader, fit_and_decomposition, motion_filter, names, picture_folder, picture_reader,
    picture_stream, polygon_reader, tracing,
};
use freeform_motion::outline_io::GrayImage;
use rand::{Rng as _, RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// So many random byte strings, each below a length.
fn random_bytes(seed: u64, count: usize, longest: usize) -> impl Iterator<Item = Vec<u8>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..count).map(move |_| {
        let mut bytes = vec![0; rng.random_range(0..longest)];
        rng.fill_bytes(&mut bytes);
        bytes
    })
}

/// The bytes with a few of them changed, taken out, or doubled.
fn damaged(original: &[u8], seed: u64, count: usize) -> impl Iterator<Item = Vec<u8>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..count).map(move |_| {
        let mut bytes = original.to_vec();
        for _ in 0..rng.random_range(1..6) {
            let place = rng.random_range(0..bytes.len());
            match rng.random_range(0..4) {
                0 => bytes[place] = rng.random(),
                1 => bytes[place] ^= 1 << rng.random_range(0..8),
                2 => drop(bytes.drain(place..(place + rng.random_range(1..20)).min(bytes.len() - 1).max(place))),
                _ => {
                    let end = (place + rng.random_range(1..20)).min(bytes.len());
                    let copy = bytes[place..end].to_vec();
                    bytes.splice(place..place, copy);
                }
            }
        }
        bytes
    })
}

#[test]
fn any_bytes_are_read_as_csv_or_refused() {
    random_bytes(1, 2000, 300).for_each(|bytes| csv_reader(&bytes));
    let good = b"frame,time,x,y,object,arc\n0,0,1,2,a,0\n0,0,3,4,a,0\n0,0,5,-6,a,1\n0,0,7,8e3,a,1\n\
        1,0.1,1,2,\"b\",\n1,0.1,2,2,b,\n1,0.1,1,3,b,\n# comment\n1,0.1,0,0,a,0\n1,0.1,0,1,a,0\n";
    csv_reader(good);
    damaged(good, 2, 5000).for_each(|bytes| csv_reader(&bytes));
}

/// A file that the tests of `outline-io` have too.
fn sample(name: &str) -> Vec<u8> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/outline-io/tests/data");
    std::fs::read(folder.join(name)).expect("a sample")
}

#[cfg(feature = "parquet")]
#[test]
fn any_bytes_are_read_as_parquet_or_refused() {
    use crate::checks::parquet_reader;
    random_bytes(21, 500, 300).for_each(|bytes| parquet_reader(&[b"PAR1", &bytes[..], b"PAR1"].concat()));
    for name in ["good-arrow", "good-gzip", "good-zstd", "good-types", "good-polars", "good-points", "arcs-rows"] {
        let good = sample(&format!("parquet/{name}.parquet"));
        parquet_reader(&good);
        damaged(&good, 22, 2000).for_each(|bytes| parquet_reader(&bytes));
    }
}

#[test]
fn any_bytes_are_read_as_polygons_or_refused() {
    for name in ["coco.json", "labelme-9.json", "trackmate.xml"] {
        let good = sample(&format!("polygons/{name}"));
        polygon_reader(&good);
        damaged(&good, 23, 2000).for_each(|bytes| polygon_reader(&bytes));
    }
}

#[test]
fn any_bytes_are_read_as_a_picture_or_refused() {
    random_bytes(3, 500, 300).for_each(|bytes| picture_reader(&bytes));
    let disc = GrayImage::from_fn(40, 30, |x, y| {
        let distance = (f64::from(x) - 20.0).hypot(f64::from(y) - 15.0);
        image::Luma([((10.0 - distance).clamp(0.0, 1.0) * 255.0) as u8])
    });
    let mut png = Cursor::new(Vec::new());
    disc.write_to(&mut png, image::ImageFormat::Png).expect("memory takes it");
    picture_reader(png.get_ref());
    damaged(png.get_ref(), 4, 2000).for_each(|bytes| picture_reader(&bytes));
}

#[test]
fn any_bytes_are_read_as_a_stream_of_pictures_or_refused() {
    let mut video = b"YUV4MPEG2 W16 H12 F25:1 A1:1 C420jpeg\n".to_vec();
    for frame in 0..3 {
        video.extend(b"FRAME\n");
        video.extend(
            (0..16 * 12).map(|i: i32| if (i % 16 - 8).abs() + (i / 16 - 6).abs() < 4 + frame { 220 } else { 20 }),
        );
        video.extend([128; 2 * 8 * 6]);
    }
    picture_stream(&video);
    damaged(&video, 10, 3000).for_each(|bytes| picture_stream(&bytes));
    let head = video.iter().position(|&byte| byte == b'\n').expect("a line");
    damaged(&video[..head], 11, 3000).for_each(|bytes| picture_stream(&[&bytes, &video[head..]].concat()));
}

#[test]
fn any_files_in_a_folder_are_read_as_pictures_or_refused() {
    random_bytes(12, 100, 600).for_each(|bytes| picture_folder(&bytes));
}

#[test]
fn any_name_is_shown_without_what_a_terminal_acts_upon() {
    random_bytes(13, 3000, 60).for_each(|bytes| names(&bytes));
    // Characters of two and three bytes, among which are the marks of direction.
    random_bytes(14, 3000, 60).for_each(|bytes| {
        let text: String = bytes
            .chunks_exact(2)
            .filter_map(|b| char::from_u32(u32::from_le_bytes([b[0], b[1] & 0x21, 0, 0])))
            .collect();
        names(text.as_bytes());
    });
}

#[test]
fn any_pixels_are_traced_or_refused() {
    random_bytes(5, 1000, 1500).for_each(|bytes| tracing(&bytes));
    // Blobs instead of noise: one grey value for many pixels in a row.
    random_bytes(6, 1000, 60).for_each(|bytes| {
        let pixels = bytes.iter().flat_map(|&value| std::iter::repeat_n(value & 0xc0, usize::from(value % 32)));
        tracing(&[13].into_iter().chain(pixels).collect::<Vec<u8>>());
    });
    // Found by fuzzing: a point was moved beyond the picture by one rounding.
    tracing(b"\x03\xff\xff\x00\xff\x2b\xc0\x05\xc0\x15\xff\xff\xe0\xe0\xe0\x15\xff\xff\xff\xff\xff\xff\xef\x14\xff\xff\xff\xff\xc0");
}

#[test]
fn any_points_are_fitted_and_decomposed_or_refused() {
    random_bytes(7, 1000, 1200).for_each(|bytes| fit_and_decomposition(&bytes));
}

#[test]
fn any_sequence_leaves_the_adaptive_identifier_finite() {
    random_bytes(8, 500, 1200).for_each(|bytes| adaptive_identifier(&bytes));
}

#[test]
fn any_sequence_leaves_the_motion_filter_finite() {
    random_bytes(9, 150, 1200).for_each(|bytes| motion_filter(&bytes));
}

#[cfg(feature = "serde")]
#[test]
fn any_bytes_are_read_as_a_saved_filter_or_refused() {
    random_bytes(12, 300, 60).for_each(|bytes| crate::checks::saved_state(&bytes));
}

#[test]
fn what_the_targets_in_fuzz_have_found_stays_mended() {
    // An arc of two points has no inside; its bounded fit was the polynomial 0.
    fit_and_decomposition(&[48, 255, 2, 1, 1, 0]);
    // Of an outline that says next to nothing the variances of a projective motion were beyond any number.
    motion_filter(&[
        47, 10, 223, 8, 0, 4, 4, 220, 220, 220, 0, 220, 220, 255, 255, 0, 0, 4, 1, 0, 0, 0, 0, 251, 0, 3, 99, 99, 0,
        99, 99, 99, 32,
    ]);
    motion_filter(&[255, 255, 255, 9, 255, 9, 91, 0, 0, 0, 14, 255, 153, 255, 255, 63, 255, 8, 8]);
    // A pipeline of a changed state could not be saved and restored after some frames.
    #[cfg(feature = "serde")]
    {
        crate::checks::saved_state(b"=J#=J#9J\xf52");
        crate::checks::saved_state(&[0x96, 0xb7, 0xa9]);
        crate::checks::saved_state(&[0xbd, 0x02, 0xc2]);
    }
    // A list of 1.2 billion truth values in 60 bytes, through which the library counted for seconds.
    #[cfg(feature = "parquet")]
    crate::checks::parquet_reader(&[
        80, 65, 82, 49, 70, 155, 146, 146, 1, 0, 21, 247, 82, 50, 0, 230, 155, 155, 155, 155, 155, 155, 155, 155, 101,
        100, 100, 100, 155, 155, 155, 155, 41, 155, 155, 155, 155, 117, 33, 155, 205, 10, 0, 58, 58, 58, 58, 58, 58,
        191, 41, 24, 39, 0, 0, 0, 80, 65, 82, 49,
    ]);
}
