use freeform_curve_fit::isoline::{self, Crossing};

/// Grey values on a grid of samples, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Field {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) values: Vec<f32>,
}

impl Field {
    /// Where the grey value passes a level, between the samples.
    pub(crate) fn isolines(&self, level: f64) -> Vec<Vec<Crossing>> {
        isoline::of_samples([self.width, self.height], |x, y| f64::from(self.values[y * self.width + x]), level)
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

    /// Blurs with a Gaussian of this standard deviation in samples. Beyond the grid its edge goes on, so that a contour
    /// that meets the edge is not bent there.
    pub(crate) fn blur(&mut self, sigma: f64) {
        let weights = kernel(sigma);
        let (width, height) = (self.width, self.height);
        let mut line = vec![0.0; width.max(height)];
        for row in self.values.chunks_exact_mut(width) {
            line[..width].copy_from_slice(row);
            for (x, value) in row.iter_mut().enumerate() {
                *value = weighted_sum(&line[..width], x, &weights);
            }
        }
        // Row by row in both directions: going down the columns would miss the cache at every step.
        let across = self.values.clone();
        for (y, row) in self.values.chunks_exact_mut(width).enumerate() {
            row.fill(0.0);
            for (distance, &weight) in weights.iter().enumerate() {
                let below = (y + distance).min(height - 1) * width;
                let above = y.saturating_sub(distance) * width;
                let weight = if distance == 0 { 0.5 * weight } else { weight };
                for ((value, a), b) in row.iter_mut().zip(&across[below..below + width]).zip(&across[above..]) {
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

fn weighted_sum(line: &[f32], x: usize, weights: &[f32]) -> f32 {
    let last = line.len() - 1;
    let sides = |d: usize| line[(x + d).min(last)] + line[x.saturating_sub(d)];
    let around: f32 = weights.iter().enumerate().skip(1).map(|(d, weight)| weight * sides(d)).sum();
    weights[0] * line[x] + around
}
