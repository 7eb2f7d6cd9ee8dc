//! Prints how the three adaptive laws settle on the motion of two exact line pairs, started from zero.
use freeform_decompose::Line;
use freeform_identify::{AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings};
use freeform_riccati::{RigidMotion, line_flow};
use nalgebra::Complex;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let motion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };
    let lines = [
        Line { l: Complex::new(0.4, 0.7), k: Complex::new(0.1, -0.2) },
        Line { l: Complex::new(-0.5, 0.9), k: Complex::new(-0.2, 0.1) },
    ];
    println!("omega = {:.4} rad/s, b1 = {:.4}, b2 = {:.4} 1/s\n", motion.omega, motion.b1, motion.b2);
    for law in [AdaptiveLaw::Printed, AdaptiveLaw::Structured, AdaptiveLaw::FilteredLeastSquares] {
        let mut identifier = AdaptiveIdentifier::new(AdaptiveSettings { law, ..AdaptiveSettings::default() })?;
        println!("{law:?}\n  time/s    omega       b1       b2");
        for frame in 0..=900 {
            let time = f64::from(frame) / 30.0;
            let mut moved = lines;
            for (moved, line) in moved.iter_mut().zip(&lines) {
                *moved = line_flow(&motion.generator(), line, time)?.0;
            }
            identifier.step(time, &moved)?;
            if let Some(estimate) = identifier.estimate()
                && [15, 150, 300, 450, 600, 900].contains(&frame)
            {
                let v = estimate.values();
                println!("{time:>8.1} {:>8.4} {:>8.4} {:>8.4}", v[0], v[1], v[2]);
            }
        }
    }
    Ok(())
}
