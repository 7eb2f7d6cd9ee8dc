use std::f64::consts::TAU;

use freeform_riccati::MotionModel;
use nalgebra::{Matrix2, Point2, Rotation2, Vector2};
use rand::{Rng, RngExt as _};

use crate::ExperimentError;

/// Range of the ratio of the shorter to the longer axis of a circle in a plane that is seen aslant.
const AXES: (f64, f64) = (0.5, 1.0);

/// Range of the rate at which the picture grows or shrinks, in 1/s: by a third in three seconds at most.
const GROWTH: (f64, f64) = (0.01, 0.1);

/// What becomes of the plane in which the object moves rigidly: a point x of it is at `linear (centre + exp(growth t) (x - centre))`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch {
    pub(super) linear: Matrix2<f64>,
    /// In 1/s.
    pub(super) growth: f64,
    /// Where the growth moves nothing.
    pub(super) centre: Point2<f64>,
}

impl Stretch {
    /// Nothing.
    pub(super) fn none() -> Self {
        Self { linear: Matrix2::identity(), growth: 0.0, centre: Point2::origin() }
    }

    /// One that makes rigid motions such of a family: growth or shrinking about a point, in affine motion of a plane that is seen aslant
    /// from anywhere.
    ///
    /// # Errors
    /// [`ExperimentError::NoStressOfFamily`] for projective motion.
    pub(super) fn draw(model: MotionModel, centre: Point2<f64>, rng: &mut impl Rng) -> Result<Self, ExperimentError> {
        let growth = |unit: &mut dyn FnMut() -> f64| {
            let sign = if unit() < 0.5 { -1.0 } else { 1.0 };
            sign * (GROWTH.0 + (GROWTH.1 - GROWTH.0) * unit())
        };
        let mut unit = || rng.random::<f64>();
        match model {
            MotionModel::Rigid => Ok(Self::none()),
            MotionModel::Similarity => Ok(Self { growth: growth(&mut unit), centre, ..Self::none() }),
            MotionModel::Affine => {
                let growth = growth(&mut unit);
                let [before, after] = [unit(), unit()].map(|share| Rotation2::new(TAU * share).into_inner());
                let shorter = AXES.0 + (AXES.1 - AXES.0) * unit();
                let linear = after * Matrix2::from_diagonal(&Vector2::new(1.0, shorter)) * before;
                Ok(Self { linear, growth, centre })
            }
            MotionModel::Projective => Err(ExperimentError::NoStressOfFamily { model }),
        }
    }

    /// How much the picture has grown at a time in seconds.
    pub(super) fn scale(&self, time: f64) -> f64 {
        (self.growth * time).exp()
    }

    /// Unit normal in the picture of a contour with this unit normal in the plane.
    pub(super) fn normal(&self, of_plane: &Vector2<f64>) -> Vector2<f64> {
        match self.linear.try_inverse() {
            Some(back) if self.linear != Matrix2::identity() => (back.transpose() * of_plane).normalize(),
            _ => *of_plane,
        }
    }

    /// Where a point of the plane is at a time.
    pub(super) fn image(&self, time: f64, point: &Point2<f64>) -> Point2<f64> {
        if self.growth == 0.0 {
            return self.linear * point;
        }
        self.linear * (self.centre + self.scale(time) * (point - self.centre))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

    fn drawn(model: MotionModel, seed: u64) -> Stretch {
        Stretch::draw(model, Point2::new(1.0, 2.0), &mut ChaCha8Rng::seed_from_u64(seed)).expect("a stretch")
    }

    #[test]
    fn a_rigid_motion_stays_one_and_a_similarity_keeps_angles() {
        assert_eq!(drawn(MotionModel::Rigid, 1), Stretch::none());
        for seed in 0..20 {
            let stretch = drawn(MotionModel::Similarity, seed);
            assert_eq!(stretch.linear, Matrix2::identity());
            assert!((GROWTH.0..GROWTH.1).contains(&stretch.growth.abs()));
            let two = drawn(MotionModel::Affine, seed).linear.singular_values();
            assert!((two[0] - 1.0).abs() < 1e-12 && (AXES.0..=AXES.1).contains(&two[1]), "{two}");
        }
    }

    #[test]
    fn the_plane_grows_at_its_rate_about_its_centre() {
        let stretch = Stretch { growth: 0.5, centre: Point2::new(1.0, 2.0), ..Stretch::none() };
        assert_eq!(stretch.image(2.0, &stretch.centre), stretch.centre);
        let other = stretch.image(2.0, &Point2::new(2.0, 2.0));
        assert!((other - Point2::new(1.0 + 1.0_f64.exp(), 2.0)).norm() < 1e-14);
    }

    #[test]
    fn normals_stay_normal_to_the_contour() {
        let stretch = drawn(MotionModel::Affine, 4);
        let (tangent, normal) = (Vector2::new(0.6, 0.8), Vector2::new(0.8, -0.6));
        assert!((stretch.linear * tangent).dot(&stretch.normal(&normal)).abs() < 1e-14);
        assert_eq!(drawn(MotionModel::Similarity, 4).normal(&normal), normal);
    }

    #[test]
    fn there_is_none_of_projective_motion() {
        let error = Stretch::draw(MotionModel::Projective, Point2::origin(), &mut ChaCha8Rng::seed_from_u64(1))
            .expect_err("none");
        assert!(error.to_string().contains("projective"));
    }
}
