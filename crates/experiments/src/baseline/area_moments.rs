use freeform_curve_fit::principal_angle;
use nalgebra::{Complex, Matrix2, Point2, Vector2};

/// Moments up to the third order of the area that a polygon encloses, about its centroid and per area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AreaMoments {
    /// Positive.
    pub(super) area: f64,
    pub(super) centroid: Point2<f64>,
    /// Second central moments.
    pub(super) covariance: Matrix2<f64>,
    /// Mean of `z |z|^2` with `z = x + j y` from the centroid: turns with the area.
    pub(super) first_harmonic: Complex<f64>,
    /// Mean of `z^3`: turns three times as fast.
    pub(super) third_harmonic: Complex<f64>,
}

/// Places of the Gauss rule of two points on 0 to 1, exact for cubics.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_13, 0.788_675_134_594_812_9];

impl AreaMoments {
    /// Of the closed polygon through the points, either way round; `None` where it encloses nothing.
    pub(super) fn of(points: &[Point2<f64>]) -> Option<Self> {
        let origin = points.first()?.coords;
        let about = |centre: Vector2<f64>| {
            let next = points.iter().cycle().skip(1);
            points.iter().zip(next).map(move |(p, q)| (p.coords - centre, q.coords - centre))
        };
        // A homogeneous f of degree d has over the triangle (0, p, q) the integral p x q / (d + 2) times its mean on pq.
        let (mut area, mut first) = (0.0, Vector2::zeros());
        for (p, q) in about(origin) {
            let cross = p.perp(&q);
            area += 0.5 * cross;
            first += cross / 6.0 * (p + q);
        }
        let centroid = Point2::from(origin + first / area);
        let (mut covariance, mut third) = (Matrix2::zeros(), [Complex::new(0.0, 0.0); 2]);
        for (p, q) in about(centroid.coords) {
            let cross = p.perp(&q) / area;
            for s in GAUSS {
                let r: Vector2<f64> = p + (q - p) * s;
                let z = Complex::new(r.x, r.y);
                covariance += cross / 8.0 * r * r.transpose();
                third[0] += z * r.norm_squared() * (cross / 10.0);
                third[1] += z * z * z * (cross / 10.0);
            }
        }
        let [first_harmonic, third_harmonic] = third;
        let moments = Self { area: area.abs(), centroid, covariance, first_harmonic, third_harmonic };
        let proper = area.abs() > 0.0 && covariance.determinant() > 0.0 && covariance.trace() > 0.0;
        (proper && third.iter().all(|m| m.is_finite()) && centroid.x.is_finite()).then_some(moments)
    }

    /// Direction of the longer principal axis, rad; its other end is as good.
    pub(super) fn axis(&self) -> f64 {
        principal_angle(&self.covariance)
    }

    /// How well the third moments of `self` turned by an angle in rad agree with those of `other`: 1 for a turned copy, -1 for one
    /// turned by half a turn more.
    pub(super) fn agreement(&self, other: &Self, turn: f64) -> f64 {
        let unit = Complex::from_polar(1.0, turn);
        let part = |a: Complex<f64>, b: Complex<f64>, unit: Complex<f64>| (a * unit * b.conj()).re;
        let size = |m: &Self| (m.first_harmonic.norm_sqr() + m.third_harmonic.norm_sqr()).sqrt();
        let agreement = part(self.first_harmonic, other.first_harmonic, unit)
            + part(self.third_harmonic, other.third_harmonic, unit * unit * unit);
        agreement / (size(self) * size(other)).max(f64::MIN_POSITIVE)
    }

    /// The turn in rad that agrees best.
    pub(super) fn best_turn(&self, other: &Self) -> f64 {
        const TRIED: usize = 90;
        let step = std::f64::consts::TAU / TRIED as f64;
        let tried = (0..TRIED).map(|i| step * i as f64);
        let start = tried.max_by(|a, b| self.agreement(other, *a).total_cmp(&self.agreement(other, *b))).unwrap_or(0.0);
        // The agreement is A cos(t + a) + B cos(3 t + b): Newton on its derivative.
        let first = self.first_harmonic * other.first_harmonic.conj();
        let third = self.third_harmonic * other.third_harmonic.conj();
        let mut turn = start;
        for _ in 0..8 {
            let (one, three) = (first * Complex::from_polar(1.0, turn), third * Complex::from_polar(1.0, 3.0 * turn));
            let (slope, curvature) = (-one.im - 3.0 * three.im, -one.re - 9.0 * three.re);
            if curvature < 0.0 {
                turn -= (slope / curvature).clamp(-step, step);
            }
        }
        turn
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon() -> Vec<Point2<f64>> {
        [(0.0, 0.0), (3.0, 0.0), (2.0, 1.0), (0.5, 1.5)].map(|(x, y)| Point2::new(5.0 + x, y - 2.0)).to_vec()
    }

    fn of(points: &[Point2<f64>]) -> AreaMoments {
        AreaMoments::of(points).expect("an area")
    }

    #[test]
    fn the_moments_of_a_rectangle_are_the_textbook_ones_either_way_round() {
        let mut corners = [(1.0, 1.0), (5.0, 1.0), (5.0, 3.0), (1.0, 3.0)].map(|(x, y)| Point2::new(x, y)).to_vec();
        for _ in 0..2 {
            let moments = of(&corners);
            assert!((moments.area - 8.0).abs() < 1e-12 && (moments.centroid - Point2::new(3.0, 2.0)).norm() < 1e-12);
            let expected = Matrix2::new(16.0 / 12.0, 0.0, 0.0, 4.0 / 12.0);
            assert!((moments.covariance - expected).norm() < 1e-12, "{}", moments.covariance);
            assert!(moments.first_harmonic.norm() < 1e-12 && moments.third_harmonic.norm() < 1e-12);
            corners.reverse();
        }
    }

    #[test]
    fn third_moments_are_those_of_a_fine_grid() {
        let (points, n) = (polygon(), 600);
        let moments = of(&points);
        let inside = |p: Point2<f64>| (0..4).all(|i| (points[(i + 1) % 4] - points[i]).perp(&(p - points[i])) >= 0.0);
        let (mut count, mut first, mut third) = (0.0, Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let at = |k: i32, length: f64| length * (f64::from(k) + 0.5) / f64::from(n);
            let p = Point2::new(5.0 + at(i, 3.0), -2.0 + at(j, 1.5));
            if inside(p) {
                let r = p - moments.centroid;
                let z = Complex::new(r.x, r.y);
                count += 1.0;
                first += z * z.norm_sqr();
                third += z * z * z;
            }
        }
        assert!((first / count - moments.first_harmonic).norm() < 1e-3, "{}", first / count);
        assert!((third / count - moments.third_harmonic).norm() < 1e-3, "{}", third / count);
    }

    #[test]
    fn a_turned_copy_is_found_by_its_third_moments() {
        let before = polygon();
        for turn in [-2.9, -0.4, 0.0, 1.3, 3.0] {
            let rotation = nalgebra::Rotation2::new(turn);
            let after: Vec<_> = before.iter().map(|p| rotation * p).collect();
            let error = of(&before).best_turn(&of(&after)) - turn;
            assert!(error.sin().abs() < 1e-9 && error.cos() > 0.0, "{turn}: {error}");
            assert!((of(&before).agreement(&of(&after), turn) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_polygon_without_area_has_no_moments() {
        let line = [0.0, 1.0, 2.0].map(|x| Point2::new(x, x));
        assert!(AreaMoments::of(&line).is_none());
    }
}
