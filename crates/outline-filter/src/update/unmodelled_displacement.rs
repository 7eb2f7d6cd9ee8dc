//! How far motions that the model leaves out displace the cells of an outline.
use freeform_riccati::{MotionModel, map_point};
use nalgebra::{Matrix2, Matrix3, Point2, SMatrix, SVector, Vector2};

use crate::{
    belief::Belief,
    map::{Cell, OutlineMap},
};

/// Motions that may be left out: growth, stretch, skew, two of perspective, that of rows which are read one after the other, and three of a
/// lens.
pub(crate) const UNMODELLED: usize = 9;

pub(crate) type UnmodelledVector = SVector<f64, UNMODELLED>;
pub(crate) type UnmodelledMatrix = SMatrix<f64, UNMODELLED, UNMODELLED>;

/// Which of them a model has.
fn has(model: MotionModel) -> [bool; UNMODELLED] {
    let (growth, shear, perspective) =
        (model != MotionModel::Rigid, model >= MotionModel::Affine, model >= MotionModel::Projective);
    // The slant of a rolling shutter is a shear.
    [growth, shear, shear, perspective, perspective, shear, perspective, perspective, perspective]
}

/// A pose and motion that displacements are taken at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instant {
    pose: Matrix3<f64>,
    /// Transposed inverse of the linear part: normals of the body to those of the image, not normalised.
    of_normals: Matrix2<f64>,
    /// Of the object, in the image.
    centroid: Point2<f64>,
    generator: Matrix3<f64>,
    elapsed: f64,
    is_had: [bool; UNMODELLED],
}

impl Instant {
    /// `elapsed` is the time since the first frame. `None` where the model has all of the motions, or the pose has collapsed.
    pub(super) fn new(belief: &Belief, pose: &Matrix3<f64>, map: &OutlineMap, elapsed: f64) -> Option<Self> {
        let is_had = has(belief.model);
        let linear = pose.fixed_view::<2, 2>(0, 0).into_owned();
        if is_had.iter().all(|had| *had) || linear.determinant() <= 0.0 {
            return None;
        }
        Some(Self {
            pose: *pose,
            of_normals: linear.try_inverse()?.transpose(),
            centroid: map_point(pose, &map.centroid()),
            generator: belief.model.generator(&belief.motion[..belief.parameter_count()]),
            elapsed,
            is_had,
        })
    }

    /// Displacement of a cell along its normal in the body frame by a unit of each motion, and how far an error of the pose moves it.
    #[inline(always)]
    pub(super) fn displacement(&self, cell: &Cell, offset: f64) -> ([f64; UNMODELLED], Point2<f64>, Vector2<f64>) {
        let p = map_point(&self.pose, &(cell.centre + offset * cell.normal));
        // A step of the image along n moves the body point by as much along the normal of the cell.
        let n = self.of_normals * cell.normal;
        let along = n.dot(&p.coords);
        // A row is seen later the further down it is; the outline has moved on meanwhile.
        let g = &self.generator;
        let velocity = Vector2::new(g.m11 * p.x + g.m12 * p.y + g.m13, g.m21 * p.x + g.m22 * p.y + g.m23);
        let square = p.coords.norm_squared();
        let mut all = [
            self.elapsed * n.dot(&(p - self.centroid)),
            n.x * p.x - n.y * p.y,
            n.x * p.y + n.y * p.x,
            p.x * along,
            p.y * along,
            p.y * (n.x * velocity.x + n.y * velocity.y),
            square * along,
            2.0 * p.x * along + square * n.x,
            2.0 * p.y * along + square * n.y,
        ];
        for (displacement, is_had) in all.iter_mut().zip(self.is_had) {
            *displacement = if is_had { 0.0 } else { *displacement };
        }
        (all, p, n)
    }
}
