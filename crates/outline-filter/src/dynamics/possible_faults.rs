//! What frames may leave out that neither show nor rule it out.
use nalgebra::{DMatrix, DVector};

use crate::tuning::family as tuning;

/// Second moments of the sizes of a fault, of one number or of several that go together, by the information and the score of the frames. Most
/// pictures have no such fault; of those that do, most have one of the usual size, and larger ones are rarer. `most` usual sizes is the largest that
/// there is. The frames say how probable each size is, and how large the fault is then (R. E. Kass and A. E. Raftery, Bayes factors, 1995). `None`
/// where numbers do not allow it.
pub(super) fn moments_of_fault(
    information: &DMatrix<f64>,
    score: &DVector<f64>,
    (usual, most): (f64, f64),
) -> Option<DMatrix<f64>> {
    let count = score.len();
    let mut sizes = Vec::with_capacity(tuning::SIZES.len());
    let mut largest = tuning::ODDS_AGAINST.ln();
    for (times, share) in tuning::SIZES.into_iter().filter(|(times, _)| *times <= most) {
        let size = usual * times;
        // In units of the size, in which the prior has a variance of 1.
        let precision = information * (size * size) + DMatrix::identity(count, count);
        let covariance = precision.cholesky()?.inverse();
        let mean = &covariance * score * size;
        let odds = share.ln() + 0.5 * (covariance.determinant().ln() + size * score.dot(&mean));
        largest = largest.max(odds);
        sizes.push((odds, (covariance + &mean * mean.transpose()) * (size * size)));
    }
    // Of logarithms, the largest taken off, so that none is beyond any number.
    let mut odds_in_all = (tuning::ODDS_AGAINST.ln() - largest).exp();
    let mut moments = DMatrix::zeros(count, count);
    for (odds, of_size) in sizes {
        let odds = (odds - largest).exp();
        odds_in_all += odds;
        moments += of_size * odds;
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
        moments_of_fault(&information, &score, (USUAL, most)).expect("numbers")[(0, 0)].sqrt() / USUAL
    }

    #[test]
    fn a_fault_many_times_the_usual_one_is_reckoned_with_as_large_as_frames_show_it() {
        for (asked, deviations) in [(1.5, 5.0), (4.0, 5.0), (12.0, 5.0), (20.0, 60.0)] {
            assert!((0.8..1.1).contains(&(size_of(asked, deviations, 100.0) / asked)), "{asked} {deviations}");
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
