//! Traces the largest object of each picture and writes the outlines as CSV to standard output, one frame per picture,
//! 30 frames per second: `trace mask-0000.png mask-0001.png > outlines.csv`.
use std::error::Error;
use std::io;

use freeform_outline_io::{
    Clipping, DEFAULT_OBJECT, OutlineFrame, OutlineWriter, TraceSettings, WriterOptions, read_picture, trace_mask,
};

fn main() -> Result<(), Box<dyn Error>> {
    let settings = TraceSettings { clipping: Clipping::Open, ..TraceSettings::default() };
    let options = WriterOptions { arc_column: true, ..WriterOptions::default() };
    let mut writer = OutlineWriter::new(io::stdout().lock(), options)?;
    for (frame, path) in (0..).zip(std::env::args().skip(1)) {
        match trace_mask(&read_picture(&path)?, &settings) {
            Ok(traced) => {
                let (time, object) = (frame as f64 / 30.0, DEFAULT_OBJECT.to_owned());
                writer.write(&OutlineFrame { frame, time, object, outline: traced.outline })?;
            }
            Err(error) => eprintln!("{path}: {error}"),
        }
    }
    writer.flush()?;
    Ok(())
}
