//! Tests of likelihoods of poses.
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

use super::likelihood::{NegativeLogLikelihood, Sums};
use crate::tuning::likelihood as tuning;

#[test]
fn points_where_nothing_is_known_speak_against_a_pose_but_never_rule_it_out() {
    for points in [40_u32, 400, 4000] {
        let with_unknown = |unknown: u32| {
            let innovations: Vec<_> = (0..points).map(|i| (i >= unknown).then_some(1.0)).collect();
            Sums::of(&innovations, 1.0).likelihood(1.0)
        };
        let [none, few, most, all] = [0, 1, points / 2, points].map(with_unknown);
        assert!(none.all() < few.all() && few.all() < most.all() && most.all() <= all.all(), "{points}");
        assert!(
            !all.is_worse_than(&none) && all.is_worse_by(0.9 * tuning::MOST_AGAINST * tuning::SIGNIFICANT, &none),
            "{points}"
        );
        // Outliers in their place do.
        let off: Vec<_> = (0..points).map(|i| Some(if i < points / 2 { 9.0 } else { 1.0 })).collect();
        let off = Sums::of(&off, 1.0).likelihood(1.0);
        assert!(off.is_worse_than(&none), "{points}");
    }
}

#[test]
fn the_variance_of_a_difference_of_squares_is_that_of_points_that_share_half_their_noise() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let (points, runs) = (50, 2000);
    let (mut sum, mut worse) = (0.0, 0);
    for _ in 0..runs {
        let mut poses = [NegativeLogLikelihood::of_squares(0.0, f64::from(points)); 2];
        for _ in 0..points {
            let shared = normal();
            poses.iter_mut().for_each(|pose| pose.squares += 0.5 * (shared + normal()).powi(2));
        }
        sum += (poses[0].squares - poses[1].squares).powi(2);
        worse += usize::from(poses[0].is_worse_than(&poses[1]));
    }
    let variance = sum / f64::from(runs * points);
    assert!((variance / tuning::VARIANCE - 1.0).abs() < 0.1, "{variance}");
    assert_eq!(worse, 0);
}
