//! Test pictures of moving bodies.
use std::fs;
use std::path::Path;

use freeform_motion::sim_camera::{BodyTruth, Rendering, SimulatedPicture, SimulatedPictures};
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder as _};

use crate::args::SimulateArgs;
use crate::command_line::command_line;
use crate::failure::{Failure, plain};
use crate::output::WholeFile;
use crate::progress::Progress;

/// Length of a sequence of pictures where none is given, in seconds.
const SECONDS: f64 = 2.0;

/// Writes the pictures of a scene, and where the bodies in them are.
pub(super) fn write_pictures(args: &SimulateArgs, folder: &Path) -> Result<(), Failure> {
    let seconds = args.seconds.unwrap_or(SECONDS);
    let pictures = SimulatedPictures::new(args.scene, args.seed, args.fps, seconds).map_err(Failure::unusable)?;
    let rendering = Rendering { exposure: args.exposure, gamma: args.gamma, ..pictures.rendering() };
    let pictures = pictures.with_rendering(rendering).map_err(Failure::unusable)?;
    let failed = |error: &std::io::Error| Failure::unusable(format_args!("{}: {}", folder.display(), plain(error)));
    fs::create_dir_all(folder).map_err(|error| failed(&error))?;
    if fs::read_dir(folder).map_err(|error| failed(&error))?.next().is_some() {
        let reason = "not empty, pictures go into a new or an empty folder";
        return Err(Failure::unusable(format_args!("{}: {reason}", folder.display())));
    }
    let mut truth = format!(
        "# {}\nframe,time,object,x,y,angle,omega,v1,v2,whole,seen,first_frame,first_x,first_y\n",
        command_line()
    );
    let mut first_whole: Vec<Option<(usize, [f64; 2])>> = Vec::new();
    let progress = Progress::of_frames(Some(pictures.len() as u64), false);
    for picture in pictures.iter() {
        let extension = if args.jpeg.is_some() { "jpg" } else { "png" };
        let path = folder.join(format!("{:06}.{extension}", picture.index));
        let bytes = encoded(&picture, pictures.rendering().size, args.jpeg);
        let bytes = bytes.map_err(|error| Failure::unusable(format_args!("{}: {error}", path.display())))?;
        WholeFile::write_bytes(&path, &bytes)?;
        for (object, body) in picture.bodies.iter().enumerate() {
            let BodyTruth { middle: [x, y], angle, omega, velocity: [v1, v2], is_whole, is_seen } = body;
            let SimulatedPicture { index, time, .. } = picture;
            if first_whole.len() <= object {
                first_whole.resize(object + 1, None);
            }
            if *is_whole && *is_seen {
                first_whole[object].get_or_insert((index, body.middle));
            }
            let first =
                first_whole[object].map_or_else(|| ",,".to_owned(), |(frame, [x, y])| format!("{frame},{x},{y}"));
            truth +=
                &format!("{index},{time},{object},{x},{y},{angle},{omega},{v1},{v2},{is_whole},{is_seen},{first}\n");
        }
        progress.advance();
    }
    WholeFile::write(&folder.join("truth.csv"), &truth)
}

fn encoded(picture: &SimulatedPicture, size: [usize; 2], jpeg: Option<u8>) -> Result<Vec<u8>, image::ImageError> {
    let [width, height] = size.map(|size| size as u32);
    let (mut bytes, grey) = (Vec::new(), ExtendedColorType::L8);
    match jpeg {
        Some(quality) => {
            JpegEncoder::new_with_quality(&mut bytes, quality).write_image(&picture.grey, width, height, grey)?;
        }
        None => PngEncoder::new(&mut bytes).write_image(&picture.grey, width, height, grey)?,
    }
    Ok(bytes)
}
