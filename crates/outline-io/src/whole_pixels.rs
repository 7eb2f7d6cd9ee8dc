//! Whether what is seen was drawn on whole pixels: by its edges, or by how it moves.
use std::collections::HashMap;

use nalgebra::{Point2, Vector2};

use crate::picture_outlines::TracedFrame;
use crate::tracing::settings::TraceSettings;
use crate::tracing::trace::TracedOutline;

/// How far a step may be off a whole number of pixels to be one, in pixels.
const WHOLE_STEP: f64 = 0.05;

/// How many steps have to be seen at least, and what share of them has to be whole ones. A single step along the rows or columns is whole by chance
/// in one case of ten. Steps of a constant motion are all the same, and all of them whole in one of ten: they tell nothing. Those of an object that
/// is put on whole pixels at other speeds differ by a pixel now and then, as 4, 4 and 5 do, and no step that is drawn where it is does so. This is
/// demanded besides. Of steps that change by their motion, each is whole by a chance of its own, four of five in one case of two thousand.
const FEWEST_STEPS: usize = 4;
const MOST_STEPS: f64 = 0.8;

/// A step moves an object by half a pixel at least, along the rows or the columns.
const MOVES: f64 = 0.5;

/// Share of its area that an object may differ by from one picture to the next to be seen as a whole in both.
const SAME_AREA: f64 = 0.05;

/// Whether most of the edges of these pictures lie between pixels, or what moves in them moves by whole pixels, and not always by as many.
pub(crate) fn are_drawn_on(pictures: &[TracedFrame], trace: &TraceSettings) -> bool {
    let pixel = trace.pixel_grid(0).pixel_size();
    let (mut edges, mut on_pixels) = (0_usize, 0_usize);
    let (mut steps, mut whole) = (0_usize, 0_usize);
    let mut before: HashMap<u64, (Point2<f64>, f64)> = HashMap::new();
    let (mut first_steps, mut differ) = (HashMap::<u64, Vector2<f64>>::new(), false);
    for TracedFrame { objects, .. } in pictures {
        let mut seen = HashMap::new();
        for (name, TracedOutline { edges: fit, centre, area, touches_border, .. }) in objects.iter().flatten() {
            if let Some(fit) = fit {
                edges += 1;
                on_pixels += usize::from(fit.is_on_pixels());
            }
            if *touches_border {
                continue;
            }
            seen.insert(*name, (*centre, *area));
            let Some((from, area_before)) = before.get(name) else { continue };
            let step = (centre - from).component_div(&pixel);
            if step.amax() > MOVES && (area / area_before - 1.0).abs() < SAME_AREA {
                steps += 1;
                let pixels = step.map(f64::round);
                if (step - pixels).amax() < WHOLE_STEP {
                    whole += 1;
                    // What turns back goes on at its speed.
                    differ |= *first_steps.entry(*name).or_insert(pixels.abs()) != pixels.abs();
                }
            }
        }
        before = seen;
    }
    2 * on_pixels > edges || (differ && steps >= FEWEST_STEPS && whole as f64 >= MOST_STEPS * steps as f64)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use image::GrayImage;

    use super::*;
    use crate::identity::identities::Selection;
    use crate::picture_file::sequence::PictureFrame;
    use crate::picture_outlines::{PictureOutlines, PictureSettings};

    /// Grey value of an anti-aliased rectangle with a border, whose upper left corner is at a place.
    fn bordered(x: f64, y: f64, left: f64, top: f64) -> f64 {
        let covered = |low: f64, high: f64, at: f64| (high.min(at + 1.0) - low.max(at)).clamp(0.0, 1.0);
        let within = |by: f64| covered(left + by, left + 26.0 - by, x) * covered(top + by, top + 13.0 - by, y);
        100.0 - 40.0 * within(0.0) + 116.0 * within(1.0)
    }

    fn is_drawn(grey: impl Fn(f64, f64, f64) -> f64) -> bool {
        let frames = (0..8_u64).map(|frame| {
            let picture = GrayImage::from_fn(120, 60, |x, y| {
                image::Luma([grey(f64::from(x), f64::from(y), frame as f64).round() as u8])
            });
            let (time, file, picture) = (frame as f64 / 30.0, "memory".to_owned(), Arc::new(picture));
            Ok(PictureFrame { frame, time, file, picture })
        });
        let settings = PictureSettings { selection: Selection::All, ..PictureSettings::default() };
        let trace = settings.trace;
        let traced: Vec<TracedFrame> = PictureOutlines::new(frames, settings).expect("settings").flatten().collect();
        are_drawn_on(&traced, &trace)
    }

    #[test]
    fn what_is_placed_on_whole_pixels_is_told_by_its_steps_and_what_is_drawn_where_it_is_is_not() {
        let place = |k: f64| 20.0 + 4.33 * k;
        assert!(is_drawn(|x, y, k| bordered(x, y, place(k).round(), 21.0)));
        assert!(!is_drawn(|x, y, k| bordered(x, y, place(k), 21.3)));
    }

    #[test]
    fn a_constant_motion_by_nearly_whole_pixels_that_is_drawn_where_it_is_is_not_one_by_whole_pixels() {
        let place = |k: f64| 20.3 + 3.02 * k;
        assert!(!is_drawn(|x, y, k| bordered(x, y, place(k), 21.3)));
        // Nor where it turns back.
        assert!(!is_drawn(|x, y, k| bordered(x, y, place((k - 4.0).abs()), 21.3)));
    }

    #[test]
    fn edges_without_anti_aliasing_are_those_of_pixels_at_any_turn() {
        let inside = |x: f64, y: f64, k: f64| {
            let (x, y) = (x + 0.5 - 60.0, y + 0.5 - 30.0);
            let (sin, cos) = (0.3 + 0.2 * k).sin_cos();
            let (u, v) = (cos * x + sin * y, cos * y - sin * x);
            u.abs() < 20.0 && v.abs() < 9.0
        };
        let grey = |share: f64, x: f64| 60.0 + 0.2 * x.floor() + 100.0 * share;
        assert!(is_drawn(|x, y, k| grey(f64::from(u8::from(inside(x, y, k))), x)));
        let part = |i: i32| (f64::from(i) + 0.5) / 6.0 - 0.5;
        let covered = |x: f64, y: f64, k: f64| {
            let parts = (0..36).filter(|i| inside(x + part(i % 6), y + part(i / 6), k));
            parts.count() as f64 / 36.0
        };
        assert!(!is_drawn(|x, y, k| grey(covered(x, y, k), x)));
    }
}
