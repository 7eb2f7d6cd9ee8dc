//! What an affine map leaves of the area within a polygon (Flusser and Suk, 1993).
use nalgebra::{Complex, Matrix2, Point2, Vector2};

/// Places and weights of the Gauss rule of three points on 0 to 1, exact for polynomials up to the fifth degree.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Largest value of the compactness, that of ellipses.
const OF_ELLIPSES: f64 = 4.0 * std::f64::consts::PI;

/// What an affine map of the plane, a mirror image included, leaves of the area within a closed polygon: affine moment
/// invariants (J. Flusser and T. Suk, Pattern recognition by affine moment invariants, 1993), here by normalisation
/// (I. Rothe, H. Suesse and K. Voss, The method of normalization to determine invariants, 1996).
///
/// With the mean at 0 and the second moments mapped to those of unit variance in all directions, what is left is a turn,
/// which the moduli of the complex moments `c_pq`, the means of `z^p conj(z)^q`, do not see. The third moments tell
/// lopsided shapes apart, the fourth those of half-turn symmetry. The values are of the size of 1 and change
/// in proportion to the shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AffineMomentInvariants([f64; 6]);

impl AffineMomentInvariants {
    /// Of the polygon through the points, either way round; `None` where it encloses nothing.
    pub(crate) fn of(points: &(impl Iterator<Item = Point2<f64>> + Clone)) -> Option<Self> {
        let area = AreaAndCentre::of(points);
        let SecondMoments(covariance) = SecondMoments::about(&area, points);
        let unit = covariance.cholesky()?.l().try_inverse()?;
        let zero = Complex::new(0.0, 0.0);
        let (mut c21, mut c30, mut c22, mut c31, mut c40) = (zero, zero, 0.0, zero, zero);
        area.integrals(points, |r, weight| {
            let r = unit * r;
            let (z, square) = (Complex::new(r.x, r.y), r.norm_squared());
            c21 += z * (square * weight / 5.0);
            c30 += z * z * z * (weight / 5.0);
            c22 += square * square * weight / 6.0;
            c31 += z * z * (square * weight / 6.0);
            c40 += z * z * z * z * (weight / 6.0);
        });
        let compactness = area.signed_area.abs() / covariance.determinant().sqrt() / OF_ELLIPSES;
        let values = [compactness, c21.norm(), c30.norm(), c22, c31.norm(), c40.norm()];
        values.iter().all(|value| value.is_finite()).then_some(Self(values))
    }

    /// `|c_21|`, `|c_30|`, `c_22`, `|c_31|` and `|c_40|`, after the compactness: area over the root of the determinant of
    /// the second moments, as a share of that of ellipses, in (0, 1].
    #[must_use]
    pub const fn values(&self) -> [f64; 6] {
        self.0
    }

    /// Euclidean distance of the values.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        self.0.iter().zip(&other.0).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }
}

/// Second moments of the area within a closed polygon about its centre, over the area.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SecondMoments(Matrix2<f64>);

impl SecondMoments {
    /// Of the polygon through the points, either way round.
    pub(crate) fn of(points: &(impl Iterator<Item = Point2<f64>> + Clone)) -> Self {
        Self::about(&AreaAndCentre::of(points), points)
    }

    fn about(area: &AreaAndCentre, points: &(impl Iterator<Item = Point2<f64>> + Clone)) -> Self {
        let mut moments = Matrix2::zeros();
        area.integrals(points, |r, weight| moments += weight / 4.0 * r * r.transpose());
        Self(moments)
    }

    /// The largest and the smallest, of all directions.
    pub(crate) fn principal(&self) -> [f64; 2] {
        let (mean, half) = (0.5 * self.0.trace(), 0.5 * (self.0.m11 - self.0.m22));
        let apart = half.hypot(self.0.m12);
        [mean + apart, mean - apart]
    }
}

/// Area and centre of area of a closed polygon.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AreaAndCentre {
    /// Positive for a polygon that runs counter-clockwise.
    pub(crate) signed_area: f64,
    pub(crate) centre: Point2<f64>,
}

impl AreaAndCentre {
    pub(crate) fn of(points: &(impl Iterator<Item = Point2<f64>> + Clone)) -> Self {
        let origin = points.clone().next().unwrap_or_else(Point2::origin);
        let (mut doubled, mut moment) = (0.0, Vector2::zeros());
        for (p, q) in edges(points) {
            let (p, q) = (p - origin, q - origin);
            let cross = p.perp(&q);
            doubled += cross;
            moment += cross * (p + q);
        }
        let centre = if doubled == 0.0 { origin } else { origin + moment / (3.0 * doubled) };
        Self { signed_area: 0.5 * doubled, centre }
    }

    /// Integrals of homogeneous functions over the triangles between the centre and the edges: from the centre, with weights by the area.
    fn integrals(&self, points: &(impl Iterator<Item = Point2<f64>> + Clone), mut add: impl FnMut(Vector2<f64>, f64)) {
        for (p, q) in edges(points) {
            let (p, q) = (p - self.centre, q - self.centre);
            let cross = p.perp(&q) / self.signed_area;
            GAUSS.iter().for_each(|(place, weight)| add(p + (q - p) * *place, cross * weight));
        }
    }
}

fn edges(points: &(impl Iterator<Item = Point2<f64>> + Clone)) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> {
    points.clone().zip(points.clone().cycle().skip(1))
}

/// Whether a point lies within a closed polygon, by the crossings of a ray.
pub(crate) fn is_within(p: &Point2<f64>, polygon: &(impl Iterator<Item = Point2<f64>> + Clone)) -> bool {
    let crossed = edges(polygon)
        .filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x));
    crossed.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use nalgebra::Affine2;

    use super::*;

    fn polygon() -> Vec<Point2<f64>> {
        [(0.0, 0.0), (3.0, 0.0), (2.0, 1.0), (2.5, 2.0), (0.5, 1.5)]
            .map(|(x, y)| Point2::new(50.0 + x, y - 20.0))
            .to_vec()
    }

    fn of(points: &[Point2<f64>]) -> [f64; 6] {
        AffineMomentInvariants::of(&points.iter().copied()).expect("an area").values()
    }

    #[test]
    fn no_affine_map_changes_them() {
        let expected = of(&polygon());
        for (map, reversed) in [
            ([2.0, 0.7, 5.0, -0.3, 0.9, 1.0], false),
            ([0.1, -4.0, 0.0, 3.0, 0.2, -9.0], true),
            ([-1.0, 0.0, 3.0, 0.4, 1.0, 0.0], false),
        ] {
            let matrix = nalgebra::Matrix3::new(map[0], map[1], map[2], map[3], map[4], map[5], 0.0, 0.0, 1.0);
            let map = Affine2::from_matrix_unchecked(matrix);
            let mut points: Vec<_> = polygon().iter().map(|p| map * p).collect();
            if reversed {
                points.reverse();
            }
            for (value, expected) in of(&points).iter().zip(expected) {
                assert!((value - expected).abs() < 1e-9, "{value} and {expected}");
            }
        }
    }

    #[test]
    fn known_shapes_have_the_values_of_the_textbook() {
        let disc: Vec<_> = (0..4000)
            .map(|k| std::f64::consts::TAU * f64::from(k) / 4000.0)
            .map(|angle| Point2::new(7.0 + 2.0 * angle.cos(), angle.sin()))
            .collect();
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
        for (values, expected) in [
            (of(&disc), [1.0, 0.0, 0.0, 16.0 / 3.0, 0.0, 0.0]),
            (of(&square), [12.0 / OF_ELLIPSES, 0.0, 0.0, 5.6, 0.0, 2.4]),
        ] {
            for (value, expected) in values.iter().zip(expected) {
                assert!((value - expected).abs() < 1e-4, "{values:?}");
            }
        }
    }

    #[test]
    fn they_are_those_of_flusser_and_suk() {
        // The third and fourth invariant of the paper of 1993, with central moments of the area from a fine grid.
        let points = polygon();
        let n = 800;
        let at = |k: i32, low: f64, length: f64| low + length * (f64::from(k) + 0.5) / f64::from(n);
        let samples: Vec<_> = (0..n)
            .flat_map(|i| (0..n).map(move |j| Point2::new(at(i, 50.0, 3.0), at(j, -20.0, 2.0))))
            .filter(|p| is_within(p, &points.iter().copied()))
            .collect();
        let cell = 6.0 / f64::from(n * n);
        let centre = samples.iter().map(|p| p.coords).sum::<Vector2<f64>>() / samples.len() as f64;
        let mu = |p: i32, q: i32| {
            samples.iter().map(|s| (s.x - centre.x).powi(p) * (s.y - centre.y).powi(q)).sum::<f64>() * cell
        };
        let m00 = mu(0, 0);
        let (m20, m11, m02) = (mu(2, 0), mu(1, 1), mu(0, 2));
        let (m30, m21, m12, m03) = (mu(3, 0), mu(2, 1), mu(1, 2), mu(0, 3));
        let i1 = (m20 * m02 - m11 * m11) / m00.powi(4);
        let i3 = (m20 * (m21 * m03 - m12 * m12) - m11 * (m30 * m03 - m21 * m12) + m02 * (m30 * m12 - m21 * m21))
            / m00.powi(7);
        let i4 =
            (m20.powi(3) * m03.powi(2) - 6.0 * m20.powi(2) * m11 * m12 * m03 - 6.0 * m20.powi(2) * m02 * m21 * m03
                + 9.0 * m20.powi(2) * m02 * m12.powi(2)
                + 12.0 * m20 * m11.powi(2) * m21 * m03
                + 6.0 * m20 * m11 * m02 * m30 * m03
                - 18.0 * m20 * m11 * m02 * m21 * m12
                - 8.0 * m11.powi(3) * m30 * m03
                - 6.0 * m20 * m02.powi(2) * m30 * m12
                + 9.0 * m20 * m02.powi(2) * m21.powi(2)
                + 12.0 * m11.powi(2) * m02 * m30 * m12
                - 6.0 * m11 * m02.powi(2) * m30 * m21
                + m02.powi(3) * m30.powi(2))
                / m00.powi(11);
        let [compactness, c21, c30, ..] = of(&points);
        let scale = (OF_ELLIPSES * compactness).powi(-2);
        assert!((i1 / scale - 1.0).abs() < 1e-3);
        // In the normalised plane I3 is (|c21|^2 - |c30|^2) / 8 and I4 is |c30|^2; moments of unit area have unit variance there.
        let third = (c21 * c21 - c30 * c30) / 8.0;
        assert!((i3 / scale.powi(2) - third).abs() < 2e-3 * third.abs().max(0.1), "{} {third}", i3 / scale.powi(2));
        assert!((i4 / scale.powi(3) - c30 * c30).abs() < 2e-3, "{} {}", i4 / scale.powi(3), c30 * c30);
    }

    #[test]
    fn a_polygon_without_area_has_none() {
        let line = [0.0, 1.0, 2.0].map(|x| Point2::new(x, x));
        assert_eq!(AffineMomentInvariants::of(&line.into_iter()), None);
    }
}
