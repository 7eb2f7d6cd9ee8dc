//! Grey values on a grid, their smoothing and their level lines.
use freeform_curve_fit::isoline::{self, LargestLines, LineTooLong, WantedHoles};

/// Grey values on a grid of samples, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Field {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) values: Vec<f32>,
}

impl Field {
    /// Where the grey value passes a level, between the samples: of the lines the one around the largest area and those around holes; `None` if
    /// there is no line.
    pub(crate) fn isolines(
        &self,
        level: f64,
        wanted: WantedHoles,
        most: usize,
    ) -> Result<Option<LargestLines>, LineTooLong> {
        isoline::largest_of_samples([self.width, self.height], &self.values, level, wanted, most)
    }

    /// Indices of the samples above, below and beside a sample, as far as the grid goes.
    pub(crate) fn neighbours(&self, index: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = (self.width, self.height);
        let (x, y) = (index % width, index / width);
        let around = [
            (x > 0).then(|| index - 1),
            (x + 1 < width).then_some(index + 1),
            (y > 0).then(|| index - width),
            (y + 1 < height).then_some(index + width),
        ];
        around.into_iter().flatten()
    }

    /// Whether a sample lies on the edge of the grid.
    pub(crate) fn is_at_edge(&self, index: usize) -> bool {
        let (x, y) = (index % self.width, index / self.width);
        x == 0 || y == 0 || x + 1 == self.width || y + 1 == self.height
    }

    /// The grey values nearest to samples from 0 to 255, halves upwards: what `f32::round` says, which is a call of the library for each of them
    /// where the processor that is built for has no instruction for it.
    pub(crate) fn nearest_grey_values(&self) -> Vec<u8> {
        let nearest = |value: &f32| {
            let below = *value as i32;
            (below + i32::from(value - below as f32 >= 0.5)) as u8
        };
        self.values.iter().map(nearest).collect()
    }

    /// Blurs with a Gaussian of this standard deviation in samples. Beyond the grid its edge goes on, so that a contour
    /// that meets the edge is not bent there.
    pub(crate) fn blur(&mut self, sigma: f64) {
        let weights = kernel(sigma);
        let (width, height) = (self.width, self.height);
        let reach = weights.len() - 1;
        // A row with its ends repeated beyond the grid.
        let mut line = vec![0.0; width + 2 * reach];
        for row in self.values.chunks_exact_mut(width) {
            line[..reach].fill(row[0]);
            line[reach..][..width].copy_from_slice(row);
            line[reach + width..].fill(row[width - 1]);
            row.fill(0.0);
            for (distance, &weight) in weights.iter().enumerate().skip(1) {
                let (right, left) = (&line[reach + distance..], &line[reach - distance..]);
                for ((value, right), left) in row.iter_mut().zip(right).zip(left) {
                    *value += weight * (right + left);
                }
            }
            for (value, centre) in row.iter_mut().zip(&line[reach..]) {
                *value += weights[0] * centre;
            }
        }
        // Row by row in both directions: going down the columns would miss the cache at every step. Of the rows that have been
        // blurred those that are still needed are kept as they were, so that the grid is held once and not twice.
        let kept = weights.len().min(height);
        let mut before = vec![0.0; kept * width];
        for y in 0..height {
            let (row, below) = self.values[y * width..].split_at_mut(width);
            before[y % kept * width..][..width].copy_from_slice(row);
            row.fill(0.0);
            for (distance, &weight) in weights.iter().enumerate() {
                let as_it_was = |y: usize| &before[y % kept * width..][..width];
                let last = (y + distance).min(height - 1);
                let a = if last == y { as_it_was(y) } else { &below[(last - y - 1) * width..][..width] };
                let b = as_it_was(y.saturating_sub(distance));
                let weight = if distance == 0 { 0.5 * weight } else { weight };
                for ((value, a), b) in row.iter_mut().zip(a).zip(b) {
                    *value += weight * (a + b);
                }
            }
        }
    }
}

/// One half of the kernel, its centre first, cut at 4 standard deviations.
fn kernel(sigma: f64) -> Vec<f32> {
    let reach = blur_reach(sigma);
    let weights: Vec<f64> = (0..=reach).map(|d| (-0.5 * (d as f64 / sigma).powi(2)).exp()).collect();
    let total = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    weights.iter().map(|weight| (weight / total) as f32).collect()
}

/// How far a blur reaches, in samples.
pub(crate) fn blur_reach(sigma: f64) -> usize {
    (4.0 * sigma).ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_values_are_rounded_as_the_library_rounds() {
        let beside = |value: f32| [value.next_down().max(0.0), value, value.next_up().min(255.0)];
        let values: Vec<f32> = (0..=510_u16).flat_map(|half| beside(0.5 * f32::from(half))).collect();
        let rounded: Vec<u8> = values.iter().map(|value| value.round() as u8).collect();
        let field = Field { width: values.len(), height: 1, values };
        assert_eq!(field.nearest_grey_values(), rounded);
    }
}
