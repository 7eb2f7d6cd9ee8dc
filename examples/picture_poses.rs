//! How well poses from simulated pictures hold what is stated of them: errors of the turn since the first picture, and of the place of a point of
//! the body, over the deviations that are stated, in light of every kind.
//!
//! ```text
//! cargo run --release --example picture_poses -- SEEDS
//! ```
use std::error::Error;

use freeform_motion::outline_filter::{FilterSettings, MotionFilter};
use freeform_motion::outline_io::{Clipping, Contours, Contrast, GrayImage, TraceSettings, TracedOutline, trace_mask};
use freeform_motion::sim_camera::{BodyTruth, PictureScene, Rendering, SimulatedPictures};
use nalgebra::{Point2, Rotation2};

const RATE: f64 = 30.0;
const SECONDS: f64 = 1.0;
/// What is taken for the systematic part of the edges.
const WAYS: [&str; 2] = ["as traced", "none"];
/// Half of an interval of 95 %, in deviations.
const INTERVAL: f64 = 1.96;

/// What bodies lie on.
#[derive(Clone, Copy)]
enum Ground {
    Even,
    /// Lighter by 30 grey values on the right of a slope of 40 pixels in the middle.
    Slope,
}

impl Ground {
    /// A picture with this ground in place of an even one.
    fn under(self, mut grey: Vec<u8>, rendering: &Rendering) -> Vec<u8> {
        if let Self::Slope = self {
            let [width, _] = rendering.size;
            for (index, value) in grey.iter_mut().enumerate() {
                let of_ground = 1.0 - ((f64::from(*value) - rendering.ground) / rendering.contrast).clamp(0.0, 1.0);
                let across = ((index % width) as f64 - 0.5 * width as f64) / 40.0 + 0.5;
                *value = (f64::from(*value) + 30.0 * of_ground * across.clamp(0.0, 1.0)).round() as u8;
            }
        }
        grey
    }
}

/// Errors of poses, and the deviations that are stated.
#[derive(Default, Clone)]
struct Errors {
    turns: Vec<(f64, f64)>,
    places: Vec<(f64, f64)>,
    omegas: Vec<(f64, f64)>,
}

impl Errors {
    fn add(&mut self, other: &Self) {
        self.turns.extend(&other.turns);
        self.places.extend(&other.places);
        self.omegas.extend(&other.omegas);
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let seeds: u64 = std::env::args().nth(1).ok_or("usage: picture_poses SEEDS")?.parse()?;
    println!(
        "errors over deviations: root mean square, share within 95 % (errors, root mean square; deviations, median)"
    );
    let mut of_all = vec![Errors::default(); WAYS.len()];
    for (name, rendering, ground) in kinds() {
        let mut of_kind = vec![Errors::default(); WAYS.len()];
        let mut systematic = Vec::new();
        for scene in [PictureScene::Gear, PictureScene::AcceleratingL, PictureScene::MarkedDiscs] {
            for seed in 0..seeds {
                let own = run((scene, seed + 100), rendering, ground, &mut systematic)?;
                own.iter().zip(&mut of_kind).for_each(|(own, all)| all.add(own));
            }
        }
        println!("{name}: systematic part {:.4} pixels", median(systematic));
        for ((way, errors), all) in WAYS.iter().zip(&of_kind).zip(&mut of_all) {
            print(way, errors);
            all.add(errors);
        }
    }
    println!("all");
    WAYS.iter().zip(&of_all).for_each(|(way, errors)| print(way, errors));
    Ok(())
}

/// Light of every kind, each with a name.
fn kinds() -> Vec<(&'static str, Rendering, Ground)> {
    let light = Rendering::default();
    let even = [
        ("contrast 140, blur 1, noise 3", light),
        ("noise 0.6", Rendering { noise: 0.6, ..light }),
        ("noise 10", Rendering { noise: 10.0, ..light }),
        ("contrast 20, noise 1", Rendering { contrast: 20.0, noise: 1.0, ..light }),
        ("contrast 40, noise 4", Rendering { contrast: 40.0, noise: 4.0, ..light }),
        ("blur 0.5, noise 1", Rendering { blur: 0.5, noise: 1.0, ..light }),
        ("blur 0.7, noise 1", Rendering { blur: 0.7, noise: 1.0, ..light }),
        ("blur 2, noise 2", Rendering { blur: 2.0, noise: 2.0, ..light }),
        ("blur 3, noise 2", Rendering { blur: 3.0, noise: 2.0, ..light }),
        ("shading of half the contrast, noise 1.5", Rendering { shading: 0.5, noise: 1.5, ..light }),
    ];
    let slope = Rendering { ground: 50.0, contrast: 125.0, ..light };
    let even = even.into_iter().map(|(name, rendering)| (name, rendering, Ground::Even));
    even.chain([("ground with a slope", slope, Ground::Slope)]).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn print(label: &str, errors: &Errors) {
    let told = |list: &[(f64, f64)]| {
        let count = list.len().max(1) as f64;
        let rms = (list.iter().map(|(e, s)| (e / s).powi(2)).sum::<f64>() / count).sqrt();
        let within = list.iter().filter(|(e, s)| e.abs() < INTERVAL * s).count() as f64 / count;
        let size = (list.iter().map(|(e, _)| e * e).sum::<f64>() / count).sqrt();
        let stated = median(list.iter().map(|(_, s)| *s).collect());
        format!("{rms:.2} {within:.3} ({size:.1e}; {stated:.1e})")
    };
    println!(
        "  {label:9} turns {}, places {}, omega {}",
        told(&errors.turns),
        told(&errors.places),
        told(&errors.omegas)
    );
}

/// Errors with the systematic part as traced, and with none.
fn run(
    (scene, seed): (PictureScene, u64),
    rendering: Rendering,
    ground: Ground,
    systematic: &mut Vec<f64>,
) -> Result<Vec<Errors>, Box<dyn Error>> {
    let pictures = SimulatedPictures::new(scene, seed, RATE, SECONDS)?.with_rendering(rendering)?;
    let contours = if scene == PictureScene::MarkedDiscs { Contours::All } else { Contours::Boundary };
    let contrast = if rendering.contrast > 0.0 { Contrast::LightOnDark } else { Contrast::DarkOnLight };
    let trace = TraceSettings { contrast, contours, clipping: Clipping::Open, ..TraceSettings::default() };
    let mut frames: Vec<(f64, TracedOutline, Vec<BodyTruth>)> = Vec::new();
    for picture in pictures.iter() {
        let [width, height] = rendering.size.map(|size| size as u32);
        let image = GrayImage::from_raw(width, height, ground.under(picture.grey, &rendering)).ok_or("size")?;
        if let Ok(traced) = trace_mask(&image, &trace) {
            frames.push((picture.time, traced, picture.bodies));
        }
    }
    let of_edges = frames.iter().take(15).filter_map(|(_, traced, _)| Some(traced.edges.as_ref()?.systematic));
    let length = median(of_edges.collect());
    if length.is_nan() {
        return Ok(vec![Errors::default(); WAYS.len()]);
    }
    systematic.push(length);
    [length, 0.0].into_iter().map(|length| errors(&frames, length)).collect()
}

/// Errors of a filter that takes this for the systematic part of edges, in pixels.
fn errors(frames: &[(f64, TracedOutline, Vec<BodyTruth>)], edge_uncertainty: f64) -> Result<Errors, Box<dyn Error>> {
    let mut filter = MotionFilter::new(FilterSettings { edge_uncertainty, ..FilterSettings::default() })?;
    let mut found = Errors::default();
    let Some((_, first, bodies)) = frames.first() else { return Ok(found) };
    let count = first.outline.point_count() as f64;
    let centre = Point2::from(first.outline.points().map(|p| p.coords).sum::<nalgebra::Vector2<f64>>() / count);
    let far = |b: &BodyTruth| (Point2::from(b.middle) - centre).norm();
    let Some(body) = (0..bodies.len()).min_by(|&a, &b| far(&bodies[a]).total_cmp(&far(&bodies[b]))) else {
        return Ok(found);
    };
    let start = bodies[body];
    for (time, traced, bodies) in frames {
        if !filter.step(*time, &traced.outline).is_ok_and(|step| step.is_accepted()) {
            continue;
        }
        let Some(state) = filter.state() else { continue };
        let truth = bodies[body];
        let turn = truth.angle - start.angle;
        let place = Point2::from(truth.middle) + Rotation2::new(-turn) * (centre - Point2::from(start.middle));
        for parameter in state.pose_parameters() {
            let stated = parameter.standard_deviation;
            match parameter.name {
                "angle" => {
                    let error = (parameter.value - turn + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
                        - std::f64::consts::PI;
                    found.turns.push((error, stated));
                }
                "x" => found.places.push((parameter.value - place.x, stated)),
                "y" => found.places.push((parameter.value - place.y, stated)),
                _ => {}
            }
        }
    }
    if let (Some(estimate), Some((_, _, bodies))) = (filter.estimate(), frames.last()) {
        for parameter in estimate.parameters() {
            if parameter.name == "omega"
                && let (Some(value), Some(stated)) = (parameter.value, parameter.standard_deviation)
            {
                found.omegas.push((value - bodies[body].omega, stated));
            }
        }
    }
    Ok(found)
}
