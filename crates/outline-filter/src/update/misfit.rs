//! What a frame says of motions that the model leaves out: growth, stretch, skew, perspective. Score tests of what is left out (C. R. Rao,
//! Large sample tests of statistical hypotheses, 1948).
use freeform_riccati::MotionModel;
use nalgebra::{SMatrix, SVector};

use crate::{
    belief::Belief,
    dynamics::CentredPose,
    measurement::{Frame, NO_CELL},
};

/// Motions that may be left out: growth, stretch, skew, and two of perspective.
pub(crate) const LEFT_OUT: usize = 5;

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
    [growth, shear, shear, perspective, perspective]
}

/// Of a solved frame that has not been taken yet: `frame.cells` have the information with it, those of the belief without.
pub(crate) fn misfit(belief: &Belief, frame: &Frame, at: &CentredPose, sigma: f64) -> Option<Misfit> {
    type Rows = SVector<f64, 13>;
    let (model, k) = (belief.model, belief.parameter_count());
    let is_had = has(model);
    if is_had.iter().all(|had| *had) || at.linear().determinant() <= 0.0 {
        return None;
    }
    let (centre, scale) = (at.centre(), 1.0 / belief.scale());
    let mut gram = SMatrix::<f64, 13, 13>::zeros();
    let mut right = Rows::zeros();
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
        let mut row = Rows::zeros();
        (0..k).for_each(|i| row[i] = m.jacobian[i]);
        let left_out = [along, nx * d.x - ny * d.y, nx * d.y + ny * d.x, d.x * along, d.y * along];
        for (i, value) in left_out.into_iter().enumerate() {
            row[8 + i] = if is_had[i] { 0.0 } else { value };
        }
        for i in 0..13 {
            let factor = weight * row[i];
            if factor != 0.0 {
                right[i] += factor * residual;
                (0..=i).for_each(|j| gram[(i, j)] += factor * row[j]);
            }
        }
        total += weight;
    }
    let pose = SMatrix::<f64, 8, 8>::from_fn(|i, j| {
        if i < k && j < k { gram[(i.max(j), i.min(j))] } else { f64::from(u8::from(i == j)) }
    });
    let jitter = (0..k).map(|i| pose[(i, i)]).fold(0.0, f64::max) * 1e-9;
    let factor = (pose + SMatrix::<f64, 8, 8>::identity() * jitter).cholesky()?;
    let mut found = Misfit { standardised: LeftOutVector::zeros(), displacement: LeftOutVector::zeros() };
    for i in (0..LEFT_OUT).filter(|i| !is_had[*i]) {
        let cross = SVector::<f64, 8>::from_fn(|j, _| if j < k { gram[(8 + i, j)] } else { 0.0 });
        let explained = factor.solve(&cross);
        let own = gram[(8 + i, 8 + i)];
        let left = own - cross.dot(&explained);
        // Of a motion that is the same as one of the model's on this outline nothing can be told.
        if left > 1e-3 * own && left > 0.0 {
            let of_pose = SVector::<f64, 8>::from_fn(|j, _| if j < k { right[j] } else { 0.0 });
            let score = right[8 + i] - explained.dot(&of_pose);
            found.standardised[i] = score / (left.sqrt() * sigma);
            found.displacement[i] = score / (left * total).sqrt();
        }
    }
    (total > 0.0 && found.standardised.iter().all(|e| e.is_finite())).then_some(found)
}
