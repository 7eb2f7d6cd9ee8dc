//! Frames of the motion filter and nothing else, to count what a frame costs in instructions: a bird in rigid motion, without noise beyond
//! that of its camera. What the frames from 300 to 900 cost is the difference of two runs, divided by 600.
//!
//! ```text
//! cargo build --release --example frame_cost
//! for frames in 300 900; do
//!     valgrind --tool=callgrind --toggle-collect='*MotionFilter*step*' target/release/examples/frame_cost rigid 400 $frames
//! done
//! ```
use std::error::Error;

use freeform_motion::{
    outline_filter::{FilterSettings, MotionFilter},
    riccati::MotionModel,
    sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator},
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut next = || arguments.next().ok_or("usage: frame_cost MODEL POINTS FRAMES");
    let name = next()?;
    let model = MotionModel::ALL.into_iter().find(|model| model.to_string() == name).ok_or("no such model")?;
    let (points, frames) = (next()?.parse()?, next()?.parse()?);
    let scene = PaperExperiment::FLIGHT_BIRD.scene(PaperExperiment::SCALE)?;
    let settings = Settings { points, length: SequenceLength::Frames(frames), ..Settings::default() };
    let mut filter = MotionFilter::new(FilterSettings { model, ..FilterSettings::default() })?;
    for frame in Simulator::new(scene, settings)?.frames() {
        filter.step(frame.time, &frame.outline)?;
    }
    Ok(())
}
