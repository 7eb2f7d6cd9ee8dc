use nalgebra::{Const, DimMin, SMatrix, SVector};

use super::{least_squares_law::LeastSquaresLaw, origin_shift::OriginShift, regressor::Regressor};

/// Rate at which a parameter goes to its value where all are excited alike, per second: that of the paper's slower errors doubled, so that the
/// law settles within some seconds.
const GAIN: f64 = 2.0;

/// Dynamic regressor extension and mixing (Aranovskiy, Bobtsov, Ortega, Pyrkin, Performance enhancement of parameter estimators via dynamic
/// regressor extension and mixing, 2017).
///
/// The extension by Kreisselmeier's filter gives `Omega theta = Y`, the sums of filtered least squares. Mixing by the adjugate gives an
/// equation for each parameter by itself, `Delta theta_i = (adj(Omega) Y)_i` with `Delta = det Omega`, and so a law for each,
///
/// ```text
/// theta_i' = -gamma rho (theta_i - (adj(Omega) Y)_i / Delta),    rho = Delta / (trace(Omega) / N)^N,
/// ```
///
/// in which the excitation is normalised: `rho` is 1 where all parameters are excited alike and 0 where one of them is not at all. Of exact
/// lines no parameter's error ever grows, whatever the others do.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DremLaw<const N: usize> {
    extended: LeastSquaresLaw<N>,
    parameters: SVector<f64, N>,
}

impl<const N: usize> DremLaw<N> {
    /// The sums that are extended by each frame.
    pub(crate) fn sums_mut(&mut self) -> &mut LeastSquaresLaw<N> {
        &mut self.extended
    }
}

impl<const N: usize> DremLaw<N>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    pub(crate) fn new(regressor: Regressor<N>, initial: SVector<f64, N>) -> Self {
        Self { extended: LeastSquaresLaw::without_prior(regressor, initial), parameters: initial }
    }

    pub(crate) fn parameters(&self) -> &SVector<f64, N> {
        &self.parameters
    }

    /// Goes on in other coordinates; `old_from_new` takes the parameters back. The filters move by themselves.
    pub(crate) fn shift_origin(&mut self, shift: &OriginShift, old_from_new: &SMatrix<f64, N, N>) {
        self.extended.shift_origin(shift, old_from_new);
        self.parameters = shift.of_parameters(self.extended.regressor().model()) * self.parameters;
    }

    #[cfg(feature = "serde")]
    pub(crate) fn numbers_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        self.extended.numbers_mut().chain(self.parameters.iter_mut())
    }

    /// Runs the laws of the parameters for `seconds`, the sums being what they are at its end.
    pub(crate) fn adapt(&mut self, seconds: f64) {
        let Some(towards) = self.extended.solution().filter(|found| found.iter().all(|value| value.is_finite())) else {
            return;
        };
        let share = 1.0 - (-GAIN * self.extended.excitation() * seconds).exp();
        self.parameters += share * (towards - self.parameters);
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::{MotionModel, RealVariables, RigidMotion};
    use nalgebra::Vector4;
    use proptest::prelude::*;

    use crate::adaptive::least_squares_law::FilteredPair;

    use super::*;

    proptest! {
        #[test]
        fn of_exact_lines_no_error_of_any_parameter_ever_grows(
            start in prop::array::uniform4(-1.0..1.0_f64),
            motion in prop::array::uniform3(-1.0..1.0_f64),
            initial in prop::array::uniform3(-2.0..2.0_f64),
        ) {
            let truth = RigidMotion { omega: motion[0], b1: motion[1], b2: motion[2] };
            let mut x = Vector4::from(start);
            x[1] = 0.5 + x[1].abs();
            let regressor = Regressor::<3>::new(MotionModel::Rigid);
            let mut law = DremLaw::new(regressor, initial.into());
            let mut filter = FilteredPair::starting_at(&x);
            let (true_values, step) = (SVector::from(motion), 1e-3);
            for i in 0..2000 {
                // The middle of a small step of the lines' own equations.
                let rate = |x: &Vector4<f64>| RealVariables::from(*x).rate(&truth.into());
                let middle = x + 0.5 * step * rate(&x);
                filter.advance(step, &middle, &regressor.at(&middle));
                x += step * rate(&middle);
                if !x.iter().all(|v| v.abs() < 10.0) {
                    break;
                }
                if i % 20 == 19 {
                    let before = (law.parameters() - true_values).abs();
                    law.sums_mut().forget(20.0 * step);
                    law.sums_mut().take(20.0 * step, &filter, &x, 1.0);
                    law.adapt(20.0 * step);
                    let after = (law.parameters() - true_values).abs();
                    prop_assert!((0..3).all(|j| after[j] <= before[j] + 1e-3), "{} to {}", before, after);
                }
            }
        }
    }
}
