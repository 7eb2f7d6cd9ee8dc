//! Fig. 1: the ten objects and their quartics.
use freeform_curve_fit::{FitSettings, Rectangle};
use freeform_riccati::AffineMotion;
use freeform_sim_camera::{BuiltInShape, Camera, PaperExperiment, Scene, SequenceLength, Settings};
use nalgebra::Vector2;

use super::Run;
use super::curves::{FAR_OVALS, closed_quartic, curve, curve_near, data_of, image_panel, points_of};
use super::document::Section;
use super::method::fit_in_words;
use super::sequence::{POINTS, Sequence, paper_settings};
use crate::ExperimentError;
use crate::figure::{Figure, Look, Panel};
use freeform_drawing::page::{Drawing, Table};
use freeform_motion::significant;

/// Half the side of each picture in image lengths; the objects are of size 1.
const HALF_VIEW: f64 = 0.55;

pub(super) fn section(run: &Run) -> Result<Section, ExperimentError> {
    let (mut panels, mut with_far_ovals) = (Vec::new(), Vec::new());
    let mut distances = Table {
        name: "fig1-fits".to_owned(),
        title: "Distance of the points from the quartics of Fig. 1".to_owned(),
        caption: format!(
            "Root mean square first-order distance (Taubin 1991) in units of the object's size, with noise {} in it. The \
             margin is the smallest value of the leading form on the unit circle over its root mean square: the curve is \
             closed and bounded where it is positive. (That of the constraint is in units of what that root mean square \
             is without it.)",
            PaperExperiment::NOISE
        ),
        ..Table::of_data(&["object", "distance", "margin"])
    };
    for shape in BuiltInShape::FIGURE_1 {
        let camera = Camera::new(PaperExperiment::SCALE)?;
        let settings = Settings { length: SequenceLength::Frames(1), ..paper_settings(1.0, run.seed) };
        let sequence = Sequence::simulate(Scene::new(shape, AffineMotion::default(), camera), settings)?;
        let Some((_, outline)) = sequence.frames.first() else { continue };
        let fit = closed_quartic(outline)?;
        let drawn = curve_near(&fit, outline);
        if drawn.has_far_ovals {
            with_far_ovals.push(title(shape).to_lowercase());
        }
        // All objects to the same scale.
        let middle = outline.bounding_box().centre();
        let half = Vector2::repeat(HALF_VIEW);
        let view = Rectangle { low: middle - half, high: middle + half };
        let curves =
            vec![curve("points", Look::FineDots, vec![points_of(outline)]), curve("quartic", Look::Line, drawn.runs)];
        panels.push(Panel { is_bare: true, ..image_panel(title(shape), &view, curves) });
        let diagnostics = fit.diagnostics();
        let row = [diagnostics.geometric_residual, diagnostics.boundedness_margin];
        let numbers = row.map(|value| significant(value, 2));
        distances.rows.push(std::iter::once(title(shape)).chain(numbers).collect());
        run.advance();
    }
    let drawing = drawing(panels, &with_far_ovals);
    Ok(Section {
        heading: "Fig. 1: free-form objects and their quartics".to_owned(),
        text: String::new(),
        drawings: vec![drawing],
        tables: vec![distances],
        findings: Vec::new(),
    })
}

fn drawing(panels: Vec<Panel>, with_far_ovals: &[String]) -> Drawing {
    let fit_settings = FitSettings::default();
    Drawing {
        name: "fig1".to_owned(),
        caption: format!(
            "Fig. 1. Outlines of ten objects (grey: {POINTS} points each, noise {} on objects of size 1) with their \
             closed-bounded quartics (blue), in the order of the paper. The drawings are this project's own; the paper's are \
             known only by name. Each quartic is fitted by {}: its leading form is held positive, so that it is closed and \
             bounded by construction. A quartic has {} free numbers: it follows a car, not its wheels.",
            PaperExperiment::NOISE,
            fit_in_words(&fit_settings),
            fit_settings.degree.coefficient_count() - 1
        ) + &if with_far_ovals.is_empty() {
            String::new()
        } else {
            format!("{FAR_OVALS} {}.", with_far_ovals.join(", "))
        },
        data: data_of(&panels),
        figure: Figure {
            title: "Outlines of ten objects and their closed-bounded quartics".to_owned(),
            shares_legend: true,
            panels,
            columns: 5,
            panel_size: [190.0, 212.0],
        },
    }
}

fn title(shape: BuiltInShape) -> String {
    match shape {
        BuiltInShape::Plane => "Plane",
        BuiltInShape::Van => "Van",
        BuiltInShape::GlassVase => "Glass vase",
        BuiltInShape::CdBox => "CD box",
        BuiltInShape::Shoe => "Shoe",
        BuiltInShape::Car => "Car",
        BuiltInShape::Vase => "Vase",
        BuiltInShape::Glider => "Glider",
        BuiltInShape::Phone => "Cellular phone",
        BuiltInShape::Hat => "Hat",
        other => other.name(),
    }
    .to_owned()
}
