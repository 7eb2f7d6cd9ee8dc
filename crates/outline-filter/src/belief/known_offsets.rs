//! Offsets as far as frames have shown them.
use super::Belief;
use crate::tuning::map::SEEN;

/// Offsets of the outline from the cells along their normals, with the information on each, in points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KnownOffsets<'a> {
    pub(crate) offsets: &'a [f64],
    pub(crate) information: &'a [f64],
}

impl KnownOffsets<'_> {
    /// None of any cell.
    pub(crate) const NONE: Self = Self { offsets: &[], information: &[] };

    /// That of a cell; 0 where too few points have shown it to be relied on.
    pub(crate) fn of(self, cell: usize) -> f64 {
        let is_known = self.information.get(cell).is_some_and(|information| *information > SEEN);
        self.offsets.get(cell).copied().filter(|_| is_known).unwrap_or(0.0)
    }
}

impl Belief {
    pub(crate) fn known_offsets(&self) -> KnownOffsets<'_> {
        KnownOffsets { offsets: &self.offsets, information: self.information.cells.own() }
    }
}
