//! Sequences of pictures: files, folders, animations, video; rings and backgrounds; and bad ones.
use std::fs::File;
use std::io::{BufReader, Cursor};
use std::path::{Path, PathBuf};

use crate::support::traced;
use freeform_outline_io::{
    Background, Channel, Clipping, Contrast, GrayImage, PictureError, PictureErrorKind, PictureOutlines,
    PictureSequence, PictureSettings, Ring, SequenceSettings, TraceError, TraceSettings, TracedFrame, TracedOutline,
    picture_files, trace_mask,
};
use image::codecs::gif::GifEncoder;
use image::{Delay, DynamicImage, Frame, Luma, Rgb, RgbImage};

/// A light disc on dark ground.
fn disc(centre: f64, radius: f64) -> GrayImage {
    GrayImage::from_fn(80, 60, |column, row| {
        let distance = (f64::from(column) + 0.5 - centre).hypot(f64::from(row) + 0.5 - 30.0);
        Luma([(20.0 + 180.0 * (radius - distance + 0.5).clamp(0.0, 1.0)) as u8])
    })
}

fn open(paths: &[PathBuf]) -> PictureSequence {
    PictureSequence::open(paths, SequenceSettings::default()).expect("pictures")
}

fn stream(bytes: Vec<u8>, settings: SequenceSettings) -> Result<PictureSequence, PictureError> {
    PictureSequence::from_stream(BufReader::with_capacity(7, Cursor::new(bytes)), "<stdin>", settings)
}

fn gif(count: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = GifEncoder::new(&mut bytes);
    for frame in 0..count {
        let picture = DynamicImage::ImageLuma8(disc(20.0 + f64::from(frame), 10.0)).into_rgba8();
        let delay = Delay::from_numer_denom_ms(40, 1);
        encoder.encode_frame(Frame::from_parts(picture, 0, 0, delay)).expect("memory");
    }
    drop(encoder);
    bytes
}

/// Grey video with chroma planes of 128.
fn video(header: &str, pictures: &[GrayImage], chroma_bytes: usize) -> Vec<u8> {
    let mut bytes = format!("YUV4MPEG2 {header}\n").into_bytes();
    for picture in pictures {
        bytes.extend(b"FRAME\n");
        bytes.extend(picture.as_raw());
        bytes.extend(vec![128; chroma_bytes]);
    }
    bytes
}

#[test]
fn a_folder_and_a_pattern_are_read_in_natural_order() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, centre) in [("f10.png", 30.0), ("f9.bmp", 25.0), ("f1.tiff", 20.0), (".f2.png", 50.0)] {
        disc(centre, 10.0).save(folder.path().join(name)).expect("a picture");
    }
    std::fs::write(folder.path().join("notes.txt"), "no picture").expect("a file");
    let files = |sequence: PictureSequence| -> Vec<String> {
        let frames = sequence.map(|frame| frame.expect("a picture").file);
        frames.map(|file| Path::new(&file).file_name().expect("a name").to_string_lossy().into_owned()).collect()
    };
    let folder_sequence = open(&[folder.path().to_owned()]);
    assert_eq!(folder_sequence.frame_count(), Some(3));
    assert_eq!(files(folder_sequence), ["f1.tiff", "f9.bmp", "f10.png"]);
    assert_eq!(files(open(&[folder.path().join("f[19]*")])), ["f1.tiff", "f9.bmp", "f10.png"]);
    let nothing = PictureSequence::open(&[folder.path().join("g*.png")], SequenceSettings::default());
    assert!(nothing.expect_err("no match").to_string().ends_with("g*.png: no pictures found"));
}

#[test]
fn of_a_folder_with_nothing_but_compressed_video_the_first_video_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("a.txt"), "no video").expect("a file");
    let said = || picture_files(folder.path()).expect_err("nothing to read").to_string();
    assert!(said().ends_with(": no pictures found"), "{}", said());
    for name in ["clip-10.mp4", "clip-9.mp4"] {
        std::fs::write(folder.path().join(name), b"\0\0\0\x20ftypisom\0\0\x02\0isom").expect("a file");
    }
    assert!(said().contains("clip-9.mp4: MP4 video is not decoded here"), "{}", said());
    disc(20.0, 10.0).save(folder.path().join("frame.png")).expect("a picture");
    assert_eq!(picture_files(folder.path()).expect("pictures"), [folder.path().join("frame.png")]);
}

#[test]
fn the_frames_of_a_gif_come_at_their_own_times() {
    let times: Vec<f64> =
        stream(gif(3), SequenceSettings::default()).expect("a GIF").map(|frame| frame.expect("a frame").time).collect();
    assert!(times.iter().zip([0.0, 0.04, 0.08]).all(|(time, expected)| (time - expected).abs() < 1e-9), "{times:?}");
    let settings = SequenceSettings { frames_per_second: Some(10.0), ..SequenceSettings::default() };
    let last = stream(gif(3), settings).expect("a GIF").last().expect("three").expect("a frame");
    assert_eq!((last.frame, last.time), (2, 0.2));
}

#[test]
fn the_good_frames_of_a_cut_gif_count() {
    let whole = gif(4);
    let items: Vec<_> = stream(whole[..whole.len() * 5 / 8].to_vec(), SequenceSettings::default())
        .expect("the header is there")
        .collect();
    let good = items.iter().filter(|item| item.is_ok()).count();
    assert!((1..4).contains(&good), "{good}");
    let error = items.last().expect("items").as_ref().expect_err("the cut").to_string();
    assert!(error.starts_with(&format!("<stdin>: frame {good}: the picture is damaged")), "{error}");
}

#[test]
fn video_has_the_rate_and_pixels_that_its_header_says() {
    let pictures = [disc(20.0, 10.0), disc(30.0, 10.0)];
    for (colour, chroma) in [("C420jpeg", 2400), ("Cmono", 0), ("C422", 4800), ("C444", 9600), ("C411", 2400)] {
        let bytes = video(&format!("W80 H60 F25:2 Ip A8:7 {colour} XYSCSS=1"), &pictures, chroma);
        let mut sequence = stream(bytes, SequenceSettings::default()).expect("a video");
        assert_eq!(sequence.pixel_aspect(), Some(8.0 / 7.0));
        let second = sequence.nth(1).expect("two frames").expect("a frame");
        assert_eq!((second.time, &*second.picture), (0.08, &pictures[1]), "{colour}");
        assert!(sequence.next().is_none());
    }
}

#[test]
fn video_of_more_than_8_bits_keeps_its_upper_ones() {
    let mut bytes = b"YUV4MPEG2 W2 H1 Cmono10\nFRAME\n".to_vec();
    bytes.extend([0xff, 0x03, 0x04, 0x00]);
    let frame = stream(bytes, SequenceSettings::default()).expect("a video").next().expect("a frame");
    assert_eq!(frame.expect("a frame").picture.as_raw(), &[255, 1]);
}

#[test]
fn a_broken_video_says_where_and_keeps_what_came_before() {
    let message = |bytes: Vec<u8>| match stream(bytes, SequenceSettings::default()) {
        Err(error) => (0, error.to_string()),
        Ok(sequence) => {
            let items: Vec<_> = sequence.collect();
            let good = items.iter().filter(|item| item.is_ok()).count();
            (good, items.into_iter().find_map(Result::err).expect("an error").to_string())
        }
    };
    let whole = video("W80 H60", &[disc(20.0, 10.0), disc(30.0, 10.0)], 2400);
    let cut = "<stdin>: frame 1: the video ends within a frame, after 7195 of 7200 bytes".to_owned();
    assert_eq!(message(whole[..whole.len() - 5].to_vec()), (1, cut));
    let mut garbled = whole.clone();
    garbled[whole.len() - 7206..whole.len() - 7200].copy_from_slice(b"Frame\n");
    let found = "<stdin>: frame 1: \"Frame\" where a frame of the video should begin".to_owned();
    assert_eq!(message(garbled), (1, found));
    let of_header = |header: &str| message(format!("YUV4MPEG2 {header}\nFRAME\n").into_bytes()).1;
    assert_eq!(of_header("W80"), "<stdin>: the video header \"YUV4MPEG2 W80\" lacks the size");
    assert_eq!(of_header("W80 H0"), "<stdin>: the video parameter H0 is wrong or not supported");
    assert_eq!(of_header("W80 H60 C999"), "<stdin>: the video parameter C999 is wrong or not supported");
    assert_eq!(of_header("W20000 H20000"), "<stdin>: 20000 x 20000 pixels, more than 67108864 in all");
    assert_eq!(message(b"YUV4MPEG3 W1 H1\n".to_vec()).1, "<stdin>: not a picture");
    assert_eq!(message(Vec::new()).1, "<stdin>: the file is empty");
}

#[test]
fn pictures_that_cannot_be_read_leave_gaps_in_a_sequence() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    disc(20.0, 10.0).save(at("0.png")).expect("a picture");
    std::fs::write(at("1.png"), b"").expect("a file");
    std::fs::write(at("2.png"), b"no picture at all").expect("a file");
    GrayImage::new(40, 60).save(at("3.png")).expect("a picture");
    disc(30.0, 10.0).save(at("4.png")).expect("a picture");
    let whole = std::fs::read(at("4.png")).expect("a picture");
    std::fs::write(at("5.png"), &whole[..whole.len() / 2]).expect("a file");
    disc(40.0, 10.0).save(at("6.jpg")).expect("a picture");
    let items: Vec<_> = open(&[folder.path().to_owned()]).collect();
    let good: Vec<u64> = items.iter().flatten().map(|frame| frame.frame).collect();
    assert_eq!(good, [0, 4, 6]);
    let errors: Vec<&PictureError> = items.iter().filter_map(|item| item.as_ref().err()).collect();
    assert!(matches!(errors[0].kind, PictureErrorKind::Empty) && errors[0].file.ends_with("1.png"));
    assert!(matches!(errors[1].kind, PictureErrorKind::NotAPicture));
    assert!(matches!(errors[2].kind, PictureErrorKind::SizeChanged { width: 40, first_width: 80, .. }));
    assert!(matches!(errors[3].kind, PictureErrorKind::Damaged(_)));
}

#[test]
fn a_channel_shows_what_grey_values_hide() {
    // Of the same luminance as the ground, to a grey value.
    let picture = RgbImage::from_fn(80, 60, |x, _| if x < 30 { Rgb([200, 0, 0]) } else { Rgb([0, 59, 0]) });
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.png");
    picture.save(&path).expect("a picture");
    let grey = |channel| {
        let settings = SequenceSettings { channel, ..SequenceSettings::default() };
        let mut sequence = PictureSequence::open(std::slice::from_ref(&path), settings).expect("a picture");
        let picture = sequence.next().expect("one").expect("a picture").picture;
        [picture.get_pixel(0, 0).0[0], picture.get_pixel(79, 0).0[0]]
    };
    let [red, green] = grey(Channel::Luminance);
    assert!(red.abs_diff(green) <= 1);
    assert_eq!((grey(Channel::Red), grey(Channel::Green)), ([200, 0], [0, 59]));
    assert_eq!(grey(Channel::Saturation), [200, 59]);
}

/// A disc with a dark line around it on ground of its own colour that grows lighter to the right, with grain.
fn ringed(gap: f64, strength: f64) -> GrayImage {
    GrayImage::from_fn(160, 120, |column, row| {
        let (x, y) = (f64::from(column) + 0.5 - 80.0, f64::from(row) + 0.5 - 60.0);
        let from_line = (x.hypot(y) - 30.0).abs();
        let is_gap = y.abs() < gap && x > 0.0;
        let line = if is_gap { 0.0 } else { strength * (-0.5 * (from_line / 1.5).powi(2)).exp() };
        let grain = f64::from((column * 7919 + row * 104_729 + column * row * 31) % 7) - 3.0;
        Luma([(120.0 + 0.4 * x + grain - line) as u8])
    })
}

fn dark_ring() -> TraceSettings {
    let ring = Ring { contrast: Contrast::DarkOnLight, width: None };
    TraceSettings { ring: Some(ring), ..TraceSettings::default() }
}

#[test]
fn an_object_told_by_a_ring_is_traced_along_the_outer_edge_of_the_ring() {
    for strength in [25.0, 50.0, 80.0] {
        let found = trace_mask(&ringed(0.0, strength), &dark_ring()).expect("a ring");
        let distances: Vec<f64> = found.outline.points().map(|p| (p.x - 80.0).hypot(p.y - 60.0)).collect();
        let mean = distances.iter().sum::<f64>() / distances.len() as f64;
        let worst = distances.iter().map(|distance| (distance - mean).abs()).fold(0.0, f64::max);
        println!("strength {strength}: mean radius {mean:.2}, worst deviation {worst:.2}");
        // Half of the strength of a Gaussian line of width 1.5, blurred by 1, is 2.1 pixels from its middle.
        assert!((mean - 32.1).abs() < 0.6 && worst < 1.5, "strength {strength}: {mean}, {worst}");
    }
    let dark = ringed(0.0, 50.0);
    let inverted = GrayImage::from_fn(160, 120, |x, y| Luma([255 - dark.get_pixel(x, y).0[0]]));
    assert!(matches!(trace_mask(&GrayImage::new(160, 120), &dark_ring()), Err(TraceError::NoRing)));
    let light = Ring { contrast: Contrast::LightOnDark, width: Some(6.0) };
    let light = TraceSettings { ring: Some(light), ..TraceSettings::default() };
    assert!((trace_mask(&inverted, &light).expect("a ring").area / 3237.0 - 1.0).abs() < 0.06);
}

#[test]
fn a_ring_that_the_border_cuts_becomes_open_arcs() {
    let whole = ringed(0.0, 50.0);
    let settings = TraceSettings { clipping: Clipping::Open, ..dark_ring() };
    // The disc of radius 32 about (80, 60), cut by one border, by two, and by two with the corner between them.
    for (left, top, width, height, arcs) in [(70, 0, 90, 120, 1), (53, 0, 107, 87, 2), (65, 45, 95, 75, 1)] {
        let picture = image::imageops::crop_imm(&whole, left, top, width, height).to_image();
        let found = trace_mask(&picture, &settings).expect("a ring");
        assert!(found.touches_border);
        assert_eq!(found.outline.pieces().filter(|piece| !piece.closed).count(), arcs, "from {left}, {top}");
        let centre = (80.0 - f64::from(left), f64::from(height) - 60.0 + f64::from(top));
        let distances: Vec<f64> = found.outline.points().map(|p| (p.x - centre.0).hypot(p.y - centre.1)).collect();
        let mean = distances.iter().sum::<f64>() / distances.len() as f64;
        let worst = distances.iter().map(|distance| (distance - mean).abs()).fold(0.0, f64::max);
        println!("from {left}, {top}: mean radius {mean:.2}, worst deviation {worst:.2}, {} points", distances.len());
        assert!((mean - 32.1).abs() < 0.8 && worst < 2.5, "from {left}, {top}: {mean}, {worst}");
    }
    let gone = image::imageops::crop_imm(&whole, 120, 0, 40, 120).to_image();
    assert_eq!(trace_mask(&gone, &settings), Err(TraceError::NoRing));
}

#[test]
fn a_background_leaves_only_what_moves() {
    // Ground with structure brighter than the object.
    let ground = GrayImage::from_fn(80, 60, |x, y| Luma([if (x / 8 + y / 8) % 2 == 0 { 60 } else { 210 }]));
    let with_disc = |centre: f64| {
        GrayImage::from_fn(80, 60, |x, y| {
            let inside = (f64::from(x) + 0.5 - centre).hypot(f64::from(y) - 29.5) < 10.0;
            if inside { Luma([130]) } else { *ground.get_pixel(x, y) }
        })
    };
    let pictures: Vec<GrayImage> = (0..20).map(|frame| with_disc(12.0 + 3.0 * f64::from(frame))).collect();
    for background in [Background::Picture(ground.clone().into()), Background::RunningMedian(15)] {
        let settings = PictureSettings { background: Some(background), ..PictureSettings::default() };
        for (frame, traced) in traced(pictures.clone(), settings).iter().enumerate() {
            let (_, object) = &traced.objects.as_ref().expect("the disc")[0];
            assert!((object.centre.x - 12.0 - 3.0 * frame as f64).abs() < 0.5, "frame {frame}: {}", object.centre);
        }
    }
    let other_size = Background::Picture(GrayImage::new(3, 3).into());
    let settings = PictureSettings { background: Some(other_size), ..PictureSettings::default() };
    let refused = traced(vec![disc(20.0, 10.0)], settings);
    let said = refused[0].objects.as_ref().expect_err("another size").to_string();
    assert_eq!(said, "80 x 60 pixels, the background has 3 x 3");
}

#[test]
fn pictures_of_changing_size_have_a_median_of_their_own_size() {
    let of_size = |width: u32, centre: f64| {
        GrayImage::from_fn(width, 60, |x, y| {
            Luma([if (f64::from(x) - centre).hypot(f64::from(y) - 30.0) < 8.0 { 200 } else { 20 }])
        })
    };
    let pictures = (0..30).map(|frame| of_size(if frame < 12 { 80 } else { 50 }, 10.0 + f64::from(frame)));
    let settings = PictureSettings { background: Some(Background::RunningMedian(5)), ..PictureSettings::default() };
    let seen = traced(pictures.collect(), settings);
    let wrong_size = |frame: &TracedFrame| matches!(frame.objects, Err(TraceError::BackgroundSize { .. }));
    assert!(seen.iter().filter(|frame| wrong_size(frame)).count() <= 5);
    assert!(seen[29].objects.is_ok() && seen[0].objects.is_ok());
}

#[test]
fn noise_and_shading_alone_are_no_object() {
    let grain = |x: u32, y: u32| {
        let mixed = (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)).wrapping_mul(0xC2B2_AE35);
        ((mixed >> 16) % 23 + (mixed >> 8) % 19) as u8
    };
    let noise = GrayImage::from_fn(120, 90, |x, y| Luma([90 + grain(x, y)]));
    let shading = GrayImage::from_fn(120, 90, |x, y| Luma([60 + x as u8 + grain(x, y) / 8]));
    for picture in [noise, shading] {
        let error = trace_mask(&picture, &TraceSettings::default()).expect_err("no object");
        assert!(matches!(error, TraceError::NoContrast { .. }), "{error}");
    }
}

/// The folder of real data, if it is there.
fn data(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
    }
    path.exists().then_some(path)
}

/// How much the invariants change from one outline to the next that is as large.
fn changes_of_shape(found: &[TracedOutline]) -> String {
    let alike = found.windows(2).filter(|pair| (pair[1].area / pair[0].area).ln().abs() < 0.1);
    let change = |pair: &[TracedOutline]| Some(pair[0].invariants?.distance(&pair[1].invariants?));
    let mut changes: Vec<f64> = alike.filter_map(change).collect();
    changes.sort_by(f64::total_cmp);
    let share = |part: usize| changes[(changes.len() - 1) * part / 10];
    format!("change of shape: median {:.3}, 9 of 10 below {:.3}, largest {:.3}", share(5), share(9), share(10))
}

#[test]
fn the_robot_is_found_in_raw_frames_by_its_dark_ring() {
    let Some(folder) = data("sequences/microrobot_h/frames") else { return };
    let settings = SequenceSettings { channel: Channel::Red, ..SequenceSettings::default() };
    // Every tenth frame, and those around the change of light.
    let chosen = (0..140).filter(|frame| frame % 10 == 0 || (40..70).contains(frame) && frame % 3 == 0);
    let files: Vec<PathBuf> = chosen.map(|frame| folder.join(format!("{frame:04}.jpg"))).collect();
    let sequence = PictureSequence::open(&files, settings).expect("frames");
    let settings = PictureSettings { trace: dark_ring(), ..PictureSettings::default() };
    let found: Vec<TracedOutline> = PictureOutlines::new(sequence, settings)
        .expect("settings")
        .filter_map(|traced| Some(traced.expect("a frame").objects.ok()?.remove(0).1))
        .collect();
    println!("{}", changes_of_shape(&found));
    let areas: Vec<f64> = found.iter().map(|robot| robot.area).collect();
    let found = areas.iter().filter(|area| (15_000.0..17_000.0).contains(*area)).count();
    println!("{found} of {} frames", files.len());
    assert!(found + 1 >= files.len(), "{areas:?}");
}

#[test]
fn the_bolt_moves_evenly_while_it_is_in_view() {
    let Some(path) = data("sequences/bolt/bolt.gif") else { return };
    assert!(File::open(&path).is_ok());
    let outlines = PictureOutlines::new(open(&[path]), PictureSettings::default()).expect("settings");
    let seen: Vec<(f64, TracedOutline)> = outlines
        .filter_map(|traced| {
            let traced = traced.expect("a frame");
            let (_, bolt) = traced.objects.ok()?.into_iter().next()?;
            (!bolt.touches_border).then_some((traced.frame.time, bolt))
        })
        .collect();
    assert!(seen.len() > 15);
    let (times, bolts): (Vec<f64>, Vec<TracedOutline>) = seen.into_iter().unzip();
    println!("{}", changes_of_shape(&bolts));
    let between: Vec<[f64; 2]> =
        (1..times.len()).map(|k| [times[k] - times[k - 1], bolts[k].centre.x - bolts[k - 1].centre.x]).collect();
    // The file has delays of 6 and 7 hundredths of a second.
    assert!(between.iter().all(|[seconds, _]| (seconds * 15.0 - 1.0).abs() < 0.002), "{between:?}");
    assert!(between.iter().all(|[_, shift]| (shift / 23.2 - 1.0).abs() < 0.04), "{between:?}");
}
