use std::collections::HashMap;

use crate::comparison::Comparison;
use crate::error::RecogniseError;
use crate::evidence::Evidence;

/// Evidence on one object of a sequence.
#[derive(Debug, Clone)]
pub struct ObjectEvidence {
    /// Name of the object.
    pub object: String,
    /// What its frames say.
    pub evidence: Evidence,
    /// Frames that could not be compared.
    pub frames_rejected: usize,
    /// Why the first outline that could not be compared was refused.
    pub first_refusal: Option<RecogniseError>,
}

/// Evidence on the objects of a sequence, in the order in which they first appeared.
///
/// ```
/// use freeform_recognise::EvidenceByObject;
///
/// let mut objects = EvidenceByObject::default();
/// objects.of("left").reject();
/// objects.of("right").take(Ok(Vec::new()));
/// objects.of("left").take(Ok(Vec::new()));
/// let counts: Vec<_> = objects.iter().map(|object| (object.object.as_str(), object.frames_rejected)).collect();
/// assert_eq!(counts, [("left", 1), ("right", 0)]);
/// ```
#[derive(Debug, Clone, Default)]
pub struct EvidenceByObject {
    list: Vec<ObjectEvidence>,
    /// By their names.
    positions: HashMap<String, usize>,
}

impl EvidenceByObject {
    /// The object of a name, which may be new.
    pub fn of(&mut self, name: &str) -> &mut ObjectEvidence {
        let position = self.positions.get(name).copied().unwrap_or_else(|| {
            let (object, evidence) = (name.to_owned(), Evidence::new());
            self.positions.insert(object.clone(), self.list.len());
            self.list.push(ObjectEvidence { object, evidence, frames_rejected: 0, first_refusal: None });
            self.list.len() - 1
        });
        &mut self.list[position]
    }

    /// All objects.
    pub fn iter(&self) -> impl Iterator<Item = &ObjectEvidence> {
        self.list.iter()
    }
}

impl ObjectEvidence {
    /// Adds how a frame compares with the known outlines, or why it cannot be compared.
    pub fn take(&mut self, compared: Result<Vec<Comparison>, RecogniseError>) {
        match compared {
            Ok(comparisons) => self.evidence.add(&comparisons),
            Err(error) => {
                self.reject();
                self.first_refusal.get_or_insert(error);
            }
        }
    }

    /// Counts a frame without an outline.
    pub fn reject(&mut self) {
        self.frames_rejected += 1;
    }
}
