//! What is chosen to be followed where no option says it.
use freeform_outline_io::{
    Channel, GrayImage, PictureError, PictureFrame, PictureSample, PictureSettings, Selection, TraceSettings,
    TracingEvidence, TracingWay, choose_tracing,
};
use image::Luma;

/// Noise of a few grey values, the same whenever it is asked for.
fn noise(x: u32, y: u32, frame: u32) -> f64 {
    let mut mixed = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ frame.wrapping_mul(0xc2b2_ae3d);
    mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2c1b_3c6d);
    f64::from((mixed ^ (mixed >> 13)) % 7) - 3.0
}

/// A picture of what is light at some places, with edges of a pixel.
fn picture(frame: u32, light: impl Fn(f64, f64) -> f64) -> GrayImage {
    GrayImage::from_fn(320, 240, |x, y| {
        let outside = light(f64::from(x) + 0.5, f64::from(y) + 0.5);
        Luma([(40.0 + 140.0 * (0.5 - outside).clamp(0.0, 1.0) + noise(x, y, frame)).round() as u8])
    })
}

/// Distance from a disc.
fn disc(x: f64, y: f64, [cx, cy, radius]: [f64; 3]) -> f64 {
    (x - cx).hypot(y - cy) - radius
}

/// Distance from a ruler that stands upright.
fn ruler(x: f64, y: f64) -> f64 {
    ((x - 150.0).abs() - 8.0).max((y - 120.0).abs() - 90.0)
}

fn chosen(pictures: &[GrayImage]) -> TracingEvidence {
    let sample = PictureSample::read(&[Channel::Luminance], |_| {
        let frame = |(frame, picture): (u64, GrayImage)| {
            let time = frame as f64 / 30.0;
            Ok::<_, PictureError>(PictureFrame { frame, time, file: "memory".to_owned(), picture: picture.into() })
        };
        Some((0..).zip(pictures.to_vec()).map(frame))
    });
    let trace = TraceSettings { minimum_area: 64, ..TraceSettings::default() };
    let choice = choose_tracing(&sample, &PictureSettings { trace, ..PictureSettings::default() }, &[]);
    choice.best().expect("a way").clone()
}

#[test]
fn a_small_disc_that_moves_is_followed_where_something_larger_rests() {
    // By its own size, and by four times that, from picture to picture.
    for (step, radius) in [(6.0, 8.0), (24.0, 6.0)] {
        let pictures = (0..12).map(|frame| {
            let place = [16.0 + step * f64::from(frame), 30.0 + 1.5 * f64::from(frame), radius];
            picture(frame, |x, y| ruler(x, y).min(disc(x, y, place)))
        });
        let best = chosen(&pictures.collect::<Vec<_>>());
        assert!(matches!(best.tracing.way, TracingWay::Median(_)) && !best.rests, "step {step}: {best:?}");
        assert!(best.movement > 3.0 * step, "step {step}: {best:?}");
    }
}

#[test]
fn what_rests_is_told_to_rest_where_nothing_moves() {
    let best = chosen(&(0..12).map(|frame| picture(frame, ruler)).collect::<Vec<_>>());
    assert!(best.rests && best.selection == Selection::Largest, "{best:?}");
}

#[test]
fn a_toothed_wheel_that_turns_in_its_place_is_followed_and_not_its_teeth() {
    for turn in [0.02, 0.2] {
        let wheel = |frame: u32| {
            picture(frame, move |x, y| {
                let (x, y) = (x - 160.0, y - 120.0);
                let along = y.atan2(x) - turn * f64::from(frame);
                x.hypot(y) - 60.0 - 8.0 * (5.0 * along).cos()
            })
        };
        let best = chosen(&(0..24).map(wheel).collect::<Vec<_>>());
        assert!(!matches!(best.tracing.way, TracingWay::Median(_)) && !best.rests, "{turn}: {best:?}");
        assert!((0.12..0.2).contains(&best.area_share), "{turn}: {best:?}");
    }
}

#[test]
fn a_disc_that_swings_slowly_does_not_rest() {
    // From picture to picture by less than it would be seen to move, and back to where it was.
    for amplitude in [0.0, 7.0] {
        let swinging = |frame: u32| {
            let along = amplitude * (std::f64::consts::TAU * f64::from(frame) / 24.0).cos();
            picture(frame, move |x, y| disc(x, y, [160.0 + along, 120.0, 40.0]))
        };
        let best = chosen(&(0..24).map(swinging).collect::<Vec<_>>());
        assert_eq!(best.rests, amplitude == 0.0, "{best:?}");
    }
}
