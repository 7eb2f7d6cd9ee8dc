//! An identifier as bytes and back.
use freeform_decompose::MAX_PAIRS;
use freeform_estimate::{StateError, StateFormat};
use serde::{Deserialize, Serialize};

use super::{
    identifier::AdaptiveIdentifier,
    pair_quality::PairQuality,
    running_law::Last,
    settings::{AdaptiveSettings, PairChoice},
};

/// The format of the bytes.
const FORMAT: StateFormat = StateFormat { version: 1, kind: *b"adap", name: "adaptive identifier" };

/// What is saved. All that follows from the settings is made anew.
#[derive(Serialize, Deserialize)]
struct SavedIdentifier {
    settings: AdaptiveSettings,
    /// Of all laws one after the other.
    numbers: Vec<f64>,
    by_slopes: bool,
    qualities: [PairQuality; MAX_PAIRS],
    last: Option<Last>,
    origin_since: f64,
    frames: usize,
    followed: usize,
}

impl AdaptiveIdentifier {
    /// Everything that the identifier knows, as bytes: 0.5 to 9 kB. An identifier [made from them](Self::from_bytes) goes on as this one
    /// would, to the last bit. The first four bytes are the version of the format, little-endian.
    ///
    /// # Errors
    /// None for an identifier; the encoder reports errors of its sink, and memory has none.
    pub fn to_bytes(&self) -> Result<Vec<u8>, StateError> {
        let mut laws = self.laws.clone();
        FORMAT.encoded(&SavedIdentifier {
            settings: self.settings.clone(),
            numbers: laws.numbers_mut().into_iter().map(|number| *number).collect(),
            by_slopes: laws.by_slopes_mut().first().is_some_and(|by_slopes| **by_slopes),
            qualities: self.qualities,
            last: self.last,
            origin_since: self.origin_since,
            frames: self.frames,
            followed: self.followed,
        })
    }

    /// An identifier from the bytes of [`to_bytes`](Self::to_bytes). Bytes from anywhere may be given: everything is checked.
    ///
    /// ```
    /// use freeform_decompose::Line;
    /// use freeform_identify::{AdaptiveIdentifier, AdaptiveSettings};
    /// use nalgebra::Complex;
    ///
    /// let mut identifier = AdaptiveIdentifier::new(AdaptiveSettings::default())?;
    /// let line = |time: f64| Line { l: Complex::new(0.2 + 0.1 * time, 0.9), k: Complex::new(-0.1, 0.3 + 0.2 * time) };
    /// (0..10).map(|k| 0.1 * f64::from(k)).try_for_each(|time| identifier.step(time, &[line(time)]))?;
    /// let mut restored = AdaptiveIdentifier::from_bytes(&identifier.to_bytes()?)?;
    /// identifier.step(1.0, &[line(1.0)])?;
    /// restored.step(1.0, &[line(1.0)])?;
    /// assert_eq!(restored.estimate(), identifier.estimate());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Bytes of another version or kind, damaged ones, and ones that describe no identifier.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, StateError> {
        let inconsistent = |part| StateError::Inconsistent { part };
        let SavedIdentifier { settings, numbers, by_slopes, qualities, last, origin_since, frames, followed } =
            FORMAT.decoded(bytes)?;
        let pairs = settings.pairs;
        let mut identifier = Self::new(settings).map_err(|_| inconsistent("settings"))?;
        let mut places = identifier.laws.numbers_mut();
        if places.len() != numbers.len() {
            return Err(inconsistent("numbers of the laws"));
        }
        places.iter_mut().zip(numbers).for_each(|(place, number)| **place = number);
        identifier.laws.by_slopes_mut().into_iter().for_each(|place| *place = by_slopes);
        if !identifier.laws.is_finite() {
            return Err(inconsistent("numbers of the laws"));
        }
        if !last.as_ref().is_none_or(|last| is_valid(last, pairs)) || !origin_since.is_finite() {
            return Err(inconsistent("lines"));
        }
        let counts = [usize::from(last.is_some()), frames, StateFormat::MOST_COUNTED].is_sorted();
        if !counts || last.is_none() != (frames == 0) || followed > frames.saturating_sub(1) {
            return Err(inconsistent("counts"));
        }
        let used = last.map_or(0, |last| last.count);
        let frames_of = |pair| if pair < used { frames } else { 0 };
        if !qualities.iter().enumerate().all(|(pair, quality)| quality.is_of(frames_of(pair))) {
            return Err(inconsistent("qualities of the pairs"));
        }
        identifier.laws_before = identifier.laws.clone();
        Ok(Self { qualities, last, origin_since, frames, followed, ..identifier })
    }
}

/// A frame of which the identifier can go on.
fn is_valid(last: &Last, pairs: PairChoice) -> bool {
    let fewest = if let PairChoice::Given(index) = pairs { index.saturating_add(1) } else { 1 };
    let coordinates = last.lines.iter().flat_map(|line| [line.l.re, line.l.im, line.k.re, line.k.im]);
    (fewest..=MAX_PAIRS).contains(&last.count) && last.time.is_finite() && { coordinates }.all(f64::is_finite)
}
