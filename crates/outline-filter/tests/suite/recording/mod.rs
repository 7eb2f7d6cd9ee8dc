//! Outlines of a shape in given poses, for any map of the plane.
use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_estimate::{BoundaryPoint, CramerRaoBound};
use freeform_riccati::MotionModel;
use freeform_sim_camera::{BuiltInShape, Shape};
use nalgebra::{Matrix3, Point2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

pub(crate) const NOISE: f64 = 0.005;
pub(crate) const POINTS: usize = 400;
pub(crate) const SECONDS_PER_FRAME: f64 = 1.0 / 30.0;

/// What a camera does to a frame.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Corruption {
    /// Share of the outline that is hidden, one arc anywhere.
    pub(crate) hidden: f64,
    /// Share of the points that lie anywhere within 0.3 of where they should.
    pub(crate) outliers: f64,
}

pub(crate) fn map(pose: &Matrix3<f64>, p: &Point2<f64>) -> Point2<f64> {
    Point2::from_homogeneous(pose * p.to_homogeneous()).expect("a finite point")
}

/// A motion for every model; b in lengths per second.
pub(crate) fn parameters(model: MotionModel) -> Vec<f64> {
    match model {
        MotionModel::Rigid => vec![1.5, -0.3, 0.4],
        MotionModel::Similarity => vec![-0.1, 1.2, -0.3, 0.4],
        MotionModel::Affine => vec![0.05, 1.2, -1.7, -0.08, -0.3, 0.4],
        MotionModel::Projective => vec![0.05, 1.2, -1.7, -0.08, -0.3, 0.4, 0.1, -0.15],
    }
}

pub(crate) fn constant_motion(model: MotionModel, frames: usize) -> Vec<Matrix3<f64>> {
    let theta = parameters(model);
    (0..frames).map(|i| model.flow(&theta, SECONDS_PER_FRAME * i as f64).into_inner()).collect()
}

/// One outline per pose, its points drawn one from each of equal stretches.
pub(crate) fn record(
    shape: BuiltInShape,
    poses: &[Matrix3<f64>],
    corruption: Corruption,
    noise: f64,
    seed: u64,
) -> Vec<(f64, Outline)> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let shape = Shape::from(shape);
    let frames = poses.iter().enumerate().map(|(frame, pose)| {
        let start: f64 = rng.random();
        let count = (POINTS as f64 * (1.0 - corruption.hidden)).round() as usize;
        let points = (0..count).map(|i| {
            let s = start + (1.0 - corruption.hidden) * (i as f64 + rng.random::<f64>()) / count as f64;
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let noise = noise * Vector2::new(normal(), normal());
            let mut p = map(pose, &shape.point_at(s.fract())) + noise;
            if rng.random::<f64>() < corruption.outliers {
                let (radius, angle) = (0.3 * rng.random::<f64>().sqrt(), std::f64::consts::TAU * rng.random::<f64>());
                p += radius * Vector2::new(angle.cos(), angle.sin());
            }
            p
        });
        let points: Vec<_> = points.collect();
        let outline = if corruption.hidden > 0.0 {
            Outline::Open(OpenOutline::new(vec![OpenArc::new(points).expect("an arc")]).expect("one arc"))
        } else {
            Outline::closed(points).expect("an outline")
        };
        (frame as f64 * SECONDS_PER_FRAME, outline)
    });
    frames.collect()
}

/// Standard deviations of the bound, for points that a share of inform.
pub(crate) fn bound(shape: BuiltInShape, model: MotionModel, frames: usize, share: f64) -> Vec<f64> {
    let shape = Shape::from(shape);
    let theta = parameters(model);
    let mut bound = CramerRaoBound::new(model, &theta).expect("a motion");
    for (frame, pose) in constant_motion(model, frames).iter().enumerate() {
        let points = (0..POINTS).map(|i| {
            let s = i as f64 / POINTS as f64;
            let (point, before, after) =
                (map(pose, &shape.point_at(s)), map(pose, &shape.point_at((s + 0.9999).fract())), {
                    map(pose, &shape.point_at((s + 0.0001).fract()))
                });
            let tangent: Vector2<f64> = (after - before).normalize();
            BoundaryPoint { point, normal: Vector2::new(tangent.y, -tangent.x) }
        });
        bound.add_frame(frame as f64 * SECONDS_PER_FRAME, points, NOISE, share).expect("finite");
    }
    bound.covariance().expect("finite").standard_deviations().map(|s| s.expect("observable")).collect()
}

pub(crate) fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// Whether a share of hits out of so many trials, possibly dependent in groups, is compatible with 95 %: within three standard
/// deviations of it.
pub(crate) fn is_near_95_percent(hits: usize, trials: usize, group: usize) -> bool {
    let independent = trials as f64 / group as f64;
    let deviation = (0.95 * 0.05 / independent).sqrt();
    (hits as f64 / trials as f64 - 0.95).abs() < 3.0 * deviation
}
