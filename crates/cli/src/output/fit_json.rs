use std::io::{self, Write};

use freeform_motion::curve_fit::exponents;
use freeform_motion::decompose::{AffineInvariants, DecompositionError};
use serde_json::{Map, Value, json};

use crate::fitted_outline::{Deviations, FittedOutline, Parts};

/// The fits as one JSON object.
pub(crate) fn write_fits_json(sink: &mut impl Write, fits: &[FittedOutline]) -> io::Result<()> {
    let outlines: Vec<Value> = fits.iter().map(outline_json).collect();
    serde_json::to_writer_pretty(&mut *sink, &json!({"schema": "freeform.fit/1", "outlines": outlines}))?;
    writeln!(sink)
}

fn outline_json(fitted: &FittedOutline) -> Value {
    let polynomial = fitted.fit.polynomial();
    let diagnostics = fitted.fit.diagnostics();
    let degree = polynomial.degree().value();
    let coefficients: Map<String, Value> =
        exponents(degree).zip(polynomial.coefficients()).map(|((i, j), a)| (format!("a_{i}{j}"), json!(a))).collect();
    let parts = fitted.parts.as_ref();
    let deviations = fitted.deviations.as_ref();
    json!({
        "object": fitted.object,
        "frame": fitted.frame,
        "time": fitted.time,
        "points": diagnostics.point_count,
        "degree": degree,
        "coefficients": coefficients,
        "bounded": fitted.fit.is_bounded(),
        "margin": diagnostics.boundedness_margin,
        "constraint_active": diagnostics.constraint_active,
        "condition": diagnostics.condition,
        "residual": {"algebraic": diagnostics.algebraic_residual, "geometric": diagnostics.geometric_residual},
        "stray_parts": fitted.stray_parts.iter().map(|p| json!({"x": p.x, "y": p.y})).collect::<Vec<_>>(),
        "levels": parts.map_or_else(|_| Vec::new(), levels_json),
        "related_points": parts.map_or_else(|_| Vec::new(), |parts| related_points_json(parts, deviations)),
        "invariants": parts.ok().and_then(|parts| parts.invariants.as_ref()).map(AffineInvariants::values),
        "invariants_std": deviations.map(|d| &d.invariants).filter(|list| !list.is_empty()),
        "decomposition_error": parts.err().map(DecompositionError::to_string),
    })
}

fn levels_json(parts: &Parts) -> Vec<Value> {
    let decomposition = &parts.decomposition;
    let level = |level: usize| {
        let lines = decomposition.level(level).iter();
        let lines: Vec<Value> =
            lines.map(|line| json!({"l": [line.l.re, line.l.im], "k": [line.k.re, line.k.im]})).collect();
        json!({"level": level, "coefficient": decomposition.coefficient(level), "lines": lines})
    };
    let constant = json!({"level": 0, "coefficient": decomposition.coefficient(0), "lines": []});
    decomposition.levels().map(level).chain([constant]).collect()
}

fn related_points_json(parts: &Parts, deviations: Option<&Deviations>) -> Vec<Value> {
    let points = parts.related_points.as_slice().iter().enumerate();
    points
        .map(|(index, d)| {
            let std = deviations.and_then(|deviations| deviations.related_points.get(index));
            json!({"level": d.level, "pair": d.pair, "x": d.point.x, "y": d.point.y, "std": std, "value": d.value})
        })
        .collect()
}
