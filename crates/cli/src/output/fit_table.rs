use std::io::{self, Write};

use freeform_motion::curve_fit::exponents;
use freeform_motion::outline_io::readable;
use freeform_motion::{CurveDeviations, CurveParts, FittedOutline};
use freeform_motion::{short, significant};
use nalgebra::{Complex, Point2};

/// Digits of coefficients and lines.
const DIGITS: usize = 6;

/// One fit for reading, after a blank line where it is not the first.
pub(crate) fn write_fit_table(sink: &mut impl Write, fitted: &FittedOutline, blank_line: bool) -> io::Result<()> {
    if blank_line {
        writeln!(sink)?;
    }
    let diagnostics = fitted.fit.diagnostics();
    let polynomial = fitted.fit.polynomial();
    let degree = polynomial.degree();
    let FittedOutline { object, frame, time, .. } = fitted;
    let (time, points) = (short(*time), diagnostics.point_count);
    writeln!(sink, "object {}, frame {frame}, {time} s: degree {degree}, {points} points", readable(object))?;
    let margin = significant(diagnostics.boundedness_margin, 3);
    let constraint = if diagnostics.constraint_active { ", constraint active" } else { "" };
    let bounded = if fitted.fit.is_bounded() { "yes" } else { "no" };
    writeln!(sink, "  bounded         {bounded} (margin {margin}{constraint})")?;
    writeln!(sink, "  residual        {} (root mean square distance)", significant(diagnostics.geometric_residual, 3))?;
    writeln!(sink, "  condition       {}", significant(diagnostics.condition, 2))?;
    if !fitted.stray_parts.is_empty() {
        let place = |p: &Point2<f64>| format!("({}, {})", significant(p.x, 3), significant(p.y, 3));
        let places: Vec<String> = fitted.stray_parts.iter().map(place).collect();
        writeln!(sink, "  beside outline  {} part(s) of the curve, about {}", places.len(), places.join(", "))?;
    }
    writeln!(sink, "  coefficients a_ij of x^i y^j")?;
    let names = exponents(degree.value()).map(|(i, j)| format!("a_{i}{j}"));
    let coefficients = polynomial.coefficients().iter();
    let cells: Vec<String> =
        names.zip(coefficients).map(|(name, a)| format!("{name} {:>13}", significant(*a, DIGITS))).collect();
    for row in cells.chunks(4) {
        writeln!(sink, "    {}", row.join("   "))?;
    }
    match &fitted.parts {
        Ok(parts) => write_parts(sink, parts, fitted.deviations.as_ref()),
        Err(error) => writeln!(sink, "  no lines        {error}"),
    }
}

fn write_parts(sink: &mut impl Write, parts: &CurveParts, deviations: Option<&CurveDeviations>) -> io::Result<()> {
    let decomposition = &parts.decomposition;
    for level in decomposition.levels() {
        let coefficient = significant(decomposition.coefficient(level), DIGITS);
        writeln!(sink, "  lines x + l y + k of level {level}, coefficient {coefficient}")?;
        for line in decomposition.level(level) {
            writeln!(sink, "    l {:<26} k {}", complex(line.l), complex(line.k))?;
        }
    }
    writeln!(sink, "  constant        {}", significant(decomposition.coefficient(0), DIGITS))?;
    writeln!(sink, "  related points")?;
    for d in parts.related_points.as_slice() {
        let [x, y, value] = [d.point.x, d.point.y, d.value].map(|number| significant(number, DIGITS));
        writeln!(sink, "    level {} ({x}, {y}), value {value}", d.level)?;
    }
    match &parts.invariants {
        Some(invariants) => {
            let values: Vec<String> = invariants.values().iter().map(|value| significant(*value, DIGITS)).collect();
            writeln!(sink, "  invariants      {}", values.join(", "))?;
            let Some(deviations) = deviations else { return Ok(()) };
            let values: Vec<String> = deviations.invariants.iter().map(|value| significant(*value, 2)).collect();
            writeln!(sink, "    deviations    {}", values.join(", "))
        }
        None => writeln!(sink, "  invariants      none"),
    }
}

fn complex(z: Complex<f64>) -> String {
    if z.im == 0.0 {
        return significant(z.re, DIGITS);
    }
    let sign = if z.im < 0.0 { '-' } else { '+' };
    format!("{} {sign} {} j", significant(z.re, DIGITS), significant(z.im.abs(), DIGITS))
}
