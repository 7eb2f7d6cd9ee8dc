//! Steps of the motion filter in the first frames of recordings, to count what each of them costs in instructions, without or with calls of `prepare`
//! between frames. Each leaves a file whose line `totals:` is the count, in their order.
//!
//! ```text
//! cargo build --release --example step_cost
//! step=freeform_outline_filter::supervisor::motion_filter::MotionFilter::step
//! valgrind --tool=callgrind --toggle-collect=$step --dump-after=$step target/release/examples/step_cost changing 30 64 calls
//! ```
use std::error::Error;

use freeform_motion::outline_filter::{FilterSettings, MotionFilter};

#[path = "../benches/recordings/mod.rs"]
mod recordings;

fn main() -> Result<(), Box<dyn Error>> {
    let usage = "usage: step_cost changing|thrown RECORDINGS FRAMES [calls]";
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [kind, numbers, frames, rest @ ..] = arguments.as_slice() else { return Err(usage.into()) };
    let recording = match kind.as_str() {
        "changing" => recordings::recording,
        "thrown" => recordings::thrown,
        _ => return Err(usage.into()),
    };
    let is_called = rest.first().is_some_and(|argument| argument == "calls");
    for number in 0..numbers.parse()? {
        let mut filter = MotionFilter::new(FilterSettings::default())?;
        for (time, outline) in recording(number).iter().take(frames.parse()?) {
            filter.step(*time, outline)?;
            while is_called && filter.prepare() {}
        }
    }
    Ok(())
}
