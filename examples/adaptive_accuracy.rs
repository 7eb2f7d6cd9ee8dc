//! How close the adaptive identifier comes after 30 s, over built-in shapes and mask pictures given as arguments, for the
//! three motions of the paper.
use freeform_motion::{
    Pipeline, PipelineSettings,
    curve_fit::Method,
    identify::{AdaptiveLaw, AdaptiveSettings, PairChoice},
    outline_io::read_shape,
    riccati::RigidMotion,
    sim_camera::{BuiltInShape, Camera, Motion, Scene, SequenceLength, Settings, Shape, Simulator},
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let motions =
        [(std::f64::consts::FRAC_PI_2, -3.0, 4.0), (-std::f64::consts::FRAC_PI_3, 0.0, 4.0), (-2.0, 4.0, 0.0)];
    let mut shapes: Vec<Shape> = BuiltInShape::ALL.into_iter().map(|s| s.shape()).collect();
    for path in std::env::args().skip(1).filter(|a| a.ends_with(".png")) {
        let outline = read_shape(&path)?;
        let points: Vec<_> = outline.points().copied().collect();
        let name = std::path::Path::new(&path).file_stem().map_or(String::new(), |s| s.to_string_lossy().into_owned());
        shapes.push(Shape::from_polygon(&points)?.normalised().with_name(format!("*{name}")));
    }
    let env = |name: &str, default: f64| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    let law = match std::env::var("LAW").as_deref() {
        Ok("printed") => AdaptiveLaw::Printed,
        Ok("fast") => AdaptiveLaw::FilteredLeastSquares,
        _ => AdaptiveLaw::Structured,
    };
    let pairs = match std::env::var("PAIRS").as_deref() {
        Ok("all") => PairChoice::All,
        Ok("0") => PairChoice::Given(0),
        Ok("1") => PairChoice::Given(1),
        Ok("best") => PairChoice::Best,
        _ => PairChoice::All,
    };
    println!("{:<16} {:>7} {:>8} {:>8}  |w| (chosen first)   rejected", "shape", "motion", "omega %", "b %");
    let mut passed = [0; 3];
    for shape in shapes {
        for (m, &(omega, b1, b2)) in motions.iter().enumerate() {
            let motion = RigidMotion { omega, b1, b2 };
            let scene = Scene::new(shape.clone(), Motion::constant(motion), Camera::new(0.1)?);
            let settings = Settings {
                length: SequenceLength::Seconds(30.0),
                seed: env("SEED", 1.0) as u64,
                noise: env("NOISE", 0.005),
                ..Settings::default()
            };
            let simulator = Simulator::new(scene, settings)?;
            let mut fit = freeform_motion::curve_fit::FitSettings { offset: env("OFFSET", 0.1), ..Default::default() };
            if let Method::Bounded { margin, ridge_weight } = &mut fit.method {
                *margin = env("MARGIN", *margin);
                *ridge_weight = env("RIDGE", *ridge_weight);
            }
            if let Ok(kappa) = std::env::var("KAPPA") {
                fit.method = Method::GloballyStabilised { ridge_weight: kappa.parse()? };
            }
            let identify = AdaptiveSettings { law, pairs, ..Default::default() };
            let mut pipeline = Pipeline::new(PipelineSettings { fit, identify })?;
            let mut active = 0;
            for frame in simulator.frames() {
                match pipeline.push(frame.time, &frame.outline) {
                    Ok(result) => active += usize::from(result.fit.diagnostics().constraint_active),
                    Err(error) if std::env::var("VERBOSE").is_ok() => println!("{error}"),
                    Err(_) => {}
                }
            }
            let Some(estimate) = pipeline.estimate() else {
                println!("{} none", shape.name());
                continue;
            };
            let space = estimate.in_space(0.1);
            let v = space.values();
            let omega_error = 100.0 * (v[0] - omega).abs() / omega.abs();
            let b_error = 100.0 * (v[1] - b1).hypot(v[2] - b2) / b1.hypot(b2);
            let worst = (omega_error / 3.0).max(b_error / 5.0);
            let verdict = if worst <= 1.0 {
                0
            } else if worst <= 3.0 {
                1
            } else {
                2
            };
            passed[verdict] += 1;
            let id = pipeline.identifier();
            let chosen = id.chosen_pair().unwrap_or(0);
            println!(
                "{:<16} {m:>7} {omega_error:>8.2} {b_error:>8.2}  {:.3} {:.3} {:>8} {active:>5} {}",
                shape.name(),
                id.rotation_content(chosen),
                id.rotation_content(1 - chosen.min(1)),
                pipeline.frames_rejected(),
                ["", "!", "!!!"][verdict]
            );
        }
    }
    println!("within: {}, within three times: {}, beyond: {}", passed[0], passed[1], passed[2]);
    Ok(())
}
