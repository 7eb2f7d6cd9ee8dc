//! Outlines on the edges themselves: bias and scatter of straight edges against the bound, and what may not move them.
use freeform_outline_io::{Clipping, EdgeFit, GrayImage, Threshold, TraceSettings, TracedOutline, trace_mask};
use image::Luma;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

const SIZE: u32 = 160;

/// An edge through the middle of a picture: lighter where `x cos + y sin` is small, y downwards.
#[derive(Debug, Clone, Copy)]
struct Step {
    angle: f64,
    /// From the middle.
    place: f64,
    contrast: f64,
    blur: f64,
    /// Share of the contrast that the picture is darker at its right side.
    shading: f64,
    noise: f64,
}

impl Step {
    fn distance(&self, x: f64, y: f64) -> f64 {
        let middle = 0.5 * f64::from(SIZE);
        (x - middle) * self.angle.cos() + (y - middle) * self.angle.sin() - self.place
    }

    fn picture(&self, seed: u64) -> GrayImage {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        GrayImage::from_fn(SIZE, SIZE, |column, row| {
            let share = self.share(column, row);
            let shade = self.shading * self.contrast * f64::from(column) / 640.0;
            let error: f64 = StandardNormal.sample(&mut rng);
            Luma([(40.0 + self.contrast * share - shade + self.noise * error).round().clamp(0.0, 255.0) as u8])
        })
    }

    /// Light that a pixel gets, of that on the light side: by the three places of Gauss in both directions, which do for a blur of half a pixel.
    fn share(&self, column: u32, row: u32) -> f64 {
        let middle = self.distance(f64::from(column) + 0.5, f64::from(row) + 0.5);
        if middle.abs() > 5.5 * self.blur + 1.0 {
            return if middle > 0.0 { 0.0 } else { 1.0 };
        }
        let places = [-0.15_f64.sqrt(), 0.0, 0.15_f64.sqrt()].into_iter().zip([5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0]);
        let (cos, sin) = (self.angle.cos(), self.angle.sin());
        let of_place = |(x, a): (f64, f64)| {
            places.clone().map(move |(y, b)| a * b * tail((middle + x * cos + y * sin) / self.blur)).sum::<f64>()
        };
        places.clone().map(of_place).sum()
    }

    fn traced(&self, seed: u64, settings: &TraceSettings) -> TracedOutline {
        trace_mask(&self.picture(seed), settings).expect("the light side")
    }

    /// How far the points lie to the dark side of the edge, those near the edge of the picture left out.
    fn errors(&self, traced: &TracedOutline) -> Vec<f64> {
        let inner = 14.0..f64::from(SIZE) - 14.0;
        let points = traced.outline.points().map(|p| (p.x, f64::from(SIZE) - p.y));
        points.filter(|(x, y)| inner.contains(x) && inner.contains(y)).map(|(x, y)| self.distance(x, y)).collect()
    }
}

/// The share of a normal distribution beyond `z`.
fn tail(z: f64) -> f64 {
    let x = z.abs() / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + 0.5 * x);
    let series = [
        -1.26551223,
        1.00002368,
        0.37409196,
        0.09678418,
        -0.18628806,
        0.27886807,
        -1.13520398,
        1.48851587,
        -0.82215223,
        0.17087277,
    ];
    let exponent = -x * x + series.iter().rev().fold(0.0, |sum, c| sum * t + c);
    let tail = 0.5 * t * exponent.exp();
    if z < 0.0 { 1.0 - tail } else { tail }
}

fn settings() -> TraceSettings {
    TraceSettings { clipping: Clipping::Open, ..TraceSettings::default() }
}

/// Root mean square.
fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// What is found of an edge.
struct Found {
    /// Its mean place, in pixels.
    mean: f64,
    /// The same in units of the bound.
    ratio: f64,
    /// How far its points lie off, root mean square, over what they state.
    of_stated: f64,
}

/// What is found of many edges.
fn found_of_edges(count: u64, of: impl Fn(u64) -> Step) -> Vec<Found> {
    let found = |k: u64| {
        let step = of(k);
        let traced = step.traced((step.angle * 1000.0) as u64, &settings());
        let errors = step.errors(&traced);
        let of_stated = rms(&errors) / median(traced.edges.expect("edges").deviations);
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        // An edge crosses so many of the lines between pixels on a pixel of its length.
        let length = errors.len() as f64 / (step.angle.cos().abs() + step.angle.sin().abs());
        // Information on the place of an edge in one pixel of it, of the blur and the square of the pixel together; rounding to grey values is
        // noise too.
        let width = step.blur.hypot(12.0_f64.powf(-0.5));
        let noise = step.noise.hypot(12.0_f64.powf(-0.5));
        let bound = noise / step.contrast * (2.0 * std::f64::consts::PI.sqrt() * width / length).sqrt();
        Found { mean, ratio: mean / bound, of_stated }
    };
    (0..count).map(found).collect()
}

#[test]
fn edges_have_no_bias_and_scatter_as_little_as_the_grey_values_allow() {
    const EDGES: u64 = 150;
    for blur in [0.7, 1.5, 3.0] {
        let mut of_blur = Vec::new();
        for (case, contrast) in (0..).zip([20.0, 70.0, 200.0]) {
            for (part, shading) in (0..).zip([0.0, 0.5]) {
                let found = found_of_edges(EDGES, |k| Step {
                    angle: 0.05 + 0.151 * (k + EDGES * (2 * case + part)) as f64,
                    place: 0.37 * (k % 8) as f64,
                    contrast,
                    blur,
                    shading,
                    noise: 0.03 * contrast,
                });
                let bias = found.iter().map(|edge| edge.mean).sum::<f64>() / EDGES as f64;
                let ratios: Vec<f64> = found.iter().map(|edge| edge.ratio).collect();
                let ratio = rms(&ratios);
                let of_stated = rms(&found.iter().map(|edge| edge.of_stated).collect::<Vec<_>>());
                println!(
                    "contrast {contrast} blur {blur} shading {shading}: bias {bias:.4}, {ratio:.2} of the bound, \
                     points {of_stated:.2} of what they state"
                );
                // Points share pixels with their neighbours, so that they scatter less than a pixel of edge by itself, whose deviation they state.
                assert!((0.7..1.1).contains(&of_stated), "{of_stated}");
                // So many edges tell a ratio to 6 %.
                assert!(bias.abs() < 0.005 && ratio < 1.5, "{bias} {ratio}");
                of_blur.extend(ratios);
            }
        }
        let ratio = rms(&of_blur);
        println!("blur {blur}: {ratio:.3} of the bound");
        // And those of one blur to 2.4 %.
        assert!(ratio < 1.3, "{ratio}");
    }
}

#[test]
fn neither_threshold_nor_shading_moves_an_edge() {
    let step = Step { angle: 0.3, place: 4.0, contrast: 140.0, blur: 1.2, shading: 0.0, noise: 1.0 };
    let mean = |errors: Vec<f64>| errors.iter().sum::<f64>() / errors.len() as f64;
    let of = |step: Step, level| {
        let settings = TraceSettings { threshold: Threshold::Level(level), ..settings() };
        mean(step.errors(&step.traced(1, &settings)))
    };
    let middle = of(step, 110.0);
    for level in [90.0, 130.0] {
        assert!((of(step, level) - middle).abs() < 0.01, "level {level}: {} {middle}", of(step, level));
    }
    let shaded = of(Step { shading: 2.0, ..step }, 100.0);
    assert!((shaded - middle).abs() < 0.02, "{shaded} {middle}");
}

#[test]
fn blur_contrast_and_noise_are_told_and_points_have_their_deviations() {
    let step = Step { angle: 1.1, place: -3.0, contrast: 90.0, blur: 1.8, shading: 0.0, noise: 4.0 };
    let traced = step.traced(5, &settings());
    let EdgeFit {
        deviations,
        systematic,
        contrast,
        blur,
        motion_blur,
        systematic_by_motion,
        noise,
        clear_share,
        on_pixels,
    } = traced.edges.clone().expect("edges");
    assert_eq!(deviations.len(), traced.outline.point_count());
    assert!(
        (contrast - 90.0).abs() < 4.0 && (blur - 1.85).abs() < 0.25 && (noise - 4.0).abs() < 1.2,
        "{contrast} {blur} {noise}"
    );
    assert!(on_pixels < 0.1 && motion_blur == 0.0 && systematic_by_motion == 0.0, "{on_pixels} {motion_blur}");
    assert!(clear_share > 0.9 && systematic < 0.1, "{clear_share} {systematic}");
    let errors = step.errors(&traced);
    let (spread, typical) = (rms(&errors), median(deviations));
    // Points 0.8 pixels apart share pixels with their neighbours, so that each scatters less than one pixel of edge does.
    assert!(spread < 1.3 * typical && spread > 0.3 * typical, "{spread} {typical}");
}

#[test]
fn a_blurred_disc_has_its_radius() {
    for (radius, blur) in [(20.0, 1.0), (30.0, 2.0), (60.0, 3.0)] {
        let centre = 80.3;
        // A disc blurred by a Gaussian: means over a fine grid.
        let fine = 4;
        let count = (SIZE * fine) as usize;
        let is_within = |k: usize| (k as f64 + 0.5) / f64::from(fine) - centre;
        let mut grey: Vec<f64> = (0..count * count)
            .map(|k| f64::from(u8::from(is_within(k % count).hypot(is_within(k / count)) < radius)))
            .collect();
        let reach = (4.0 * blur * f64::from(fine)) as usize;
        let weights: Vec<f64> = (0..=2 * reach)
            .map(|k| (-0.5 * ((k as f64 - reach as f64) / blur / f64::from(fine)).powi(2)).exp())
            .collect();
        let total: f64 = weights.iter().sum();
        for stride in [1, count] {
            let before = grey.clone();
            for (k, value) in grey.iter_mut().enumerate() {
                let place = k / stride % count;
                let tap = |j: usize| (place + j).saturating_sub(reach).min(count - 1);
                *value = weights
                    .iter()
                    .enumerate()
                    .map(|(j, w)| w * before[k - place * stride + tap(j) * stride])
                    .sum::<f64>()
                    / total;
            }
        }
        let picture = GrayImage::from_fn(SIZE, SIZE, |column, row| {
            let cells =
                (0..fine * fine).map(|k| ((column * fine + k % fine) as usize, (row * fine + k / fine) as usize));
            let mean = cells.map(|(x, y)| grey[y * count + x]).sum::<f64>() / f64::from(fine * fine);
            Luma([(30.0 + 180.0 * mean).round() as u8])
        });
        let traced = trace_mask(&picture, &settings()).expect("a disc");
        let radii: Vec<f64> =
            traced.outline.points().map(|p| (p.x - centre).hypot(f64::from(SIZE) - p.y - centre)).collect();
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        println!("radius {radius}, blur {blur}: {mean:.4}");
        assert!((mean - radius).abs() < 0.03, "radius {radius}, blur {blur}: {mean}");
    }
}

#[test]
fn a_thin_bar_has_its_thickness_and_points_that_are_off_as_they_state() {
    for (blur, thickness) in [(0.7, 4.0), (0.7, 6.0), (1.2, 6.0), (1.2, 8.0), (2.0, 9.0), (2.0, 11.0)] {
        let (mut errors, mut deviations, mut systematic) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..6_u32 {
            let angle = 0.11 + 0.5 * f64::from(k);
            let step = Step { angle, place: 0.17 * f64::from(k), contrast: 0.0, blur, shading: 0.0, noise: 2.0 };
            let side = |distance: f64| Step { place: step.place + distance, ..step };
            let (near, far) = (side(-0.5 * thickness), side(0.5 * thickness));
            let mut rng = ChaCha8Rng::seed_from_u64(u64::from(k));
            let picture = GrayImage::from_fn(SIZE, SIZE, |column, row| {
                let error: f64 = StandardNormal.sample(&mut rng);
                let share = far.share(column, row) - near.share(column, row);
                Luma([(60.0 + 100.0 * share + step.noise * error).round() as u8])
            });
            let traced = trace_mask(&picture, &settings()).expect("a bar");
            let edges = traced.edges.clone().expect("edges");
            systematic.push(edges.systematic);
            let places = step.errors(&traced).into_iter().map(|distance| distance.abs() - 0.5 * thickness);
            errors.extend(places);
            deviations.push(median(edges.deviations));
        }
        let bias = errors.iter().sum::<f64>() / errors.len() as f64;
        let [off, stated, together] = [&errors, &deviations, &systematic].map(|of| rms(of));
        println!("blur {blur} thickness {thickness}: bias {bias:.3}, {off:.3} stated {stated:.3}, {together:.3}");
        // Profiles that reach the other side made them 0.3 to 0.6 thicker, with deviations of 0.1 to 0.6 and a systematic part of a pixel.
        assert!(bias.abs() < 0.04 * blur.max(1.0) && off < 1.3 * stated && stated < 2.0 * off, "{bias} {off} {stated}");
        assert!(together < 0.1, "{together}");
    }
}

#[test]
fn a_small_disc_that_is_found_far_from_its_edge_is_traced_on_it() {
    let (radius, middle) = (5.0, 20.0);
    let (mut errors, mut ratios) = (Vec::new(), Vec::new());
    for seed in 0..12 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let centre = middle + 0.083 * seed as f64;
        let picture = GrayImage::from_fn(40, 40, |column, row| {
            let error: f64 = StandardNormal.sample(&mut rng);
            let distance = (f64::from(column) + 0.5 - centre).hypot(f64::from(row) + 0.5 - centre) - radius;
            // Of a disc that is blurred, the middle grey value lies within its edge.
            Luma([(40.0 + 110.0 * tail(distance + 0.5 / radius) + 2.0 * error).round().max(0.0) as u8])
        });
        let settings = TraceSettings { threshold: Threshold::Level(52.0), y_up: false, ..TraceSettings::default() };
        let traced = trace_mask(&picture, &settings).expect("a disc");
        let deviations = traced.edges.clone().expect("edges").deviations;
        let of_seed: Vec<f64> = traced.outline.points().map(|p| (p.x - centre).hypot(p.y - centre) - radius).collect();
        ratios.extend(of_seed.iter().zip(&deviations).map(|(error, stated)| error / stated));
        errors.extend(of_seed);
    }
    let [off, ratio] = [&errors, &ratios].map(|of| rms(of));
    println!("off {off:.3}, {ratio:.2} of what is stated");
    assert!(off < 0.15 && ratio < 1.5, "{off} {ratio}");
}

/// How far edges at places within a pixel are off together, root mean square, and what is stated of that in the mean. The picture is changed
/// before it is rounded, by the distance from the edge and the share of the light side.
fn off_together(step: Step, change: impl Fn(f64, f64) -> f64) -> (f64, f64) {
    let (mut squares, mut stated) = (0.0, 0.0);
    for phase in 0..8_u32 {
        let step = Step { place: f64::from(phase) / 8.0, ..step };
        let mut rng = ChaCha8Rng::seed_from_u64(u64::from(phase));
        let picture = GrayImage::from_fn(SIZE, SIZE, |column, row| {
            let share = step.share(column, row);
            let error: f64 = StandardNormal.sample(&mut rng);
            let distance = step.distance(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let grey = 60.0 + step.contrast * share + change(distance, share) + step.noise * error;
            Luma([grey.round().clamp(0.0, 255.0) as u8])
        });
        let traced = trace_mask(&picture, &TraceSettings::default()).expect("the light side");
        let errors = step.errors(&traced);
        squares += (errors.iter().sum::<f64>() / errors.len() as f64).powi(2) / 8.0;
        stated += traced.edges.expect("edges").systematic / 8.0;
    }
    (squares.sqrt(), stated)
}

#[test]
fn light_that_changes_on_one_side_alone_moves_edges_by_what_is_stated() {
    for blur in [0.7, 1.0, 2.0, 3.0] {
        for slope in [0.3, 0.7, 1.5] {
            let step = Step { angle: 0.4, place: 0.0, contrast: 100.0, blur, shading: 0.0, noise: 1.0 };
            let ground = |distance: f64, share: f64| (1.0 - share) * (slope * distance).clamp(-10.0, 45.0);
            let (off, stated) = off_together(step, ground);
            println!("blur {blur} slope {slope}: {off:.4} stated {stated:.4}");
            assert!(off < 1.3 * stated && stated < 1.3 * off.max(0.02), "{off} {stated}");
        }
    }
}

#[test]
fn what_the_grid_of_pixels_and_rounding_do_to_edges_along_the_rows_is_stated() {
    for angle in [0.0, std::f64::consts::FRAC_PI_4] {
        for (contrast, noise) in [(140.0, 1.0), (140.0, 0.0), (20.0, 0.0)] {
            for blur in [0.5, 0.7, 1.0, 2.0] {
                let (off, stated) =
                    off_together(Step { angle, place: 0.0, contrast, blur, shading: 0.0, noise }, |_, _| 0.0);
                println!("angle {angle} contrast {contrast} noise {noise} blur {blur}: {off:.4} stated {stated:.4}");
                assert!(off < 1.3 * stated, "{off} {stated}");
            }
        }
    }
}

/// Share of the light of a disc, blurred by 0.8 pixels, that a place from its middle gets while the disc moves on by a way.
pub(crate) fn share_of_moving_disc([x, y]: [f64; 2], radius: f64, [across, down]: [f64; 2]) -> f64 {
    let instants = 4 * across.hypot(down).ceil() as u32 + 1;
    let share = |k: u32| {
        let gone = (f64::from(k) + 0.5) / f64::from(instants) - 0.5;
        tail(((x - across * gone).hypot(y - down * gone) - radius) / 0.8)
    };
    (0..instants).map(share).sum::<f64>() / f64::from(instants)
}

/// A disc that moves on by a way while the shutter is open, in noise of 2 grey values.
fn moving_disc(radius: f64, way: f64, direction: f64, seed: u64) -> GrayImage {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    GrayImage::from_fn(SIZE, SIZE, |column, row| {
        let place = [column, row].map(|pixel| f64::from(pixel) + 0.5 - 0.5 * f64::from(SIZE));
        let light = share_of_moving_disc(place, radius, [way * direction.cos(), way * direction.sin()]);
        let error: f64 = StandardNormal.sample(&mut rng);
        Luma([(40.0 + 140.0 * light + 2.0 * error).round().clamp(0.0, 255.0) as u8])
    })
}

/// Extents of the outline along a direction and across it, halved.
fn half_extents(traced: &TracedOutline, direction: f64) -> [f64; 2] {
    // In pictures y points down.
    let (sin, cos) = (-direction).sin_cos();
    [(cos, sin), (-sin, cos)].map(|(x, y)| {
        let along = || traced.outline.points().map(move |point| x * point.x + y * point.y);
        0.5 * (along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min))
    })
}

#[test]
fn a_disc_that_moves_while_the_shutter_is_open_is_as_long_as_it_is_wide() {
    for (radius, share) in [(15.0, 0.45), (15.0, 0.6), (26.0, 0.3), (26.0, 0.45), (26.0, 0.6)] {
        for (seed, direction) in [(0, 0.0), (1, 0.4), (2, 1.3), (3, 2.4)] {
            let traced = trace_mask(&moving_disc(radius, share * radius, direction, seed), &settings());
            let traced = traced.expect("a disc");
            let edges = traced.edges.as_ref().expect("edges");
            let [along, across] = half_extents(&traced, direction);
            let (way, systematic) = (edges.motion_blur, edges.systematic_by_motion);
            let found = format!("{radius} {share} {direction}: {along} {across}, way {way}, systematic {systematic}");
            assert!((way / (share * radius) - 1.0).abs() < 0.4, "{found}");
            // Extremes of many points lie beyond, by noise.
            let off = [along, across].map(|extent| extent - radius);
            assert!(off.iter().all(|off| off.abs() < 0.02 * radius), "{found}");
            // The way is found up to a quarter too long, so that longer ones seem to be too long for the radius.
            assert!(share > 0.5 || systematic < 0.02 * radius, "{found}");
        }
    }
}

#[test]
fn a_disc_that_moves_by_more_than_its_radius_meanwhile_is_not_known_well() {
    let traced = trace_mask(&moving_disc(15.0, 18.0, 0.7, 4), &settings()).expect("a disc");
    let systematic = traced.edges.expect("edges").systematic_by_motion;
    assert!(systematic > 1.5, "{systematic}");
}
