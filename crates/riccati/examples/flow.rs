//! Follows the lines of a quartic, its alpha and its beta through a rigid motion, next to the curve moved as a whole.
use freeform_curve_fit::Degree;
use freeform_decompose::{Decomposition, Line, rotation_chart};
use freeform_riccati::{AlphaBeta, RigidMotion, line_flow};
use nalgebra::Complex;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let line = |l1, l2, k1, k2| Line { l: Complex::new(l1, l2), k: Complex::new(k1, k2) };
    let [first, second, third] = [line(0.3, 0.6, 0.1, -0.2), line(-0.4, 1.4, -0.2, 0.3), line(0.1, 0.8, 0.2, 0.1)];
    let lines = [first, second, third].map(|line| [line, line.conjugate()]).concat();
    let start = Decomposition::from_parts(Degree::Quartic, &lines, &[1.0, 0.6, -1.0])?;
    let coefficients = AlphaBeta { alpha: start.alpha(), beta: start.beta() };
    let motion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };

    println!(
        "time   l                  k                  |w|      alpha     beta    | alpha and beta of the moved curve"
    );
    for step in 0..=8 {
        let time = 0.25 * f64::from(step);
        let (line, _) = line_flow(&motion.generator(), &first, time)?;
        let AlphaBeta { alpha, beta } =
            coefficients.moved(&motion.flow(time), start.level(4).try_into()?, start.level(2).try_into()?)?;
        let curve = Decomposition::of(&start.expand().moved(&motion.flow(time))?)?;
        println!(
            "{time:.2} {:>18.4} {:>18.4} {:>8.5} {alpha:>9.4} {beta:>8.4}  | {:>9.4} {:>8.4}",
            line.l,
            line.k,
            rotation_chart(line.l).norm(),
            curve.alpha(),
            curve.beta(),
        );
    }
    Ok(())
}
