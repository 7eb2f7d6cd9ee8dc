//! What tracing the pictures of a folder costs, their reading left out: time of a picture on one core, the least of several rounds, for every
//! way of tracing; or of one way alone, to count its instructions.
//!
//! ```text
//! freeform simulate --pictures frames --scene gear
//! cargo run --release -p freeform-outline-io --example trace_cost -- frames
//! valgrind --tool=callgrind --toggle-collect='*trace_cost*traced*' target/release/examples/trace_cost frames ring-dark
//! ```
use std::error::Error;
use std::time::Instant;

use freeform_outline_io::{
    Background, Clipping, Contrast, PictureFrame, PictureOutlines, PictureSequence, PictureSettings, Ring,
    SequenceSettings, TraceSettings, picture_files,
};

/// Rounds of which the fastest counts.
const ROUNDS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("usage: trace_cost FOLDER [WAY]")?;
    let wanted = arguments.next();
    let files = picture_files(folder.as_ref())?;
    let pictures: Vec<PictureFrame> =
        PictureSequence::open(&files, SequenceSettings::default())?.collect::<Result<_, _>>()?;
    for (name, settings) in ways() {
        match &wanted {
            Some(wanted) if *wanted == name => println!("{} points", traced(&pictures, &settings)?),
            Some(_) => {}
            None => {
                let (mut least, mut points) = (f64::INFINITY, 0);
                for _ in 0..ROUNDS {
                    let began = Instant::now();
                    points = traced(&pictures, &settings)?;
                    least = least.min(began.elapsed().as_secs_f64());
                }
                let count = pictures.len() as f64;
                println!("{name}: {:.2} ms a picture, {:.0} points", 1e3 * least / count, points as f64 / count);
            }
        }
    }
    Ok(())
}

fn ways() -> [(&'static str, PictureSettings); 5] {
    let with = |contrast, ring, background| {
        let clipping = Clipping::Open;
        let trace = TraceSettings { contrast, ring, clipping, ..TraceSettings::default() };
        PictureSettings { trace, background, ..PictureSettings::default() }
    };
    let ring = |contrast| Some(Ring { contrast, width: None });
    let (light, dark) = (Contrast::LightOnDark, Contrast::DarkOnLight);
    [
        ("light", with(light, None, None)),
        ("dark", with(dark, None, None)),
        ("surface", with(light, None, Some(Background::Surface))),
        ("ring-light", with(light, ring(light), None)),
        ("ring-dark", with(light, ring(dark), None)),
    ]
}

/// Points of all outlines.
#[inline(never)]
fn traced(pictures: &[PictureFrame], settings: &PictureSettings) -> Result<usize, Box<dyn Error>> {
    let frames = pictures.iter().cloned().map(Ok);
    let mut points = 0;
    for traced in PictureOutlines::new(frames, settings.clone())? {
        let objects = traced?.objects.unwrap_or_default();
        points += objects.iter().map(|(_, found)| found.outline.point_count()).sum::<usize>();
    }
    Ok(points)
}
