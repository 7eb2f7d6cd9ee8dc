//! Bodies of flat grey values that one threshold leaves out.
use image::{GrayImage, Luma};

use crate::identity::identities::OBJECT_LIMIT;
use crate::tracing::object_mask::{ObjectMask, Objects};
use crate::tracing::settings::TraceSettings;
use crate::tracing::trace::trace_objects;

/// Share of a picture that has the grey value of its ground, and of a body that has its own: drawn pictures, and no photographs.
const LEAST_OF_GROUND: f64 = 0.4;
const LEAST_OF_BODY: f64 = 0.5;

/// Grey values up to which a pixel is ground: edges are smoothed.
const GROUND: u8 = 4;

/// A body is another than the one that stands out most where it differs from the ground by less than this share of what that does, or to the
/// other side.
const UNLIKE: f64 = 0.5;

/// Difference from the ground, in grey values, by which the bodies of a drawn picture are told from it where the settings leave some of them out, as
/// bodies are of quite different grey values; `None` where they do not, or the picture is no drawing.
pub(crate) fn level_of_missed(picture: &GrayImage, trace: &TraceSettings) -> Option<f64> {
    let (ground, share) = most_frequent(picture.as_raw().iter().copied())?;
    if share < LEAST_OF_GROUND {
        return None;
    }
    let (width, height) = picture.dimensions();
    let is_body = |x: u32, y: u32| picture.get_pixel(x, y).0[0].abs_diff(ground) > GROUND;
    let differs = GrayImage::from_fn(width, height, |x, y| Luma([if is_body(x, y) { u8::MAX } else { 0 }]));
    let bodies = Objects::of(&differs, |value| value == u8::MAX, trace.minimum_area, OBJECT_LIMIT).ok()?;
    let difference = |body: ObjectMask| {
        let (value, share) = most_frequent(values_of(&body, picture))?;
        (share >= LEAST_OF_BODY).then(|| f64::from(value) - f64::from(ground))
    };
    let differences: Vec<f64> = bodies.into_masks(0).map(difference).collect::<Option<_>>()?;
    let most = differences.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let least = differences.iter().map(|difference| difference.abs()).fold(f64::INFINITY, f64::min);
    let is_unlike = |difference: &f64| difference * most.signum() < UNLIKE * most.abs();
    let found = trace_objects(picture, trace, OBJECT_LIMIT).map_or(0, |traced| traced.len());
    (differences.iter().any(is_unlike) && found < differences.len()).then_some(0.5 * least)
}

/// The grey values of a body, with those in its holes.
fn values_of<'a>(body: &'a ObjectMask, picture: &'a GrayImage) -> impl Iterator<Item = u8> + 'a {
    let place = |index: usize| (body.left + index % body.width, body.top + index / body.width);
    let inside = body.filled.iter().enumerate().filter(|(_, filled)| **filled);
    inside.map(move |(index, _)| place(index)).map(|(x, y)| picture.get_pixel(x as u32, y as u32).0[0])
}

/// The most frequent of some values, and its share.
fn most_frequent(values: impl Iterator<Item = u8>) -> Option<(u8, f64)> {
    let mut counts = [0_u64; 256];
    values.for_each(|value| counts[usize::from(value)] += 1);
    let all: u64 = counts.iter().sum();
    let (value, count) = (0..=u8::MAX).zip(counts).max_by_key(|(_, count)| *count)?;
    (all > 0).then(|| (value, count as f64 / all as f64))
}
