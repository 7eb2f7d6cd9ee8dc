use freeform_curve_fit::Outline;

use crate::{
    alignment::{align, by_correlation},
    comparison::{Comparison, OutlineFit},
    error::RecogniseError,
    settings::RecogniseSettings,
    signature::{Signature, SignatureMaker},
};

/// Known outlines that are always compared as a whole: so many whose invariants are nearest, and so many whose contours correlate best,
/// for the lines of nearly round or symmetric curves swing out further than their covariance says.
const COMPARED: usize = 6;
/// So are those whose invariants are no more than this many standard deviations away. Noise is not all that makes them differ.
const GATE: f64 = 10.0;

/// Compares outlines with known ones, whatever the affine maps between them.
#[derive(Debug, Clone)]
pub struct Recogniser {
    settings: RecogniseSettings,
    maker: SignatureMaker,
    known: Vec<Known>,
}

#[derive(Debug, Clone)]
struct Known {
    name: String,
    signature: Signature,
}

impl Recogniser {
    /// One that knows nothing yet.
    ///
    /// # Errors
    /// A setting outside its range.
    pub fn new(settings: RecogniseSettings) -> Result<Self, RecogniseError> {
        settings.check()?;
        Ok(Self { settings, maker: SignatureMaker::new(settings.tracing), known: Vec::new() })
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &RecogniseSettings {
        &self.settings
    }

    /// Learns an outline under a name. Names need not differ: several outlines of one kind of object may bear one.
    ///
    /// # Errors
    /// An outline of which a part is hidden, that encloses no region, or that no curve can be fitted to.
    pub fn learn(&mut self, name: impl Into<String>, outline: &Outline) -> Result<(), RecogniseError> {
        let signature = self.maker.signature(outline)?;
        self.known.push(Known { name: name.into(), signature });
        Ok(())
    }

    /// The names of the known outlines in the order in which they were learnt.
    pub fn names(&self) -> impl ExactSizeIterator<Item = &str> + Clone {
        self.known.iter().map(|known| known.name.as_str())
    }

    /// Compares an outline with every known one: by the Mahalanobis distance of the invariants first and, where that leaves it
    /// open or is among the smallest, by bringing the known outline onto it. In the order in which they were learnt.
    ///
    /// # Errors
    /// As [`learn`](Self::learn).
    pub fn compare(&mut self, outline: &Outline) -> Result<Vec<Comparison>, RecogniseError> {
        let seen = self.maker.signature(outline)?;
        let mut comparisons: Vec<Comparison> = self
            .known
            .iter()
            .enumerate()
            .map(|(known, Known { signature, .. })| Comparison {
                known,
                invariant_distance: invariant_distance(signature, &seen),
                fit: None,
            })
            .collect();
        let correlated: Vec<_> =
            self.known.iter().map(|known| by_correlation(&known.signature.contour, &seen.contour)).collect();
        let by_invariants = |k: usize| comparisons[k].invariant_distance.unwrap_or(0.0);
        let by_contour = |k: usize| correlated[k].iter().map(|c| c.squared_distance).fold(f64::INFINITY, f64::min);
        let mut chosen: Vec<usize> = (0..self.known.len()).filter(|&k| by_invariants(k) <= GATE).collect();
        chosen.extend(first(self.known.len(), by_invariants));
        chosen.extend(first(self.known.len(), by_contour));
        chosen.sort_unstable();
        chosen.dedup();
        for k in chosen {
            let known = &self.known[k].signature;
            comparisons[k].fit = align(known, &seen, &correlated[k]).map(|alignment| OutlineFit {
                map: seen.image_from_inertia * alignment.map * known.image_from_inertia.inverse(),
                distance: alignment.squared_distance.sqrt(),
                expected: seen.noise.hypot(known.noise).hypot(self.settings.tracing),
            });
        }
        Ok(comparisons)
    }
}

/// The few of so many that are smallest by a measure.
fn first(count: usize, measure: impl Fn(usize) -> f64) -> impl Iterator<Item = usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| measure(a).total_cmp(&measure(b)));
    order.into_iter().take(COMPARED)
}

fn invariant_distance(known: &Signature, seen: &Signature) -> Option<f64> {
    let (known, seen) = (known.curve.as_ref()?, seen.curve.as_ref()?);
    known.invariants.mahalanobis(&seen.invariants, &(&known.covariance + &seen.covariance))
}
