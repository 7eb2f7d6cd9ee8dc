//! The motion filter in a loop of one's own: `cargo run --release --example own_loop`.
use freeform_motion::curve_fit::Outline;
use freeform_motion::outline_filter::{FilterSettings, MotionFilter};
use nalgebra::{Isometry2, Point2, Vector2};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut filter = MotionFilter::new(FilterSettings::default())?;
    for frame in 0..60 {
        let time = f64::from(frame) / 30.0;
        let outline = outline_at(time)?;
        let step = filter.step(time, &outline)?;
        if let Some(state) = filter.state().filter(|_| frame % 10 == 9) {
            println!("{time:.2} s, {:?}, accepted: {}", step.phase, step.is_accepted());
            for number in state.pose_parameters() {
                println!("  {} = {:.5} +- {:.5}", number.name, number.value, number.standard_deviation);
            }
            for parameter in state.motion().parameters() {
                match (parameter.value, parameter.standard_deviation) {
                    (Some(value), Some(std)) => println!("  {} = {value:.5} +- {std:.5}", parameter.name),
                    _ => println!("  {} is not known", parameter.name),
                }
            }
        }
    }
    Ok(())
}

/// Stands for a camera: an egg that turns anticlockwise at 0.5 rad/s and drifts to the right at 0.2 lengths/s.
fn outline_at(time: f64) -> Result<Outline, freeform_motion::curve_fit::OutlineError> {
    let pose = Isometry2::new(Vector2::new(0.2 * time, 0.0), 0.5 * time);
    let points = (0..300).map(|i| {
        let t = std::f64::consts::TAU * f64::from(i) / 300.0;
        pose * Point2::new(0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.35 * t.sin())
    });
    Outline::closed(points.collect())
}
