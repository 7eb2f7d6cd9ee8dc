//! The ground of a sequence: the median of its pictures, without what rests in most of them and is gone in others.
use std::sync::Arc;

use image::GrayImage;

use crate::choice::BURST;
use crate::ground::background::median_picture;
use crate::tracing::connected_components::{Components, Connectivity, Run};
use crate::tracing::threshold::{beyond_noise, counted};

/// Fewest pictures in which a thing that the median shows must be gone: one more than a burst of a sample. What passes in front of it and looks like
/// the ground hides it in all pictures of a burst, as they follow each other.
const FEWEST_GONE: usize = BURST as usize + 1;

/// With fewer pictures the plain median is taken.
const FEWEST_PICTURES: usize = 8;

/// Fewest pixels of a thing.
const FEWEST_PIXELS: usize = 64;

/// What changes more of a picture than this is the light, or the camera.
const LARGEST_SHARE: f64 = 0.3;

/// What differs differs by more grey values than this, however little noise there is: its edges are to be told from none.
const LEAST_DIFFERENCE: f64 = 12.0;

/// The median has an edge around what is gone in a picture, and the picture has so many times less of one. What is in front of the ground is the
/// other way round, and what only changes has edges in both.
const LESS_OF_AN_EDGE: f64 = 2.0;

/// Distance, in pixels, of the places on both sides of an edge at which it is looked at: an edge in pictures is some pixels wide.
const REACH: isize = 2;

/// Every so many pixels of a picture tell its noise.
const NOISE_STEP: usize = 37;

/// What the pixels of a picture are, while what differs in it is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pixel {
    Ground,
    Lighter,
    Darker,
}

/// The ground of pictures of one size, from anywhere in a sequence: their median, pixel by pixel. What rests in most of them is a part of that. Where
/// it has left, pictures differ from the median in its shape, but have no edge there, as what is in front of the ground has: there the ground is the
/// median of these pictures instead. `None` of no picture.
#[must_use]
pub fn ground_picture(pictures: &[Arc<GrayImage>]) -> Option<Arc<GrayImage>> {
    let plain = median_picture(pictures)?;
    if pictures.len() < FEWEST_PICTURES {
        return Some(plain);
    }
    let mut pixels = Vec::new();
    let of_size = pictures.iter().filter(|picture| picture.dimensions() == plain.dimensions());
    let uncovered: Vec<(&[u8], PixelSet)> = of_size
        .filter_map(|picture| Some((picture.as_raw().as_slice(), uncovered(picture, &plain, &mut pixels)?)))
        .collect();
    if uncovered.len() < FEWEST_GONE {
        return Some(plain);
    }
    let mut ground = GrayImage::clone(&plain);
    let mut values = Vec::with_capacity(uncovered.len());
    for (place, ground) in ground.iter_mut().enumerate() {
        values.clear();
        values.extend(uncovered.iter().filter(|(_, set)| set.contains(place)).map(|(picture, _)| picture[place]));
        if values.len() >= FEWEST_GONE {
            let middle = values.len() / 2;
            *ground = *values.select_nth_unstable(middle).1;
        }
    }
    Some(Arc::new(ground))
}

/// Some pixels of a picture, by a bit for each: an eighth of the memory of the picture, however many they are.
struct PixelSet(Vec<u64>);

impl PixelSet {
    fn none_of(pixels: usize) -> Self {
        Self(vec![0; pixels.div_ceil(64)])
    }

    fn insert(&mut self, place: usize) {
        self.0[place / 64] |= 1 << (place % 64);
    }

    fn contains(&self, place: usize) -> bool {
        self.0[place / 64] >> (place % 64) & 1 == 1
    }
}

/// The pixels where a picture shows the ground and the median something in front of it; `None` where there are none.
fn uncovered(picture: &GrayImage, plain: &GrayImage, pixels: &mut Vec<Pixel>) -> Option<PixelSet> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let differences = || picture.as_raw().iter().zip(plain.as_raw()).map(|(a, b)| a.abs_diff(*b));
    let level = beyond_noise(&counted(differences().step_by(NOISE_STEP)), LEAST_DIFFERENCE)?;
    if level > f64::from(u8::MAX) {
        return None;
    }
    let level = level as u8;
    let count = differences().filter(|difference| *difference > level).count();
    if count < FEWEST_PIXELS || count as f64 > LARGEST_SHARE * (width * height) as f64 {
        return None;
    }
    pixels.clear();
    // What is gone and what has come differ in opposite ways from the ground, where they touch too.
    let pixel = |(value, ground): (&u8, &u8)| match value.abs_diff(*ground) > level {
        true if value > ground => Pixel::Lighter,
        true => Pixel::Darker,
        false => Pixel::Ground,
    };
    pixels.extend(picture.as_raw().iter().zip(plain.as_raw()).map(pixel));
    let (mut is_taken, mut uncovered) = (vec![false; pixels.len()], None);
    for kind in [Pixel::Lighter, Pixel::Darker] {
        let is_of_kind = |column: usize, row: usize| pixels[row * width + column] == kind;
        let things = Components::of(width, height, Connectivity::Four, is_of_kind);
        let is_large = |(_, count): &(u32, u64)| *count >= FEWEST_PIXELS as u64;
        let large: Vec<u32> = things.pixel_counts().filter(is_large).map(|(thing, _)| thing).collect();
        for runs in things.into_runs_of(&large) {
            let of_run = |run: Run| run.columns().map(move |column| run.row() * width + column);
            let thing: Vec<usize> = runs.into_iter().flat_map(of_run).collect();
            if is_gone(&thing, pixels, picture, plain, f64::from(level)) {
                let uncovered = uncovered.get_or_insert_with(|| PixelSet::none_of(pixels.len()));
                add(&thing, pixels, (width, height), &mut is_taken, uncovered);
            }
        }
    }
    uncovered
}

/// Whether the median has an edge around what differs, and the picture has not.
fn is_gone(thing: &[usize], pixels: &[Pixel], picture: &GrayImage, plain: &GrayImage, level: f64) -> bool {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let (mut of_median, mut of_picture, mut places) = (0_u64, 0_u64, 0_u64);
    for &index in thing {
        let (column, row) = ((index % width) as isize, (index / width) as isize);
        for (across, down) in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
            let at = |by: isize| -> Option<usize> {
                let (column, row) = (column + by * across, row + by * down);
                let is_within = (0..width as isize).contains(&column) && (0..height as isize).contains(&row);
                is_within.then(|| row as usize * width + column as usize)
            };
            if at(1).is_none_or(|neighbour| pixels[neighbour] != Pixel::Ground) {
                continue;
            }
            if let Some((inner, outer)) = at(-REACH).zip(at(REACH)) {
                let step = |image: &GrayImage| u64::from(image.as_raw()[inner].abs_diff(image.as_raw()[outer]));
                of_median += step(plain);
                of_picture += step(picture);
                places += 1;
            }
        }
    }
    of_median as f64 > level * places as f64 && of_median as f64 > LESS_OF_AN_EDGE * of_picture as f64
}

/// Adds the pixels where a thing is gone, with those around it that its blurred edge has reached, but for those that the edge of what is in front of
/// the ground beside it has reached. `size` is that of the picture, columns and rows.
fn add(thing: &[usize], pixels: &[Pixel], size: (usize, usize), is_taken: &mut [bool], uncovered: &mut PixelSet) {
    let (width, height) = (size.0 as isize, size.1 as isize);
    let near = |place: usize| {
        let (column, row) = (place as isize % width, place as isize / width);
        let columns = (column - REACH).max(0)..=(column + REACH).min(width - 1);
        let rows = (row - REACH).max(0)..=(row + REACH).min(height - 1);
        rows.flat_map(move |y| columns.clone().map(move |x| (y * width + x) as usize))
    };
    let kind = pixels[thing[0]];
    let is_beside = |place: usize| near(place).any(|other| pixels[other] != Pixel::Ground && pixels[other] != kind);
    for place in thing.iter().flat_map(|&index| near(index)) {
        if !is_taken[place] {
            is_taken[place] = true;
            if !is_beside(place) {
                uncovered.insert(place);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use image::Luma;

    use super::*;

    /// Distance from an L.
    fn letter(x: f64, y: f64) -> f64 {
        let bar = |cx: f64, cy: f64, w: f64, h: f64| ((x - cx).abs() - w).max((y - cy).abs() - h);
        bar(0.0, 0.0, 20.0, 7.0).min(bar(14.0, 15.0, 6.0, 20.0))
    }

    /// The ground, uneven.
    fn ground(x: f64, y: f64) -> f64 {
        110.0 + 12.0 * (0.21 * x).sin() * (0.17 * y + 0.4).cos()
    }

    fn picture(seed: u32, grey: impl Fn(f64, f64) -> f64) -> Arc<GrayImage> {
        Arc::new(GrayImage::from_fn(160, 120, |x, y| {
            let mixed = (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ seed.wrapping_mul(0xc2b2_ae3d))
                .wrapping_mul(0x2c1b_3c6d);
            let noise = f64::from((mixed >> 13) % 5) - 2.0;
            Luma([(grey(f64::from(x) + 0.5, f64::from(y) + 0.5) + noise).round().clamp(0.0, 255.0) as u8])
        }))
    }

    /// Pictures of a dark L that is moved by this in the picture of this number.
    fn moved(count: u32, by: impl Fn(f64) -> f64) -> Vec<Arc<GrayImage>> {
        (0..count)
            .map(|k| {
                let along = 50.0 + by(f64::from(k));
                picture(k, move |x, y| {
                    let inside = (0.5 - letter(x - along, y - 60.0)).clamp(0.0, 1.0);
                    ground(x, y) * (1.0 - inside) + 45.0 * inside
                })
            })
            .collect()
    }

    fn farthest(found: &GrayImage, true_ground: impl Fn(f64, f64) -> f64) -> f64 {
        let off = |(x, y, value): (u32, u32, &Luma<u8>)| {
            (f64::from(value.0[0]) - true_ground(f64::from(x) + 0.5, f64::from(y) + 0.5)).abs()
        };
        found.enumerate_pixels().map(off).fold(0.0, f64::max)
    }

    #[test]
    fn what_rests_in_most_pictures_and_leaves_is_no_part_of_the_ground() {
        // Before it goes, after it has come, and between.
        let ways: [fn(f64) -> f64; 3] = [
            |k| 8.0 * (k - 16.0).max(0.0),
            |k| 8.0 * k.min(9.0),
            |k| 10.0 * ((k - 5.0).min(0.0) + (k - 20.0).max(0.0)),
        ];
        for (number, way) in ways.into_iter().enumerate() {
            let pictures = moved(26, way);
            let plain = farthest(&median_picture(&pictures).expect("a median"), ground);
            let found = farthest(&ground_picture(&pictures).expect("a ground"), ground);
            assert!(plain > 50.0, "{number}: {plain}");
            assert!(found < 8.0, "{number}: {found}");
        }
    }

    #[test]
    fn what_is_hidden_in_one_burst_by_what_looks_like_the_ground_is_not_taken_for_gone() {
        // In the pictures of one burst, and in one picture more.
        for (hidden, is_gone) in [(BURST, false), (BURST + 1, true)] {
            let square = |x: f64, y: f64| (x - 110.0).abs().max((y - 50.0).abs()) - 14.0;
            let is_hidden = |k: u32| k >= 9 && u64::from(k) < 9 + hidden;
            let grey = |k: u32, x: f64, y: f64| if square(x, y) < 0.0 && !is_hidden(k) { 45.0 } else { ground(x, y) };
            let pictures: Vec<_> = (0..24).map(|k| picture(k, |x, y| grey(k, x, y))).collect();
            let [plain, found] = [median_picture(&pictures), ground_picture(&pictures)].map(|g| g.expect("a ground"));
            assert_eq!(plain != found, is_gone, "{hidden}");
        }
    }

    #[test]
    fn what_moves_through_what_only_changes_and_what_is_covered_or_out_of_focus_leave_the_median_as_it_is() {
        let square = |x: f64, y: f64, half: f64| (x - 110.0).abs().max((y - 50.0).abs()) - half;
        let still = |x: f64, y: f64| if square(x, y, 14.0) < 0.0 { 45.0 } else { ground(x, y) };
        let kinds: [Vec<Arc<GrayImage>>; 5] = [
            moved(26, |k| 4.0 * k),
            // A lamp that is lit in some.
            (0..26)
                .map(|k| {
                    picture(k, |x, y| still(x, y) + if k % 3 == 0 && square(x, y, 14.0) < 0.0 { 150.0 } else { 0.0 })
                })
                .collect(),
            // Something lighter than the ground in front of it in some.
            (0..26)
                .map(|k| picture(k, |x, y| if k > 18 && square(x, y, 25.0) < 0.0 { 190.0 } else { still(x, y) }))
                .collect(),
            // Dimmer.
            (0..26).map(|k| picture(k, |x, y| still(x, y) * if k > 18 { 0.6 } else { 1.0 })).collect(),
            // Blurred.
            (0..26)
                .map(|k| {
                    picture(k, |x, y| {
                        let inside = 0.5 - square(x, y, 14.0) / if k > 18 { 8.0 } else { 1.0 };
                        let inside = inside.clamp(0.0, 1.0);
                        ground(x, y) * (1.0 - inside) + 45.0 * inside
                    })
                })
                .collect(),
        ];
        for (number, pictures) in kinds.iter().enumerate() {
            let [plain, found] = [median_picture(pictures), ground_picture(pictures)].map(|g| g.expect("a ground"));
            assert!(plain == found, "{number}");
        }
    }
}
