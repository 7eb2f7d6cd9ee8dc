//! The least-squares leading form that is positive on the unit circle by at least a margin.
use crate::{
    active_set::ActiveSetProblem, error::FitError, interior_point::GramProblem, leading_form::CircleRange,
    least_squares::TriangularSystem, monomials::monomial_index,
};

/// Replaces the leading form in `coefficients` (degree n) by the best one, in the sense of `system`, whose values on the
/// unit circle are at least `floor`, and the other coefficients by the best ones given that. Returns the range of the new
/// form.
///
/// The problem is convex, so that a form which satisfies the optimality conditions is the solution however it was found: a
/// few Newton steps on the directions where it touches the floor find it nearly always, the interior-point method always.
pub(crate) fn constrain_leading_form(
    degree: usize,
    system: &TriangularSystem,
    floor: f64,
    coefficients: &mut [f64],
) -> Result<CircleRange, FitError> {
    let first = monomial_index(degree, 0);
    let form = &mut coefficients[first..];
    let range = match degree {
        2 => by_active_set_or::<3>(system, first, floor, form, GramProblem::<2, 3, 3>::solve_floor),
        4 => by_active_set_or::<5>(system, first, floor, form, GramProblem::<3, 6, 5>::solve_floor),
        6 => by_active_set_or::<7>(system, first, floor, form, GramProblem::<4, 10, 7>::solve_floor),
        _ => by_active_set_or::<9>(system, first, floor, form, GramProblem::<5, 15, 9>::solve_floor),
    }?;
    system.solve_leading(first, coefficients);
    Ok(range)
}

fn by_active_set_or<const FORM: usize>(
    system: &TriangularSystem,
    first: usize,
    floor: f64,
    form: &mut [f64],
    fallback: impl Fn(&TriangularSystem, usize, f64, &mut [f64]) -> Result<(), FitError>,
) -> Result<CircleRange, FitError> {
    if let Some((solution, range)) = ActiveSetProblem::<FORM>::new(system, first, floor).solve() {
        form.copy_from_slice(&solution);
        return Ok(range);
    }
    fallback(system, first, floor, form)?;
    Ok(CircleRange::of(form))
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::{
        degree::{Degree, MAX_COEFFICIENTS},
        level_set_moments::{LevelSetMoments, OrientedPoints},
        normals::outward_normals,
        outline::Outline,
    };

    /// The least-squares problem of a wavy outline of radius about 1.
    fn system(degree: Degree, seed: u32) -> TriangularSystem {
        let phase = |k: u32| f64::from(seed * 7 + k * k) * 0.61;
        let radius = |t: f64| 1.0 + (2..6).map(|k| 0.12 * (f64::from(k) * t + phase(k)).sin()).sum::<f64>();
        let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / 300.0;
        let points = (0..300).map(angle).map(|t| Point2::new(radius(t) * t.cos(), radius(t) * t.sin()));
        let outline = Outline::closed(points.collect()).expect("an outline");
        let (xs, ys): (Vec<f64>, Vec<f64>) = outline.points().map(|p| (p.x, p.y)).unzip();
        let (nx, ny): (Vec<f64>, Vec<f64>) = outward_normals(&outline, 0.02).iter().map(|n| (n.x, n.y)).unzip();
        let mut sums = LevelSetMoments::ZERO;
        sums.set_to(degree.value(), 0.1, OrientedPoints { points: [&xs, &ys], normals: [&nx, &ny] });
        let mut system = TriangularSystem::new();
        system.factor_gram(degree.value(), &sums, &[1e-6; MAX_COEFFICIENTS]);
        system
    }

    /// Solves a problem with both methods; the active-set method may give up.
    fn both<const FORM: usize>(
        degree: Degree,
        seed: u32,
        interior: impl Fn(&TriangularSystem, usize, f64, &mut [f64]) -> Result<(), FitError>,
    ) -> Option<f64> {
        let system = system(degree, seed);
        let first = monomial_index(degree.value(), 0);
        let mut coefficients = [0.0; MAX_COEFFICIENTS];
        system.solve(&mut coefficients[..degree.coefficient_count()]);
        let form = &mut coefficients[first..degree.coefficient_count()];
        let unconstrained = CircleRange::of(form);
        let floor = 0.9 * unconstrained.rms;
        assert!(unconstrained.minimum < floor, "the constraint is to be active");
        let (by_active_set, range) = ActiveSetProblem::<FORM>::new(&system, first, floor).solve()?;
        assert!(range.minimum >= 0.999_999 * floor);
        interior(&system, first, floor, form).expect("the interior-point method ends");
        let distance = form.iter().zip(&by_active_set).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        Some(distance / unconstrained.rms)
    }

    #[test]
    fn the_active_set_method_nearly_always_ends_and_finds_the_form_of_the_interior_point_method() {
        let count = 200;
        let mut worst = [0.0_f64; 3];
        let mut given_up = [0; 3];
        for seed in 0..count {
            let distances = [
                both::<5>(Degree::Quartic, seed, GramProblem::<3, 6, 5>::solve_floor),
                both::<7>(Degree::Sextic, seed, GramProblem::<4, 10, 7>::solve_floor),
                both::<9>(Degree::Octic, seed, GramProblem::<5, 15, 9>::solve_floor),
            ];
            for (k, distance) in distances.into_iter().enumerate() {
                given_up[k] += i32::from(distance.is_none());
                worst[k] = worst[k].max(distance.unwrap_or(0.0));
            }
        }
        assert!(worst[0] < 1e-6 && worst[1] < 1e-5 && worst[2] < 1e-4, "{worst:?}");
        assert!(given_up[0] <= 4 && given_up[1] <= 20 && given_up[2] <= 60, "{given_up:?}");
    }
}
