/// Information on the offsets of the cells, and what each has to do with pose and motion; in units of the noise. Rows have the size of the
/// model: most of the work on larger ones would be on zeros.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct OffsetInformation {
    /// Entries of pose and motion.
    size: usize,
    /// Of each offset itself.
    own: Vec<f64>,
    /// Between pose and motion, and each offset.
    coupling: Vec<f64>,
}

impl OffsetInformation {
    /// Of no cell, for pose and motion of so many entries.
    pub(crate) fn new(size: usize) -> Self {
        Self { size, own: Vec::new(), coupling: Vec::new() }
    }

    /// Number of cells.
    pub(crate) fn len(&self) -> usize {
        self.own.len()
    }

    /// Information on each offset itself.
    pub(crate) fn own(&self) -> &[f64] {
        &self.own
    }

    #[cfg(test)]
    pub(crate) fn own_mut(&mut self) -> &mut [f64] {
        &mut self.own
    }

    /// Between pose and motion, and the offset of each cell: as many entries as there are.
    #[cfg(test)]
    pub(crate) fn couplings(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.coupling.chunks_exact(self.size)
    }

    /// Between pose and motion, and the offset of each cell, in the size S that they have.
    pub(crate) fn rows<const S: usize>(&self) -> &[[f64; S]] {
        debug_assert_eq!(S, self.size);
        self.coupling.as_chunks().0
    }

    /// [`own`](Self::own) and [`rows`](Self::rows), to be changed.
    pub(crate) fn all_mut<const S: usize>(&mut self) -> (&mut [f64], &mut [[f64; S]]) {
        debug_assert_eq!(S, self.size);
        (&mut self.own, self.coupling.as_chunks_mut().0)
    }

    /// As [`all_mut`](Self::all_mut), cell by cell, of any size.
    pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = (&mut f64, &mut [f64])> {
        self.own.iter_mut().zip(self.coupling.chunks_exact_mut(self.size))
    }

    /// Makes room for so many cells, of which nothing is known if they are new.
    pub(crate) fn resize(&mut self, cells: usize) {
        self.own.resize(cells, 0.0);
        self.coupling.resize(cells * self.size, 0.0);
    }

    /// Makes room for as many cells and entries as another has; what is known of them is to be written.
    pub(crate) fn resize_as(&mut self, other: &Self) {
        self.size = other.size;
        self.resize(other.len());
    }

    /// Takes all of another, in the room that there is.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.size = other.size;
        self.own.clone_from(&other.own);
        self.coupling.clone_from(&other.coupling);
    }

    /// Forgets what the offsets have to do with pose and motion.
    pub(crate) fn clear_couplings(&mut self) {
        self.coupling.fill(0.0);
    }
}

#[cfg(feature = "serde")]
impl OffsetInformation {
    /// Whether it is that of so many cells and entries of pose and motion, all finite.
    pub(crate) fn is_valid(&self, cells: usize, size: usize) -> bool {
        self.size == size
            && self.own.len() == cells
            && self.coupling.len() == cells * size
            && self.own.iter().chain(&self.coupling).all(|number| number.is_finite())
    }
}
