//! Shapes, affine maps and outlines as they are seen.
use freeform_curve_fit::Outline;
use freeform_recognise::{RecogniseSettings, Recogniser};
use freeform_sim_camera::BuiltInShape;
use nalgebra::{Affine2, Matrix2, Matrix3, Point2, Rotation2, Vector2};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

/// One of each kind that an affine map does not take to another: an ellipse is a circle, a square a box.
pub(crate) const SHAPES: [BuiltInShape; 13] = [
    BuiltInShape::Plane,
    BuiltInShape::Van,
    BuiltInShape::GlassVase,
    BuiltInShape::CdBox,
    BuiltInShape::Shoe,
    BuiltInShape::Car,
    BuiltInShape::Vase,
    BuiltInShape::Glider,
    BuiltInShape::Phone,
    BuiltInShape::Hat,
    BuiltInShape::Bird,
    BuiltInShape::Boomerang,
    BuiltInShape::Circle,
];

/// A recogniser that has learnt shapes in their order, without noise.
pub(crate) fn recogniser(shapes: &[BuiltInShape]) -> Recogniser {
    let mut recogniser = Recogniser::new(RecogniseSettings::default()).expect("good settings");
    for shape in shapes {
        recogniser.learn(shape.name(), &outline(*shape, 400, 0.0)).expect("a whole outline");
    }
    recogniser
}

/// Evenly spaced points of a shape, the first of them at a fraction of its perimeter.
pub(crate) fn outline(shape: BuiltInShape, count: usize, begin: f64) -> Outline {
    Outline::closed(shape.shape().sample(count, begin)).expect("an outline")
}

/// Each coordinate of each point moved by noise that is uniform, with a standard deviation.
pub(crate) fn noisy(outline: &Outline, deviation: f64, seed: u64) -> Outline {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = || deviation * 12.0_f64.sqrt() * (rng.random::<f64>() - 0.5);
    let points = outline.points().map(|p| p + Vector2::new(uniform(), uniform())).collect();
    Outline::closed(points).expect("an outline")
}

/// Its points in reversed order.
pub(crate) fn reversed(outline: &Outline) -> Outline {
    let mut points: Vec<Point2<f64>> = outline.points().copied().collect();
    points.reverse();
    Outline::closed(points).expect("an outline")
}

/// Stretched and sheared by up to a third, turned by any angle, mirrored or not, of any size from 0.01 to 100, and shifted.
pub(crate) fn any_affine() -> impl Strategy<Value = Affine2<f64>> {
    let linear = prop::array::uniform4(-0.35..0.35_f64);
    (linear, -3.2..3.2_f64, any::<bool>(), -2.0..2.0_f64, prop::array::uniform2(-5.0..5.0_f64)).prop_map(
        |(linear, turn, mirrored, scale, shift)| {
            let mirror = Matrix2::new(if mirrored { -1.0 } else { 1.0 }, 0.0, 0.0, 1.0);
            let stretch = Matrix2::identity() + Matrix2::from_row_slice(&linear);
            let size = 10.0_f64.powf(scale);
            let linear = size * Rotation2::new(turn).matrix() * stretch * mirror;
            let mut matrix = Matrix3::identity();
            matrix.fixed_view_mut::<2, 2>(0, 0).copy_from(&linear);
            matrix.fixed_view_mut::<2, 1>(0, 2).copy_from(&(size * Vector2::from(shift)));
            Affine2::from_matrix_unchecked(matrix)
        },
    )
}
