//! From pictures to motion in a loop of one's own: `cargo run --release --example pictures_to_motion -- frames/`.
use std::collections::HashMap;
use std::path::PathBuf;

use freeform_motion::identify::{FilterSettings, MotionFilter};
use freeform_motion::outline_io::{
    Clipping, PictureOutlines, PictureSequence, PictureSettings, Selection, SequenceSettings, TraceSettings,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let paths: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let pictures = PictureSequence::open(&paths, SequenceSettings::default())?;
    let trace = TraceSettings { clipping: Clipping::Open, minimum_area: 100, ..TraceSettings::default() };
    let settings = PictureSettings { trace, selection: Selection::All, ..PictureSettings::default() };
    let mut filters: HashMap<u64, MotionFilter> = HashMap::new();
    for traced in PictureOutlines::new(pictures, settings)? {
        // What is wrong with one picture does not end the sequence.
        let traced = match traced {
            Ok(traced) => traced,
            Err(error) => {
                eprintln!("{error}");
                continue;
            }
        };
        let time = traced.frame.time;
        match traced.objects {
            Err(error) => eprintln!("{}: {error}", traced.frame.file),
            Ok(objects) => {
                for (name, object) in objects {
                    let filter = match filters.entry(name) {
                        std::collections::hash_map::Entry::Occupied(entry) => entry.into_mut(),
                        std::collections::hash_map::Entry::Vacant(entry) => {
                            entry.insert(MotionFilter::new(FilterSettings::default())?)
                        }
                    };
                    let step = filter.step(time, &object.outline)?;
                    println!("{time:.3} s, object {name}: {:?}, {:?}", step.phase, filter.estimate());
                }
            }
        }
    }
    Ok(())
}
