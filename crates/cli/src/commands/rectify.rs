use std::io::Write as _;
use std::path::Path;

use freeform_motion::curve_fit::Outline;
use freeform_motion::outline_io::read_shape;
use freeform_motion::plane_by_outline;
use freeform_motion::riccati::homography;
use nalgebra::Projective2;

use crate::args::RectifyArgs;
use crate::awaited::Waiting;
use crate::failure::{Failure, warn, warn_of};
use crate::input::Input;
use crate::left_out::MissingWarnings;
use crate::output::{Sink, refuse_overwriting, refuse_standard_output};
use crate::progress::Verbosity;
use crate::seen::Item;

/// Most outlines of an object at rest that are read; more would not tell more.
const MOST_SEEN: usize = 1000;

/// Finds the map from a picture to a plane.
pub(crate) fn run(args: &RectifyArgs) -> Result<(), Failure> {
    let (map, by) = match &args.known {
        Some(known) => of_outline(args, known)?,
        None => of_points(args)?,
    };
    let mut sink = Sink::stdout();
    let mut text = format!("# map from the picture to the plane{by}");
    for row in map.matrix().row_iter() {
        text.push_str(&format!("\n{} {} {}", row[0], row[1], row[2]));
    }
    writeln!(sink, "{text}").map_err(|error| sink.failure(&error))?;
    sink.finish()
}

/// The map, and what it comes from if that has errors.
fn of_points(args: &RectifyArgs) -> Result<(Projective2<f64>, String), Failure> {
    if let [option, ..] = args.pictures.given()[..] {
        return Err(Failure::unusable(format_args!("{option} is for --seen, not for points")));
    }
    let map = homography(&args.points).map_err(Failure::unusable)?;
    let squares = args.points.iter().map(|(picture, plane)| (map * picture - plane).norm_squared());
    let off = (squares.sum::<f64>() / args.points.len() as f64).sqrt();
    let is_more = args.points.len() > 4;
    let by =
        if is_more { format!("; {} points, off by {off:.3e} in the plane", args.points.len()) } else { String::new() };
    Ok((map, by))
}

fn of_outline(args: &RectifyArgs, known: &Path) -> Result<(Projective2<f64>, String), Failure> {
    let candidates: Vec<_> = args.pictures.candidates.iter().map(AsRef::as_ref).collect();
    let read = [args.pictures.files_read(&args.seen), vec![known.to_owned()]].concat();
    refuse_overwriting(&read, &candidates)?;
    refuse_standard_output(&candidates)?;
    let known = read_shape(known).map_err(Failure::unusable)?;
    let mut input = Input::open(&args.seen, &args.pictures, Waiting::Allowed, Verbosity::Usual)?;
    let name = input.name.clone();
    input.tell_tracing();
    let (mut seen, mut object, mut warnings) = (Vec::<Outline>::new(), None::<String>, MissingWarnings::default());
    while let Some(item) = input.next() {
        input.news().iter().for_each(|(warning, message)| warn_of(warning.code(), message));
        match item? {
            Item::Outline(frame, _) => {
                let first = object.get_or_insert_with(|| frame.object.clone());
                if *first != frame.object {
                    let more =
                        format_args!("{name}: objects {first:?} and {:?}, where one at rest is wanted", frame.object);
                    return Err(Failure::unusable(more));
                }
                seen.push(frame.outline);
            }
            Item::NoOutline { reason, .. } => warn(&reason),
            Item::Gap(missing) => warnings.take(&missing).into_iter().for_each(|reason| warn(&reason)),
        }
        if seen.len() >= MOST_SEEN {
            break;
        }
    }
    warnings.finish().for_each(|reason| warn(&reason));
    let found = plane_by_outline(&known, &seen).map_err(|error| Failure::no_result(format_args!("{name}: {error}")))?;
    let points: usize = seen.iter().map(Outline::point_count).sum();
    let by = format!("; {points} points of {} outline(s), off by {:.3e} in the plane", seen.len(), found.distance);
    Ok((found.plane_from_picture, by))
}
