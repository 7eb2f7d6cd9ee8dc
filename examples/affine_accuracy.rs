//! How close the six parameters of an affine motion come by lines after 30 s, over the built-in shapes and outlines given.
//!
//! ```text
//! cargo run --release --example affine_accuracy -- [key=value ...] [mask.png ...]
//! ```
//!
//! Keys: `law` (structured), `pairs` (best), `seed`, `noise`, `occlusion` (share hidden from the second
//! second on), `offset`, `margin`, `ridge`, `window`,
//! `normalise` (similarity). Columns: the largest error of a1 to a4 in percent of the largest of them, the error of b in
//! percent of its length, frames rejected.
use std::{error::Error, path::Path};

use freeform_motion::{
    Pipeline, PipelineSettings,
    curve_fit::{Method, Normalise},
    identify::{AdaptiveLaw, PairChoice},
    outline_io::read_shape,
    riccati::{AffineMotion, MotionModel},
    sim_camera::{BuiltInShape, Camera, Occlusion, Scene, SequenceLength, Settings, Shape, Simulator},
};

/// Turns that are faster one way round, one of them the other way, with some growth and some shrinking.
const MOTIONS: [[f64; 6]; 3] =
    [[0.05, 1.2, -1.7, -0.08, -0.3, 0.4], [0.1, 1.0, -1.0, -0.1, 0.2, 0.0], [-0.05, -0.8, 1.3, 0.04, 0.1, -0.2]];

fn main() -> Result<(), Box<dyn Error>> {
    let mut pipeline = PipelineSettings::for_model(MotionModel::Affine);
    let mut simulation = Settings { length: SequenceLength::Seconds(30.0), seed: 1, ..Settings::default() };
    let mut shapes: Vec<Shape> = BuiltInShape::ALL.into_iter().map(BuiltInShape::shape).collect();
    for argument in std::env::args().skip(1) {
        let Some((key, value)) = argument.split_once('=') else {
            shapes.push(mask(Path::new(&argument))?);
            continue;
        };
        match (key, &mut pipeline.fit.method) {
            ("law", _) if value == "structured" => pipeline.identify.law = AdaptiveLaw::Structured,
            ("pairs", _) if value == "best" => pipeline.identify.pairs = PairChoice::Best,
            ("normalise", _) if value == "similarity" => pipeline.fit.normalise = Normalise::Similarity,
            ("seed", _) => simulation.seed = value.parse()?,
            ("noise", _) => simulation.noise = value.parse()?,
            ("occlusion", _) => {
                simulation.occlusion = Occlusion { fraction: value.parse()?, first_frame: 30, ..Occlusion::default() };
            }
            ("offset", _) => pipeline.fit.offset = value.parse()?,
            ("window", _) => pipeline.fit.normal_half_window = value.parse()?,
            ("margin", Method::Bounded { margin, .. }) => *margin = value.parse()?,
            ("ridge", Method::Bounded { ridge_weight, .. }) => *ridge_weight = value.parse()?,
            _ => return Err(format!("no setting {key:?}").into()),
        }
    }
    println!("{:<16} {}", "shape", "rates %    b %  rejected   ".repeat(MOTIONS.len()));
    for shape in &shapes {
        print!("{:<16}", shape.name());
        for motion in MOTIONS {
            let mut identified = Pipeline::new(pipeline.clone())?;
            let [a1, a2, a3, a4, b1, b2] = motion;
            let scene = Scene::new(shape.clone(), AffineMotion { a1, a2, a3, a4, b1, b2 }, Camera::default());
            for frame in &Simulator::new(scene, simulation.clone())? {
                // What is refused is counted.
                let _ = identified.push(frame.time, &frame.outline);
            }
            let Some(estimate) = identified.estimate().filter(|e| e.parameters().all(|p| p.value.is_some())) else {
                print!(" {:>25}  ", "not observable");
                continue;
            };
            let v = estimate.values();
            let largest = motion[..4].iter().fold(0.0_f64, |m, a| m.max(a.abs()));
            let rates = v[..4].iter().zip(motion).map(|(v, a)| (v - a).abs()).fold(0.0_f64, f64::max) / largest;
            let b = (v[4] - b1).hypot(v[5] - b2) / b1.hypot(b2);
            print!(" {:>7.2} {:>7.2} {:>8}   ", 100.0 * rates, 100.0 * b, identified.frames_rejected());
        }
        println!();
    }
    Ok(())
}

/// The outline of the object in a mask, at unit size; its name with a star.
fn mask(path: &Path) -> Result<Shape, Box<dyn Error>> {
    let points: Vec<_> = read_shape(path)?.points().copied().collect();
    let name = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    Ok(Shape::from_polygon(&points)?.normalised().with_name(format!("{name}*")))
}
