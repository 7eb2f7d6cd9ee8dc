//! What the corrections of an outline do to the poses that are measured against it.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{Matrix3, SMatrix, SVector};

use crate::{belief::CellInformation, map::OutlineMap, tuning::update as tuning};

/// The error of a pose, on the left, that later frames will find beside that of the frames before, because a frame has moved the outline by
/// shifts of its offsets: the motion of the model that is nearest to them, by least squares with the information on each offset, taken back.
/// None in directions that the outline does not show.
pub(crate) fn outline_shift(
    map: &OutlineMap,
    model: freeform_riccati::MotionModel,
    pose: &Matrix3<f64>,
    (shifts, cells): (&[f64], &[CellInformation]),
) -> Option<SVector<f64, MAX_PARAMETERS>> {
    let k = model.parameter_count();
    let mut gram = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::zeros();
    let mut right = SVector::<f64, MAX_PARAMETERS>::zeros();
    for ((cell, shift), CellInformation { own, .. }) in map.cells().iter().zip(shifts).zip(cells) {
        if *shift == 0.0 {
            continue;
        }
        let row = model.normal_velocities(&cell.centre, &cell.normal);
        for i in 0..k {
            let weighted = own * row[i];
            right[i] += weighted * shift;
            (0..=i).for_each(|j| gram[(i, j)] += weighted * row[j]);
        }
    }
    let largest = (0..k).map(|i| gram[(i, i)]).fold(0.0, f64::max);
    for i in 0..MAX_PARAMETERS {
        gram[(i, i)] += if i < k { tuning::SINGULAR * largest } else { 1.0 };
    }
    let moved = gram.cholesky()?.solve(&right);
    let adjoint = model.adjoint(pose, &pose.try_inverse()?);
    let error = SVector::<f64, MAX_PARAMETERS>::from_fn(|i, _| -(0..k).map(|j| adjoint[i][j] * moved[j]).sum::<f64>());
    error.iter().all(|e| e.is_finite()).then_some(error)
}
