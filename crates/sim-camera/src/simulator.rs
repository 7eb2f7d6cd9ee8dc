use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_riccati::{ProjectiveMotion, is_affine};
use nalgebra::{Affine2, Matrix2, Point2, Projective2, Rotation2, Translation2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::{
    corruption::{HiddenArc, add_noise, add_outliers},
    error::SimulationError,
    sampling::Stretch,
    scene::Scene,
    settings::Settings,
    shape::Shape,
    shapes::BuiltInShape,
};

/// One frame of a sequence.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Frame {
    /// Number of the frame, from 0; dropped frames leave gaps.
    pub index: usize,
    /// Time in seconds, `index / fps`.
    pub time: f64,
    /// What is seen of the contour. A hidden arc makes it an open outline of one arc.
    pub outline: Outline,
    /// What was done to the frame.
    pub corruption: Corruption,
}

/// What was done to a frame, for judging an estimator; not for its eyes.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Corruption {
    /// The object shown instead of the true one.
    pub wrong_shape: Option<BuiltInShape>,
    /// The arc out of view.
    pub hidden: Option<HiddenArc>,
    /// Positions of the outliers among the outline's points, increasing.
    pub outliers: Vec<usize>,
}

/// Makes the frames of a scene.
///
/// Frame k depends on the scene, the settings and k alone: it has its own streams of random numbers, one for each purpose,
/// so that a change of the noise, say, leaves the sampling of every frame as it was.
#[derive(Debug, Clone)]
pub struct Simulator {
    scene: Scene,
    settings: Settings,
    poses: Vec<Projective2<f64>>,
    other_shapes: Vec<(BuiltInShape, Shape)>,
}

/// What a stream of random numbers is for.
#[derive(Debug, Clone, Copy)]
enum Purpose {
    Drop,
    WrongShape,
    Occlusion,
    Sampling,
    Noise,
    Outliers,
}

/// Streams reserved for each frame, at least the number of purposes.
const STREAMS_PER_FRAME: u64 = 8;

impl Simulator {
    /// Checks the settings and the whole motion.
    ///
    /// # Errors
    /// As [`Settings::frame_count`]; as [`Motion::try_flow`](crate::Motion::try_flow); or the object's pose in some frame
    /// is too large, too small, too flat or too far off.
    pub fn new(scene: Scene, settings: Settings) -> Result<Self, SimulationError> {
        let count = settings.frame_count()?;
        let time = |k: usize| k as f64 / settings.fps;
        let mut poses = vec![scene.true_pose(0.0)];
        for k in 1..count {
            let flow = scene.motion().try_flow(time(k - 1), time(k))?;
            poses.push(scene.camera().image_map(&flow) * poses[k - 1]);
        }
        if let Some(k) = poses.iter().position(|pose| !can_be_pictured(pose, scene.shape())) {
            return Err(SimulationError::PoseOutOfRange { time: time(k) });
        }
        let mut other_shapes = Vec::new();
        if settings.wrong_frames > 0.0 {
            let others = BuiltInShape::FIGURE_1.into_iter().filter(|shape| shape.name() != scene.shape().name());
            other_shapes.extend(others.map(|shape| (shape, shape.shape())));
        }
        Ok(Self { scene, settings, poses, other_shapes })
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Number of frames, dropped ones included.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.poses.len()
    }

    /// The map from the body frame to the image at a time in seconds, not negative.
    #[must_use]
    pub fn true_pose(&self, time: f64) -> Projective2<f64> {
        self.scene.true_pose(time)
    }

    /// The motion in the image at time 0, which is the motion at all times if it is constant.
    #[must_use]
    pub fn image_motion(&self) -> ProjectiveMotion {
        self.scene.image_motion(0.0)
    }

    /// The frames in order, without the dropped ones.
    pub fn frames(&self) -> Frames<'_> {
        Frames { simulator: self, next: 0 }
    }

    /// Frame `index`, counted from 0. None if it is dropped or beyond the end, or if its few points happen to lie on one
    /// line and so are no outline.
    #[must_use]
    pub fn frame(&self, index: usize) -> Option<Frame> {
        let pose = self.poses.get(index)?;
        if self.stream(index, Purpose::Drop).random::<f64>() < self.settings.dropped_frames {
            return None;
        }
        let (wrong_shape, body) = self.body_shown(index);
        let hidden = self.settings.occlusion.draw(index, &mut self.stream(index, Purpose::Occlusion));
        let mut sampling = self.stream(index, Purpose::Sampling);
        let whole = Stretch { start: sampling.random(), length: 1.0 };
        let (count, stretch) = match hidden {
            Some(arc) => (self.settings.visible_points(), arc.rest()),
            None => (self.settings.points, whole),
        };
        let places = self.settings.sampling.places(count, stretch, &mut sampling);
        let (shape, turn) = body;
        let mut points: Vec<Point2<f64>> = places.iter().map(|s| pose * (turn * shape.point_at(*s))).collect();
        add_noise(&mut points, self.settings.noise, &mut self.stream(index, Purpose::Noise));
        let Settings { outliers, outlier_radius, .. } = self.settings;
        let outliers = add_outliers(&mut points, outliers, outlier_radius, &mut self.stream(index, Purpose::Outliers));
        let outline = match hidden {
            Some(_) => Outline::Open(OpenOutline::new(vec![OpenArc::new(points).ok()?]).ok()?),
            None => Outline::closed(points).ok()?,
        };
        let time = index as f64 / self.settings.fps;
        Some(Frame { index, time, outline, corruption: Corruption { wrong_shape, hidden, outliers } })
    }

    /// The shape that a frame shows, and its place in the body frame.
    fn body_shown(&self, index: usize) -> (Option<BuiltInShape>, (&Shape, Affine2<f64>)) {
        let mut rng = self.stream(index, Purpose::WrongShape);
        let truth = self.scene.shape();
        if self.other_shapes.is_empty() || rng.random::<f64>() >= self.settings.wrong_frames {
            return (None, (truth, Affine2::identity()));
        }
        let (name, shape) = &self.other_shapes[rng.random_range(0..self.other_shapes.len())];
        let turn = Rotation2::new(rng.random_range(0.0..std::f64::consts::TAU));
        let place = Translation2::from(truth.centroid()) * turn;
        let scaled = nalgebra::Similarity2::from_isometry(nalgebra::convert(place), truth.diameter());
        (Some(*name), (shape, nalgebra::convert(scaled)))
    }

    fn stream(&self, frame: usize, purpose: Purpose) -> ChaCha8Rng {
        let mut rng = ChaCha8Rng::seed_from_u64(self.settings.seed);
        rng.set_stream(STREAMS_PER_FRAME * frame as u64 + purpose as u64);
        rng
    }
}

impl<'a> IntoIterator for &'a Simulator {
    type Item = Frame;
    type IntoIter = Frames<'a>;

    fn into_iter(self) -> Frames<'a> {
        self.frames()
    }
}

/// Iterator over the frames of a [`Simulator`], dropped ones left out.
#[derive(Debug, Clone)]
pub struct Frames<'a> {
    simulator: &'a Simulator,
    next: usize,
}

impl Iterator for Frames<'_> {
    type Item = Frame;

    fn next(&mut self) -> Option<Frame> {
        while self.next < self.simulator.frame_count() {
            self.next += 1;
            if let Some(frame) = self.simulator.frame(self.next - 1) {
                return Some(frame);
            }
        }
        None
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (0, Some(self.simulator.frame_count() - self.next))
    }
}

/// Whether every outline in this pose can be told from a point, from a line and from its distance to the origin, and no part of
/// the object comes near the line that the pose moves to infinity.
fn can_be_pictured(pose: &Projective2<f64>, shape: &Shape) -> bool {
    const RANGE: std::ops::Range<f64> = 1e-50..1e50;
    /// Places of the outline that are looked at.
    const PLACES: usize = 64;
    /// Largest ratio of the magnifications, square roots of areas, of two parts of the object.
    const MAGNIFICATION: f64 = 100.0;
    let matrix = pose.matrix();
    if matrix.iter().any(|value| !value.is_finite()) {
        return false;
    }
    if !is_affine(matrix) {
        let depths = shape.sample(PLACES, 0.0).into_iter().map(|p| (matrix * p.to_homogeneous()).z);
        let (least, most) = depths.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), w| (a.min(w), b.max(w)));
        // Areas are magnified by the third power of 1/w.
        if !(least > 0.0 && (most / least).powf(1.5) < MAGNIFICATION) {
            return false;
        }
    }
    // The affine map that is nearest about the middle of the object.
    let centre = matrix * shape.centroid().to_homogeneous();
    let image = centre.xy() / centre.z;
    let by_row = |row: usize, column: usize| (matrix[(row, column)] - image[row] * matrix[(2, column)]) / centre.z;
    let linear = Matrix2::from_fn(by_row);
    let size = linear.norm();
    let distance = image.norm();
    let flatness = (linear[(0, 0)] / size * linear[(1, 1)] - linear[(0, 1)] / size * linear[(1, 0)]) / size;
    RANGE.contains(&size) && distance < 1e10 * size && flatness.abs() > 1e-6
}
