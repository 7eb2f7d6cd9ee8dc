//! Figures as data: panels of curves, and what each curve is drawn like.
use serde::{Deserialize, Serialize};

/// Number of colours that [`Look::Series`] and [`Look::Dashed`] tell curves apart by.
pub const SERIES: usize = 6;

/// What a curve looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Look {
    /// A solid line.
    Line,
    /// A dashed line for what is known to be true.
    Truth,
    /// A thin dashed line in the colour of the text, for what several curves of different colours are held against.
    Reference,
    /// A filled area.
    Band,
    /// Small dots.
    Dots,
    /// Crosses.
    Crosses,
    /// Lines over the whole height, for times at which something was the case; the y axis knows nothing of them.
    Marks,
    /// Pale areas over the whole height, each from the first to the last of its points; the y axis knows nothing of them.
    Spans,
    /// Smaller dots, for many points in a small panel.
    FineDots,
    /// A thin grey line, for what is only there for comparison.
    Faint,
    /// A solid line in one of the [`SERIES`] colours.
    Series(usize),
    /// A dashed line in one of the [`SERIES`] colours.
    Dashed(usize),
}

/// Points of one meaning, in one or more connected runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Stands in the legend, unless it is empty.
    pub name: String,
    /// What it looks like.
    pub look: Look,
    /// Points `[x, y]` in the units of the panel's axes.
    pub runs: Vec<Vec<[f64; 2]>>,
}

/// One pair of axes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Panel {
    /// Stands over it; may be empty.
    pub title: String,
    /// What x is, with its unit.
    pub x_label: String,
    /// What y is, with its unit.
    pub y_label: String,
    /// What is drawn, the first below the others.
    pub curves: Vec<Curve>,
    /// Where the x axis begins, if before all curves.
    pub x_from: Option<f64>,
    /// Where the x axis ends, if after all curves.
    pub x_to: Option<f64>,
    /// Lower left and upper right corner of what is to be seen, with a length drawn the same along both axes; curves are
    /// cut off at the frame. Without it, axes are as long as the curves.
    pub view: Option<[[f64; 2]; 2]>,
    /// Whether the y axis is logarithmic; only values above 0 are drawn then.
    pub y_logarithmic: bool,
    /// Lower and upper end of the y axis, if not those of the curves; what lies beyond is cut off at the frame.
    pub y_limits: Option<[f64; 2]>,
    /// Whether only title and curves are drawn, without frame, ticks and labels.
    pub is_bare: bool,
}

/// Panels of equal size, row by row.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Over all panels; none if empty.
    pub title: String,
    /// Whether one legend, over all panels, stands for all.
    pub shares_legend: bool,
    /// Its panels.
    pub panels: Vec<Panel>,
    /// Panels in a row, at least 1.
    pub columns: usize,
    /// Width and height of each panel in pixels.
    pub panel_size: [f64; 2],
}
