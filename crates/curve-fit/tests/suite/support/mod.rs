//! Outlines that the tests share.
use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use nalgebra::{Affine2, Matrix2, Matrix3, Point2, Vector2};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// A star-shaped outline `r(t) = 1 + sum_k a_k cos(k t) + b_k sin(k t)` seen through noisy points.
pub(crate) fn star(harmonics: &[(f64, f64)], count: usize, noise: f64, seed: u64) -> Vec<Point2<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, noise).expect("a noise level");
    (0..count)
        .map(|i| {
            let t = std::f64::consts::TAU * i as f64 / count as f64;
            let wave = |(k, (a, b)): (usize, &(f64, f64))| {
                let angle = (k + 2) as f64 * t;
                a * angle.cos() + b * angle.sin()
            };
            let r = 1.0 + harmonics.iter().enumerate().map(wave).sum::<f64>();
            Point2::new(r * t.cos() + normal.sample(&mut rng), r * t.sin() + normal.sample(&mut rng))
        })
        .collect()
}

/// Random star-shaped outlines: 150 to 400 points, noise 0.001 to 0.02 of a unit radius.
pub(crate) fn any_star() -> impl Strategy<Value = Vec<Point2<f64>>> {
    let harmonics = prop::collection::vec((-0.15..0.15_f64, -0.15..0.15_f64), 3);
    (harmonics, 150..400_usize, 0.001..0.02_f64, any::<u64>())
        .prop_map(|(h, count, noise, seed)| star(&h, count, noise, seed))
}

/// Random similarities without reflection: any turn, scale 0.1 to 10, shift up to 10.
pub(crate) fn any_similarity() -> impl Strategy<Value = Affine2<f64>> {
    (-3.2..3.2_f64, -1.0..1.0_f64, -10.0..10.0_f64, -10.0..10.0_f64)
        .prop_map(|(turn, scale, x, y)| similarity(turn, 10.0_f64.powf(scale), Vector2::new(x, y)))
}

pub(crate) fn similarity(turn: f64, scale: f64, shift: Vector2<f64>) -> Affine2<f64> {
    affine(nalgebra::Rotation2::new(turn).matrix() * scale, shift)
}

pub(crate) fn affine(linear: Matrix2<f64>, shift: Vector2<f64>) -> Affine2<f64> {
    let mut matrix = Matrix3::identity();
    matrix.fixed_view_mut::<2, 2>(0, 0).copy_from(&linear);
    matrix.fixed_view_mut::<2, 1>(0, 2).copy_from(&shift);
    Affine2::from_matrix_unchecked(matrix)
}

pub(crate) fn closed(points: Vec<Point2<f64>>) -> Outline {
    Outline::closed(points).expect("a closed outline")
}

/// What is seen of a contour, given by its points, with one or two stretches of it hidden.
pub(crate) fn open(points: &[Point2<f64>], visible: &[std::ops::Range<f64>]) -> Outline {
    let index = |share: f64| (share * points.len() as f64) as usize;
    let arcs = visible.iter().map(|part| points[index(part.start)..index(part.end)].to_vec());
    Outline::Open(OpenOutline::new(arcs.map(|arc| OpenArc::new(arc).expect("an arc")).collect()).expect("arcs"))
}

/// A random star-shaped outline whole, as one arc and as two arcs that start anywhere; one half to 95 % are seen.
pub(crate) fn any_visibility() -> impl Strategy<Value = [Outline; 3]> {
    (any_star(), 0.0..1.0_f64, 0.5..0.95_f64, 0.05..0.4_f64).prop_map(|(mut points, start, seen, gap)| {
        let from = (start * points.len() as f64) as usize;
        points.rotate_left(from);
        let hidden = 1.0 - seen;
        let cut = 0.5 * seen;
        let two = [0.0..cut, cut + gap * hidden..seen + gap * hidden];
        [open(&points, &[0.0..seen]), open(&points, &two), closed(points)]
    })
}
