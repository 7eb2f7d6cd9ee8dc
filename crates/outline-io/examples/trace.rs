//! Traces the largest object of each picture and writes the outlines as CSV to standard output: `trace frames/ > outlines.csv`.
use std::error::Error;
use std::io;
use std::path::PathBuf;

use freeform_outline_io::{
    Clipping, DEFAULT_OBJECT, OutlineFrame, OutlineWriter, PictureOutlines, PictureSequence, PictureSettings,
    SequenceSettings, TraceSettings, WriterOptions,
};

fn main() -> Result<(), Box<dyn Error>> {
    let paths: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let trace = TraceSettings { clipping: Clipping::Open, ..TraceSettings::default() };
    let settings = PictureSettings { trace, ..PictureSettings::default() };
    let pictures = PictureSequence::open(&paths, SequenceSettings::default())?;
    let options = WriterOptions { arc_column: true, ..WriterOptions::default() };
    let mut writer = OutlineWriter::new(io::stdout().lock(), options)?;
    for traced in PictureOutlines::new(pictures, settings)? {
        let traced = match traced {
            Ok(traced) => traced,
            Err(error) => {
                eprintln!("{error}");
                continue;
            }
        };
        match traced.objects {
            Ok(objects) => {
                for (_, found) in objects {
                    let (frame, time, object) = (traced.frame.frame, traced.frame.time, DEFAULT_OBJECT.to_owned());
                    writer.write(&OutlineFrame { frame, time, object, outline: found.outline })?;
                }
            }
            Err(error) => eprintln!("{}: {error}", traced.frame.file),
        }
    }
    writer.flush()?;
    Ok(())
}
