//! Drawings as an animation, as a video, and of the ways of tracing.
use std::path::Path;

use image::{AnimationDecoder as _, GrayImage, Luma};

use crate::support::{run, stderr, stdout, succeed};

/// Pictures of an L that drifts, with the noise of a camera, in a folder.
fn frames(base: &Path, count: u32) -> String {
    let folder = base.join("frames");
    std::fs::create_dir(&folder).expect("a folder");
    let mut noise = 12345_u32;
    for frame in 0..count {
        let picture = GrayImage::from_fn(160, 120, |x, y| {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let (x, y) = (x as i32 - 40 - frame as i32, y as i32 - 40);
            let is_inside =
                (0..40).contains(&x) && (0..14).contains(&y) || (0..14).contains(&x) && (0..40).contains(&y);
            Luma([if is_inside { 190 } else { 40 } + (noise >> 24) as u8 % 9])
        });
        picture.save(folder.join(format!("{frame}.png"))).expect("a picture");
    }
    folder.to_str().expect("UTF-8").to_owned()
}

fn size(path: impl AsRef<Path>) -> u64 {
    std::fs::metadata(path).expect("a file").len()
}

#[test]
fn an_animation_is_no_larger_than_the_pictures_that_it_was_made_of_and_shows_them_in_their_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let (pictures, drawn) = (frames(folder.path(), 12), folder.path().join("drawn.gif"));
    succeed(&format!("identify {pictures} --fps 5 --light --quiet --overlay {}", drawn.display()), "");
    let of_pictures: u64 =
        std::fs::read_dir(&pictures).expect("a folder").map(|e| size(e.expect("a file").path())).sum();
    println!("animation {} bytes, pictures {of_pictures} bytes", size(&drawn));
    assert!(size(&drawn) < of_pictures);
    let file = std::io::BufReader::new(std::fs::File::open(&drawn).expect("an animation"));
    let decoder = image::codecs::gif::GifDecoder::new(file).expect("a GIF");
    let shown: Vec<_> = decoder.into_frames().map(|frame| frame.expect("a picture")).collect();
    assert_eq!(shown.len(), 12);
    assert!(shown.iter().all(|frame| frame.delay().numer_denom_ms() == (200, 1)));
    // What is shown is what a folder of drawings holds, but for a few grey values.
    succeed(&format!("identify {pictures} --fps 5 --light --quiet --overlay {}/drawn", folder.path().display()), "");
    for (number, frame) in shown.iter().enumerate() {
        let whole = image::open(folder.path().join(format!("drawn/{number:06}.png"))).expect("a picture").into_rgb8();
        let pairs = whole.pixels().zip(frame.buffer().pixels());
        let grey = pairs.filter(|(pixel, _)| pixel.0[0] == pixel.0[1] && pixel.0[1] == pixel.0[2]);
        let off = grey.map(|(pixel, shown)| pixel.0[0].abs_diff(shown.0[0])).max();
        assert!(off.is_some_and(|off| off <= 8), "frame {number} is off by {off:?}");
    }
}

#[test]
fn a_video_of_drawings_has_their_rate_and_is_read_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let (pictures, base) = (frames(folder.path(), 5), folder.path().display());
    succeed(&format!("track {pictures} --fps 12.5 --light --overlay {base}/drawn.y4m"), "");
    let video = std::fs::read(folder.path().join("drawn.y4m")).expect("a video");
    assert!(video.starts_with(b"YUV4MPEG2 W160 H120 F12500:1000 Ip A1:1 C444\nFRAME\n"));
    assert_eq!(video.len(), 45 + 5 * (6 + 3 * 160 * 120));
    let csv = succeed(&format!("outline {base}/drawn.y4m --threshold 100"), "");
    assert!(csv.contains("\n4,0.32,"), "the times of the video");
    // A name of another kind of video is none of a folder.
    let refused = run(&format!("track {pictures} --overlay {base}/drawn.mp4"), "");
    assert!(stderr(&refused).contains("one animation FILE.gif or FILE.y4m"), "{}", stderr(&refused));
}

#[test]
fn the_ways_of_tracing_are_drawn_where_they_are_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let (pictures, base) = (frames(folder.path(), 12), folder.path().display());
    succeed(&format!("outline {pictures} --output {base}/o.csv --candidates {base}/ways.png"), "");
    let sheet = image::open(folder.path().join("ways.png")).expect("a picture").into_rgb8();
    assert!(sheet.width() > 4 * 160 && sheet.height() > 120, "{:?}", sheet.dimensions());
    let count = |is_wanted: fn([u8; 3]) -> bool| sheet.pixels().filter(|pixel| is_wanted(pixel.0)).count();
    assert!(count(|[red, _, blue]| red > 200 && blue < 120) > 100, "outlines");
    assert!(count(|colour| colour == [235; 3]) > 500, "options");
    let given = run(&format!("outline {pictures} --light --candidates {base}/none.png"), "");
    assert!(stderr(&given).contains("none.png: not written, as no way of tracing was chosen"), "{}", stderr(&given));
    assert!(!folder.path().join("none.png").exists());
    let input = run(&format!("outline {pictures} --candidates {pictures}/3.png"), "");
    assert_eq!((input.status.code(), stdout(&input).as_str()), (Some(2), ""));
    assert!(stderr(&input).contains("a file of the input"), "{}", stderr(&input));
}
