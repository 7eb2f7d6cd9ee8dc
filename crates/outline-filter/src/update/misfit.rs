//! What a frame says of motions that the model leaves out: growth, stretch, skew, perspective, a rolling shutter. Score tests of what is left out (C. R. Rao,
//! Large sample tests of statistical hypotheses, 1948).
use freeform_riccati::{MAX_PARAMETERS, MotionModel, map_point};
use nalgebra::{Matrix3, Point2, SMatrix, SVector};

use crate::{
    belief::Belief,
    measurement::{Frame, NO_CELL},
    tuning::family as tuning,
};

/// Motions that may be left out: growth, stretch, skew, two of perspective, and that of rows which are read one after the other.
pub(crate) const LEFT_OUT: usize = 6;

type LeftOutVector = SVector<f64, LEFT_OUT>;

/// The part of a frame's residuals in each motion that the model leaves out, pose and outline taken off.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Misfit {
    /// In standard deviations; 0 for motions that the model has.
    pub(crate) standardised: LeftOutVector,
    /// Displacement of the outline that it stands for, root mean square, normalised.
    pub(crate) displacement: LeftOutVector,
}

/// Which of them a model has.
fn has(model: MotionModel) -> [bool; LEFT_OUT] {
    let (growth, shear, perspective) =
        (model != MotionModel::Rigid, model >= MotionModel::Affine, model >= MotionModel::Projective);
    // The slant of a rolling shutter is a shear.
    [growth, shear, shear, perspective, perspective, shear]
}

/// Entries of the equations: those of the pose, and behind them those of what is left out.
const ENTRIES: usize = MAX_PARAMETERS + LEFT_OUT;

/// Of a solved frame that has not been taken yet: `frame.cells` have the information with it, those of the belief without. `pose` is that
/// of the frame, `middle` that of the object in the body frame.
pub(crate) fn misfit(
    belief: &Belief,
    frame: &Frame,
    (pose, middle): (&Matrix3<f64>, &Point2<f64>),
    sigma: f64,
) -> Option<Misfit> {
    let (model, k) = (belief.model, belief.parameter_count());
    let is_had = has(model);
    if is_had.iter().all(|had| *had) || pose.fixed_view::<2, 2>(0, 0).determinant() <= 0.0 {
        return None;
    }
    let (centre, scale) = (map_point(pose, middle), 1.0 / belief.scale());
    let generator = model.generator(&belief.motion[..k]);
    let mut gram = SMatrix::<f64, ENTRIES, ENTRIES>::zeros();
    let mut right = SVector::<f64, ENTRIES>::zeros();
    let mut total = 0.0;
    for (m, p) in frame.measurements.iter().zip(&frame.points) {
        if m.cell == NO_CELL || m.weight <= 0.0 || m.cell >= belief.information.cells.len() {
            continue;
        }
        let (known, with) = (belief.information.cells[m.cell].own, frame.cells[m.cell].own);
        if known <= 0.0 {
            continue;
        }
        // What the cell was known to before: points of one cell share its error.
        let weight = m.weight * known / with;
        let residual = m.residual + m.by_offset * frame.shifts[m.cell];
        let (nx, ny) = (m.jacobian[k - 2], m.jacobian[k - 1]);
        let d = (p - centre) * scale;
        let along = nx * d.x + ny * d.y;
        let mut row = SVector::<f64, ENTRIES>::zeros();
        (0..k).for_each(|i| row[i] = m.jacobian[i]);
        // A row is seen later the further it is from that of the middle; the outline has moved on meanwhile.
        let velocity = generator * p.to_homogeneous();
        let meanwhile = d.y * (nx * velocity.x + ny * velocity.y);
        let left_out = [along, nx * d.x - ny * d.y, nx * d.y + ny * d.x, d.x * along, d.y * along, meanwhile];
        for (i, value) in left_out.into_iter().enumerate() {
            row[MAX_PARAMETERS + i] = if is_had[i] { 0.0 } else { value };
        }
        for i in 0..ENTRIES {
            let factor = weight * row[i];
            if factor != 0.0 {
                right[i] += factor * residual;
                (0..=i).for_each(|j| gram[(i, j)] += factor * row[j]);
            }
        }
        total += weight;
    }
    let of_pose = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::from_fn(|i, j| {
        if i < k && j < k { gram[(i.max(j), i.min(j))] } else { f64::from(u8::from(i == j)) }
    });
    let jitter = (0..k).map(|i| of_pose[(i, i)]).fold(0.0, f64::max) * tuning::SINGULAR;
    let factor = (of_pose + SMatrix::identity() * jitter).cholesky()?;
    let mut found = Misfit { standardised: LeftOutVector::zeros(), displacement: LeftOutVector::zeros() };
    for i in (0..LEFT_OUT).filter(|i| !is_had[*i]) {
        let cross =
            SVector::<f64, MAX_PARAMETERS>::from_fn(|j, _| if j < k { gram[(MAX_PARAMETERS + i, j)] } else { 0.0 });
        let explained = factor.solve(&cross);
        let own = gram[(MAX_PARAMETERS + i, MAX_PARAMETERS + i)];
        let left = own - cross.dot(&explained);
        // Of a motion that is the same as one of the model's on this outline nothing can be told.
        if left > tuning::TOLD_APART * own && left > 0.0 {
            let score = right[MAX_PARAMETERS + i] - (0..k).map(|j| explained[j] * right[j]).sum::<f64>();
            found.standardised[i] = score / (left.sqrt() * sigma);
            found.displacement[i] = score / (left * total).sqrt();
        }
    }
    (total > 0.0 && found.standardised.iter().all(|e| e.is_finite())).then_some(found)
}
