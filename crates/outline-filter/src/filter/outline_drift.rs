//! Outlines that change slowly, as those of segmented pictures do: seen by innovations of the offsets that repeat.
use super::{arrow_information::STATE, outline_map::OutlineMap};

/// Frames that the estimate looks back on.
const MEMORY: f64 = 15.0;
/// Standard deviations by which repeated innovations must be seen. A shape that does not change must not be forgotten.
const SIGNIFICANT: f64 = 5.0;
/// Share of the repeated part that the drift is corrected by in one frame.
const GAIN: f64 = 0.1;

/// How fast the offsets change, from the correlation of their innovations in successive frames (R. Mehra, 1970); none until the
/// evidence is significant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct OutlineDrift {
    /// Variance added to every offset per frame, in units of the noise.
    variance: f64,
    repeated: f64,
    uncertainty: f64,
}

impl OutlineDrift {
    /// Takes the sums of products of successive innovations and of their squares, over so many cells.
    fn take(&mut self, products: f64, squares: f64, cells: f64) {
        if self.variance > 0.0 {
            self.variance = (self.variance + GAIN * products / cells).max(0.0);
            return;
        }
        let kept = 1.0 - 1.0 / MEMORY;
        self.repeated = kept * self.repeated + products;
        self.uncertainty = kept * self.uncertainty + squares;
        if self.repeated > SIGNIFICANT * self.uncertainty.sqrt() {
            self.variance = GAIN * products.max(0.0) / cells;
            (self.repeated, self.uncertainty) = (0.0, 0.0);
        }
    }
}

impl OutlineMap {
    /// Compares the innovations of the offsets with those of the frame before. `before` is the information that the cells had, now
    /// held by the map with the frame added; `shifts` are the corrections made.
    pub(crate) fn compare_innovations(&mut self, shifts: &[f64], before: &[super::arrow_information::CellInformation]) {
        let scale = self.pose.fixed_view::<2, 2>(0, 0).determinant().abs().sqrt() / self.sigma;
        let (mut products, mut squares, mut count) = (0.0, 0.0, 0.0);
        for (number, cell) in self.cells.iter_mut().enumerate() {
            let gain = 1.0 - before[number].own / self.information.cells[number].own;
            // Also false where a cell has no information yet.
            let innovation = if gain > 1e-6 && before[number].own > 0.0 { scale * shifts[number] / gain } else { 0.0 };
            // One cell gone wrong must not speak for all.
            let innovation = innovation.clamp(-6.0, 6.0);
            if innovation != 0.0 && cell.innovation != 0.0 {
                let product = innovation * cell.innovation;
                products += product;
                squares += product * product;
                count += 1.0;
            }
            cell.innovation = innovation;
        }
        if count > 0.0 {
            self.drift.take(products, squares, count);
        }
    }

    /// Lets the outline have changed since the last frame: the offsets lose information, pose and motion do not.
    pub(crate) fn let_outline_drift(&mut self) {
        if self.drift.variance <= 0.0 {
            return;
        }
        for cell in &mut self.information.cells {
            if cell.own <= 0.0 {
                continue;
            }
            let own = 1.0 / (1.0 / cell.own + self.drift.variance);
            let kept = own / cell.own;
            // The marginal information `dense - c c' / own` stays as it is.
            let lost = (1.0 - kept) / cell.own;
            for i in 0..STATE {
                let factor = lost * cell.coupling[i];
                for j in 0..STATE {
                    self.information.dense[i][j] -= factor * cell.coupling[j];
                }
            }
            cell.coupling.iter_mut().for_each(|entry| *entry *= kept);
            cell.own = own;
        }
    }
}
