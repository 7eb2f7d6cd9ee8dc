//! Figures as SVG: panels with axes, ticks at round numbers and a legend above the data.
mod legend;
mod panel;
mod style;
mod ticks;

pub(crate) use panel::{Curve, Look, Panel};
pub(crate) use style::{Figure, escape, panel_svg, stacked_svg};
