//! Figures as SVG: panels with axes, ticks at round numbers and a legend above the data.
mod legend;
mod panel;
mod style;
mod ticks;

pub(crate) use style::{Svg, escape, panel_svg, stacked_svg};
