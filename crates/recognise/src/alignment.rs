//! The affine map that brings a known outline onto another one.
use nalgebra::{Affine2, Complex, Matrix3, Matrix6, Point2, Vector3, Vector6};

use crate::signature::{Contour, Signature};

/// Points that contours are correlated by.
const CORRELATED: usize = 128;
/// Candidates that are refined.
const REFINED: usize = 3;
/// Steps of the refinement.
const STEPS: usize = 6;
/// Three related points that span less than this area, in squares of the inertia's disc radius, fix no map.
const SMALLEST_TRIANGLE: f64 = 0.01;
/// Maps between outlines with the inertia of a disc are turns and reflections but for noise: singular values outside this range are
/// those of related points that have swung out.
const STRETCH: std::ops::Range<f64> = 0.7..1.4;
/// Keeps maps that the outline does not tell from growing, per point.
const DAMPING: f64 = 1e-6;

/// How a known outline lies on another one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Alignment {
    /// From the inertia coordinates of the known outline to those of the other.
    pub(crate) map: Affine2<f64>,
    /// Mean squared distance of both outlines from each other, in inertia coordinates.
    pub(crate) squared_distance: f64,
}

/// The best map from a known outline to another: of the candidates from the related points of both curves (three points fix an affine
/// map) and those of [`by_correlation`], refined by iterated closest points.
pub(crate) fn align(known: &Signature, seen: &Signature, correlated: &[Correlated]) -> Option<Alignment> {
    let mut candidates = by_related_points(known, seen);
    candidates.extend(correlated.iter().map(|candidate| candidate.map));
    let mut judged: Vec<Alignment> = candidates.into_iter().filter_map(|map| judge(known, seen, map)).collect();
    judged.sort_by(|a, b| a.squared_distance.total_cmp(&b.squared_distance));
    judged.truncate(REFINED);
    let refined = judged.into_iter().map(|candidate| {
        let better = judge(known, seen, refine(&known.contour, &seen.contour, candidate.map));
        better.filter(|better| better.squared_distance < candidate.squared_distance).unwrap_or(candidate)
    });
    refined.min_by(|a, b| a.squared_distance.total_cmp(&b.squared_distance))
}

/// Both ways to pair the points of the first level.
fn by_related_points(known: &Signature, seen: &Signature) -> Vec<Affine2<f64>> {
    let (Some(known), Some(seen)) = (&known.curve, &seen.curve) else { return Vec::new() };
    let ([a, b, c], [d, e, f]) = (&known.points[..], &seen.points[..]) else { return Vec::new() };
    let columns = |p: &Point2<f64>, q: &Point2<f64>, r: &Point2<f64>| {
        Matrix3::from_columns(&[p.to_homogeneous(), q.to_homogeneous(), r.to_homogeneous()])
    };
    let from = columns(a, b, c);
    if from.determinant().abs() < SMALLEST_TRIANGLE {
        return Vec::new();
    }
    let Some(inverse) = from.try_inverse() else { return Vec::new() };
    let maps = [columns(d, e, f), columns(e, d, f)].map(|to| Affine2::from_matrix_unchecked(to * inverse));
    let is_nearly_a_turn = |map: &Affine2<f64>| {
        let stretches = map.matrix().fixed_view::<2, 2>(0, 0).singular_values();
        stretches.iter().all(|s| STRETCH.contains(s))
    };
    maps.into_iter().filter(is_nearly_a_turn).collect()
}

/// A turn, or a turn after a reflection, that brings one contour near another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Correlated {
    map: Affine2<f64>,
    /// Mean squared distance of points that are as far along both contours, in inertia coordinates.
    pub(crate) squared_distance: f64,
}

/// The turn, and the turn after a reflection, that bring one contour nearest to the other over all places to begin at: of all
/// turns by t, `sum |q_(k+s) - exp(j t) p_k|^2` is least for t the argument of `sum conj(p_k) q_(k+s)`.
pub(crate) fn by_correlation(known: &Contour, seen: &Contour) -> [Correlated; 2] {
    let samples = |contour: &Contour| -> Vec<Complex<f64>> {
        let step = contour.points.len() / CORRELATED;
        contour.points.iter().step_by(step).map(|p| Complex::new(p.x, p.y)).collect()
    };
    let (known, seen) = (samples(known), samples(seen));
    let squares = |points: &[Complex<f64>]| points.iter().map(Complex::norm_sqr).sum::<f64>();
    let sizes = squares(&known) + squares(&seen);
    // Mirrored on the x axis and walked the other way, so that it runs counter-clockwise again.
    let mirrored: Vec<_> = known.iter().rev().map(Complex::conj).collect();
    [(known, 1.0), (mirrored, -1.0)].map(|(known, handedness)| {
        let correlation =
            |s: usize| known.iter().zip(seen[s..].iter().chain(&seen[..s])).map(|(p, q)| p.conj() * q).sum();
        let larger = |a: Complex<f64>, b: Complex<f64>| if b.norm_sqr() > a.norm_sqr() { b } else { a };
        let best = (0..seen.len()).map(correlation).fold(Complex::ZERO, larger);
        let turn = Complex::from_polar(1.0, best.arg());
        let matrix =
            Matrix3::new(turn.re, -handedness * turn.im, 0.0, turn.im, handedness * turn.re, 0.0, 0.0, 0.0, 1.0);
        let squared_distance = ((sizes - 2.0 * best.norm()) / seen.len() as f64).max(0.0);
        Correlated { map: Affine2::from_matrix_unchecked(matrix), squared_distance }
    })
}

/// Both ways, so that neither a part that is missing nor one that is too many goes unseen.
fn judge(known: &Signature, seen: &Signature, map: Affine2<f64>) -> Option<Alignment> {
    let back = map.try_inverse()?;
    let there = known.contour.points.iter().map(|p| seen.contour.squared_distance(&(map * p))).sum::<f64>();
    let here = seen.contour.points.iter().map(|p| known.contour.squared_distance(&(back * p))).sum::<f64>();
    let squared_distance = (there + here) / (known.contour.points.len() + seen.contour.points.len()) as f64;
    squared_distance.is_finite().then_some(Alignment { map, squared_distance })
}

/// Iterated closest points: each step is the affine map that brings every second point of the outline seen onto the lines through the nearest
/// points of the known one.
fn refine(known: &Contour, seen: &Contour, map: Affine2<f64>) -> Affine2<f64> {
    let mut map = map;
    for _ in 0..STEPS {
        let back = map.inverse();
        let mut information = Matrix6::identity() * (DAMPING * seen.points.len() as f64);
        let mut right = Vector6::zeros();
        for p in seen.points.iter().step_by(2) {
            let p = back * p;
            let nearest = known.nearest(&p);
            let normal = known.normals[nearest];
            let distance = normal.dot(&(p - known.points[nearest]));
            let p = Vector3::new(p.x, p.y, 1.0);
            let row = Vector6::from_iterator((p * normal.x).iter().chain((p * normal.y).iter()).copied());
            information += row * row.transpose();
            right -= distance * row;
        }
        let Some(d) = information.cholesky().map(|factor| factor.solve(&right)) else { break };
        let step = Matrix3::new(1.0 + d[0], d[1], d[2], d[3], 1.0 + d[4], d[5], 0.0, 0.0, 1.0);
        let Some(inverse) = Affine2::from_matrix_unchecked(step).try_inverse() else { break };
        map *= inverse;
    }
    map
}
