//! Time of a frame of the motion filter and of the tracker, the least of many: what `crates/python/measure.py` is compared with.
//!
//! ```text
//! cargo run --release --example filter_speed            least wall times
//! cargo run --release --example filter_speed ROUNDS     follows the recording so often and prints nothing, for processor time
//! ```
use std::error::Error;
use std::time::Instant;

use freeform_motion::curve_fit::{Outline, OutlineError};
use freeform_motion::outline_filter::{FilterSettings, MotionFilter};
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::riccati::RigidMotion;
use freeform_motion::sim_camera::{BuiltInShape, Camera, Scene, SequenceLength, Settings, Simulator};
use freeform_motion::{Tracker, TrackerSettings};
use nalgebra::Point2;

const OBJECTS: usize = 10;
const FRAMES: usize = 300;
const REPEATS: usize = 20;

fn main() -> Result<(), Box<dyn Error>> {
    let motion = RigidMotion { omega: 1.5, b1: 0.2, b2: -0.1 };
    let settings = Settings { length: SequenceLength::Frames(FRAMES), ..Settings::default() };
    let simulator = Simulator::new(Scene::new(BuiltInShape::Bird, motion, Camera::default()), settings)?;
    let frames: Vec<(f64, Vec<Point2<f64>>)> =
        simulator.frames().map(|frame| (frame.time, frame.outline.points().copied().collect())).collect();

    let rounds = std::env::args().nth(1).map(|rounds| rounds.parse::<usize>()).transpose()?;
    let mut least = f64::INFINITY;
    for _ in 0..if rounds.is_some() { 0 } else { REPEATS } {
        let mut filter = MotionFilter::new(FilterSettings::default())?;
        let (first, rest) = frames.split_at(FRAMES / 3);
        for (time, points) in first {
            filter.step(*time, &Outline::closed(points.clone())?)?;
        }
        for chunk in rest.chunks(50) {
            let start = Instant::now();
            for (time, points) in chunk {
                filter.step(*time, &Outline::closed(points.clone())?)?;
            }
            least = least.min(start.elapsed().as_secs_f64() / chunk.len() as f64);
        }
    }
    let seconds_of_steps = least;

    let recording = || -> Result<Vec<OutlineFrame>, OutlineError> {
        let all =
            frames.iter().zip(0..).flat_map(|(frame, number)| (0..OBJECTS).map(move |object| (frame, number, object)));
        all.map(|((time, points), frame, object)| {
            Ok(OutlineFrame {
                frame,
                time: *time,
                object: object.to_string(),
                outline: Outline::closed(points.clone())?,
            })
        })
        .collect()
    };
    let mut least = f64::INFINITY;
    for _ in 0..rounds.unwrap_or(REPEATS / 4) {
        let outlines = recording()?;
        let mut tracker = Tracker::new(TrackerSettings::default())?;
        let start = Instant::now();
        tracker.follow(outlines, |_| {});
        least = least.min(start.elapsed().as_secs_f64());
    }
    if rounds.is_none() {
        println!("outline of 400 points and step: {:.1} us", 1e6 * seconds_of_steps);
        println!("{OBJECTS} objects in {FRAMES} frames: {:.1} ms", 1e3 * least);
    }
    Ok(())
}
