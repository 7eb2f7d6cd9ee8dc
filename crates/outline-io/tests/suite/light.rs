//! Bodies that their motion blurs, in grey values that are not in proportion to light.
use freeform_outline_io::{
    Background, Contrast, Difference, GrayImage, PictureFrame, PictureOutlines, PictureSettings, TraceSettings,
    Transfer, trace_mask,
};
use image::Luma;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

use crate::choice::{choice, noise};
use crate::edges::share_of_moving_disc;

/// The grey value of a light from 0 to 1, by the transfer function of sRGB.
fn srgb(light: f64) -> u8 {
    let value = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (255.0 * value).round() as u8
}

/// A disc of radius 40 that has moved by `way` pixels to the right while the shutter was open, in a picture of 160 by 120: the mean of its light,
/// from `ground` to `body`, before it is told as grey values by the transfer function.
fn moved_disc(way: f64, [ground, body]: [f64; 2]) -> GrayImage {
    GrayImage::from_fn(160, 120, |column, row| {
        let place = [f64::from(column) + 0.5 - 80.3, f64::from(row) + 0.5 - 60.1];
        let share = share_of_moving_disc(place, 40.0, [way, 0.0]);
        Luma([srgb(ground + share * (body - ground))])
    })
}

#[test]
fn a_body_that_its_motion_blurs_keeps_its_size_where_its_light_is_looked_at() {
    for (contrast, light) in [(Contrast::LightOnDark, [0.05, 0.6]), (Contrast::DarkOnLight, [0.7, 0.02])] {
        // How much wider than high it is seen, against the grey values as they are.
        let grown = |way: f64, transfer: Transfer| {
            let settings = TraceSettings { contrast, transfer, y_up: false, ..TraceSettings::default() };
            let traced = trace_mask(&moved_disc(way, light), &settings).expect("the disc");
            let [left, right] =
                traced.outline.points().fold([f64::INFINITY, 0.0], |[a, b], p| [a.min(p.x), f64::max(b, p.x)]);
            right - left - 80.0
        };
        let sign = if contrast == Contrast::LightOnDark { 1.0 } else { -1.0 };
        for way in [6.0, 12.0] {
            let [linear, srgb] =
                [Transfer::Linear, Transfer::Srgb].map(|transfer| grown(way, transfer) - grown(0.0, transfer));
            assert!(sign * linear > 0.12 * way, "{contrast:?} {way}: {linear}");
            assert!(srgb.abs() < 0.25 * linear.abs(), "{contrast:?} {way}: {srgb} {linear}");
        }
    }
}

#[test]
fn light_is_compared_with_that_of_a_background_and_not_grey_values() {
    let light = [0.05, 0.6];
    let ground = GrayImage::from_pixel(160, 120, Luma([srgb(light[0])]));
    let outline_of = |background: Option<Background>, difference: Difference| {
        let frame =
            PictureFrame { frame: 0, time: 0.0, file: "memory".to_owned(), picture: moved_disc(9.0, light).into() };
        let trace = TraceSettings { transfer: Transfer::Srgb, ..TraceSettings::default() };
        let settings = PictureSettings { trace, background, difference, ..PictureSettings::default() };
        let mut traced = PictureOutlines::new(std::iter::once(Ok(frame)), settings).expect("settings");
        let objects = traced.next().expect("a picture").expect("read").objects.expect("the disc");
        objects[0].1.outline.points().copied().collect::<Vec<_>>()
    };
    let plain = outline_of(None, Difference::Either);
    for difference in [Difference::Either, Difference::Lighter] {
        let compared = outline_of(Some(Background::Picture(ground.clone().into())), difference);
        let nearest = |p: &nalgebra::Point2<f64>| plain.iter().map(|q| (q - p).norm()).fold(f64::INFINITY, f64::min);
        let farthest = compared.iter().map(nearest).fold(0.0, f64::max);
        // Points lie a pixel apart; along the outline theirs are others.
        assert!(farthest < 0.6, "{farthest}");
        let width = |points: &[nalgebra::Point2<f64>]| {
            let [low, high] = points.iter().fold([f64::INFINITY, 0.0], |[a, b], p| [a.min(p.x), f64::max(b, p.x)]);
            high - low
        };
        assert!((width(&compared) - width(&plain)).abs() < 0.05, "{} {}", width(&compared), width(&plain));
    }
}

#[test]
fn points_of_edges_in_light_lie_off_by_as_much_as_they_state() {
    for (light, of_noise) in [([0.04, 0.5], 3.0), ([0.6, 0.05], 3.0), ([0.2, 0.35], 1.5)] {
        let contrast = if light[0] < light[1] { Contrast::LightOnDark } else { Contrast::DarkOnLight };
        let settings = TraceSettings { contrast, transfer: Transfer::Srgb, y_up: false, ..TraceSettings::default() };
        let clear = moved_disc(0.0, light);
        let (mut squares, mut count) = (0.0, 0.0);
        for seed in 0..8 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let mut picture = clear.clone();
            for grey in picture.iter_mut() {
                let error: f64 = StandardNormal.sample(&mut rng);
                *grey = (f64::from(*grey) + of_noise * error).round().clamp(0.0, 255.0) as u8;
            }
            let traced = trace_mask(&picture, &settings).expect("the disc");
            let stated = traced.outline.deviations().expect("edges");
            for (point, deviation) in traced.outline.points().zip(stated) {
                let error = (point.x - 80.3).hypot(point.y - 60.1) - 40.0;
                squares += (error / deviation).powi(2);
                count += 1.0;
            }
        }
        let ratio = f64::sqrt(squares / count);
        assert!((0.6..1.4).contains(&ratio), "{light:?}: {ratio}");
    }
}

/// A bar that speeds up and turns slowly, blurred by the way that it goes while the shutter is open for a share of the time between two pictures, of
/// these grey values on ground of others. They are those of the light to the power of `1 / gamma`.
fn bar_that_speeds_up(gamma: f64, exposure: f64, greys: [f64; 2]) -> Vec<GrayImage> {
    moving_bar(gamma, exposure, greys, |time| (50.0 + time + 0.4 * time * time, 0.04 * time))
}

/// A bar whose place and turn are those of a way, by the number of the picture.
fn moving_bar(gamma: f64, exposure: f64, [ground, bar]: [f64; 2], way: impl Fn(f64) -> (f64, f64)) -> Vec<GrayImage> {
    let light = |grey: f64| (grey / 255.0).powf(gamma);
    let picture_at = |frame: u32| {
        let time = f64::from(frame);
        let fastest = (way(time + 0.5).0 - way(time - 0.5).0).abs();
        let instants = (1.0 + exposure * fastest).ceil() as u32;
        GrayImage::from_fn(320, 240, |x, y| {
            let share = (0..instants).map(|k| {
                let time = time + exposure * ((f64::from(k) + 0.5) / f64::from(instants) - 0.5);
                let (middle, turn) = way(time);
                let (dx, dy) = (f64::from(x) + 0.5 - middle, f64::from(y) + 0.5 - 120.0);
                let (along, across) =
                    (dx * f64::cos(turn) + dy * f64::sin(turn), dy * f64::cos(turn) - dx * f64::sin(turn));
                let outside = (along.abs() - 34.0).max(across.abs() - 16.0);
                (0.5 - 0.5 * outside).clamp(0.0, 1.0)
            });
            let share = share.sum::<f64>() / f64::from(instants);
            let grey = 255.0 * (light(ground) + share * (light(bar) - light(ground))).powf(gamma.recip());
            Luma([(grey + noise(x, y, frame)).round().clamp(0.0, 255.0) as u8])
        })
    };
    (0..20).map(picture_at).collect()
}

#[test]
fn what_grey_values_stand_for_is_told_by_the_size_of_a_body_that_its_motion_blurs() {
    for greys in [[40.0, 190.0], [210.0, 60.0]] {
        // Up to a quarter of the length of the bar, and to more than half.
        for exposure in [0.6, 1.3] {
            let told = [2.2, 1.0].map(|gamma| choice(&bar_that_speeds_up(gamma, exposure, greys)).transfer);
            assert_eq!(told, [Transfer::Srgb, Transfer::Linear], "{greys:?} {exposure}");
        }
        // It is not told where nothing is blurred.
        assert_eq!(choice(&bar_that_speeds_up(2.2, 0.0, greys)).transfer, Transfer::Linear);
    }
}

#[test]
fn at_a_constant_speed_wide_edges_tell_what_grey_values_stand_for() {
    for greys in [[40.0, 190.0], [210.0, 60.0]] {
        let along = |time: f64| (60.0 + 9.0 * time, 0.7);
        let told = [2.2, 1.0].map(|gamma| choice(&moving_bar(gamma, 0.8, greys, along)).transfer);
        assert_eq!(told, [Transfer::Srgb, Transfer::Linear], "{greys:?}");
    }
}

#[test]
fn the_settings_of_a_choice_have_what_was_found_of_the_pictures() {
    let chosen = choice(&bar_that_speeds_up(2.2, 0.6, [40.0, 190.0]));
    let settings = chosen.base(&PictureSettings::default());
    assert_eq!((settings.trace.transfer, settings.trace.margins), (Transfer::Srgb, Some(chosen.margins)));
}
