//! Test pictures of moving bodies with the truth: anti-aliased, blurred, shaded, with noise, shadows and holes.
mod body;
mod render;
mod scenes;

use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::error::SimulationError;
use body::Body;
pub use render::Rendering;
pub use scenes::{PictureScene, UnknownScene};

/// Most pictures of a sequence.
const MOST_PICTURES: f64 = 1e6;

/// A sequence of test pictures.
///
/// ```
/// use freeform_sim_camera::{PictureScene, SimulatedPictures};
///
/// let pictures = SimulatedPictures::new(PictureScene::Gear, 7, 30.0, 0.2)?;
/// let last = pictures.iter().last().expect("pictures");
/// assert_eq!((last.index, last.grey.len()), (5, 640 * 480));
/// println!("it turns at {} rad/s", last.bodies[0].omega);
/// # Ok::<(), freeform_sim_camera::SimulationError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SimulatedPictures {
    bodies: Vec<Body>,
    rendering: Rendering,
    seed: u64,
    frames_per_second: f64,
    count: usize,
}

/// One picture, and where the bodies in it are.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedPicture {
    /// Number of the picture, from 0.
    pub index: usize,
    /// Time in seconds.
    pub time: f64,
    /// Grey values row by row from the top.
    pub grey: Vec<u8>,
    /// The bodies, in the same order in every picture.
    pub bodies: Vec<BodyTruth>,
}

/// Where a body is and how it moves, in pixels with y upwards from the lower left corner of the picture. Angles and angular velocities
/// are positive clockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyTruth {
    /// Its middle.
    pub middle: [f64; 2],
    /// Its angle in rad.
    pub angle: f64,
    /// Angular velocity in rad/s; of a disc without marks no picture shows it.
    pub omega: f64,
    /// Velocity of the middle, in pixels per second.
    pub velocity: [f64; 2],
    /// Whether no part of it is beyond the edge of the picture.
    pub is_whole: bool,
    /// Whether some of it is in the picture.
    pub is_seen: bool,
}

impl SimulatedPictures {
    /// The pictures of a scene. The seed decides on sizes, motions, light and noise.
    ///
    /// # Errors
    /// A rate or a length that is not positive and finite, or more than a million pictures.
    pub fn new(scene: PictureScene, seed: u64, frames_per_second: f64, seconds: f64) -> Result<Self, SimulationError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let rendering = scene.rendering(&mut rng);
        let bodies = scene.bodies(&mut rng);
        for (setting, value) in [("frames per second", frames_per_second), ("length of the sequence", seconds)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(SimulationError::OutOfRange { setting, value, range: "positive" });
            }
        }
        let count = (frames_per_second * seconds).round().max(1.0);
        if count > MOST_PICTURES {
            return Err(SimulationError::TooManyFrames { frames: count, limit: MOST_PICTURES as usize });
        }
        Ok(Self { bodies, rendering, seed, frames_per_second, count: count as usize })
    }

    /// With another rendering.
    ///
    /// # Errors
    /// No pixel or more than 2^28, or a number out of its range.
    pub fn with_rendering(self, rendering: Rendering) -> Result<Self, SimulationError> {
        let [width, height] = rendering.size;
        let limit = 1 << 28;
        if width == 0 || height == 0 || width.checked_mul(height).is_none_or(|pixels| pixels > limit) {
            return Err(SimulationError::MaskSize { width, height, limit });
        }
        let Rendering { ground, contrast, blur, shading, noise, shadow, line, exposure, gamma, .. } = rendering;
        for (setting, value, range, [least, most]) in [
            ("ground", ground, "0 to 255", [0.0, 255.0]),
            ("contrast", contrast, "-255 to 255", [-255.0, 255.0]),
            ("blur", blur, "0 to 100 pixels", [0.0, 100.0]),
            ("shading", shading, "-10 to 10", [-10.0, 10.0]),
            ("noise of the pictures", noise, "0 to 255", [0.0, 255.0]),
            ("shadow", shadow, "0 to 1", [0.0, 1.0]),
            ("line", line, "0 to 100 pixels", [0.0, 100.0]),
            ("exposure", exposure, "0 to the time between two pictures", [0.0, self.frames_per_second.recip()]),
            ("gamma", gamma, "0.1 to 10", [0.1, 10.0]),
        ] {
            if !(least..=most).contains(&value) {
                return Err(SimulationError::OutOfRange { setting, value, range });
            }
        }
        Ok(Self { rendering, ..self })
    }

    /// How the pictures are rendered.
    #[must_use]
    pub fn rendering(&self) -> Rendering {
        self.rendering
    }

    /// Number of pictures.
    #[must_use]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is no picture: never.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The pictures one after the other. Each depends on the scene, the seed and its number alone.
    pub fn iter(&self) -> impl Iterator<Item = SimulatedPicture> {
        (0..self.count).map(|index| self.picture(index))
    }

    fn picture(&self, index: usize) -> SimulatedPicture {
        let time = index as f64 / self.frames_per_second;
        let mut noise = ChaCha8Rng::seed_from_u64(self.seed);
        noise.set_stream(index as u64 + 1);
        let grey = self.rendering.picture(&self.bodies, time, &mut noise);
        let bodies = self.bodies.iter().map(|body| self.truth(body, time)).collect();
        SimulatedPicture { index, time, grey, bodies }
    }

    fn truth(&self, body: &Body, time: f64) -> BodyTruth {
        let [width, height] = self.rendering.size.map(|size| size as f64);
        let contours = body.in_picture(time, nalgebra::Vector2::zeros(), height);
        let is_within = |p: &nalgebra::Point2<f64>| (0.0..=width).contains(&p.x) && (0.0..=height).contains(&p.y);
        let boundary = contours.iter().flatten();
        let path = body.path;
        BodyTruth {
            middle: path.middle(time).into(),
            angle: path.angle(time),
            omega: path.omega(time),
            velocity: path.velocity(time).into(),
            is_whole: boundary.clone().all(is_within),
            is_seen: boundary.clone().any(is_within),
        }
    }
}
