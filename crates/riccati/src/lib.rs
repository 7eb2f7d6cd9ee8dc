//! Riccati dynamics of complex lines, and of whole implicit polynomial curves, under rigid, similarity, affine and
//! projective motion of the plane.
//!
//! A motion is `P' = A P` on homogeneous points `P = (x, y, 1)` (equation 4 of M. Unel and B. K. Ghosh, Motion
//! identification of planar free-form objects; equation numbers in this crate are theirs). What moves with it:
//!
//! | object | equation | here |
//! |---|---|---|
//! | point | `P' = A P` | [`RigidMotion`], [`SimilarityMotion`], [`AffineMotion`], [`ProjectiveMotion`], [`MotionModel`] |
//! | line `L = (p, l, k)` | `L' = -A' L` (5, 6) | [`line_flow`], [`moved_line`] |
//! | line in the chart `p = 1` | Riccati (9 to 12) | [`line_rate`], in real variables (14 to 17) [`RealVariables`] |
//! | coefficients of line products | (7, 8, 18) | [`level_rate`], [`level_factor`], [`AlphaBeta`] |
//! | coefficients of the polynomial | `a' = L(A) a` | [`Lift`], [`Transport`] |
//!
//! Constant motions have closed forms; [`FlowIntegrator`] is for those that change with time, [`flow_sensitivity`] for the
//! derivative of a flow with respect to the motion. Positive omega turns clockwise in a y-up frame.
//!
//! ```
//! use freeform_curve_fit::{Degree, ImplicitPolynomial};
//! use freeform_riccati::{MotionModel, RigidMotion, Transport, line_flow};
//! use freeform_decompose::Line;
//! use nalgebra::{Complex, Point2};
//!
//! // The flight bird of the paper, seen with f / Z0 = 0.1, for half a second.
//! let motion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };
//! let map = motion.flow(0.5);
//!
//! // A complex line goes along: it vanishes where it did before, and the chart divides out the factor s.
//! let line = Line { l: Complex::new(0.2, 0.9), k: Complex::new(-0.1, 0.3) };
//! let (moved, s) = line_flow(&motion.generator(), &line, 0.5)?;
//! let p = Point2::new(0.4, -0.7);
//! assert!((moved.evaluate(&(map * p)) * s - line.evaluate(&p)).norm() < 1e-14);
//!
//! // So does a whole curve, by one linear map of its coefficients.
//! let ellipse = ImplicitPolynomial::new(Degree::Conic, &[-1.0, 0.0, 0.0, 1.0, 0.0, 4.0])?;
//! let moved = Transport::new(Degree::Conic, &map)?.polynomial(&ellipse)?;
//! assert!((moved.evaluate(&(map * p)) - ellipse.evaluate(&p)).abs() < 1e-14);
//!
//! // The same motion by its parameter vector.
//! assert_eq!(MotionModel::Rigid.generator(&[motion.omega, -0.3, 0.4]), motion.generator());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod alpha_beta;
mod camera_scale;
mod coefficient_map;
mod error;
mod exponential;
mod flow;
mod generator;
mod homography;
mod integrate;
mod lift;
mod logarithm;
mod motion;
mod motion_model;
mod pinhole_camera;
mod plane_in_space;
mod plane_map;
mod real_variables;
mod sensitivity;
mod transport;

pub use alpha_beta::{AlphaBeta, level_factor, level_rate};
pub use camera_scale::CameraScale;
pub use error::DynamicsError;
pub use flow::{LineRate, line_flow, line_rate, moved_line, rotation_chart_flow};
pub use generator::{ParameterMatrix, ParameterVector, turn_rate};
pub use homography::{HomographyError, homography};
pub use integrate::{FlowIntegrator, IntegratedFlow};
pub use lift::Lift;
pub use logarithm::logarithm;
pub use motion::{AffineMotion, ProjectiveMotion, RigidMotion, SimilarityMotion};
pub use motion_model::{MAX_PARAMETERS, MotionModel, ParameterKind};
pub use pinhole_camera::PinholeCamera;
pub use plane_in_space::{PlaneMotion, PlaneSolutions};
pub use plane_map::{is_affine, map_point, map_point_by, pull_back, pull_back_by};
pub use real_variables::RealVariables;
pub use sensitivity::flow_sensitivity;
pub use transport::Transport;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
