//! Coordinates about the middle of a map in which it has the size 1.
use freeform_riccati::MotionModel;
use nalgebra::{Matrix2, Matrix3, Point2, Rotation2, Vector2};

use super::Cell;
#[cfg(feature = "serde")]
use crate::tuning::null_space::UNDONE;
use crate::tuning::null_space::{ANY_DIRECTION, AREA_OVER_CELLS};

/// Coordinates about the mean of the cells in which their RMS radius is 1. Where shapes may be stretched, outlines that are the same up to a
/// stretch are the same in them: a slender one shows as much there as one that is as long as wide.
#[derive(Debug, Clone, Copy)]
pub(super) struct Centring {
    pub(super) centroid: Point2<f64>,
    /// RMS radius in the body frame.
    spread: f64,
    stretch: Option<Stretch>,
    /// How much longer the stretch makes the outline.
    mean_length: f64,
}

/// A unit normal in the body frame, by the cells before and after it, and the variances of its direction in rad squared.
#[derive(Debug, Clone, Copy)]
pub(super) struct NormalByNeighbours {
    pub(super) direction: Vector2<f64>,
    /// By the noise of these cells.
    pub(super) of_noise: f64,
    /// By the bend of the outline between them.
    pub(super) of_bend: f64,
}

/// Makes an outline as long as wide.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Stretch {
    linear: Matrix2<f64>,
    inverse: Matrix2<f64>,
}

impl Centring {
    /// That of the cells of a map; `sigma` is the deviation of their noise, which is wide enough for an outline that is a line, `of_area` the
    /// covariance of the places within it, where it is closed.
    pub(super) fn of(cells: &[Cell], model: MotionModel, sigma: f64, of_area: Option<Matrix2<f64>>) -> Self {
        let count = cells.len() as f64;
        let centroid = Point2::from(cells.iter().map(|c| c.centre.coords / count).sum::<Vector2<f64>>());
        let spread = cells.iter().map(|c| (c.centre - centroid).norm_squared() / count).sum::<f64>().sqrt();
        let mut centring = Self { centroid, spread, stretch: None, mean_length: 1.0 };
        if model <= MotionModel::Similarity {
            return centring;
        }
        let from_centre = || cells.iter().map(|cell| cell.centre - centroid);
        let least = (sigma * sigma).max(spread * spread * f64::EPSILON);
        let of_cells = from_centre().map(|v| v * v.transpose() / count).sum::<Matrix2<f64>>();
        let of_area = of_area.filter(|area| is_like(area, &(of_cells + Matrix2::identity() * least)));
        let axes = of_area.unwrap_or(of_cells).symmetric_eigen();
        let widths = axes.eigenvalues.map(|variance| variance.max(least).sqrt());
        let along_axes =
            |sizes: Vector2<f64>| axes.eigenvectors * Matrix2::from_diagonal(&sizes) * axes.eigenvectors.transpose();
        let (linear, inverse) = (along_axes(widths.map(f64::recip)), along_axes(widths));
        // Stretched, the RMS radius is still 1.
        let radius = (from_centre().map(|v| (linear * v).norm_squared()).sum::<f64>() / count).sqrt() / spread;
        let stretch = Stretch { linear: linear / radius, inverse: inverse * radius };
        centring.mean_length =
            cells.iter().map(|cell| (stretch.linear * along(&cell.normal)).norm()).sum::<f64>() / count;
        centring.stretch = Some(stretch);
        centring
    }

    /// A point of the body frame in these coordinates.
    pub(super) fn centred(&self, point: &Point2<f64>) -> Point2<f64> {
        let centred = (point - self.centroid) / self.spread;
        Point2::from(self.stretch.map_or(centred, |stretch| stretch.linear * centred))
    }

    /// How much longer the outline is here than in the body frame where it has this normal there, over what it is in the mean.
    pub(super) fn relative_length(&self, normal: &Vector2<f64>) -> f64 {
        self.stretch.map_or(1.0, |stretch| (stretch.linear * along(normal)).norm() / self.mean_length)
    }

    /// A normal in these coordinates, and the variance of its direction in rad squared. The tips of a slender outline count for much in them,
    /// and bend within a cell or two: so bends are counted where the outline is stretched.
    pub(super) fn normal(&self, normal: &NormalByNeighbours) -> (Vector2<f64>, f64) {
        let NormalByNeighbours { direction, of_noise, of_bend } = normal;
        let Some(Stretch { linear, .. }) = self.stretch else { return (*direction, *of_noise) };
        let tangent = linear * along(direction);
        let length = tangent.norm();
        let turned = linear.determinant() / (length * length);
        let variance = (of_noise + of_bend) * turned * turned;
        (Vector2::new(tangent.y, -tangent.x) / length, variance.min(ANY_DIRECTION))
    }

    pub(super) fn spread(&self) -> f64 {
        self.spread
    }

    /// What makes the outline as long as wide; `None` where its shape is kept.
    pub(super) fn stretch(&self) -> Option<Stretch> {
        self.stretch
    }

    /// A generator as it is before the stretch.
    pub(super) fn unstretched(&self, generator: &Matrix3<f64>) -> Matrix3<f64> {
        self.stretch.map_or(*generator, |stretch| stretch.unstretched(generator))
    }

    /// From these coordinates to the body frame.
    pub(super) fn to_body_from_stretched(self) -> Matrix3<f64> {
        self.to_body() * self.stretch.map_or_else(Matrix3::identity, |stretch| stretch.inverse.to_homogeneous())
    }

    /// From these coordinates, before the stretch, to the body frame.
    pub(super) fn to_body(self) -> Matrix3<f64> {
        let Self { centroid: c, spread, .. } = self;
        Matrix3::new(spread, 0.0, c.x, 0.0, spread, c.y, 0.0, 0.0, 1.0)
    }
}

impl Stretch {
    /// A generator of the stretched outline as it is before the stretch.
    pub(super) fn unstretched(&self, generator: &Matrix3<f64>) -> Matrix3<f64> {
        self.inverse.to_homogeneous() * generator * self.linear.to_homogeneous()
    }

    /// How many times as long as wide the outline is after a linear map.
    pub(super) fn ratio_after(&self, map: &Matrix2<f64>) -> f64 {
        let widths = (map * self.inverse).singular_values();
        widths.max() / widths.min()
    }

    /// A linear map of the outline as one of the stretched outline.
    pub(super) fn stretched(&self, map: &Matrix2<f64>) -> Matrix2<f64> {
        self.linear * map * self.inverse
    }

    /// The linear part of a turn of the stretched outline by an angle, rad, before the stretch.
    pub(super) fn turn(&self, angle: f64) -> Matrix2<f64> {
        self.inverse * Rotation2::new(angle).matrix() * self.linear
    }
}

#[cfg(feature = "serde")]
impl Stretch {
    /// Whether it stretches along two axes, and can be undone.
    pub(super) fn is_valid(&self) -> bool {
        let undone = self.linear * self.inverse - Matrix2::identity();
        let is_symmetric = |m: &Matrix2<f64>| (m.m12 - m.m21).abs() <= UNDONE * m.amax() && m.trace() > 0.0;
        let is_finite = self.linear.iter().chain(&self.inverse).all(|entry| entry.is_finite());
        is_finite
            && undone.iter().all(|entry| entry.abs() < UNDONE)
            && is_symmetric(&self.linear)
            && is_symmetric(&self.inverse)
            && self.inverse.determinant() > 0.0
    }
}

/// Whether the covariance of an area is about that of the cells around it. An outline that crosses itself encloses areas of both signs, which make no
/// covariance.
fn is_like(of_area: &Matrix2<f64>, of_cells: &Matrix2<f64>) -> bool {
    let Some(root) = of_cells.cholesky().and_then(|factor| factor.l().try_inverse()) else { return false };
    let ratios = (root * of_area * root.transpose()).symmetric_eigenvalues();
    ratios.iter().all(|ratio| AREA_OVER_CELLS.contains(ratio))
}

/// The direction of an outline with this normal.
fn along(normal: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-normal.y, normal.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ellipse(width: f64) -> Vec<Cell> {
        let cell = |k: i32| {
            let (sine, cosine) = (f64::from(k) * std::f64::consts::TAU / 200.0).sin_cos();
            let normal = Vector2::new(width * cosine, sine).normalize();
            Cell { centre: Point2::new(3.0 + cosine, width * sine), normal, neighbours: [0, 0] }
        };
        (0..200).map(cell).collect()
    }

    fn normal_of(cell: &Cell) -> NormalByNeighbours {
        NormalByNeighbours { direction: cell.normal, of_noise: 1e-4, of_bend: 0.0 }
    }

    #[test]
    fn a_slender_ellipse_is_a_circle_where_shapes_may_be_stretched() {
        let cells = ellipse(0.1);
        let of_area = Matrix2::from_diagonal(&Vector2::new(0.25, 0.0025));
        let centring = Centring::of(&cells, MotionModel::Affine, 1e-3, Some(of_area));
        for cell in &cells {
            let p = centring.centred(&cell.centre);
            let (normal, _) = centring.normal(&normal_of(cell));
            assert!((p.coords.norm() - 1.0).abs() < 1e-9, "{p}");
            assert!((normal - p.coords).norm() < 1e-9, "{normal} {p}");
            // A rotation of the circle slides points along the ellipse.
            let in_body = centring.to_body() * centring.unstretched(&crate::map::CLOCKWISE);
            let from_body = centring.to_body().try_inverse().expect("a size");
            let velocity = in_body * from_body * cell.centre.to_homogeneous();
            assert!(velocity.xy().norm() > 0.05 && velocity.xy().dot(&cell.normal).abs() < 1e-9, "{velocity}");
        }
        let lengths: f64 = cells.iter().map(|cell| centring.relative_length(&cell.normal)).sum();
        assert!((lengths / 200.0 - 1.0).abs() < 1e-9);
        // The flat sides are turned away from, the tips towards.
        let [tip, side] = [0, 50].map(|number| centring.normal(&normal_of(&cells[number])).1);
        assert!(tip < 1e-5 && side > 1e-3, "{tip} {side}");
    }

    #[test]
    fn an_area_that_is_none_does_not_stretch_an_outline() {
        let cells = ellipse(0.5);
        let by_cells = Centring::of(&cells, MotionModel::Affine, 1e-3, None).stretch().expect("a stretch");
        for of_area in [[0.1, -0.05], [10.0, 0.02], [1e-3, 2e-4]] {
            let of_area = Matrix2::from_diagonal(&Vector2::from(of_area));
            let stretch = Centring::of(&cells, MotionModel::Affine, 1e-3, Some(of_area)).stretch().expect("a stretch");
            assert!((stretch.linear - by_cells.linear).amax() < 1e-12, "{of_area} {stretch:?}");
        }
    }

    #[test]
    fn where_shapes_keep_their_form_an_outline_is_as_slender_as_it_is() {
        let cells = ellipse(0.1);
        let centring = Centring::of(&cells, MotionModel::Similarity, 1e-3, None);
        assert!((centring.centred(&cells[50].centre).coords.norm() - 0.14).abs() < 1e-2);
        assert_eq!(centring.normal(&normal_of(&cells[7])), (cells[7].normal, 1e-4));
        assert_eq!(centring.relative_length(&cells[7].normal), 1.0);
    }
}
