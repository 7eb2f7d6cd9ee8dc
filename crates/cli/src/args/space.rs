//! A plane in space and the camera that looks at it.
use clap::Args;
use freeform_motion::riccati::{PinholeCamera, PlaneMotion};
use nalgebra::{Point2, Vector3};

use super::values::{numbers, positive};
use crate::failure::Failure;

/// The camera, for `--motion plane`.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct PerspectiveArgs {
    /// Focal length of the camera in pixels, for --motion plane
    #[arg(long, value_name = "PIXELS", value_parser = positive, allow_hyphen_values = true,
          required_if_eq("motion", "plane"))]
    focal: Option<f64>,

    /// Where the optical axis meets the picture, in the coordinates of the outlines, for --motion plane: mostly the middle of the
    /// picture
    #[arg(long, value_name = "X,Y", value_parser = numbers::<2>("X,Y"), allow_hyphen_values = true,
          required_if_eq("motion", "plane"))]
    principal: Option<[f64; 2]>,
}

impl PerspectiveArgs {
    /// The camera, if it is given.
    pub(crate) fn camera(&self) -> Option<PinholeCamera> {
        let [x, y] = self.principal?;
        PinholeCamera::new(self.focal?, Point2::new(x, y)).ok()
    }

    /// Refuses a camera where no motion in space is asked for.
    pub(crate) fn check(&self, is_plane: bool) -> Result<(), Failure> {
        if !is_plane && (self.focal.is_some() || self.principal.is_some()) {
            return Err(Failure::unusable("--focal and --principal are for --motion plane"));
        }
        Ok(())
    }
}

/// The true motion of a plane in space.
#[derive(Debug, Clone, Args)]
pub(crate) struct PlaneArgs {
    /// With --motion plane: angular velocity in rad/s and velocity per second, in distances of the plane along the optical axis at the
    /// first frame [default: 0.12,-0.08,0.5,0.1,0.05,0.12]
    #[arg(long, value_name = "WX,WY,WZ,VX,VY,VZ", value_parser = numbers::<6>("WX,WY,WZ,VX,VY,VZ"), allow_hyphen_values = true)]
    plane: Option<[f64; 6]>,

    /// With --motion plane: x and y of the normal of the plane at the first frame, its z being 1; 0.577,0 is a tilt of 30 degrees [default:
    /// 0.46,0.35]
    #[arg(long, value_name = "NX,NY", value_parser = numbers::<2>("NX,NY"), allow_hyphen_values = true)]
    normal: Option<[f64; 2]>,

    /// With --motion plane: how large the object would be in the picture, if it faced the camera, in pixels [default: 300]
    #[arg(long, value_name = "PIXELS", value_parser = positive)]
    size: Option<f64>,

    #[command(flatten)]
    pub(crate) camera: PerspectiveArgs,
}

/// A plane in motion, its camera, and the size of the object.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlaneBefore {
    pub(crate) motion: PlaneMotion,
    pub(crate) camera: PinholeCamera,
    pub(crate) size: f64,
}

impl PlaneArgs {
    /// The plane if one is asked for.
    pub(crate) fn plane(&self, is_plane: bool) -> Result<Option<PlaneBefore>, Failure> {
        self.camera.check(is_plane)?;
        if !is_plane {
            let given =
                [("plane", self.plane.is_some()), ("normal", self.normal.is_some()), ("size", self.size.is_some())];
            return match given.into_iter().find(|(_, is_given)| *is_given) {
                Some((option, _)) => Err(Failure::unusable(format_args!("--{option} is for --motion plane"))),
                None => Ok(None),
            };
        }
        let Some(camera) = self.camera.camera() else {
            return Err(Failure::unusable("--motion plane needs --focal PIXELS and --principal X,Y"));
        };
        let [wx, wy, wz, vx, vy, vz] = self.plane.unwrap_or([0.12, -0.08, 0.5, 0.1, 0.05, 0.12]);
        let [nx, ny] = self.normal.unwrap_or([0.46, 0.35]);
        let motion = PlaneMotion {
            angular_velocity: Vector3::new(wx, wy, wz),
            velocity: Vector3::new(vx, vy, vz),
            normal: Vector3::new(nx, ny, 1.0),
        };
        Ok(Some(PlaneBefore { motion, camera, size: self.size.unwrap_or(300.0) }))
    }
}
