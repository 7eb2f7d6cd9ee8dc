//! Fig. 2: a boomerang, its line factors and its related points.
use freeform_curve_fit::{Fit, FitSettings, Fitter, ImplicitPolynomial, Outline};
use freeform_decompose::{Decomposition, Line, RelatedPoint, RelatedPoints};
use freeform_riccati::AffineMotion;
use freeform_sim_camera::{BuiltInShape, Camera, PaperExperiment, Scene, SequenceLength, Settings};
use nalgebra::{Point2, Vector2};

use super::Run;
use super::curves::{curve, curve_near, data_of, image_panel, points_of, xy};
use super::document::Section;
use super::method::fit_in_words;
use super::sequence::{Sequence, paper_settings};
use crate::ExperimentError;
use crate::figure::{Figure, Look};
use freeform_drawing::page::{Drawing, Table};
use freeform_motion::significant;

/// The outer level sets of the fit are so far from the points, in RMS radii. With those of the other figures, twice as far away, the
/// conic lines of the boomerang are real.
const OFFSET: f64 = 0.05;

/// Lines are drawn so far from their points, in image lengths: beyond every view.
const FAR: f64 = 20.0;

/// Related points further from the outline than this share of its extent are left out of the view.
const VIEW: f64 = 0.75;

/// The outline of the boomerang with its quartic in image coordinates, decomposed.
struct Boomerang {
    outline: Outline,
    fit: Fit,
    decomposition: Decomposition,
    related: RelatedPoints,
}

impl Boomerang {
    fn seen(seed: u64) -> Result<Self, ExperimentError> {
        let camera = Camera::new(PaperExperiment::SCALE)?;
        let settings = Settings { length: SequenceLength::Frames(1), ..paper_settings(1.0, seed) };
        let scene = Scene::new(BuiltInShape::Boomerang, AffineMotion::default(), camera);
        let frame = Sequence::simulate(scene, settings)?.frames.pop();
        let (_, outline) = frame.ok_or(ExperimentError::NoOutline { object: "boomerang" })?;
        let fit = Fitter::new(fit_settings())?.fit(&outline)?;
        let image_from_working = fit.normalisation().image_from_working();
        let working = Decomposition::of(fit.working())?;
        let decomposition = working.moved(&image_from_working)?;
        let factor = working.coefficient(4) / decomposition.coefficient(4);
        let related = RelatedPoints::of(&working).moved(&image_from_working).scaled(factor);
        Ok(Self { outline, fit, decomposition, related })
    }
}

/// How the boomerang is fitted.
fn fit_settings() -> FitSettings {
    FitSettings { offset: OFFSET, ..FitSettings::default() }
}

pub(super) fn section(run: &Run) -> Result<Section, ExperimentError> {
    let Boomerang { outline, fit, decomposition, related } = Boomerang::seen(run.seed)?;
    let mut curves = vec![
        curve("outline", Look::Dots, vec![points_of(&outline)]),
        curve("quartic", Look::Line, curve_near(&fit, &outline).runs),
    ];
    let mut marked = Vec::new();
    for (index, pair) in pairs(&decomposition).enumerate() {
        let drawn = if pair.is_complex() { &pair.lines[..1] } else { pair.lines };
        curves.push(curve(&pair.name(), Look::Dashed(2 + index), drawn.iter().map(real_part).collect()));
        marked.extend(pair.related(&related).map(|d| d.point));
    }
    let around = outline.bounding_box();
    let near = around.widened(VIEW);
    marked.retain(|d| near.contains(d));
    let view = around.extended(&marked).widened(0.12).square();
    curves.push(curve("related points", Look::Crosses, vec![marked.iter().map(xy).collect()]));
    run.advance();
    let panels = vec![image_panel("A boomerang, its quartic and its line factors".to_owned(), &view, curves)];
    let complex = pairs(&decomposition).filter(Pair::is_complex).count() * 2;
    let lines: usize = decomposition.levels().sum();
    let ours = if complex == lines {
        format!(
            "all {lines} here are complex too. The quartic lines are so because the curve is bounded; the conic lines need not be, and \
             of the fit of the other figures, with level sets at {} RMS radii, they are real for this outline",
            FitSettings::default().offset
        )
    } else {
        format!(
            "{complex} here are complex: the quartic lines because the curve is bounded, the conic lines are real, which (1) allows, \
             and both are drawn as they are"
        )
    };
    let drawing = Drawing {
        name: "fig2".to_owned(),
        caption: format!(
            "Fig. 2. A boomerang-shaped quartic (solid) and its line factors (dashed). The paper shows {lines} complex \
             lines; {ours}. Of a conjugate pair x + l y + k the real line Re(x + l y + k) = 0 is drawn: it passes through \
             the related point, where both lines of the pair vanish, in the direction that Re l gives, and stands for both. \
             Which real line a pair has depends on the axes, its related point does not. The paper does not say how it \
             draws complex lines; this convention is this project's, and so is the drawing of the boomerang. The quartic is \
             fitted by {}.",
            fit_in_words(&fit_settings())
        ),
        data: data_of(&panels),
        figure: Figure { panels, columns: 1, panel_size: [640.0, 640.0], ..Figure::default() },
    };
    Ok(Section {
        heading: "Fig. 2: decomposition into lines".to_owned(),
        text: String::new(),
        drawings: vec![drawing],
        tables: vec![factors_table(&decomposition, &related), sum_table(&fit, &decomposition)],
        findings: Vec::new(),
    })
}

/// Two lines of a level, conjugate or both real.
struct Pair<'a> {
    level: usize,
    /// Counted from 0 within its level.
    index: usize,
    lines: &'a [Line],
}

/// All pairs of lines, highest level first.
fn pairs(decomposition: &Decomposition) -> impl Iterator<Item = Pair<'_>> {
    let of_level = |level| {
        decomposition.level(level).chunks_exact(2).enumerate().map(move |(index, lines)| Pair { level, index, lines })
    };
    decomposition.levels().flat_map(of_level)
}

impl Pair<'_> {
    fn is_complex(&self) -> bool {
        self.lines[0].l.im != 0.0
    }

    fn name(&self) -> String {
        let kind = if self.is_complex() { "conjugate" } else { "real" };
        match self.level {
            4 => format!("quartic lines {} ({kind})", self.index + 1),
            _ => format!("conic lines ({kind})"),
        }
    }

    fn related<'r>(&self, points: &'r RelatedPoints) -> Option<&'r RelatedPoint> {
        let index = self.index;
        points.level(self.level).find(|d| d.pair == index)
    }
}

/// Every line, real and complex.
fn factors_table(decomposition: &Decomposition, related: &RelatedPoints) -> Table {
    let rows = pairs(decomposition).flat_map(|pair| {
        let d = pair.related(related);
        let (name, place) = (pair.name(), d.map(|d| [d.point.x, d.point.y, d.value]));
        pair.lines.iter().map(move |Line { l, k }| {
            let line = [l.re, l.im, k.re, k.im].map(number);
            let place = place.map_or_else(|| [(); 3].map(|()| "-".to_owned()), |place| place.map(number));
            std::iter::once(name.clone()).chain(line).chain(place).collect()
        })
    });
    Table {
        name: "fig2-factors".to_owned(),
        title: "The line factors of Fig. 2".to_owned(),
        caption: "All lines x + l y + k of equation 1, conjugates and real ones. d is the related point of the two lines \
                  of a pair, and f(d) the value of the monic polynomial there, by whose order the pairs are matched from \
                  frame to frame."
            .to_owned(),
        rows: rows.collect(),
        ..Table::of_data(&["lines", "Re l", "Im l", "Re k", "Im k", "x of d", "y of d", "f(d)"])
    }
}

/// The polynomial as fitted and as the sum of its line products.
fn sum_table(fit: &Fit, decomposition: &Decomposition) -> Table {
    let (fitted, expanded) = (fit.polynomial(), decomposition.expand());
    let monic = |f: &ImplicitPolynomial, i, j| number(f.coefficient(i, j) / f.coefficient(4, 0));
    let coefficients = (0..=4_usize).rev().flat_map(|degree| (0..=degree).rev().map(move |i| (i, degree - i)));
    let rows = coefficients.map(|(i, j)| vec![monomial(i, j), monic(&fitted, i, j), monic(&expanded, i, j)]);
    let numbers = [("alpha", decomposition.alpha()), ("beta", decomposition.beta())];
    let numbers = numbers.map(|(name, value)| vec![name.to_owned(), "-".to_owned(), number(value)]);
    Table {
        name: "fig2-sum".to_owned(),
        title: "The quartic of Fig. 2 and the sum of its line products".to_owned(),
        caption:
            "Coefficients of the monic quartic as it was fitted, and of equation 1 multiplied out: the product of the \
                  four quartic lines + alpha (product of the two conic lines) + beta."
                .to_owned(),
        rows: rows.chain(numbers).collect(),
        ..Table::of_data(&["monomial", "fitted", "line products"])
    }
}

fn monomial(i: usize, j: usize) -> String {
    let power = |name: &str, exponent: usize| match exponent {
        0 => String::new(),
        1 => name.to_owned(),
        _ => format!("{name}^{exponent}"),
    };
    let text = [power("x", i), power("y", j)].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ");
    if text.is_empty() { "1".to_owned() } else { text }
}

/// A number of the tables: enough digits to multiply the factors out.
fn number(value: f64) -> String {
    significant(value, 6)
}

/// The real line `Re(x + l y + k) = 0` across every view.
fn real_part(line: &Line) -> Vec<[f64; 2]> {
    let direction = Vector2::new(-line.l.re, 1.0).normalize();
    // The point of the line that is nearest to the origin.
    let foot = Point2::from(Vector2::new(1.0, line.l.re) * (-line.k.re / (1.0 + line.l.re * line.l.re)));
    [foot - FAR * direction, foot + FAR * direction].iter().map(xy).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::super::curves::closed_quartic;
    use super::*;

    #[test]
    fn the_real_line_of_a_pair_passes_through_its_related_point() {
        let line = Line { l: Complex::new(0.4, 0.7), k: Complex::new(0.1, -0.2) };
        // Where real and imaginary part vanish together.
        let y = -line.k.im / line.l.im;
        let related = Point2::new(-line.k.re - line.l.re * y, y);
        assert!(line.evaluate(&related).norm() < 1e-15);
        let ends: Vec<Point2<f64>> = real_part(&line).into_iter().map(Point2::from).collect();
        assert!((ends[1] - ends[0]).perp(&(related - ends[0])).abs() < 1e-12);
    }

    /// Coefficients of `x^i y^j` at `[i][j]`.
    type Form = [[Complex<f64>; 5]; 5];

    fn times(f: &Form, line: &Line) -> Form {
        let at = |i: usize, j: usize| f[i][j];
        let shifted = |i: usize, j: usize, by: (usize, usize)| match (i.checked_sub(by.0), j.checked_sub(by.1)) {
            (Some(i), Some(j)) => at(i, j),
            _ => Complex::ZERO,
        };
        let term = |i: usize, j: usize| shifted(i, j, (1, 0)) + line.l * shifted(i, j, (0, 1)) + line.k * at(i, j);
        std::array::from_fn(|i| std::array::from_fn(|j| term(i, j)))
    }

    /// The product of the lines of some kind, as the table lists them.
    fn product(table: &Table, kind: &str) -> (usize, Form) {
        let listed: Vec<Line> = table
            .rows
            .iter()
            .filter(|row| row[0].starts_with(kind))
            .map(|row| {
                let value = |column: usize| row[column].parse::<f64>().expect("a number");
                Line { l: Complex::new(value(1), value(2)), k: Complex::new(value(3), value(4)) }
            })
            .collect();
        let mut one: Form = [[Complex::ZERO; 5]; 5];
        one[0][0] = Complex::ONE;
        (listed.len(), listed.iter().fold(one, |f, line| times(&f, line)))
    }

    #[test]
    fn the_listed_factors_multiplied_out_are_the_fitted_quartic() {
        for seed in 1..=3 {
            let Boomerang { fit, decomposition, related, .. } = Boomerang::seen(seed).expect("a boomerang");
            let factors = factors_table(&decomposition, &related);
            let (four, quartic) = product(&factors, "quartic");
            let (two, conic) = product(&factors, "conic");
            assert_eq!((four, two), (4, 2));
            let sum = sum_table(&fit, &decomposition);
            let value = |name: &str, column: usize| {
                let row = sum.rows.iter().find(|row| row[0] == name).expect("a row");
                row[column].parse::<f64>().expect("a number")
            };
            let (alpha, beta) = (value("alpha", 2), value("beta", 2));
            for (i, j) in (0..=4_usize).flat_map(|i| (0..=4 - i).map(move |j| (i, j))) {
                let constant = if (i, j) == (0, 0) { beta } else { 0.0 };
                let rebuilt = quartic[i][j] + alpha * conic[i][j] + constant;
                // The size of what is added, to which the digits listed are relative.
                let size = quartic[i][j].norm() + (alpha * conic[i][j]).norm() + constant.abs();
                let fitted = value(&monomial(i, j), 1);
                assert!(
                    (rebuilt - fitted).norm() < 1e-4 * size.max(1.0),
                    "seed {seed}, x^{i} y^{j}: {rebuilt} {fitted}"
                );
                if i + j == 4 {
                    let leading = (quartic[i][j] - fitted).norm();
                    assert!(leading < 1e-4, "the quartic lines alone make the leading form: {leading}");
                }
                assert!((value(&monomial(i, j), 2) - fitted).abs() < 1e-5 * size.max(1.0));
            }
        }
    }

    #[test]
    fn all_six_lines_of_the_boomerang_are_complex_as_in_the_paper() {
        for seed in 1..=5 {
            let Boomerang { outline, decomposition, .. } = Boomerang::seen(seed).expect("a boomerang");
            assert_eq!(pairs(&decomposition).filter(Pair::is_complex).count(), 3, "seed {seed}");
            let usual = closed_quartic(&outline).expect("a fit");
            let usual = Decomposition::of(usual.working()).expect("lines");
            assert_eq!(pairs(&usual).filter(Pair::is_complex).count(), 2, "seed {seed}: as the caption says");
        }
    }

    #[test]
    fn a_monomial_is_written_as_it_is_read() {
        let written = [(4, 0), (1, 2), (0, 1), (0, 0)].map(|(i, j)| monomial(i, j));
        assert_eq!(written, ["x^4", "x y^2", "y", "1"]);
    }
}
