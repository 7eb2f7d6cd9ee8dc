//! The stress suite as JSON.
use std::io::{self, Write};

use freeform_experiments::stress::{Class, Kind, NOTES, PoseSummary, QuantitySummary, StressReport, Summary};
use serde_json::{Map, Value, json};

/// One JSON object.
pub(crate) fn write_stress_json(sink: &mut impl Write, report: &StressReport) -> io::Result<()> {
    let kinds = report.kinds.iter().map(|of| {
        let mut value = kind_json(&of.kind);
        value.extend(summary_json(&of.summary));
        value
    });
    let classes: Map<String, Value> =
        report.classes.iter().map(|(class, summary)| (class.to_string(), summary_json(summary).into())).collect();
    let document = json!({
        "schema": "freeform.stress/1",
        "motion": report.model.to_string(),
        "runs": report.runs,
        "frames": report.frames,
        "seed": report.seed,
        "notes": NOTES,
        "kinds": kinds.collect::<Vec<_>>(),
        "classes": classes,
        "overall": summary_json(&report.overall),
    });
    serde_json::to_writer_pretty(&mut *sink, &document)?;
    writeln!(sink)
}

/// The kinds with what they are, as one JSON object.
pub(crate) fn write_kinds_json(sink: &mut impl Write, kinds: &[Kind]) -> io::Result<()> {
    let classes: Map<String, Value> =
        Class::ALL.into_iter().map(|class| (class.to_string(), class.description().into())).collect();
    let kinds: Vec<_> = kinds.iter().map(kind_json).collect();
    let document = json!({"schema": "freeform.stress-kinds/1", "classes": classes, "kinds": kinds});
    serde_json::to_writer_pretty(&mut *sink, &document)?;
    writeln!(sink)
}

fn kind_json(kind: &Kind) -> Map<String, Value> {
    let fields = [("class", kind.class.name()), ("kind", &kind.name), ("explanation", &kind.explanation)];
    fields.into_iter().map(|(name, text)| (name.to_owned(), text.into())).collect()
}

fn poses_json(poses: &PoseSummary) -> Value {
    json!({
        "silent_wrong": poses.silent_wrong,
        "off": poses.off,
        "turn_coverage": poses.turn_coverage,
        "place_coverage": poses.place_coverage,
        "turn_unstated": poses.turn_unstated,
    })
}

fn summary_json(summary: &Summary) -> Map<String, Value> {
    let quantity = |of: &QuantitySummary| {
        let value = json!({
            "silent_wrong": of.silent_wrong,
            "unstated": of.unstated,
            "coverage": of.coverage,
            "median_deviations": of.median_deviations,
        });
        (of.quantity.name().to_owned(), value)
    };
    let quantities: Map<String, Value> = summary.quantities.iter().map(quantity).collect();
    let fields = [
        ("runs", json!(summary.runs)),
        ("silent_wrong", json!(summary.silent_wrong)),
        ("off", json!(summary.off)),
        ("told_of_off", json!(summary.told_of_off())),
        ("unstated", json!(summary.unstated)),
        ("warned", json!(summary.warned)),
        ("alias_told", json!(summary.alias_told)),
        ("frames_rejected", json!(summary.frames_rejected)),
        ("quantities", quantities.into()),
        ("poses", summary.poses.as_ref().map_or(Value::Null, poses_json)),
    ];
    fields.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}
