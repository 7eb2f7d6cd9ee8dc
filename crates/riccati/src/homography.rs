//! The projective map that takes given points to given points.
use nalgebra::{Matrix3, Point2, Projective2, SMatrix, SVector, Vector2};
use thiserror::Error;

/// Ratio of the second smallest to the largest squared singular value of the equations below which they leave more than one map.
const SINGULAR: f64 = 1e-12;
/// Smallest determinant of a map whose entries, between points of RMS distance sqrt 2 from their mean, have the norm 1.
const FLAT: f64 = 1e-6;
/// Share of the norm of a map that its last entry must have to be made 1.
const LAST_ENTRY: f64 = 1e-9;

/// Why there is no projective map that takes some points to others.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum HomographyError {
    /// Fewer than four pairs.
    #[error("{found} pair(s) of points, at least 4 are needed")]
    TooFewPairs {
        /// Pairs given.
        found: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("pair {index} of points is not finite")]
    NotFinite {
        /// Position of the pair, counted from 0.
        index: usize,
    },
    /// More than one map or none: three of four points on a line, or points that coincide.
    #[error("the points leave the map open: of four, no three may lie on one line")]
    Degenerate,
    /// No plane is seen like that: a line between the points would go to infinity, as where two of four points were swapped.
    #[error("no plane is seen like that: are the points of both sides in the same order?")]
    Folded,
}

/// The projective map that takes the first point of each pair to the second: exactly for four pairs, for more in the sense of the
/// normalised direct linear transformation (Hartley, *In defence of the eight-point algorithm*, 1997). Every given point has
/// a positive depth (third homogeneous coordinate); the last entry is 1 unless the map takes the origin near infinity.
///
/// ```
/// use freeform_riccati::homography;
/// use nalgebra::Point2;
///
/// // The corners of a sheet of paper, 21 x 29.7 cm, as seen in a picture.
/// let seen = [(102.0, 391.0), (418.0, 402.0), (371.0, 120.0), (160.0, 117.0)];
/// let sheet = [(0.0, 0.0), (21.0, 0.0), (21.0, 29.7), (0.0, 29.7)];
/// let pairs: Vec<_> = seen.iter().zip(sheet).map(|(p, q)| (Point2::new(p.0, p.1), Point2::new(q.0, q.1))).collect();
/// let plane_from_picture = homography(&pairs)?;
/// assert!((plane_from_picture * pairs[2].0 - Point2::new(21.0, 29.7)).norm() < 1e-9);
/// # Ok::<(), freeform_riccati::HomographyError>(())
/// ```
///
/// # Errors
/// Fewer than four pairs, numbers that are not finite, three of four points on a line, points that no view of a plane shows.
pub fn homography(pairs: &[(Point2<f64>, Point2<f64>)]) -> Result<Projective2<f64>, HomographyError> {
    if pairs.len() < 4 {
        return Err(HomographyError::TooFewPairs { found: pairs.len() });
    }
    let is_finite = |p: &Point2<f64>| p.iter().all(|v| v.is_finite());
    if let Some(index) = pairs.iter().position(|(p, q)| !(is_finite(p) && is_finite(q))) {
        return Err(HomographyError::NotFinite { index });
    }
    let from = normalising(pairs.iter().map(|(p, _)| p)).ok_or(HomographyError::Degenerate)?;
    let to = normalising(pairs.iter().map(|(_, q)| q)).ok_or(HomographyError::Degenerate)?;
    // Of finite, normalised points: nothing here is NaN.
    let mut equations = SMatrix::<f64, 9, 9>::zeros();
    for (p, q) in pairs {
        let (p, q) = (from * p.to_homogeneous(), to * q.to_homogeneous());
        let rows = [
            [p.x, p.y, 1.0, 0.0, 0.0, 0.0, -q.x * p.x, -q.x * p.y, -q.x],
            [0.0, 0.0, 0.0, p.x, p.y, 1.0, -q.y * p.x, -q.y * p.y, -q.y],
        ];
        for row in rows.map(SVector::from) {
            equations += row * row.transpose();
        }
    }
    let eigen = equations.symmetric_eigen();
    let mut order: [usize; 9] = std::array::from_fn(|i| i);
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    if eigen.eigenvalues[order[1]] <= SINGULAR * eigen.eigenvalues[order[8]] {
        return Err(HomographyError::Degenerate);
    }
    let map = Matrix3::from_row_iterator(eigen.eigenvectors.column(order[0]).iter().copied());
    if map.determinant().abs() < FLAT {
        return Err(HomographyError::Degenerate);
    }
    let map = to.try_inverse().ok_or(HomographyError::Degenerate)? * map * from;
    let depths = pairs.iter().map(|(p, _)| (map * p.to_homogeneous()).z);
    let (least, most) = depths.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), w| (a.min(w), b.max(w)));
    let map = match (least > 0.0, most < 0.0) {
        (true, _) => map,
        (_, true) => -map,
        _ => return Err(HomographyError::Folded),
    };
    let last = map[(2, 2)];
    let scaled = if last > LAST_ENTRY * map.norm() { map / last } else { map };
    Ok(Projective2::from_matrix_unchecked(scaled))
}

/// The map that brings points to the mean 0 and the RMS distance sqrt 2 from it. `None` where they coincide.
fn normalising<'a>(points: impl ExactSizeIterator<Item = &'a Point2<f64>> + Clone) -> Option<Matrix3<f64>> {
    let count = points.len() as f64;
    let mean = points.clone().map(|p| p.coords / count).sum::<Vector2<f64>>();
    let scale = (2.0 / (points.map(|p| (p.coords - mean).norm_squared()).sum::<f64>() / count)).sqrt();
    let map = Matrix3::new(scale, 0.0, -scale * mean.x, 0.0, scale, -scale * mean.y, 0.0, 0.0, 1.0);
    map.iter().all(|entry| entry.is_finite()).then_some(map)
}
