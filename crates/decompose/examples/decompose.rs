//! Prints the lines and related points of a quartic, and finds its pairs again after a motion.
use freeform_curve_fit::{Degree, ImplicitPolynomial};
use freeform_decompose::{Correspondence, Decomposition, RelatedPoints};
use nalgebra::{Isometry2, Vector2};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // (x^2 + 2 y^2) (2 x^2 + y^2) + x^2 y + x y^2 / 2 - x^2 / 5 + x y / 2 + x / 5 - 1
    let coefficients = [-1.0, 0.2, 0.0, -0.2, 0.5, 0.0, 0.0, 1.0, 0.5, 0.0, 2.0, 0.0, 5.0, 0.0, 2.0];
    let f = ImplicitPolynomial::new(Degree::Quartic, &coefficients)?;
    let decomposition = Decomposition::of(&f)?;
    for level in decomposition.levels() {
        println!("level {level}, coefficient {:.4}", decomposition.coefficient(level));
        for line in decomposition.level(level) {
            println!("  l = {:.4}, k = {:.4}", line.l, line.k);
        }
    }
    println!("constant {:.4}", decomposition.coefficient(0));
    println!("alpha {:.4}, beta {:.4}", decomposition.alpha(), decomposition.beta());
    println!("condition number {:.1}", decomposition.condition().number());
    for d in RelatedPoints::of(&decomposition).as_slice() {
        println!("related point of level {}: ({:.4}, {:.4}), f = {:.4}", d.level, d.point.x, d.point.y, d.value);
    }

    let motion = nalgebra::convert(Isometry2::new(Vector2::new(0.05, 0.02), 0.1));
    let next = Decomposition::of(&f.moved(&motion)?)?;
    let matched = Correspondence::between(&decomposition, &next, 1.0)?;
    println!("after a small motion: pairs {:?} by {:?}", matched.permutation(), matched.decided_by());
    println!("  margin of the order {:.3}", matched.ordering_margin());
    println!("  cost {:.4}, next best {:.4}", matched.continuity_cost(), matched.runner_up_cost());
    Ok(())
}
