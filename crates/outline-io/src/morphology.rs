use crate::field::Field;

/// The largest value within `reach` samples along rows and columns (a square window), as far as the grid goes.
pub(crate) fn dilated(field: &Field, reach: usize) -> Field {
    windowed(field, reach, f32::max)
}

/// The smallest value within `reach` samples along rows and columns, as far as the grid goes.
pub(crate) fn eroded(field: &Field, reach: usize) -> Field {
    windowed(field, reach, f32::min)
}

fn windowed(field: &Field, reach: usize, better: impl Fn(f32, f32) -> f32 + Copy) -> Field {
    let (width, height) = (field.width, field.height);
    let mut values = field.values.clone();
    let mut before = vec![0.0; values.len()];
    // Windows of 1 + step values grow by at most their own length at a time, so a wide one takes few passes.
    let mut covered = 0;
    while covered < reach {
        let step = (reach - covered).min(2 * covered + 1);
        before.copy_from_slice(&values);
        // A window beyond the grid is moved back to its last sample, where it still lies within the whole window.
        let (across, down) = (step.min(width - 1), step.min(height - 1));
        for (row, from) in values.chunks_exact_mut(width).zip(before.chunks_exact(width)) {
            let (first, last) = (from[0], from[width - 1]);
            row[across..].iter_mut().zip(from).for_each(|(value, other)| *value = better(*value, *other));
            row[..across].iter_mut().for_each(|value| *value = better(*value, first));
            row.iter_mut().zip(&from[across..]).for_each(|(value, other)| *value = better(*value, *other));
            row[width - across..].iter_mut().for_each(|value| *value = better(*value, last));
        }
        before.copy_from_slice(&values);
        for (y, row) in values.chunks_exact_mut(width).enumerate() {
            for other in [y.saturating_sub(down), (y + down).min(height - 1)] {
                let from = &before[other * width..(other + 1) * width];
                row.iter_mut().zip(from).for_each(|(value, other)| *value = better(*value, *other));
            }
        }
        covered += step;
    }
    Field { width, height, values }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_window_holds_every_sample_within_its_reach(
            values in (1..9_usize, 1..9_usize).prop_flat_map(|(w, h)|
                prop::collection::vec(prop::collection::vec((0..9_u8).prop_map(f32::from), w), h)),
            reach in 0..12_usize,
        ) {
            let (width, height) = (values[0].len(), values.len());
            let field = Field { width, height, values: values.concat() };
            let (largest, smallest) = (dilated(&field, reach), eroded(&field, reach));
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
