//! Fig. 2: a boomerang, its line factors and its related points.
use freeform_motion::decompose::{Decomposition, Line, RelatedPoints};
use freeform_motion::riccati::AffineMotion;
use freeform_motion::sim_camera::{BuiltInShape, Camera, PaperExperiment, Scene, SequenceLength, Settings};
use nalgebra::{Point2, Rotation2, Vector2};

use super::Run;
use super::curves::{closed_quartic, curve, curve_near, data_of, image_panel, points_of, xy};
use super::document::{Drawing, Section, Table};
use super::experiment::{Sequence, paper_settings};
use crate::failure::Failure;
use crate::level_set::Area;
use crate::output::significant;
use crate::plot::{Figure, Look};

/// The boomerang is turned by this angle in radians, so that its axis of symmetry is not one of the axes.
const TURN: f64 = 0.4;

/// Lines are drawn so far from their points, in image lengths: beyond every view.
const FAR: f64 = 20.0;

/// Related points further from the outline than this share of its extent are left out of the view.
const VIEW: f64 = 0.75;

pub(crate) fn section(run: &Run) -> Result<Section, Failure> {
    let camera = Camera::new(PaperExperiment::SCALE).map_err(Failure::unusable)?;
    let settings = Settings { length: SequenceLength::Frames(1), ..paper_settings(1.0, run.seed) };
    let scene = Scene::new(BuiltInShape::Boomerang, AffineMotion::default(), camera)
        .with_initial_pose(nalgebra::convert(Rotation2::new(TURN)));
    let sequence = Sequence::simulate(scene, settings)?;
    let Some((_, outline)) = sequence.frames.first() else { return Ok(Section::default()) };
    let fit = closed_quartic(outline)?;
    let image_from_working = fit.normalisation().image_from_working();
    let working = Decomposition::of(fit.working()).map_err(Failure::no_result)?;
    let decomposition = working.moved(&image_from_working).map_err(Failure::no_result)?;
    let factor = working.coefficient(4) / decomposition.coefficient(4);
    let related = RelatedPoints::of(&working).moved(&image_from_working).scaled(factor);

    let mut curves = vec![
        curve("outline", Look::Dots, vec![points_of(outline)]),
        curve("quartic", Look::Line, curve_near(&fit, outline).runs),
    ];
    let mut factors = Table {
        name: "fig2-factors".to_owned(),
        title: "The line factors of Fig. 2".to_owned(),
        caption: format!(
            "f = product of the four quartic lines + alpha (product of the two conic lines) + beta, with alpha = {}, \
             beta = {} (1); conjugates are not listed. f(d) is the value of the monic polynomial at the related point, \
             by whose order the pairs are matched from frame to frame.",
            significant(decomposition.alpha(), 4),
            significant(decomposition.beta(), 4)
        ),
        ..Table::of_data(&["line pair", "l", "k", "related point d", "f(d)"])
    };
    let mut colour = 2;
    let mut marked = Vec::new();
    for level in decomposition.levels() {
        for (pair, lines) in decomposition.level(level).chunks_exact(2).enumerate() {
            let kind = if level == 4 { format!("quartic lines {}", pair + 1) } else { "conic lines".to_owned() };
            let is_complex = lines[0].l.im != 0.0;
            let drawn = if is_complex { &lines[..1] } else { lines };
            let runs = drawn.iter().map(real_part).collect();
            let name = if is_complex { format!("{kind} (conjugate)") } else { format!("{kind} (real)") };
            curves.push(curve(&name, Look::Dashed(colour), runs));
            colour += 1;
            let d = related.level(level).find(|d| d.pair == pair);
            marked.extend(d.map(|d| d.point));
            factors.rows.push(vec![
                name,
                complex(lines[0].l),
                complex(lines[0].k),
                d.map_or_else(|| "-".to_owned(), |d| format!("({:.4}, {:.4})", d.point.x, d.point.y)),
                d.map_or_else(|| "-".to_owned(), |d| significant(d.value, 4)),
            ]);
        }
    }
    let around = Area::around(outline.points()).unwrap_or(Area { low: Point2::origin(), high: Point2::origin() });
    let near = around.widened(VIEW);
    marked.retain(|d| near.contains(d));
    let view = Area::around(outline.points().chain(&marked)).unwrap_or(around).widened(0.12).square();
    curves.push(curve("related points", Look::Crosses, vec![marked.iter().map(xy).collect()]));
    run.advance();
    let panels = vec![image_panel("A boomerang, its quartic and its line factors".to_owned(), &view, curves)];
    let drawing = Drawing {
        name: "fig2".to_owned(),
        caption: "Fig. 2. A boomerang-shaped quartic (solid) and its line factors (dashed). Of a conjugate pair \
                  x + l y + k the real line Re(x + l y + k) = 0 is drawn: it passes through the related point, where \
                  both lines of the pair vanish, in the direction that Re l gives, and stands for both. Which real \
                  line a pair has depends on the axes, its related point does not. The paper does not say how it draws \
                  complex lines; this convention is this project's, and so is the drawing of the boomerang."
            .to_owned(),
        data: data_of(&panels),
        figure: Figure { panels, columns: 1, panel_size: [640.0, 640.0], ..Figure::default() },
    };
    Ok(Section {
        heading: "Fig. 2: decomposition into lines".to_owned(),
        text: String::new(),
        drawings: vec![drawing],
        tables: vec![factors],
        findings: Vec::new(),
    })
}

/// The real line `Re(x + l y + k) = 0` across every view.
fn real_part(line: &Line) -> Vec<[f64; 2]> {
    let direction = Vector2::new(-line.l.re, 1.0).normalize();
    // The point of the line that is nearest to the origin.
    let foot = Point2::from(Vector2::new(1.0, line.l.re) * (-line.k.re / (1.0 + line.l.re * line.l.re)));
    [foot - FAR * direction, foot + FAR * direction].iter().map(xy).collect()
}

fn complex(value: nalgebra::Complex<f64>) -> String {
    if value.im == 0.0 {
        return format!("{:.4}", value.re);
    }
    format!("{:.4} {} {:.4} j", value.re, if value.im < 0.0 { '-' } else { '+' }, value.im.abs())
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

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
}
