//! Shows how the ways of tracing do on the pictures of a folder: `cargo run --example choose -- FOLDER`.
use freeform_outline_io::{
    Channel, PictureFrame, PictureSample, PictureSequence, PictureSettings, SamplePlan, SequenceSettings,
    TraceSettings, choose_tracing, picture_files,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("which folder?")?;
    let files = picture_files(folder.as_ref())?;
    let frames = SamplePlan::Spread(files.len() as u64).frames();
    let channels = [Channel::Luminance, Channel::Red, Channel::Green, Channel::Blue, Channel::Saturation];
    let started = std::time::Instant::now();
    let sample = PictureSample::read(&channels, |channel| {
        let settings = SequenceSettings { frames_per_second: None, channel };
        let files = &files;
        Some(frames.iter().filter_map(move |&frame| {
            let picture = PictureSequence::open(&[files[frame as usize].clone()], settings).ok()?.next()?;
            Some(picture.map(|picture| PictureFrame { frame, ..picture }))
        }))
    });
    let read = started.elapsed();
    let base = PictureSettings {
        trace: TraceSettings { minimum_area: 64, ..TraceSettings::default() },
        ..PictureSettings::default()
    };
    let choice = choose_tracing(&sample, &base, &[]);
    println!(
        "read in {read:?}, chosen in {:?}; transfer function {:?}; warnings: {:?}",
        started.elapsed() - read,
        choice.transfer,
        choice.warnings().collect::<Vec<_>>()
    );
    println!("score found steady even contrast smooth moved rests clipped area objects");
    for c in choice.candidates.iter().take(14) {
        println!(
            "{:.3} {:2}/{:2} {:.2} {:.2} {:.2} {:.2} {:6.1} {} {:.2} {:.3} {} {:?}",
            c.score,
            c.found,
            c.pictures,
            c.steadiness,
            c.evenness,
            c.contrast,
            c.smoothness,
            c.movement,
            u8::from(c.rests),
            c.clipped,
            c.area_share,
            c.objects,
            c.tracing
        );
    }
    Ok(())
}
