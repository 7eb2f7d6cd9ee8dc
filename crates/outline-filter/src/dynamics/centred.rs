//! Coordinates about the object's centroid: the rates, and the velocity of the centroid.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterKind, ParameterVector, map_point};
use nalgebra::{Matrix2, Matrix3, Point2, SMatrix, SVector, Vector2};

use crate::{
    belief::StateMatrix,
    prediction::{adjoint_matrix, centred_change},
    vectors::vectorised,
};

/// Most parameters of a model that dynamics are told for, those of projective motion.
pub(crate) const LARGEST: usize = MAX_PARAMETERS;

pub(crate) type CentredVector = SVector<f64, LARGEST>;
pub(crate) type CentredMatrix = SMatrix<f64, LARGEST, LARGEST>;

/// One entry for each parameter of any model, projective motion included.
pub(crate) type CentredDeviations = SVector<f64, MAX_PARAMETERS>;

/// A pose with the object's centroid in it, which centred coordinates are taken about.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct CentredPose {
    /// Body to image, normalised.
    pub(crate) pose: Matrix3<f64>,
    /// Of the object, in the body frame.
    pub(crate) centroid: Point2<f64>,
}

impl CentredPose {
    /// The centroid in the image.
    pub(crate) fn centre(&self) -> Point2<f64> {
        map_point(&self.pose, &self.centroid)
    }

    pub(crate) fn linear(&self) -> Matrix2<f64> {
        self.pose.fixed_view::<2, 2>(0, 0).into_owned()
    }

    /// The pose with the centroid for origin, in the body and in the image: its linear part, and for a projective one its perspective.
    pub(super) fn local(&self, model: MotionModel) -> Matrix3<f64> {
        if model != MotionModel::Projective {
            return as_map(&self.linear());
        }
        let (centre, centroid) = (self.centre(), self.centroid);
        let mut local = moved_by(-centre.x, -centre.y) * self.pose * moved_by(centroid.x, centroid.y);
        local /= local[(2, 2)];
        // By rounding alone they are not.
        (local[(0, 2)], local[(1, 2)]) = (0.0, 0.0);
        local
    }

    /// Parameters about the image origin, in the order of the model, by those about the centroid, in [that of centred
    /// coordinates](centred_order).
    pub(crate) fn about_origin(self, model: MotionModel) -> Option<SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>> {
        let (change, order) = (centred_change(model, &self.pose, &self.centroid)?, centred_order(model));
        Some(SMatrix::from_fn(|i, j| change[(i, order[j])]))
    }

    /// Parameters about the centroid by those about the image origin, in the same orders.
    pub(crate) fn about_centroid(self, model: MotionModel) -> SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS> {
        let (centre, order) = (self.centre(), centred_order(model));
        let change = adjoint_matrix(model, &moved_by(-centre.x, -centre.y), &moved_by(centre.x, centre.y));
        SMatrix::from_fn(|i, j| change[(order[i], j)])
    }
}

/// The order of centred coordinates, as numbers of the parameters of a model: the velocity comes last. In the models it does but for
/// projective motion, whose perspective comes behind it.
pub(crate) fn centred_order(model: MotionModel) -> &'static [usize; MAX_PARAMETERS] {
    match model {
        MotionModel::Rigid | MotionModel::Similarity | MotionModel::Affine => &[0, 1, 2, 3, 4, 5, 6, 7],
        MotionModel::Projective => &[0, 1, 2, 3, 6, 7, 4, 5],
    }
}

/// Where the velocity of the centroid is in [that order](centred_order).
pub(crate) fn centred_velocity(model: MotionModel) -> impl Iterator<Item = usize> {
    let kinds = model.parameter_kinds();
    let order = centred_order(model).iter().enumerate();
    order.filter(|(_, j)| kinds.get(**j) == Some(&ParameterKind::Velocity)).map(|(i, _)| i)
}

/// The generator about the centroid of parameters in the order of centred coordinates.
pub(super) fn centred_generator(model: MotionModel, parameters: &[f64]) -> Matrix3<f64> {
    match (model, parameters) {
        (MotionModel::Projective, [a1, a2, a3, a4, c1, c2, b1, b2]) => {
            Matrix3::new(*a1, *a2, *b1, *a3, *a4, *b2, *c1, *c2, 0.0)
        }
        _ => model.generator(parameters),
    }
}

/// What errors of the rates make of a velocity that they turn a lever into: by columns, the velocity of the lever by a unit of each.
pub(super) fn by_rates(model: MotionModel, lever: &Vector2<f64>) -> impl Iterator<Item = Vector2<f64>> {
    let (basis, order) = (model.basis(), centred_order(model));
    let count = model.parameter_count() - 2;
    order.iter().take(count).map(move |of_model| parts(&basis[*of_model]).0 * lever)
}

/// A shift of the plane.
pub(super) fn moved_by(x: f64, y: f64) -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, x, 0.0, 1.0, y, 0.0, 0.0, 1.0)
}

/// Pose and motion with their joint covariance at one time, normalised: what is believed, whichever the dynamics.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Summary {
    /// Body to image.
    pub(crate) pose: Matrix3<f64>,
    pub(crate) motion: ParameterVector,
    /// Of the error of the pose, on the left, and of the motion; what lies beyond their entries says nothing.
    pub(crate) covariance: StateMatrix,
}

impl Summary {
    /// This covariance with the errors about the centroid multiplied by factors, one per parameter, those of pose and motion alike, and with
    /// deviations about the centroid added.
    pub(crate) fn widened(
        &self,
        model: MotionModel,
        centroid: &Point2<f64>,
        factors: &CentredDeviations,
        added: [&CentredDeviations; 2],
    ) -> Option<Self> {
        let k = model.parameter_count();
        let at = CentredPose { pose: self.pose, centroid: *centroid };
        let (to, from) = (at.about_origin(model)?, at.about_centroid(model));
        let mut centred = carried(&of_both(&from, k), &self.covariance, 2 * k);
        for i in 0..2 * k {
            for j in 0..2 * k {
                centred[(i, j)] *= factors[i % k] * factors[j % k];
            }
            centred[(i, i)] += added[i / k][i % k].powi(2);
        }
        Some(Self { covariance: carried(&of_both(&to, k), &centred, 2 * k), ..*self })
    }

    /// How fast an outline of unit radius about the centroid moves, root mean square, as far as it is an affine motion.
    pub(crate) fn speed(&self, model: MotionModel, centroid: &Point2<f64>) -> f64 {
        let at = CentredPose { pose: self.pose, centroid: *centroid };
        let motion = at.about_centroid(model) * SVector::<f64, MAX_PARAMETERS>::from(self.motion);
        let (rates, velocity) = parts(&centred_generator(model, &motion.as_slice()[..model.parameter_count()]));
        (0.5 * rates.norm_squared() + velocity.norm_squared()).sqrt()
    }

    /// Motion and covariance about the centroid, by the change of k parameters that leads there. The pose is where errors are counted from.
    pub(super) fn about_centroid<const N: usize>(
        &self,
        change: &SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>,
        k: usize,
    ) -> (SVector<f64, N>, SMatrix<f64, N, N>) {
        let motion = change * SVector::<f64, MAX_PARAMETERS>::from(self.motion);
        let mut mean = SVector::zeros();
        (0..k).for_each(|j| mean[k + j] = motion[j]);
        let moved = carried(&of_both(change, k), &self.covariance, 2 * k);
        let covariance = SMatrix::from_fn(|i, j| if i < 2 * k && j < 2 * k { moved[(i, j)] } else { 0.0 });
        (mean, covariance)
    }
}

/// A change of k parameters as one of the errors of pose and motion.
pub(super) fn of_both(change: &SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>, k: usize) -> StateMatrix {
    let mut both = StateMatrix::zeros();
    for j in 0..k {
        for i in 0..k {
            both[(i, j)] = change[(i, j)];
            both[(k + i, k + j)] = change[(i, j)];
        }
    }
    both
}

/// `F P F'` of a symmetric P over the first `n` entries, one, two or three for each parameter. F and P have none beyond them.
pub(super) fn carried<const N: usize>(f: &SMatrix<f64, N, N>, p: &SMatrix<f64, N, N>, n: usize) -> SMatrix<f64, N, N> {
    let mut carried = *p;
    carry(f, &mut carried, n);
    carried
}

/// As [`carried`], in the place of P.
pub(super) fn carry<const N: usize>(f: &SMatrix<f64, N, N>, p: &mut SMatrix<f64, N, N>, n: usize) {
    vectorised(
        #[inline(always)]
        || match n {
            3 => carry_sized::<N, 3>(f, p),
            4 => carry_sized::<N, 4>(f, p),
            6 => carry_sized::<N, 6>(f, p),
            8 => carry_sized::<N, 8>(f, p),
            9 => carry_sized::<N, 9>(f, p),
            12 => carry_sized::<N, 12>(f, p),
            16 => carry_sized::<N, 16>(f, p),
            _ => carry_sized::<N, N>(f, p),
        },
    );
}

#[inline(always)]
fn carry_sized<const N: usize, const S: usize>(f: &SMatrix<f64, N, N>, p: &mut SMatrix<f64, N, N>) {
    const { assert!(S <= u64::BITS as usize) };
    // Most entries of a transition are zero: of each row, a bit for every one that is not.
    let mut rows = [0_u64; S];
    for (l, column) in f.data.0.iter().enumerate().take(S) {
        for (row, entry) in rows.iter_mut().zip(column) {
            *row |= u64::from(*entry != 0.0) << l;
        }
    }
    // `P F'` by columns, and then `F (P F')` by rows, which are its columns as well.
    let mut right = [[0.0; S]; S];
    for (i, row) in rows.iter().enumerate() {
        let column = combined::<N, N, S>(f, (i, *row), &p.data.0);
        for (entries, entry) in right.iter_mut().zip(column) {
            entries[i] = entry;
        }
    }
    for (j, row) in rows.iter().enumerate() {
        let column = combined::<N, S, S>(f, (j, *row), &right);
        p.data.0[j][..S].copy_from_slice(&column);
        p.data.0[j][S..].fill(0.0);
    }
    p.data.0[S..].fill([0.0; N]);
}

/// Sum of columns, each by the entry of a row of F; of those that are not zero.
#[inline(always)]
fn combined<const N: usize, const M: usize, const S: usize>(
    f: &SMatrix<f64, N, N>,
    (row, mut entries): (usize, u64),
    columns: &[[f64; M]],
) -> [f64; S] {
    let mut sum = [0.0; S];
    while entries != 0 {
        let l = entries.trailing_zeros() as usize;
        entries &= entries - 1;
        let (factor, column) = (f.data.0[l][row], &columns[l][..S]);
        for i in 0..S {
            sum[i] += factor * column[i];
        }
    }
    sum
}

/// Linear part of a generator and its velocity.
pub(super) fn parts(generator: &Matrix3<f64>) -> (Matrix2<f64>, Vector2<f64>) {
    (generator.fixed_view::<2, 2>(0, 0).into_owned(), generator.fixed_view::<2, 1>(0, 2).into_owned())
}

/// A linear map as a map of the plane.
pub(super) fn as_map(linear: &Matrix2<f64>) -> Matrix3<f64> {
    let mut map = Matrix3::identity();
    map.fixed_view_mut::<2, 2>(0, 0).copy_from(linear);
    map
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_shift_has_velocities_alone_in_centred_coordinates_of_every_model() {
        let at = CentredPose { pose: moved_by(0.3, -0.2), centroid: Point2::new(0.1, 0.4) };
        let (mut shift, velocity) = (Matrix3::zeros(), [0.7, -1.1]);
        (shift[(0, 2)], shift[(1, 2)]) = (velocity[0], velocity[1]);
        for model in MotionModel::ALL {
            let centred = at.about_centroid(model) * CentredVector::from(model.parameters_of(&shift));
            let mut expected = CentredVector::zeros();
            centred_velocity(model).zip(velocity).for_each(|(i, entry)| expected[i] = entry);
            assert!((centred - expected).amax() < 1e-12, "{model:?}: {centred}");
        }
    }

    #[test]
    fn an_outline_that_turns_and_travels_is_as_fast_as_its_points_are_root_mean_square() {
        let (omega, centroid) = (0.7, Point2::new(0.3, -0.1));
        let motion: ParameterVector = [omega, 0.2, -0.4, 0.0, 0.0, 0.0, 0.0, 0.0];
        let summary = Summary { pose: moved_by(1.0, 2.0), motion, covariance: StateMatrix::zeros() };
        let centre = map_point(&summary.pose, &centroid);
        let squares = (0..8).map(|i| {
            let (sine, cosine) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
            let (x, y) = (centre.x + cosine, centre.y + sine);
            (omega * y + 0.2).powi(2) + (-omega * x - 0.4).powi(2)
        });
        let expected = (squares.sum::<f64>() / 8.0).sqrt();
        assert!((summary.speed(MotionModel::Rigid, &centroid) - expected).abs() < 1e-12, "{expected}");
    }

    proptest! {
        #[test]
        fn a_covariance_is_carried_as_by_whole_matrices(
            f in prop::collection::vec(prop::option::of(-2.0_f64..2.0), 81), p in prop::collection::vec(-2.0_f64..2.0, 81),
        ) {
            let f = SMatrix::<f64, 9, 9>::from_fn(|i, j| f[9 * i + j].unwrap_or(0.0));
            let p = SMatrix::<f64, 9, 9>::from_fn(|i, j| p[9 * i + j] + p[9 * j + i]);
            for n in [3, 4, 6, 8, 9] {
                let within = |m: &SMatrix<f64, 9, 9>| SMatrix::<f64, 9, 9>::from_fn(|i, j| if i < n && j < n { m[(i, j)] } else { 0.0 });
                let expected = within(&f) * within(&p) * within(&f).transpose();
                prop_assert!((carried(&f, &p, n) - expected).amax() < 1e-12);
            }
        }
    }
}
