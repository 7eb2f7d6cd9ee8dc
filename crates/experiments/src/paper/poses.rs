//! Figs. 3, 5 and 7: the objects along their motion.
use std::fmt::Write as _;

use freeform_curve_fit::{FitSettings, Fitter, Rectangle};
use freeform_motion::PipelineSettings;
use freeform_sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
use nalgebra::Point2;

use super::Run;
use super::curves::{FAR_OVALS, closed_quartic, curve, curve_near, data_of, image_panel, points_of, xy};
use super::document::Section;
use super::method::fit_in_words;
use super::paper_figure::PaperFigure;
use super::sequence::{POINTS, paper_settings};
use crate::ExperimentError;
use crate::figure::{Figure, Look};
use freeform_drawing::page::Drawing;

/// Moments shown of one turn.
const MOMENTS: usize = 6;

/// Points of the path of the object's centre.
const PATH_POINTS: usize = 120;

pub(super) fn section(run: &Run, figures: &[PaperFigure]) -> Result<Section, ExperimentError> {
    let drawings = figures.iter().map(|figure| drawing(run, figure)).collect::<Result<Vec<_>, _>>()?;
    let heading = figures.first().map_or("", |figure| figure.poses_heading);
    Ok(Section { heading: heading.to_owned(), drawings, ..Section::default() })
}

fn drawing(run: &Run, figure: &PaperFigure) -> Result<Drawing, ExperimentError> {
    let PaperFigure { poses, experiment, .. } = figure;
    let scene = experiment.scene(PaperExperiment::SCALE)?;
    let turn = std::f64::consts::TAU / experiment.motion.omega.abs();
    let settings = Settings {
        fps: MOMENTS as f64 / turn,
        length: SequenceLength::Frames(MOMENTS),
        ..paper_settings(turn, run.seed)
    };
    let centre = |k: usize| scene.true_pose(turn * k as f64 / PATH_POINTS as f64) * Point2::origin();
    let path: Vec<_> = (0..=PATH_POINTS).map(|k| xy(&centre(k))).collect();
    let start: Vec<_> = scene.true_outline(0.0, POINTS);
    let start_run = start.iter().chain(start.first()).map(xy).collect::<Vec<_>>();
    let frames: Vec<_> = Simulator::new(scene, settings)?.frames().collect();
    let all = frames.iter().flat_map(|frame| frame.outline.points());
    let origin = Rectangle { low: Point2::origin(), high: Point2::origin() };
    let whole = Rectangle::around(all.chain(&start)).unwrap_or(origin);
    let view = whole.widened(0.05).square();

    // The curves that the motion is identified from.
    let mut fitter = Fitter::new(PipelineSettings::default().fit)?;
    let (mut panels, mut with_far_ovals) = (Vec::new(), 0);
    for frame in &frames {
        let fit = closed_quartic(&frame.outline)?;
        let rounder = fitter.fit(&frame.outline)?;
        let drawn = curve_near(&fit, &frame.outline);
        with_far_ovals += usize::from(drawn.has_far_ovals);
        let curves = vec![
            curve("outline at the start", Look::Faint, vec![start_run.clone()]),
            curve("path of the centre", Look::Dashed(1), vec![path.clone()]),
            curve("points", Look::FineDots, vec![points_of(&frame.outline)]),
            curve("rounder quartic, for its lines", Look::Series(2), curve_near(&rounder, &frame.outline).runs),
            curve("close quartic, for its shape", Look::Line, drawn.runs),
        ];
        panels.push(image_panel(format!("t = {:.2} s", frame.time), &view, curves));
    }
    run.advance();
    Ok(Drawing {
        name: (*poses).to_owned(),
        caption: caption(figure, turn, with_far_ovals),
        data: data_of(&panels),
        figure: Figure {
            title: format!("One turn of the {}", experiment.title),
            shares_legend: true,
            panels,
            columns: 3,
            panel_size: [330.0, 340.0],
        },
    })
}

/// Of a turn that takes so many seconds, with so many moments that have far ovals.
fn caption(figure: &PaperFigure, turn: f64, with_far_ovals: usize) -> String {
    let experiment = &figure.experiment;
    let motion = experiment.motion;
    let mut caption = format!(
        "Fig. {}, {}. {MOMENTS} moments of one turn ({turn:.2} s) of the rigid motion omega = {:.4} rad/s, b = ({}, {}) \
         in space, seen at f/Z0 = {} (positive omega turns clockwise). Grey points: the outline with noise {}; thin grey: the true outline \
         at the start; dashed: the path of the object's centre. Both curves are closed and bounded quartics. Blue, close: \
         the one that follows the outline best ({}). Green, rounder: the one whose lines Fig. {} is identified from \
         ({}); it is worse as a drawing, and its lines are calmer. Object, size in the image (1) and f/Z0 are \
         this project's choice: the paper gives none of them.{}",
        figure.poses_number(),
        experiment.title,
        motion.omega,
        motion.b1,
        motion.b2,
        PaperExperiment::SCALE,
        PaperExperiment::NOISE,
        fit_in_words(&FitSettings::default()),
        figure.number(),
        fit_in_words(&PipelineSettings::default().fit),
        figure.reading,
    );
    if with_far_ovals > 0 {
        let _ = write!(caption, "{FAR_OVALS} {with_far_ovals} of the moments.");
    }
    caption
}
