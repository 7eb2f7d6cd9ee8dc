//! What choosing how the pictures of a folder are traced costs: time to read its sample, and to choose, the least of several rounds.
//!
//! ```text
//! freeform simulate --pictures frames --scene belt
//! cargo run --release -p freeform-outline-io --example choice_cost -- frames
//! ```
use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use freeform_outline_io::{
    Channel, PicturePreview, PictureSequence, PictureSettings, SequenceSettings, TraceSettings, choose_tracing,
};

/// Rounds of which the fastest counts.
const ROUNDS: usize = 5;

/// The smallest area that is an object to the program.
const SMALLEST_AREA: u64 = 64;

fn main() -> Result<(), Box<dyn Error>> {
    let paths = [PathBuf::from(std::env::args().nth(1).ok_or("usage: choice_cost FOLDER")?)];
    let sequence = PictureSequence::open(&paths, SequenceSettings::default())?;
    let preview = PicturePreview::of_paths(&paths, &sequence);
    let channels = [Channel::Luminance, Channel::Red, Channel::Green, Channel::Blue, Channel::Saturation];
    let trace = TraceSettings { minimum_area: SMALLEST_AREA, ..TraceSettings::default() };
    let base = PictureSettings { trace, ..PictureSettings::default() };
    let (mut reading, mut choosing, mut best) = (f64::INFINITY, f64::INFINITY, None);
    for _ in 0..ROUNDS {
        let began = Instant::now();
        let sample = preview.sample(&channels);
        let read = Instant::now();
        let choice = choose_tracing(&sample, &base, &[]);
        let chosen = Instant::now();
        reading = reading.min((read - began).as_secs_f64());
        choosing = choosing.min((chosen - read).as_secs_f64());
        best = choice.best().cloned();
    }
    println!(
        "{:.0} ms to read, {:.0} ms to choose: {:?}",
        1e3 * reading,
        1e3 * choosing,
        best.map(|best| best.tracing)
    );
    Ok(())
}
