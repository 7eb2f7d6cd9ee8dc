use std::f64::consts::TAU;
use std::str::FromStr;

use nalgebra::{Point2, Vector2};
use rand::{Rng, RngExt as _};

use super::body::{Body, Path, disc, egg, gear, letter_l, polygon, star};
use super::render::Rendering;

/// What test pictures show. Sizes and motions follow from the seed, and whether bodies are lighter or darker than the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PictureScene {
    /// A gear of 18 teeth, one of which is filed away, turns and drifts.
    Gear,
    /// A coin tumbles about an axis in the plane while it crosses the picture: no rigid motion in the plane.
    Coin,
    /// Five different objects on a belt come in on one side and leave on the other.
    Belt,
    /// The belt with shadows beside its objects.
    BeltShadow,
    /// Two discs roll without slipping. Nothing shows their turn.
    Discs,
    /// Two discs with two holes each roll without slipping.
    MarkedDiscs,
    /// An L whose spin and travel accelerate.
    AcceleratingL,
    /// An L with the grey value of the ground and a dark line around it.
    Outlined,
}

/// No scene has this name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no scene is called {name:?}; the scenes are {}", PictureScene::ALL.map(PictureScene::name).join(", "))]
pub struct UnknownScene {
    /// The name asked for.
    pub name: String,
}

impl PictureScene {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Gear,
        Self::Coin,
        Self::Belt,
        Self::BeltShadow,
        Self::Discs,
        Self::MarkedDiscs,
        Self::AcceleratingL,
        Self::Outlined,
    ];

    /// Its name, as it is read back.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gear => "gear",
            Self::Coin => "coin",
            Self::Belt => "belt",
            Self::BeltShadow => "belt-shadow",
            Self::Discs => "discs",
            Self::MarkedDiscs => "marked-discs",
            Self::AcceleratingL => "accelerating-l",
            Self::Outlined => "outlined",
        }
    }

    /// A rendering with the contrast, blur, shading and noise that this scene has with these random numbers.
    pub(super) fn rendering(self, rng: &mut impl Rng) -> Rendering {
        let amount = rng.random_range(70.0..140.0);
        let blur = rng.random_range(0.7..1.8);
        let shading = rng.random_range(0.0..0.4);
        let noise = rng.random_range(1.0..4.0);
        let is_light = rng.random::<bool>();
        let shadow = if self == Self::BeltShadow { 0.35 } else { 0.0 };
        let line = if self == Self::Outlined { 5.0 } else { 0.0 };
        // A shadow is seen on a light ground, with light bodies on it still lighter.
        let (ground, contrast) = match (self, is_light) {
            (Self::Outlined, _) => (170.0, -amount),
            (Self::BeltShadow, true) => (110.0, amount),
            (_, true) => (80.0, amount),
            (_, false) => (210.0, -amount),
        };
        Rendering { ground, contrast, blur, shading, noise, shadow, line, ..Rendering::default() }
    }

    /// The bodies in a picture of 640 x 480 pixels.
    pub(super) fn bodies(self, rng: &mut impl Rng) -> Vec<Body> {
        let sign = |rng: &mut _| if Rng::next_u32(rng).is_multiple_of(2) { 1.0 } else { -1.0 };
        let spin = rng.random_range(0.6..2.0) * sign(rng);
        let angle = rng.random_range(0.0..TAU);
        let drift = Vector2::new(rng.random_range(-40.0..40.0), rng.random_range(-25.0..25.0));
        let middle = Point2::new(320.0, 240.0);
        let around = middle - drift;
        match self {
            Self::Gear => {
                let path = Path { velocity: 0.5 * drift, angle, omega: spin, ..Path::at(middle - 0.5 * drift) };
                vec![Body { contours: vec![gear(88.0, 18, 9.0, 1)], path }]
            }
            Self::Coin => {
                let path = Path { velocity: drift, angle, tumble: spin, ..Path::at(around) };
                vec![Body { contours: vec![disc(70.0)], path }]
            }
            Self::Belt | Self::BeltShadow => belt(rng.random_range(140.0..220.0), rng),
            Self::Discs | Self::MarkedDiscs => rolling(self, spin, angle),
            Self::AcceleratingL => {
                let acceleration =
                    Vector2::new(rng.random_range(20.0..50.0) * sign(rng), rng.random_range(-20.0..20.0));
                let alpha = rng.random_range(0.3..1.0) * sign(rng);
                let start = middle - acceleration;
                let path = Path { acceleration, angle, omega: spin, alpha, ..Path::at(start) };
                vec![Body { contours: vec![letter_l(150.0)], path }]
            }
            Self::Outlined => {
                let path = Path { velocity: drift, angle, omega: spin, ..Path::at(around) };
                vec![Body { contours: vec![letter_l(170.0)], path }]
            }
        }
    }
}

/// Five bodies one after the other, the first in view at time 0.
fn belt(speed: f64, rng: &mut impl Rng) -> Vec<Body> {
    let wedge = polygon(&[[0.0, 0.0], [1.0, 0.1], [0.25, 0.7]], 85.0);
    let shapes = [letter_l(90.0), gear(36.0, 9, 7.0, 1), wedge, egg(85.0), star(95.0)];
    let mut x = 500.0;
    let mut bodies = Vec::new();
    for contour in shapes {
        let start = Point2::new(x, rng.random_range(120.0..360.0));
        x -= rng.random_range(125.0..170.0);
        let path = Path { velocity: Vector2::new(speed, 0.0), angle: rng.random_range(0.0..TAU), ..Path::at(start) };
        bodies.push(Body { contours: vec![contour], path });
    }
    bodies
}

/// Two discs on two rails: one travels to the right, and so turns clockwise, the other to the left.
fn rolling(scene: PictureScene, spin: f64, angle: f64) -> Vec<Body> {
    let spin = spin.abs();
    let one = |radius: f64, at: [f64; 2], omega: f64| {
        let velocity = Vector2::new(omega * radius, 0.0);
        let body =
            Body { contours: vec![disc(radius)], path: Path { velocity, angle, omega, ..Path::at(Point2::from(at)) } };
        match scene {
            PictureScene::MarkedDiscs => body
                .with_hole(&disc(0.24 * radius), Vector2::new(0.5 * radius, 0.0))
                .with_hole(&disc(0.15 * radius), Vector2::new(-0.2 * radius, 0.45 * radius)),
            _ => body,
        }
    };
    vec![one(62.0, [110.0, 150.0], spin), one(48.0, [530.0, 350.0], -1.2 * spin)]
}

impl FromStr for PictureScene {
    type Err = UnknownScene;

    fn from_str(name: &str) -> Result<Self, UnknownScene> {
        let found = Self::ALL.into_iter().find(|scene| scene.name() == name);
        found.ok_or_else(|| UnknownScene { name: name.to_owned() })
    }
}
