use freeform_riccati::RigidMotion;

use crate::{camera::Camera, error::SimulationError, scene::Scene, shapes::BuiltInShape};

/// One of the paper's simulations (section 5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperExperiment {
    /// What the paper calls it.
    pub title: &'static str,
    /// The object.
    pub shape: BuiltInShape,
    /// Its motion in space: rad/s and space lengths per second.
    pub motion: RigidMotion,
}

impl PaperExperiment {
    /// Standard deviation of the noise on image points (section 5).
    pub const NOISE: f64 = 0.005;

    /// The scale `f/Z0`. The paper does not give it; this is this project's choice.
    pub const SCALE: f64 = 0.1;

    /// Flight bird, figures 3 and 4.
    pub const FLIGHT_BIRD: Self = Self {
        title: "flight bird",
        shape: BuiltInShape::Bird,
        motion: RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -3.0, b2: 4.0 },
    };

    /// Glider as the text of section 5 gives its motion.
    pub const GLIDER_OF_TEXT: Self = Self {
        title: "glider (text)",
        shape: BuiltInShape::Glider,
        motion: RigidMotion { omega: -std::f64::consts::FRAC_PI_3, b1: 0.0, b2: 4.0 },
    };

    /// Glider as the caption of figure 6 gives its motion.
    pub const GLIDER_OF_CAPTION: Self = Self {
        title: "glider (caption of figure 6)",
        shape: BuiltInShape::Glider,
        motion: RigidMotion { omega: -std::f64::consts::FRAC_PI_3, b1: 4.0, b2: 0.0 },
    };

    /// Cellular phone, figures 7 and 8.
    pub const CELLULAR_PHONE: Self = Self {
        title: "cellular phone",
        shape: BuiltInShape::Phone,
        motion: RigidMotion { omega: -2.0, b1: 4.0, b2: 0.0 },
    };

    /// All of them in the paper's order.
    pub const ALL: [Self; 4] = [Self::FLIGHT_BIRD, Self::GLIDER_OF_TEXT, Self::GLIDER_OF_CAPTION, Self::CELLULAR_PHONE];

    /// The scene of the experiment: a unit-size object that starts at the image origin.
    ///
    /// # Errors
    /// The scale `f/Z0` is not a positive finite number.
    pub fn scene(&self, scale: f64) -> Result<Scene, SimulationError> {
        Ok(Scene::new(self.shape, self.motion, Camera::new(scale)?))
    }
}
