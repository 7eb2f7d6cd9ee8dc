use std::io::{self, Write};

use freeform_motion::curve_fit::exponents;
use freeform_motion::decompose::{AffineInvariants, DecompositionError};
use freeform_motion::{CurveDeviations, CurveParts, FittedOutline};
use serde_json::{Map, Value, json};

/// Writes fits one by one as one JSON object, so that they need not be held.
#[derive(Debug, Default)]
pub(crate) struct FitsJson {
    is_begun: bool,
}

impl FitsJson {
    /// Writes the next fit.
    pub(crate) fn write(&mut self, sink: &mut impl Write, fitted: &FittedOutline) -> io::Result<()> {
        let text = serde_json::to_string_pretty(&outline_json(fitted))?;
        let before = if self.is_begun { "," } else { "{\n  \"outlines\": [" };
        self.is_begun = true;
        // Text of JSON has no line breaks of its own.
        write!(sink, "{before}\n    {}", text.replace('\n', "\n    "))
    }

    /// Writes the end, after at least one fit.
    pub(crate) fn finish(self, sink: &mut impl Write) -> io::Result<()> {
        writeln!(sink, "\n  ],\n  \"schema\": \"freeform.fit/1\"\n}}")
    }
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

fn levels_json(parts: &CurveParts) -> Vec<Value> {
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

fn related_points_json(parts: &CurveParts, deviations: Option<&CurveDeviations>) -> Vec<Value> {
    let points = parts.related_points.as_slice().iter().enumerate();
    points
        .map(|(index, d)| {
            let std = deviations.and_then(|deviations| deviations.related_points.get(index));
            json!({"level": d.level, "pair": d.pair, "x": d.point.x, "y": d.point.y, "std": std, "value": d.value})
        })
        .collect()
}
