//! Dilation and erosion of grey values.
use crate::tracing::field::Field;

/// Columns that are worked on together: few enough for those of a picture of some thousand rows to stay in the cache.
const STRIP: usize = 32;

/// The largest value within `reach` samples along rows and columns (a square window), as far as the grid goes.
pub(crate) fn dilated(field: &Field, reach: usize) -> Field {
    windowed(field, reach, larger)
}

/// The smallest value within `reach` samples along rows and columns, as far as the grid goes.
pub(crate) fn eroded(field: &Field, reach: usize) -> Field {
    windowed(field, reach, smaller)
}

fn windowed(field: &Field, reach: usize, better: impl Fn(f32, f32) -> f32 + Copy) -> Field {
    let mut windows = Windows::new(reach);
    let mut values = field.values.clone();
    windows.along_rows(&mut values, field.width, better);
    windows.along_columns(&mut values, field.width, |strip| strip.of(better));
    Field { width: field.width, height: field.height, values }
}

/// What is left of a field where nothing narrower than a window of `reach` samples to all sides stands out: [`dilated`] of [`eroded`].
pub(crate) fn opened(field: &Field, reach: usize) -> Field {
    let mut windows = Windows::new(reach);
    let mut values = field.values.clone();
    windows.along_rows(&mut values, field.width, smaller);
    windows.along_columns(&mut values, field.width, |strip| {
        strip.of(smaller);
        strip.of(larger);
    });
    windows.along_rows(&mut values, field.width, larger);
    Field { width: field.width, height: field.height, values }
}

// Values are numbers: the processor has an instruction for these, and none for `f32::max`, which passes over what is no number.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Windows of 1 + 2 `reach` samples, and what they are worked out in.
struct Windows {
    reach: usize,
    /// Lines beside each other, of `stride` samples side by side.
    line: Vec<f32>,
    spare: Vec<f32>,
    stride: usize,
}

impl Windows {
    fn new(reach: usize) -> Self {
        Self { reach, line: Vec::new(), spare: Vec::new(), stride: 1 }
    }

    fn along_rows(&mut self, values: &mut [f32], width: usize, better: impl Fn(f32, f32) -> f32 + Copy) {
        self.stride = 1;
        for row in values.chunks_exact_mut(width.max(1)) {
            self.line.clear();
            self.line.extend_from_slice(row);
            self.of(better);
            row.copy_from_slice(&self.line);
        }
    }

    fn along_columns(&mut self, values: &mut [f32], width: usize, of_strip: impl Fn(&mut Self)) {
        for left in (0..width).step_by(STRIP) {
            let columns = left..(left + STRIP).min(width);
            self.stride = columns.len();
            self.line.clear();
            values.chunks_exact(width).for_each(|row| self.line.extend_from_slice(&row[columns.clone()]));
            of_strip(self);
            for (row, line) in values.chunks_exact_mut(width).zip(self.line.chunks_exact(self.stride)) {
                row[columns.clone()].copy_from_slice(line);
            }
        }
    }

    /// The best of the window around every sample of the lines.
    fn of(&mut self, better: impl Fn(f32, f32) -> f32 + Copy) {
        let (length, stride) = (self.line.len(), self.stride);
        if length < stride {
            return;
        }
        let margin = self.reach * stride;
        // The first and the last sample go on beyond the ends: windows that reach there hold them anyway.
        self.spare.clear();
        (0..self.reach).for_each(|_| self.spare.extend_from_slice(&self.line[..stride]));
        self.spare.extend_from_slice(&self.line);
        (0..self.reach).for_each(|_| self.spare.extend_from_slice(&self.line[length - stride..]));
        std::mem::swap(&mut self.line, &mut self.spare);
        // Windows that begin at a sample, of twice the length in every pass, and the last one of what is left.
        let (mut covered, whole) = (stride, 2 * margin + stride);
        while covered < whole {
            let step = covered.min(whole - covered);
            let count = self.line.len() - step;
            self.spare.clear();
            let pairs = self.line[..count].iter().zip(&self.line[step..]);
            self.spare.extend(pairs.map(|(value, other)| better(*value, *other)));
            std::mem::swap(&mut self.line, &mut self.spare);
            covered += step;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_window_holds_every_sample_within_its_reach(
            values in (1..80_usize, 1..9_usize).prop_flat_map(|(w, h)|
                prop::collection::vec(prop::collection::vec((0..9_u8).prop_map(f32::from), w), h)),
            reach in 0..12_usize,
        ) {
            let (width, height) = (values[0].len(), values.len());
            let field = Field { width, height, values: values.concat() };
            let (largest, smallest) = (dilated(&field, reach), eroded(&field, reach));
            prop_assert_eq!(&opened(&field, reach).values, &dilated(&smallest, reach).values);
            for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
                let rows = values[y.saturating_sub(reach)..height.min(y + reach + 1)].iter();
                let window: Vec<f32> = rows
                    .flat_map(|row| row[x.saturating_sub(reach)..width.min(x + reach + 1)].iter().copied())
                    .collect();
                prop_assert_eq!(largest.values[y * width + x], window.iter().copied().fold(f32::MIN, f32::max));
                prop_assert_eq!(smallest.values[y * width + x], window.iter().copied().fold(f32::MAX, f32::min));
            }
        }
    }
}
