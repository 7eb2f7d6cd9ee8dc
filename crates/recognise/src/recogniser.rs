use freeform_curve_fit::Outline;

use crate::{
    alignment::align,
    comparison::{Comparison, OutlineFit},
    error::RecogniseError,
    settings::RecogniseSettings,
    signature::{Signature, SignatureMaker},
};

/// Known outlines that are always compared as a whole: those whose invariants are nearest.
const COMPARED: usize = 12;
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

    /// Compares an outline with every known one: by the Mahalanobis distance of the invariants first, and where that leaves it
    /// open, or among the nearest, by bringing the known outline onto it. In the order in which they were learnt.
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
        let mut order: Vec<usize> = (0..comparisons.len()).collect();
        let distance = |k: usize| comparisons[k].invariant_distance.unwrap_or(0.0);
        order.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        let near = order.iter().filter(|&&k| distance(k) <= GATE).count();
        for &k in &order[..near.max(COMPARED).min(order.len())] {
            comparisons[k].fit = self.fit(k, &seen);
        }
        Ok(comparisons)
    }

    fn fit(&self, known: usize, seen: &Signature) -> Option<OutlineFit> {
        let known = &self.known[known].signature;
        let alignment = align(known, seen)?;
        let map = seen.image_from_inertia * alignment.map * known.image_from_inertia.inverse();
        let expected = seen.noise.hypot(known.noise).hypot(self.settings.tracing);
        Some(OutlineFit { map, distance: alignment.squared_distance.sqrt(), expected })
    }
}

fn invariant_distance(known: &Signature, seen: &Signature) -> Option<f64> {
    let (known, seen) = (known.curve.as_ref()?, seen.curve.as_ref()?);
    known.invariants.mahalanobis(&seen.invariants, &(&known.covariance + &seen.covariance))
}
