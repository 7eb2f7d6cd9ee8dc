//! Fits curves of every degree and method to a noisy ellipse and prints what each fit says of itself.
use freeform_curve_fit::{Degree, FitSettings, Fitter, Method, Outline};
use nalgebra::Point2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let angle = |i: i32| std::f64::consts::TAU * f64::from(i) / 400.0;
    let wobble = |i: i32| 0.005 * (f64::from(i * i) * 0.37).sin();
    let points = (0..400)
        .map(|i| Point2::new((2.0 + wobble(i)) * angle(i).cos(), (1.0 + wobble(i + 7)) * angle(i).sin()))
        .collect();
    let outline = Outline::closed(points)?;
    println!("degree  method                                      margin   condition  distance");
    for degree in Degree::ALL {
        let ridge = Method::GloballyStabilised { ridge_weight: 1e-3 };
        for method in [Method::ThreeLevel, ridge, Method::Bounded { margin: 0.02, ridge_weight: 0.0 }] {
            let mut fitter = Fitter::new(FitSettings { degree, method, ..FitSettings::default() })?;
            let fit = fitter.fit(&outline)?;
            let d = fit.diagnostics();
            println!(
                "{degree:<7} {:<42} {:>8.4} {:>10.1e} {:>9.5}",
                format!("{method:?}"),
                d.boundedness_margin,
                d.condition,
                d.geometric_residual
            );
        }
    }
    Ok(())
}
