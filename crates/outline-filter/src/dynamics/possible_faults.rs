//! What frames may leave out that neither show nor rule it out.
use nalgebra::{DMatrix, DVector};

use crate::tuning::{family as tuning, steady_change::LARGEST_LOGARITHM};

/// Second moments of the sizes of motions that pictures have now and then, together, by information and score of the frames. Where there are any they are
/// of a usual size, or of some times that, which is as much rarer; `most` times is the largest there is. The frames say how probable each is, and how
/// large they are then (R. E. Kass and A. E. Raftery, Bayes factors, 1995). `None` where numbers do not allow it.
pub(super) fn moments_of_possible(
    information: &DMatrix<f64>,
    score: &DVector<f64>,
    (usual, most): (f64, f64),
) -> Option<DMatrix<f64>> {
    let count = score.len();
    let mut odds_in_all = tuning::ODDS_AGAINST;
    let mut moments = DMatrix::zeros(count, count);
    for (times, share) in tuning::SIZES.into_iter().filter(|(times, _)| *times <= most) {
        let size = usual * times;
        // In units of the size, in which the prior has a variance of 1.
        let precision = information * (size * size) + DMatrix::identity(count, count);
        let covariance = precision.cholesky()?.inverse();
        let mean = &covariance * score * size;
        let for_them = covariance.determinant().ln() + size * score.dot(&mean);
        let odds = share * (0.5 * for_them).min(LARGEST_LOGARITHM).exp();
        odds_in_all += odds;
        moments += (covariance + &mean * mean.transpose()) * (odds * size * size);
    }
    Some(moments / odds_in_all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The root mean square size, in usual ones, of a motion that frames say to be so many usual ones with so many deviations from none.
    fn size_of(asked: f64, deviations: f64, most: f64) -> f64 {
        const USUAL: f64 = 0.005;
        let information = (deviations / (asked * USUAL)).powi(2);
        let (information, score) =
            (DMatrix::repeat(1, 1, information), DVector::repeat(1, information * asked * USUAL));
        moments_of_possible(&information, &score, (USUAL, most)).expect("numbers")[(0, 0)].sqrt() / USUAL
    }

    #[test]
    fn a_fault_many_times_the_usual_one_is_reckoned_with_as_large_as_frames_show_it() {
        for asked in [1.5, 4.0, 12.0] {
            assert!((0.8..1.1).contains(&(size_of(asked, 5.0, 100.0) / asked)), "{asked}");
        }
        // Little is left of what frames that tell well do not show.
        assert!(size_of(0.01, 0.1, 100.0) < 0.1);
    }

    #[test]
    fn frames_that_tell_nothing_leave_what_pictures_have_now_and_then() {
        let shares = tuning::SIZES.map(|(times, share)| share * times * times);
        assert!((size_of(1.0, 1e-6, 100.0).powi(2) - 0.1 * shares.iter().sum::<f64>()).abs() < 1e-9);
        assert!(size_of(1.0, 1e-6, 4.0) < 0.6 * size_of(1.0, 1e-6, 100.0));
    }
}
