//! Outlines, their quartics and paths as curves of a panel.
use freeform_curve_fit::{Fit, FitSettings, Fitter, Outline, Rectangle};
use nalgebra::Point2;

use crate::ExperimentError;
use crate::figure::{Curve, Look, Panel};
use freeform_drawing::page::Table;

/// What is looked through for a curve around its points, as a share of their extent.
const SURROUNDINGS: f64 = 0.3;

/// Points of a curve within this share of the extent of the outline are near it.
const NEAR: f64 = 0.1;

/// The closed-bounded quartic of an outline, as `freeform fit` makes it.
pub(super) fn closed_quartic(outline: &Outline) -> Result<Fit, ExperimentError> {
    let mut fitter = Fitter::new(FitSettings::default())?;
    Ok(fitter.fit(outline)?)
}

/// A fitted curve as it is drawn.
pub(super) struct DrawnCurve {
    pub(super) runs: Vec<Vec<[f64; 2]>>,
    /// Whether there are further ovals, away from the points, which are left out.
    pub(super) has_far_ovals: bool,
}

/// The ovals of a fit that the points lie along.
pub(super) fn curve_near(fit: &Fit, outline: &Outline) -> DrawnCurve {
    let area = outline.bounding_box();
    let near = NEAR * area.size().max();
    let is_near = |p: &Point2<f64>| outline.points().any(|q| (p - q).norm() < near);
    let (near, far): (Vec<_>, Vec<_>) =
        fit.curve_within(&area.widened(SURROUNDINGS)).into_iter().partition(|run| run.iter().any(is_near));
    DrawnCurve { runs: near.iter().map(|run| run.iter().map(xy).collect()).collect(), has_far_ovals: !far.is_empty() }
}

/// What a caption says of ovals that are left out.
pub(super) const FAR_OVALS: &str = " A quartic may be more than one oval: one that lies away from the points is not drawn, \
                                    here for";

/// All points of an outline as one run.
pub(super) fn points_of(outline: &Outline) -> Vec<[f64; 2]> {
    outline.points().map(xy).collect()
}

pub(super) fn xy(p: &Point2<f64>) -> [f64; 2] {
    [p.x, p.y]
}

pub(super) fn curve(name: &str, look: Look, runs: Vec<Vec<[f64; 2]>>) -> Curve {
    Curve { name: name.to_owned(), look, runs }
}

/// A panel of the image plane.
pub(super) fn image_panel(title: String, view: &Rectangle, curves: Vec<Curve>) -> Panel {
    Panel {
        title,
        x_label: "x (image lengths)".to_owned(),
        y_label: "y (image lengths)".to_owned(),
        curves,
        view: Some([xy(&view.low), xy(&view.high)]),
        ..Panel::default()
    }
}

/// The points of all curves of panels: which panel, which curve, which of its runs, x and y.
pub(super) fn data_of(panels: &[Panel]) -> Table {
    let mut data = Table::of_data(&["panel", "curve", "run", "x", "y"]);
    for panel in panels {
        for curve in &panel.curves {
            for (run, points) in curve.runs.iter().enumerate() {
                points.iter().for_each(|[x, y]| {
                    let place = [&panel.title, &curve.name, &run.to_string()];
                    data.push(&place.map(String::as_str), &[*x, *y]);
                });
            }
        }
    }
    data
}
