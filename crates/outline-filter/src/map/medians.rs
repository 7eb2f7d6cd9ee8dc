//! Medians.
use crate::{
    tuning::contour::ABOUT,
    vectors::{LANES, Lanes, vectorised},
};

/// Median, the upper one of two; reorders the list.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Puts the numbers of two lists in order, place by place.
#[inline(always)]
fn exchange(values: &mut [Lanes; 9], a: usize, b: usize) {
    let (x, y) = (values[a], values[b]);
    for lane in 0..LANES {
        values[a][lane] = if x[lane] < y[lane] { x[lane] } else { y[lane] };
        values[b][lane] = if x[lane] < y[lane] { y[lane] } else { x[lane] };
    }
}

/// Middle ones of all that nine lists side by side hold in a place, by the exchanges of J. L. Smith's network (Implementing median filters in
/// XC4000E FPGAs, 1996).
#[inline(always)]
fn medians_of_nine(mut values: [Lanes; 9]) -> Lanes {
    // Written one by one, so that all nine stay in registers.
    exchange(&mut values, 1, 2);
    exchange(&mut values, 4, 5);
    exchange(&mut values, 7, 8);
    exchange(&mut values, 0, 1);
    exchange(&mut values, 3, 4);
    exchange(&mut values, 6, 7);
    exchange(&mut values, 1, 2);
    exchange(&mut values, 4, 5);
    exchange(&mut values, 7, 8);
    exchange(&mut values, 0, 3);
    exchange(&mut values, 5, 8);
    exchange(&mut values, 4, 7);
    exchange(&mut values, 3, 6);
    exchange(&mut values, 1, 4);
    exchange(&mut values, 2, 5);
    exchange(&mut values, 4, 7);
    exchange(&mut values, 4, 2);
    exchange(&mut values, 6, 4);
    exchange(&mut values, 4, 2);
    values[4]
}

/// Medians of the nine numbers from each place on, one for each place that has so many.
pub(super) fn running_medians_of_nine(numbers: &[f64]) -> Vec<f64> {
    let count = (numbers.len() + 1).saturating_sub(9);
    if count < LANES {
        let all = numbers.windows(9).filter_map(|nine| median(&mut nine.to_vec()));
        return all.collect();
    }
    let mut medians = vec![0.0; count];
    vectorised(
        #[inline(always)]
        || {
            for start in (0..count).step_by(LANES) {
                // The last ones are found again where their number is no multiple of the lanes.
                let start = start.min(count - LANES);
                let near = &numbers[start..][..LANES + 8];
                let mut values = [[0.0; LANES]; 9];
                for (offset, values) in values.iter_mut().enumerate() {
                    values.copy_from_slice(&near[offset..][..LANES]);
                }
                medians[start..][..LANES].copy_from_slice(&medians_of_nine(values));
            }
        },
    );
    medians
}

/// As [`median`], of sizes of which most are expected to be about a guess or below it: only those about it are put in order, the others are
/// counted. Overwrites the list.
pub(crate) fn median_about(guess: f64, sizes: &mut [f64]) -> Option<f64> {
    let middle = sizes.len() / 2;
    for [low, high] in ABOUT.map(|shares| shares.map(|share| share * guess)) {
        let [below, within] = counts_below([low, high], sizes);
        if !(below..within).contains(&middle) {
            continue;
        }
        let mut kept = 0;
        for i in 0..sizes.len() {
            let size = sizes[i];
            // Written in any case: which of them are kept cannot be foreseen, and a branch that is not costs more than all else here.
            sizes[kept] = size;
            kept += usize::from((size >= low) & (size < high));
        }
        return Some(*sizes[..kept].select_nth_unstable_by(middle - below, f64::total_cmp).1);
    }
    median(sizes)
}

/// How many of the sizes are below each limit.
fn counts_below(limits: [f64; 2], sizes: &[f64]) -> [usize; 2] {
    let (chunks, rest) = sizes.as_chunks::<LANES>();
    let counts = vectorised(
        #[inline(always)]
        || {
            let mut counts = [[0.0; LANES]; 2];
            for sizes in chunks {
                for (counts, limit) in counts.iter_mut().zip(limits) {
                    for lane in 0..LANES {
                        counts[lane] += if sizes[lane] < limit { 1.0 } else { 0.0 };
                    }
                }
            }
            counts
        },
    );
    [0, 1].map(|at| {
        let of_rest = rest.iter().filter(|size| **size < limits[at]).count();
        counts[at].iter().sum::<f64>() as usize + of_rest
    })
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    use super::*;

    #[test]
    fn the_network_finds_the_medians_of_nine() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        for count in (0..30).chain([1000]) {
            let mut numbers: Vec<f64> = (0..count).map(|_| StandardNormal.sample(&mut rng)).collect();
            (4..count).step_by(7).for_each(|i| numbers[i] = numbers[i - 4]);
            let expected: Vec<f64> = numbers.windows(9).filter_map(|nine| median(&mut nine.to_vec())).collect();
            assert_eq!(running_medians_of_nine(&numbers), expected, "{count}");
        }
    }

    #[test]
    fn the_median_about_a_guess_is_the_median_whatever_the_guess() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        for count in [0, 1, 2, 7, 100, 401, 1602] {
            let sizes: Vec<f64> = (0..count)
                .map(|_| {
                    let x: f64 = StandardNormal.sample(&mut rng);
                    x.abs()
                })
                .collect();
            for guess in [0.0, 0.3, 0.6, 0.6745, 0.7, 1.5, f64::INFINITY, f64::NAN] {
                assert_eq!(median_about(guess, &mut sizes.clone()), median(&mut sizes.clone()), "{count} {guess}");
            }
        }
    }
}
