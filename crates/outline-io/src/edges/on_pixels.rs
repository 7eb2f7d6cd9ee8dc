//! Whether edges lie between pixels, as those of what is drawn without anti-aliasing do.
use freeform_curve_fit::isoline::Crossing;
use image::GrayImage;

use super::SMALLEST_STEP;

/// Pixels that are looked at across an edge: the two that it lies between by the line, and one more to either side, as a smoothed line may lie
/// beside it.
const ACROSS: usize = 4;

/// Share of what the grey values across an edge differ by that two pixels beside each other differ by where the edge lies between them: a sharp edge
/// that covers pixels in part has this with one in five at random places, and blurred by 0.3 pixels 0.8 of it at most.
const BETWEEN_PIXELS: f64 = 0.9;

/// Share of the points of a closed line of crossings, given from the left upper pixel of a window, whose edge lies between two pixels.
pub(super) fn share(picture: &GrayImage, line: &[Crossing], place: [usize; 2]) -> f64 {
    let across: Vec<[u8; ACROSS]> =
        line.iter().filter_map(|crossing| pixels_across(picture, crossing, place)).collect();
    let mut steps: Vec<u8> = across.iter().map(range).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = steps.len() / 2;
    let typical = *steps.select_nth_unstable(middle).1;
    let clear = across.iter().filter(|pixels| f64::from(range(pixels)) >= SMALLEST_STEP * f64::from(typical.max(1)));
    let (mut all, mut between) = (0_usize, 0_usize);
    for pixels in clear {
        let steepest = pixels.windows(2).map(|pair| pair[0].abs_diff(pair[1])).max().unwrap_or(0);
        all += 1;
        between += usize::from(f64::from(steepest) >= BETWEEN_PIXELS * f64::from(range(pixels)));
    }
    between as f64 / all.max(1) as f64
}

fn range(pixels: &[u8; ACROSS]) -> u8 {
    pixels.iter().max().zip(pixels.iter().min()).map_or(0, |(most, least)| most - least)
}

/// The pixels of the row or column that a crossing lies on; `None` on the edge of the picture, where they are not all there, and where the place of
/// the crossing does not tell which of the two it is, as on a pixel.
fn pixels_across(picture: &GrayImage, crossing: &Crossing, [left, top]: [usize; 2]) -> Option<[u8; ACROSS]> {
    let [column, row] = [crossing.x.floor(), crossing.y.floor()].map(|place| place as usize);
    let is_along_row = match [crossing.x, crossing.y].map(|place| place.fract() != 0.0) {
        [true, false] => true,
        [false, true] => false,
        _ => return None,
    };
    // Along it, the first is one before the two that the crossing lies between.
    let first = if is_along_row { left + column } else { top + row }.checked_sub(1)?;
    let pixel = |k: usize| {
        let [x, y] = if is_along_row { [first + k, top + row] } else { [left + column, first + k] };
        Some(picture.get_pixel_checked(u32::try_from(x).ok()?, u32::try_from(y).ok()?)?.0[0])
    };
    let pixels = [pixel(0)?, pixel(1)?, pixel(2)?, pixel(3)?];
    (!crossing.at_edge).then_some(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crossing_on_a_pixel_tells_neither_row_nor_column_and_is_left_out() {
        let picture = GrayImage::from_fn(12, 12, |x, _| image::Luma([if x < 6 { 200 } else { 50 }]));
        let at = |x: f64, y: f64| Crossing { x, y, at_edge: false };
        assert_eq!(pixels_across(&picture, &at(5.5, 4.0), [0, 0]), Some([200, 200, 50, 50]));
        assert_eq!(pixels_across(&picture, &at(5.0, 4.5), [0, 0]), Some([200; ACROSS]));
        assert_eq!(pixels_across(&picture, &at(5.0, 4.0), [0, 0]), None);
        assert!(share(&picture, &[at(5.5, 4.0), at(5.0, 5.0), at(5.5, 6.0)], [0, 0]) > 0.99);
    }
}
