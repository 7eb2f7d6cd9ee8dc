use std::collections::HashMap;
use std::io::{self, Write};

use freeform_motion::estimate::{MotionState, PoseParameter};
use freeform_motion::riccati::{CameraScale, MotionModel};

use crate::trajectory::Trajectory;

/// Writes a trajectory: one row per object and frame with pose and motion and their standard deviations. What is not known stays
/// empty. Positions and velocities are divided by the camera scale where one is given; angles go on beyond half a turn.
pub(crate) fn write_trajectory(
    sink: &mut impl Write,
    trajectory: &Trajectory,
    model: MotionModel,
    scale: Option<CameraScale>,
) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(sink);
    let names = || pose_names(model).iter().chain(model.parameter_names());
    let mut header: Vec<String> = ["object", "frame", "time", "accepted"].map(str::to_owned).into();
    header.extend(names().flat_map(|name| [(*name).to_owned(), format!("{name}_std")]));
    writer.write_record(&header).map_err(io::Error::from)?;
    let mut angles: HashMap<&str, f64> = HashMap::new();
    for row in &trajectory.rows {
        let mut fields = vec![
            row.object.clone(),
            row.frame.to_string(),
            row.time.map_or_else(String::new, |time| time.to_string()),
            row.accepted.to_string(),
        ];
        match row.state() {
            Some(state) => fields.extend(numbers(&state, scale, angles.entry(&row.object).or_default())),
            None => fields.extend(std::iter::repeat_n(String::new(), 2 * names().count())),
        }
        writer.write_record(&fields).map_err(io::Error::from)?;
    }
    writer.flush()
}

fn pose_names(model: MotionModel) -> &'static [&'static str] {
    match model {
        MotionModel::Rigid => &["angle", "x", "y"],
        MotionModel::Similarity => &["scale", "angle", "x", "y"],
        MotionModel::Affine => &["m11", "m12", "m21", "m22", "x", "y"],
        MotionModel::Projective => &["m11", "m12", "m21", "m22", "x", "y", "m31", "m32"],
    }
}

/// Every number and its standard deviation; `last_angle` is that of the row before.
fn numbers(state: &MotionState, scale: Option<CameraScale>, last_angle: &mut f64) -> Vec<String> {
    let mut fields = Vec::new();
    for PoseParameter { name, mut value, mut standard_deviation } in state.pose_parameters() {
        // As a generator changes between image and space, so does a map.
        match (name, scale.map(CameraScale::value)) {
            ("angle", _) => {
                value += std::f64::consts::TAU * ((*last_angle - value) / std::f64::consts::TAU).round();
                *last_angle = value;
            }
            ("x" | "y", Some(scale)) => (value, standard_deviation) = (value / scale, standard_deviation / scale),
            ("m31" | "m32", Some(scale)) => (value, standard_deviation) = (value * scale, standard_deviation * scale),
            _ => {}
        }
        fields.extend([finite(Some(value)), finite(Some(standard_deviation))]);
    }
    let motion = state.motion();
    let motion = scale.map_or(motion, |scale| motion.in_space(scale));
    fields.extend(motion.parameters().flat_map(|p| [finite(p.value), finite(p.standard_deviation)]));
    fields
}

fn finite(value: Option<f64>) -> String {
    value.filter(|value| value.is_finite()).map_or_else(String::new, |value| value.to_string())
}
