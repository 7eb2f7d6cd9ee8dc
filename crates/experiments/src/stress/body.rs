use std::f64::consts::{PI, TAU};

use freeform_sim_camera::{BuiltInShape, Shape};
use nalgebra::Point2;
use rand::{Rng, RngExt as _};
use rand_distr::StandardNormal;

use crate::ExperimentError;
use crate::monte_carlo::suite::SHAPES;

/// Corners of the polygon that stands for a smooth contour: it is left by less than 1e-5 of its size.
const CORNERS: usize = 720;

/// Corners for each tooth of a gear.
const CORNERS_PER_TOOTH: usize = 40;

/// What moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Body {
    /// One of bird, glider, phone, van, shoe and hat.
    Object,
    /// A smooth closed curve by chance: a circle with waves of the orders 2 to 6.
    Blob,
    /// A star-shaped polygon by chance.
    Polygon {
        corners: usize,
    },
    /// A polygon with equal sides and angles.
    Regular {
        corners: usize,
    },
    /// A gear with rounded teeth that rise and fall by this share of the radius.
    Gear {
        teeth: usize,
        amplitude: f64,
    },
    Circle,
    Ellipse {
        eccentricity: f64,
    },
    /// A circle with equal waves.
    Lobes {
        lobes: usize,
        amplitude: f64,
    },
    /// A circle with a notch: its depth in radii, and its angle in rad.
    Notched {
        depth: f64,
        angle: f64,
    },
    /// A circle with waves of the orders 2 and 3, the second half as high.
    Egg {
        amplitude: f64,
    },
}

impl Body {
    /// How many turns within a full one leave the contour as it is; 1 of a circle too, none of whose turns is shown.
    pub(super) fn folds(self) -> usize {
        match self {
            Self::Regular { corners } => corners,
            Self::Gear { teeth, .. } => teeth,
            Self::Lobes { lobes, .. } => lobes,
            Self::Ellipse { .. } => 2,
            Self::Object
            | Self::Blob
            | Self::Polygon { .. }
            | Self::Circle
            | Self::Notched { .. }
            | Self::Egg { .. } => 1,
        }
    }

    /// The contour at unit size about its middle; where it is a matter of chance, another one each time.
    pub(super) fn contour(self, rng: &mut impl Rng) -> Result<Shape, ExperimentError> {
        let wave = |order: usize, angle: f64| (order as f64 * angle).cos();
        let radius: Box<dyn Fn(f64) -> f64> = match self {
            Self::Object => return Ok(SHAPES[rng.random_range(0..SHAPES.len())].shape()),
            Self::Circle => return Ok(BuiltInShape::Circle.shape()),
            Self::Blob => {
                let waves: Vec<(usize, f64, f64)> = (2..=6)
                    .map(|order| {
                        let height: f64 = rng.sample(StandardNormal);
                        (order, 0.2 * height / order as f64, rng.random_range(0.0..TAU))
                    })
                    .collect();
                Box::new(move |angle| {
                    let waves =
                        waves.iter().map(|(order, height, phase)| height * (*order as f64 * angle + phase).cos());
                    (1.0 + waves.sum::<f64>()).max(0.2)
                })
            }
            Self::Polygon { corners } => {
                let step = TAU / corners as f64;
                let mut corner = |k: usize| {
                    let angle = step * (k as f64 + rng.random_range(-0.3..0.3));
                    at(angle, rng.random_range(0.5..1.0))
                };
                return polygon(&(0..corners).map(&mut corner).collect::<Vec<_>>());
            }
            Self::Regular { corners } => {
                let corner = |k: usize| at(TAU * k as f64 / corners as f64, 1.0);
                return polygon(&(0..corners).map(corner).collect::<Vec<_>>());
            }
            Self::Gear { teeth, amplitude } => {
                // Steep flanks and flat tops.
                let tooth = |x: f64| (2.0 * x.sin()).tanh() / 2.0_f64.tanh();
                return round(CORNERS_PER_TOOTH * teeth, |angle| 1.0 + amplitude * tooth(teeth as f64 * angle));
            }
            Self::Ellipse { eccentricity } => {
                let squeeze = 1.0 - eccentricity * eccentricity;
                let corner = |k: usize| {
                    let (s, c) = (TAU * k as f64 / CORNERS as f64).sin_cos();
                    Point2::new(c, squeeze.sqrt() * s)
                };
                return polygon(&(0..CORNERS).map(corner).collect::<Vec<_>>());
            }
            Self::Lobes { lobes, amplitude } => Box::new(move |angle| 1.0 + amplitude * wave(lobes, angle)),
            Self::Notched { depth, angle } => {
                let rim = (0..=CORNERS).map(|k| at(0.5 * angle + (TAU - angle) * k as f64 / CORNERS as f64, 1.0));
                let floor = [-0.5, 0.5].map(|side| at(side * angle, 1.0 - depth));
                return polygon(&rim.chain(floor).collect::<Vec<_>>());
            }
            Self::Egg { amplitude } => {
                Box::new(move |angle| 1.0 + amplitude * (wave(2, angle) + 0.5 * wave(3, angle + 0.25 * PI)))
            }
        };
        round(CORNERS, radius)
    }
}

fn at(angle: f64, radius: f64) -> Point2<f64> {
    Point2::new(radius * angle.cos(), radius * angle.sin())
}

/// The contour with a radius for every angle.
fn round(corners: usize, radius: impl Fn(f64) -> f64) -> Result<Shape, ExperimentError> {
    let corner = |k: usize| {
        let angle = TAU * k as f64 / corners as f64;
        at(angle, radius(angle))
    };
    polygon(&(0..corners).map(corner).collect::<Vec<_>>())
}

fn polygon(corners: &[Point2<f64>]) -> Result<Shape, ExperimentError> {
    Ok(Shape::from_polygon(corners)?.normalised())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn every_body_has_unit_size_about_its_middle() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for body in [
            Body::Object,
            Body::Blob,
            Body::Polygon { corners: 7 },
            Body::Regular { corners: 3 },
            Body::Gear { teeth: 20, amplitude: 0.15 },
            Body::Circle,
            Body::Ellipse { eccentricity: 0.4 },
            Body::Lobes { lobes: 3, amplitude: 0.02 },
            Body::Egg { amplitude: 0.01 },
            Body::Notched { depth: 0.3, angle: 0.3 },
        ] {
            let shape = body.contour(&mut rng).expect("a contour");
            assert!((shape.diameter() - 1.0).abs() < 1e-4, "{body:?}: {}", shape.diameter());
            assert!(shape.centroid().coords.norm() < 1e-4, "{body:?}: {}", shape.centroid());
        }
    }

    #[test]
    fn an_ellipse_has_its_eccentricity_and_a_gear_its_teeth() {
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        let ellipse = Body::Ellipse { eccentricity: 0.6 }.contour(&mut rng).expect("a contour");
        let height = ellipse.sample(2000, 0.0).iter().map(|p| p.y).fold(0.0, f64::max);
        assert!((height - 0.4).abs() < 1e-4, "{height}");
        let gear = Body::Gear { teeth: 8, amplitude: 0.1 }.contour(&mut rng).expect("a contour");
        let radii: Vec<f64> = gear.sample(4000, 0.0).iter().map(|p| p.coords.norm()).collect();
        let middle = 0.5 / 1.1;
        let rises = radii.iter().zip(radii.iter().cycle().skip(1)).filter(|(a, b)| **a < middle && **b >= middle);
        assert_eq!(rises.count(), 8);
    }
}
