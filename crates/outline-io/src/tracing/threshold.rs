//! The grey value that parts objects from the ground: given, or by Otsu's method.
use image::GrayImage;

use crate::picture_file::error::TraceError;
use crate::tracing::contrast::{Contrast, signal};

/// Least difference of the medians of ground and objects, in robust standard deviations of the ground: Otsu's method splits
/// pure noise into halves 2.3 of them apart and an even gradient into halves 2.7 apart.
const STANDS_OUT: f64 = 3.0;

/// Noise does not reach a level so many robust standard deviations beyond its median.
const BEYOND_NOISE: f64 = 6.0;

/// Objects of few pixels are this many robust standard deviations of the ground beyond it, and so many grey values.
const RARE_STANDS_OUT: f64 = 8.0;
const LEAST_RARE: f64 = 16.0;

/// They have at least so many pixels, and at most one in so many.
const RAREST: u64 = 16;
const RARE_SHARE: u64 = 20;

/// At most one in so many, where what is around them is known to be ground, and at least one in so many: a large object may be around a highlight.
const SHARE_ON_GROUND: u64 = 4;
const FEWEST_ON_GROUND: u64 = 400;

/// Side of the square of pixels by which a corner of a picture is judged.
const CORNER: u32 = 8;

/// The grey value that parts objects from the ground.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Threshold {
    /// Half-way between the median grey values of the two classes that Otsu's method finds; for a mask, half-way between its two values. Where the
    /// class of the objects is the ground, with three corners of the picture and more than half of it, or neither stands out from the other, half-way
    /// to what lies far beyond the noise of the ground, if that is neither a speck nor large.
    #[default]
    Automatic,
    /// A grey value of the picture, above 0 and up to 255.
    Level(f64),
}

/// The grey values that tell an object from its ground, on a scale where the object is lighter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Levels {
    /// Pixels from here on belong to an object; the outline runs where the grey value passes it.
    pub(crate) threshold: f64,
    /// Median of the ground.
    pub(crate) ground: f64,
    /// Median of the objects.
    pub(crate) object: f64,
    /// Whether the picture has only two grey values, as masks do.
    pub(crate) two_valued: bool,
}

impl Levels {
    pub(crate) fn of(picture: &GrayImage, contrast: Contrast, threshold: Threshold) -> Result<Self, TraceError> {
        let counts = histogram(picture, contrast);
        let values = counts.iter().filter(|count| **count > 0).count();
        let (split, fixed) = match threshold {
            Threshold::Automatic => {
                if values < 2 {
                    let value = picture.as_raw().first().copied();
                    return Err(value.map_or(TraceError::NoPixels, |value| TraceError::Uniform { value }));
                }
                (otsu(&counts), None)
            }
            Threshold::Level(level) => {
                let level = level_in_picture(level, contrast);
                (level.ceil().clamp(0.0, 256.0) as usize, Some(level))
            }
        };
        let ground = median(&counts[..split], 0);
        let object = median(&counts[split..], split);
        match (ground, object) {
            (_, None) if counts.iter().all(|count| *count == 0) => Err(TraceError::NoPixels),
            (_, None) => Err(TraceError::NoObject { threshold: level_in_picture(fixed.unwrap_or(0.0), contrast) }),
            (ground, Some(object)) => {
                if fixed.is_none() && values > 2 {
                    let clear = stands_out(&counts[..split], ground.unwrap_or(0.0), object);
                    if let Err(error) = clear {
                        // The classes of Otsu's method are those of the ground where objects have too few pixels to make one.
                        return Self::of_rare(&counts, RARE_SHARE).ok_or(error);
                    }
                    // So they are where something on the other side of the ground comes into the picture, such as a light hand beside a dark object.
                    let is_no_speck = |rare: &Self| FEWEST_ON_GROUND * rare.pixels(&counts) >= counts.iter().sum();
                    if is_ground(picture, contrast, (&counts, split))
                        && let Some(rare) = Self::of_rare(&counts, SHARE_ON_GROUND).filter(is_no_speck)
                    {
                        return Ok(rare);
                    }
                }
                let ground = ground.unwrap_or(0.0);
                let threshold = fixed.unwrap_or(0.5 * (ground + object));
                Ok(Self { threshold, ground, object, two_valued: values <= 2 })
            }
        }
    }
}

/// How many pixels have each grey value, on the scale where the object is lighter.
fn histogram(picture: &GrayImage, contrast: Contrast) -> [u64; 256] {
    // Pixels beside each other have the same value more often than not: one counter for them would be waited for.
    let mut counts = [[0_u64; 256]; 4];
    let (fours, rest) = picture.as_raw().as_chunks::<4>();
    for four in fours {
        counts.iter_mut().zip(four).for_each(|(counts, value)| counts[usize::from(*value)] += 1);
    }
    rest.iter().for_each(|value| counts[0][usize::from(*value)] += 1);
    std::array::from_fn(|value| {
        let of_picture = usize::from(signal(value as u8, contrast));
        counts.iter().map(|counts| counts[of_picture]).sum()
    })
}

impl Levels {
    /// Levels of objects that have few pixels, one in `share` at most, far beyond the noise of the ground; `None` where nothing is there.
    fn of_rare(counts: &[u64; 256], share: u64) -> Option<Self> {
        let ground = median(counts, 0)?;
        let least = (ground + (RARE_STANDS_OUT * spread(counts, ground)).max(LEAST_RARE)).ceil() as usize;
        let rare = counts.get(least..)?;
        let (few, all): (u64, u64) = (rare.iter().sum(), counts.iter().sum());
        let object = median(rare, least).filter(|_| RAREST <= few && share * few <= all)?;
        Some(Self { threshold: 0.5 * (ground + object), ground, object, two_valued: false })
    }

    /// How many pixels belong to objects.
    fn pixels(&self, counts: &[u64; 256]) -> u64 {
        counts[self.threshold.ceil() as usize..].iter().sum()
    }
}

/// Whether the class of the grey values from `split` on is that of the ground: it has more than half of the picture and three of its corners or more.
fn is_ground(picture: &GrayImage, contrast: Contrast, (counts, split): (&[u64; 256], usize)) -> bool {
    if 2 * counts[split..].iter().sum::<u64>() <= counts.iter().sum() {
        return false;
    }
    let is_of_class = |value: &u8| usize::from(signal(*value, contrast)) >= split;
    let (width, height) = picture.dimensions();
    let side = CORNER.min(width).min(height);
    let corners = [(0, 0), (width - side, 0), (0, height - side), (width - side, height - side)];
    let has_corner = |(left, top): &(u32, u32)| {
        let square = || (0..side * side).map(|k| picture.get_pixel(left + k % side, top + k / side).0[0]);
        2 * square().filter(is_of_class).count() > square().count()
    };
    corners.iter().filter(|corner| has_corner(corner)).count() >= 3
}

/// Refuses classes that are no further apart than noise, or a ground that grows lighter to one side, is split into.
fn stands_out(ground_counts: &[u64], ground: f64, object: f64) -> Result<(), TraceError> {
    let spread = spread(ground_counts, ground);
    let difference = object - ground;
    if difference < STANDS_OUT * spread { Err(TraceError::NoContrast { difference, spread }) } else { Ok(()) }
}

/// Robust standard deviation of grey values about their median, by their median absolute deviation.
fn spread(counts: &[u64], middle: f64) -> f64 {
    let mut deviations = [0_u64; 256];
    for (value, count) in counts.iter().enumerate() {
        deviations[(value as f64 - middle).abs() as usize] += count;
    }
    // The median absolute deviation to a grey value is half a grey value too small in the mean.
    1.4826 * (median(&deviations, 0).unwrap_or(0.0) + 0.5)
}

/// How many of some grey values there are of each.
pub(crate) fn counted(values: impl Iterator<Item = u8>) -> [u64; 256] {
    let mut counts = [0; 256];
    values.for_each(|value| counts[usize::from(value)] += 1);
    counts
}

/// A level that noise of these grey values does not reach, at least `least`; `None` of no value.
pub(crate) fn beyond_noise(counts: &[u64; 256], least: f64) -> Option<f64> {
    let middle = median(counts, 0)?;
    Some((middle + BEYOND_NOISE * spread(counts, middle)).max(least))
}

/// From a grey value of the picture to the scale where the object is lighter, or back.
pub(crate) fn level_in_picture(level: f64, contrast: Contrast) -> f64 {
    match contrast {
        Contrast::LightOnDark => level,
        Contrast::DarkOnLight => 255.0 - level,
    }
}

/// First grey value of the upper class where the variance between the two classes is largest (Otsu, A threshold
/// selection method from gray-level histograms, 1979).
fn otsu(counts: &[u64; 256]) -> usize {
    let total: f64 = counts.iter().map(|count| *count as f64).sum();
    let sum: f64 = counts.iter().enumerate().map(|(value, count)| value as f64 * *count as f64).sum();
    let (mut below, mut sum_below) = (0.0, 0.0);
    let mut best = (0.0, 1);
    for split in 1..256 {
        below += counts[split - 1] as f64;
        sum_below += (split - 1) as f64 * counts[split - 1] as f64;
        let above = total - below;
        if below > 0.0 && above > 0.0 {
            let distance = sum_below / below - (sum - sum_below) / above;
            let between = below * above * distance * distance;
            if between > best.0 {
                best = (between, split);
            }
        }
    }
    best.1
}

/// Median grey value of a part of the histogram that begins at `first`.
fn median(counts: &[u64], first: usize) -> Option<f64> {
    let total: u64 = counts.iter().sum();
    let mut seen = 0;
    for (index, count) in counts.iter().enumerate() {
        seen += count;
        if *count > 0 && 2 * seen >= total {
            return Some((first + index) as f64);
        }
    }
    None
}
