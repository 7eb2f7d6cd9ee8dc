use std::io::{self, Write};

use freeform_experiments::monte_carlo::{Acquisition, Evaluation, Found, MethodResult, Report, Setting, Statistics};
use freeform_motion::sim_camera::Sampling;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::evaluate_table::Evaluated;

/// The result as one JSON object.
pub(crate) fn write_evaluation_json(sink: &mut impl Write, Evaluated { report, timing }: &Evaluated) -> io::Result<()> {
    let document = Document {
        schema: "freeform.evaluate/1",
        runs: report.runs,
        seed: report.seed,
        shapes: &report.shapes,
        evaluations: report.evaluations.iter().map(|evaluation| evaluation_json(evaluation, report, *timing)).collect(),
        acquisitions: report.acquisitions.iter().map(|acquisition| acquisition_json(acquisition, report)).collect(),
    };
    serde_json::to_writer_pretty(&mut *sink, &document)?;
    writeln!(sink)
}

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    runs: usize,
    seed: u64,
    shapes: &'a [String],
    evaluations: Vec<Value>,
    acquisitions: Vec<Value>,
}

fn evaluation_json(evaluation: &Evaluation, report: &Report, timing: bool) -> Value {
    let Evaluation { setting, methods } = evaluation;
    let methods = by_method(methods, report, |statistics| statistics_json(setting, statistics, timing));
    json!({
        "setting": setting.name,
        "motion": setting.family().to_string(),
        "truth": by_name(setting, setting.truth().into_iter().map(Value::from)),
        "frames": setting.frames,
        "fps": setting.fps,
        "points": setting.points,
        "sampling": sampling_name(setting.sampling),
        "noise": setting.noise,
        "occlusion": setting.occlusion,
        "outliers": setting.outliers,
        "wrong_frames": setting.wrong_frames,
        "methods": methods,
    })
}

/// What each method found, of all shapes together and of each.
fn by_method<T>(methods: &[MethodResult<T>], report: &Report, json: impl Fn(&T) -> Value) -> Map<String, Value> {
    let of_method = |result: &MethodResult<T>| {
        let shapes: Map<_, _> = report.shapes.iter().cloned().zip(result.shapes.iter().map(&json)).collect();
        (result.method.name().to_owned(), json!({"pooled": json(&result.pooled), "shapes": shapes}))
    };
    methods.iter().map(of_method).collect()
}

fn statistics_json(setting: &Setting, statistics: &Statistics, timing: bool) -> Value {
    let parameters = statistics.parameters.iter().map(|p| {
        json!({
            "rmse": p.rmse,
            "bound": p.bound,
            "ratio": p.ratio,
            "bias": p.bias,
            "bias_standard_error": p.bias_standard_error,
            "coverage": p.coverage,
        })
    });
    let mut value = json!({
        "runs": statistics.runs,
        "lost": statistics.lost,
        "frames_rejected": statistics.frames_rejected,
        "ratio": statistics.ratio,
        "coverage": statistics.coverage,
        "bias_in_standard_errors": statistics.bias_in_errors,
        "parameters": by_name(setting, parameters),
    });
    if timing {
        value["microseconds_per_frame"] = json!(statistics.microseconds_per_frame);
    }
    value
}

fn by_name(setting: &Setting, values: impl Iterator<Item = Value>) -> Map<String, Value> {
    setting.parameter_names().iter().map(|name| (*name).to_owned()).zip(values).collect()
}

fn acquisition_json(acquisition: &Acquisition, report: &Report) -> Value {
    let setting = &acquisition.setting;
    let found = |found: &Found| json!({"runs": found.runs, "found": found.found, "share": found.share()});
    let methods = by_method(&acquisition.methods, report, found);
    json!({
        "setting": setting.name,
        "motion": setting.model.to_string(),
        "points": setting.points,
        "sampling": sampling_name(setting.sampling),
        "noise": setting.noise,
        "occlusion": setting.occlusion,
        "outliers": setting.outliers,
        "methods": methods,
    })
}

fn sampling_name(sampling: Sampling) -> &'static str {
    match sampling {
        Sampling::Independent => "independent",
        Sampling::Regular { .. } => "stratified",
    }
}
