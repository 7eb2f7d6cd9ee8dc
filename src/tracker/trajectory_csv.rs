use std::io::{self, Write};

use freeform_riccati::{CameraScale, MotionModel};

use super::{
    not_stated::NotStated,
    result_csv::{POINT_COLUMNS, point_cells, text_cell, velocity_cells, velocity_columns},
    trajectory::{PoseAndMotion, Trajectory},
};

/// Writes a trajectory as CSV: one row per object and frame with pose and motion and their standard deviations, the segment, the velocity of the middle
/// of the object (`v1`, `v2`), why the frame was not accepted (`reason`), which values are empty and why (`unstated`, as `angle ambiguous; omega
/// ambiguous`), where the middle is whose velocity is `v1` and `v2` (`point_x`, `point_y`), and the other angular velocities that explain the outlines as
/// well, in rad/s (`aliases`, as `-4.71; 7.85`). Positions and velocities are divided by a camera scale.
///
/// # Errors
///
/// Those of the sink.
pub fn write_trajectory(
    sink: &mut impl Write,
    trajectory: &Trajectory,
    model: MotionModel,
    scale: Option<CameraScale>,
) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(sink);
    let names = || Trajectory::pose_names(model).iter().chain(model.parameter_names());
    let mut header: Vec<String> = ["object", "frame", "time", "accepted"].map(str::to_owned).into();
    header.extend(names().flat_map(|name| [(*name).to_owned(), format!("{name}_std")]));
    // The last columns, so that those before them are where they always were.
    header.push("segment".to_owned());
    header.extend(velocity_columns());
    header.extend(["reason", "unstated"].into_iter().chain(POINT_COLUMNS).chain(["aliases"]).map(str::to_owned));
    writer.write_record(&header).map_err(io::Error::from)?;
    for (row, known) in trajectory.rows().iter().zip(trajectory.poses(scale)) {
        let mut fields = vec![
            text_cell(&row.object),
            row.frame.to_string(),
            row.time.map_or_else(String::new, |time| time.to_string()),
            row.accepted.to_string(),
        ];
        let unstated = NotStated::cell(row.unstated(known.as_ref(), model));
        let velocity = known.as_ref().and_then(|known| known.velocity.as_ref());
        let (velocity, point) = (velocity_cells(velocity), point_cells(velocity));
        let aliases = known.as_ref().map_or_else(String::new, |known| aliases_cell(&known.aliases));
        match known {
            Some(PoseAndMotion { pose, motion, .. }) => {
                let pose = pose.iter().map(|p| [Some(p.value), Some(p.standard_deviation)]);
                let numbers = pose.chain(motion.parameters().map(|p| [p.value, p.standard_deviation]));
                fields.extend(numbers.flatten().map(finite));
            }
            None => fields.extend(std::iter::repeat_n(String::new(), 2 * names().count())),
        }
        fields.push(row.segment.to_string());
        fields.extend(velocity);
        fields.push(row.rejection.as_ref().map_or_else(String::new, ToString::to_string));
        fields.push(unstated);
        fields.extend(point);
        fields.push(aliases);
        writer.write_record(&fields).map_err(io::Error::from)?;
    }
    writer.flush()
}

fn finite(value: Option<f64>) -> String {
    value.filter(|value| value.is_finite()).map_or_else(String::new, |value| value.to_string())
}

fn aliases_cell(aliases: &[f64]) -> String {
    let aliases: Vec<String> = aliases.iter().filter(|alias| alias.is_finite()).map(f64::to_string).collect();
    aliases.join("; ")
}
