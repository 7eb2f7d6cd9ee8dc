use std::io::{self, Write};

use super::statistics::Statistics;
use super::study::Report;

/// Under which name the shapes appear together.
const POOLED: &str = "pooled";

/// Under which name the parameters appear together.
const ALL: &str = "all";

const HEADER: [&str; 18] = [
    "setting",
    "frames",
    "fps",
    "noise",
    "points",
    "method",
    "shape",
    "parameter",
    "truth",
    "rmse",
    "bound",
    "ratio",
    "bias",
    "bias_standard_error",
    "coverage",
    "runs",
    "lost",
    "frames_rejected",
];

/// Writes a report as CSV: one row per setting, method, shape and parameter; `pooled` shapes and `all` parameters as well. Of an acquisition the
/// ratio is empty and `lost` holds the runs in which the pose was not found. `timing`: whether there is a column with the time per frame, which no
/// run repeats.
///
/// # Errors
///
/// Those of the sink.
pub fn write_report_csv(sink: &mut impl Write, report: &Report, timing: bool) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(sink);
    let time_column = timing.then_some("microseconds_per_frame");
    writer.write_record(HEADER.into_iter().chain(time_column)).map_err(io::Error::from)?;
    let mut record = |cells: Vec<String>, time: Option<f64>| {
        let time = timing.then(|| text(time));
        writer.write_record(cells.into_iter().chain(time)).map_err(io::Error::from)
    };
    for evaluation in &report.evaluations {
        let setting = &evaluation.setting;
        let truth = setting.truth();
        for result in &evaluation.methods {
            for (shape, statistics) in result.by_shape(&report.shapes, POOLED) {
                let start = || {
                    let mut cells = vec![setting.name.clone(), setting.frames.to_string()];
                    cells.extend([setting.fps, setting.noise].map(|value| value.to_string()));
                    cells.extend([setting.points.to_string(), result.method.name().to_owned(), shape.to_owned()]);
                    cells
                };
                for ((name, p), truth) in setting.parameter_names().iter().zip(&statistics.parameters).zip(&truth) {
                    let mut cells = start();
                    cells.extend([(*name).to_owned(), truth.to_string()]);
                    let values = [p.rmse, p.bound, p.ratio, p.bias, p.bias_standard_error, p.coverage];
                    cells.extend(values.map(text));
                    cells.extend(counts(statistics));
                    record(cells, statistics.microseconds_per_frame)?;
                }
                let mut cells = start();
                cells.extend([ALL, "", "", ""].map(str::to_owned));
                cells.extend([text(statistics.ratio), String::new(), String::new(), text(statistics.coverage)]);
                cells.extend(counts(statistics));
                record(cells, statistics.microseconds_per_frame)?;
            }
        }
    }
    for acquisition in &report.acquisitions {
        let setting = &acquisition.setting;
        for result in &acquisition.methods {
            for (shape, found) in result.by_shape(&report.shapes, POOLED) {
                let mut cells = vec![setting.name.clone(), "2".to_owned(), String::new(), setting.noise.to_string()];
                cells.extend([setting.points.to_string(), result.method.name().to_owned(), shape.to_owned()]);
                cells.resize(15, String::new());
                cells.extend([found.runs.to_string(), (found.runs - found.found).to_string(), String::new()]);
                record(cells, None)?;
            }
        }
    }
    writer.flush()
}

fn counts(statistics: &Statistics) -> [String; 3] {
    [statistics.runs.to_string(), statistics.lost.to_string(), text(statistics.frames_rejected)]
}

fn text(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}
