//! What an outline is known by: its contour where its inertia is that of a disc, and the curve fitted there.
use freeform_curve_fit::{
    AreaMoments, ClosedOutline, FitSettings, Fitter, Method, Normalisation, Normalise, Outline, evenly_spaced,
    share_along_side,
};
use freeform_decompose::{AffineInvariants, CurveUncertainty, Decomposition, DecompositionError, RelatedPoints};
use nalgebra::{Affine2, DMatrix, Point2, Rotation2, Vector2};

use crate::error::RecogniseError;

/// Points that a contour is compared by.
pub(crate) const POINTS: usize = 256;
/// Points on either side of one that its normal is taken from: about the window of the fits.
const NORMAL_REACH: usize = 4;
/// Points of a piece of a contour.
const PIECE: usize = 16;
/// A piece is taken to be so much larger than it is, as rounding may make it.
const SLACK: f64 = 1e-9;
/// The fit that invariants are taken from: a bounded quartic, which always falls into pairs of lines, with a small ridge.
const FIT: FitSettings = FitSettings {
    degree: freeform_curve_fit::Degree::Quartic,
    method: Method::Bounded { margin: 0.1, ridge_weight: 1e-3 },
    offset: 0.1,
    normal_half_window: 0.02,
    normalise: Normalise::Affine,
};
/// Turns of the coordinates that a curve is taken apart in, in radians: in some the conic level of some curves vanishes.
const TURNS: [f64; 3] = [0.0, 0.6, 1.3];

/// An outline in the coordinates where it has the inertia of the unit disc about the origin, determined up to a turn and a reflection.
#[derive(Debug, Clone)]
pub(crate) struct Signature {
    pub(crate) image_from_inertia: Affine2<f64>,
    pub(crate) contour: Contour,
    /// Standard deviation of its noise along the normals.
    pub(crate) noise: f64,
    pub(crate) curve: Option<CurveSignature>,
}

/// What the lines of the fitted curve tell.
#[derive(Debug, Clone)]
pub(crate) struct CurveSignature {
    pub(crate) invariants: AffineInvariants,
    /// Of their values.
    pub(crate) covariance: DMatrix<f64>,
    /// Related points in inertia coordinates, those of the first level by rising value.
    pub(crate) points: Vec<Point2<f64>>,
}

/// Evenly spaced points of a closed contour that runs counter-clockwise, and their outward unit normals.
#[derive(Debug, Clone)]
pub(crate) struct Contour {
    pub(crate) points: Vec<Point2<f64>>,
    pub(crate) normals: Vec<Vector2<f64>>,
    /// Where every so many points lie.
    pieces: Vec<Piece>,
}

/// A circle about the points of a piece of a contour.
#[derive(Debug, Clone, Copy)]
struct Piece {
    middle: Point2<f64>,
    radius: f64,
}

impl Piece {
    fn of(points: &[Point2<f64>]) -> Self {
        let middle = points[points.len() / 2];
        let squared = points.iter().map(|p| (p - middle).norm_squared()).fold(0.0, f64::max);
        Self { middle, radius: squared.sqrt() + SLACK }
    }
}

/// Makes signatures, in buffers that are reused.
#[derive(Debug, Clone)]
pub(crate) struct SignatureMaker {
    tracing: f64,
    fitter: Fitter,
}

impl SignatureMaker {
    /// `tracing` is the smallest uncertainty of a contour, in inertia coordinates.
    pub(crate) fn new(tracing: f64) -> Self {
        Self { tracing, fitter: Fitter::new(FIT).expect("settings within their ranges") }
    }

    pub(crate) fn signature(&mut self, outline: &Outline) -> Result<Signature, RecogniseError> {
        let Outline::Closed(closed) = outline else { return Err(RecogniseError::NotWhole) };
        let moments = AreaMoments::of(closed).ok_or(RecogniseError::NoRegion)?;
        let image_from_inertia = moments.image_from_inertia_circle();
        let frame = Normalisation::affine(&image_from_inertia).ok_or(RecogniseError::NoRegion)?;
        let contour = Contour::of(closed, &frame);
        let (fit, covariance) = self.fitter.fit_with_covariance(outline)?;
        // Working and inertia coordinates differ by a scale and a shift.
        let inertia_from_working = image_from_inertia.inverse() * fit.normalisation().image_from_working();
        let scale = fit.normalisation().radius / frame.radius;
        let noise = scale * covariance.noise();
        let coefficients = covariance.coefficients_for(noise.hypot(self.tracing) / scale);
        let curve = TURNS
            .iter()
            .find_map(|&turn| curve_signature(fit.working(), &coefficients, turn, &inertia_from_working).ok())
            .flatten();
        Ok(Signature { image_from_inertia, contour, noise, curve })
    }
}

/// Takes a curve apart in coordinates turned by an angle.
fn curve_signature(
    working: &freeform_curve_fit::ImplicitPolynomial,
    covariance: &DMatrix<f64>,
    turn: f64,
    inertia_from_working: &Affine2<f64>,
) -> Result<Option<CurveSignature>, DecompositionError> {
    let turned_from_working: Affine2<f64> = nalgebra::convert(Rotation2::new(turn));
    let singular = |_| DecompositionError::SingularMap { determinant: 0.0 };
    let turned = working.moved(&turned_from_working).map_err(singular)?;
    let decomposition = Decomposition::of(&turned)?;
    // How the coefficients change with the turn: linearly.
    let size = working.coefficients().len();
    let mut change = DMatrix::zeros(size, size);
    for (k, mut column) in change.column_iter_mut().enumerate() {
        let mut unit = vec![0.0; size];
        unit[k] = 1.0;
        let basis = freeform_curve_fit::ImplicitPolynomial::new(working.degree(), &unit).map_err(singular)?;
        let moved = basis.moved(&turned_from_working).map_err(singular)?;
        column.copy_from_slice(moved.coefficients());
    }
    let uncertainty = CurveUncertainty::carried(&turned, &(&change * covariance * change.transpose()))?;
    let (Some(invariants), Some(covariance)) = (AffineInvariants::of(&decomposition), uncertainty.invariants()) else {
        return Ok(None);
    };
    let related = RelatedPoints::of(&decomposition);
    let mut first: Vec<_> = related.level(decomposition.degree().value()).collect();
    let sign = 1.0_f64.copysign(decomposition.coefficient(decomposition.degree().value()));
    first.sort_by(|a, b| (sign * a.value).total_cmp(&(sign * b.value)));
    let lower = related.as_slice().iter().filter(|d| d.level < decomposition.degree().value());
    let back = inertia_from_working * turned_from_working.inverse();
    let points = first.into_iter().chain(lower).map(|d| back * d.point).collect();
    Ok(Some(CurveSignature { invariants, covariance: covariance.clone(), points }))
}

impl Contour {
    fn of(outline: &ClosedOutline, frame: &Normalisation) -> Self {
        let mut there: Vec<_> = outline.points().iter().map(|p| frame.to_working(p)).collect();
        if outline.signed_area() < 0.0 {
            there.reverse();
        }
        let points = evenly_spaced(&there, POINTS);
        let count = points.len();
        let normal = |i: usize| {
            let along = points[(i + NORMAL_REACH) % count] - points[(i + count - NORMAL_REACH) % count];
            Vector2::new(along.y, -along.x).try_normalize(0.0).unwrap_or_default()
        };
        let normals = (0..count).map(normal).collect();
        let pieces = points.chunks(PIECE).map(Piece::of).collect();
        Self { points, normals, pieces }
    }

    /// Which of its points is nearest, the first of several.
    pub(crate) fn nearest(&self, p: &Point2<f64>) -> usize {
        let squared = |q: &Point2<f64>| (q - p).norm_squared();
        let pieces = || self.points.chunks(PIECE).zip(&self.pieces);
        // The piece whose middle is nearest tells how far the point is at most.
        let near = pieces().min_by(|(_, a), (_, b)| squared(&a.middle).total_cmp(&squared(&b.middle)));
        let most = near.map_or(0.0, |(points, _)| points.iter().map(squared).fold(f64::INFINITY, f64::min)).sqrt();
        let mut best = (f64::INFINITY, 0);
        for (number, (points, piece)) in pieces().enumerate() {
            if squared(&piece.middle) > (most + piece.radius).powi(2) {
                continue;
            }
            for (index, point) in points.iter().enumerate() {
                let distance = squared(point);
                if distance < best.0 {
                    best = (distance, number * PIECE + index);
                }
            }
        }
        best.1
    }

    /// Squared distance of a point from the closed polygon, looked for next to the nearest of its points.
    pub(crate) fn squared_distance(&self, p: &Point2<f64>) -> f64 {
        let (count, at) = (self.points.len(), self.nearest(p));
        let segment = |from: usize| to_segment(p, &self.points[from % count], &self.points[(from + 1) % count]);
        segment(at).min(segment(at + count - 1))
    }
}

fn to_segment(p: &Point2<f64>, from: &Point2<f64>, to: &Point2<f64>) -> f64 {
    (p - from - share_along_side(from, to, p) * (to - from)).norm_squared()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn contour(points: Vec<Point2<f64>>) -> Contour {
        let pieces = points.chunks(PIECE).map(Piece::of).collect();
        Contour { normals: vec![Vector2::x(); points.len()], points, pieces }
    }

    proptest! {
        #[test]
        fn the_nearest_point_is_the_first_of_those_that_a_plain_search_finds(
            // On a grid, so that many are as near as others.
            places in prop::collection::vec((-8..8_i32, -8..8_i32), 1..100),
            from in (-20..20_i32, -20..20_i32),
        ) {
            let point = |(x, y): (i32, i32)| Point2::new(f64::from(x) / 8.0, f64::from(y) / 8.0);
            let contour = contour(places.into_iter().map(point).collect());
            let from = point(from);
            let squared = contour.points.iter().map(|q| (q - from).norm_squared());
            let expected = squared.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index);
            prop_assert_eq!(Some(contour.nearest(&from)), expected);
        }
    }
}
