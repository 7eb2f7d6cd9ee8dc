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

    /// Where each offset is expected, from where it was, if pose and motion are so far from where they were; 0 of those of which nothing is known.
    pub(crate) fn expected_with(&self, state: &[f64]) -> impl ExactSizeIterator<Item = f64> {
        let of_cells = self.own.iter().zip(self.coupling.chunks_exact(self.size));
        of_cells.map(move |(own, coupling)| {
            let along: f64 = coupling.iter().zip(state).map(|(c, x)| c * x).sum();
            if *own > 0.0 { -along / own } else { 0.0 }
        })
    }

    /// [`own`](Self::own) and [`rows`](Self::rows), to be changed.
    pub(crate) fn all_mut<const S: usize>(&mut self) -> (&mut [f64], &mut [[f64; S]]) {
        debug_assert_eq!(S, self.size);
        (&mut self.own, self.coupling.as_chunks_mut().0)
    }

    /// As [`all_mut`](Self::all_mut), cell by cell, of any size.
    #[cfg(test)]
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

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;

    use crate::dense_filter::{DenseFilter, Problem};

    #[test]
    fn cells_first_seen_from_a_pose_that_was_off_do_not_speak_against_the_one_that_corrects_it() {
        // An offset is expected at its mean given pose and motion, by the covariance of all.
        for seed in 0..8 {
            let information = Problem::of(MotionModel::Rigid, 6, seed).belief.information;
            let (dense, size) = (DenseFilter::of(&information), 2 * information.k);
            let state: Vec<f64> = (0..size).map(|i| 0.3 - 0.1 * i as f64).collect();
            let of_state = dense.covariance.view((0, 0), (size, size)).clone_owned();
            let solved = of_state.cholesky().expect("positive").solve(&nalgebra::DVector::from_column_slice(&state));
            let expected: Vec<f64> = information.cells.expected_with(&state).collect();
            for (number, expected) in expected.iter().enumerate() {
                let given = dense.covariance.view((size + number, 0), (1, size)).clone_owned() * &solved;
                assert!((given[0] - expected).abs() < 1e-9 && expected.abs() > 1e-6, "{seed}: {given} {expected}");
            }
        }
    }
}
