//! How close the adaptive identifier comes after 30 s, over the built-in shapes and masks, for the three motions of the
//! paper.
//!
//! ```text
//! cargo run --release --example adaptive_accuracy -- [key=value ...] [mask.png ...]
//! ```
//!
//! Keys: `law` (structured, printed, fast), `pairs` (all, best, or the number of one), `size` (RMS radius in the coordinates
//! of the identifier), `seed`, `noise`, and of the fit `offset`, `margin`, `ridge` (bounded fit) or `kappa` (GS3L);
//! `rejections=1` prints why frames are rejected. Columns: errors of omega and of b, |w| of the chosen pair and of another,
//! rejected frames, frames with the boundedness constraint active, and `!` for errors beyond 3 % of omega or 5 % of b,
//! `!!!` beyond three times that.
use std::{error::Error, path::Path};

use freeform_motion::{
    Pipeline, PipelineSettings,
    curve_fit::Method,
    identify::{AdaptiveLaw, PairChoice},
    outline_io::read_shape,
    riccati::RigidMotion,
    sim_camera::{BuiltInShape, Camera, PaperExperiment, Scene, SequenceLength, Settings, Shape, Simulator},
};

/// What is measured.
struct Measurement {
    pipeline: PipelineSettings,
    simulation: Settings,
    shapes: Vec<Shape>,
    print_rejections: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let measurement = Measurement::from_arguments(std::env::args().skip(1))?;
    println!("{:<16} {:>7} {:>8} {:>8}  |w| (chosen first)   rejected", "shape", "motion", "omega %", "b %");
    let mut counts = [0; 3];
    let experiments = [PaperExperiment::FLIGHT_BIRD, PaperExperiment::GLIDER_OF_TEXT, PaperExperiment::CELLULAR_PHONE];
    for shape in &measurement.shapes {
        for (number, experiment) in experiments.iter().enumerate() {
            if let Some(verdict) = measurement.run(shape, number, experiment.motion)? {
                counts[verdict] += 1;
            }
        }
    }
    println!("within: {}, within three times: {}, beyond: {}", counts[0], counts[1], counts[2]);
    Ok(())
}

impl Measurement {
    fn from_arguments(arguments: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut pipeline = PipelineSettings::default();
        let mut simulation = Settings { length: SequenceLength::Seconds(30.0), seed: 1, ..Settings::default() };
        let mut shapes: Vec<Shape> = BuiltInShape::ALL.into_iter().map(BuiltInShape::shape).collect();
        let mut print_rejections = false;
        for argument in arguments {
            let Some((key, value)) = argument.split_once('=') else {
                shapes.push(mask(Path::new(&argument))?);
                continue;
            };
            match (key, &mut pipeline.fit.method) {
                ("law", _) => {
                    pipeline.identify.law = match value {
                        "structured" => AdaptiveLaw::Structured,
                        "printed" => AdaptiveLaw::Printed,
                        "fast" => AdaptiveLaw::FilteredLeastSquares,
                        _ => return Err(format!("no law {value:?}").into()),
                    }
                }
                ("pairs", _) => {
                    pipeline.identify.pairs = match value {
                        "all" => PairChoice::All,
                        "best" => PairChoice::Best,
                        number => PairChoice::Given(number.parse()?),
                    }
                }
                ("size", _) => pipeline.size = value.parse()?,
                ("seed", _) => simulation.seed = value.parse()?,
                ("noise", _) => simulation.noise = value.parse()?,
                ("offset", _) => pipeline.fit.offset = value.parse()?,
                ("margin", Method::Bounded { margin, .. }) => *margin = value.parse()?,
                ("ridge", Method::Bounded { ridge_weight, .. }) => *ridge_weight = value.parse()?,
                ("kappa", method) => *method = Method::GloballyStabilised { ridge_weight: value.parse()? },
                ("rejections", _) => print_rejections = value == "1",
                _ => return Err(format!("no setting {key:?} of this fit").into()),
            }
        }
        Ok(Self { pipeline, simulation, shapes, print_rejections })
    }

    /// Prints one row; returns 0 within the limits, 1 within three times them, 2 beyond, `None` without an estimate.
    fn run(&self, shape: &Shape, number: usize, motion: RigidMotion) -> Result<Option<usize>, Box<dyn Error>> {
        let camera = Camera::new(PaperExperiment::SCALE)?;
        let scene = Scene::new(shape.clone(), motion, camera);
        let mut pipeline = Pipeline::new(self.pipeline.clone())?;
        let mut active = 0;
        for frame in &Simulator::new(scene, self.simulation.clone())? {
            match pipeline.push(frame.time, &frame.outline) {
                Ok(result) => active += usize::from(result.fit.diagnostics().constraint_active),
                Err(error) if self.print_rejections => println!("{error}"),
                Err(_) => {}
            }
        }
        let Some(estimate) = pipeline.estimate().map(|estimate| estimate.in_space(camera.scale())) else {
            println!("{} none", shape.name());
            return Ok(None);
        };
        if estimate.parameters().any(|p| p.value.is_none()) {
            println!("{:<16} {number:>7} not observable", shape.name());
            return Ok(None);
        }
        let v = estimate.values();
        let omega_error = 100.0 * (v[0] - motion.omega).abs() / motion.omega.abs();
        let b_error = 100.0 * (v[1] - motion.b1).hypot(v[2] - motion.b2) / motion.b1.hypot(motion.b2);
        let worst = (omega_error / 3.0).max(b_error / 5.0);
        let verdict = usize::from(worst > 1.0) + usize::from(worst > 3.0);
        let identifier = pipeline.identifier();
        let chosen = identifier.chosen_pair().unwrap_or(0);
        println!(
            "{:<16} {number:>7} {omega_error:>8.2} {b_error:>8.2}  {:.3} {:.3} {:>8} {active:>5} {}",
            shape.name(),
            identifier.rotation_content(chosen),
            identifier.rotation_content(1 - chosen.min(1)),
            pipeline.frames_rejected(),
            ["", "!", "!!!"][verdict]
        );
        Ok(Some(verdict))
    }
}

/// The outline of the object in a mask, at unit size; its name with a star.
fn mask(path: &Path) -> Result<Shape, Box<dyn Error>> {
    let points: Vec<_> = read_shape(path)?.points().copied().collect();
    let name = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    Ok(Shape::from_polygon(&points)?.normalised().with_name(format!("*{name}")))
}
