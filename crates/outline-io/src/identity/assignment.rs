//! Which things of one list belong to which of another, so that all pairs together fit best: the linear assignment problem.
//!
//! The Kuhn-Munkres algorithm (H. Kuhn, *The Hungarian method for the assignment problem*, 1955) of the crate `pathfinding`
//! solves it exactly, for lists of different lengths. It adds five small crates, two of them at build time only. `lapjv`
//! (R. Jonker, A. Volgenant, 1987) would add three, but one of them is `ndarray`; it takes square matrices only, and is declared
//! to be maintained as it is, where `pathfinding` is worked on all the time.
use pathfinding::kuhn_munkres::kuhn_munkres;
use pathfinding::matrix::Matrix;

/// Parts that the largest cost is counted in. Whole numbers, since the algorithm compares sums for equality.
const RESOLUTION: f64 = (1_u64 << 32) as f64;

/// Pairs rows with columns, each with one at most; returns the column of each row. `cost` is from 0 to `largest`, or `None`
/// where row and column must not be paired; it is asked once for every pair.
///
/// The sum over all pairs of what each costs less than `largest` is as large as it can be, to 2^-32 of it: of a row and a
/// column that might be paired, to be left over is as bad as the worst pair. So what can be paired with one thing only is,
/// unless that is wanted elsewhere.
pub(crate) fn assign(
    [rows, columns]: [usize; 2],
    cost: impl Fn(usize, usize) -> Option<f64>,
    largest: f64,
) -> Vec<Option<usize>> {
    // The algorithm finds the largest sum, leaves no row over and wants no fewer columns. So the shorter list goes down the
    // rows, what must not be paired is worth nothing, and what may be is worth a little at least.
    let worth =
        |row, column| cost(row, column).map_or(0, |cost| 1 + (RESOLUTION * (1.0 - cost / largest)).max(0.0) as i64);
    let is_wide = rows <= columns;
    let worths = Matrix::from_fn(rows.min(columns), rows.max(columns), |(short, long)| {
        if is_wide { worth(short, long) } else { worth(long, short) }
    });
    let (_, assigned) = kuhn_munkres(&worths);
    let mut found = vec![None; rows];
    for (short, long) in assigned.into_iter().enumerate().filter(|pair| worths[*pair] > 0) {
        let (row, column) = if is_wide { (short, long) } else { (long, short) };
        found[row] = Some(column);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Costs = Vec<Vec<Option<f64>>>;

    fn assigned(costs: &Costs, columns: usize) -> Vec<Option<usize>> {
        assign([costs.len(), columns], |row, column| costs[row][column], 3.0)
    }

    /// What pairs are worth together; `None` where one must not be or a column is paired twice.
    fn worth(costs: &Costs, columns_of_rows: &[Option<usize>]) -> Option<f64> {
        let pairs: Vec<_> =
            columns_of_rows.iter().enumerate().filter_map(|(row, column)| Some((row, (*column)?))).collect();
        let is_paired_twice =
            pairs.iter().enumerate().any(|(k, pair)| pairs[..k].iter().any(|other| other.1 == pair.1));
        let worths = pairs.iter().map(|&(row, column)| costs[row][column].map(|cost| 3.0 - cost));
        if is_paired_twice { None } else { worths.sum() }
    }

    /// The most that any pairs of these rows with columns that are not used are worth.
    fn largest_worth(costs: &[Vec<Option<f64>>], used: &mut Vec<bool>) -> f64 {
        let Some((row, others)) = costs.split_first() else { return 0.0 };
        let mut largest = largest_worth(others, used);
        for (column, cost) in row.iter().enumerate() {
            if let (Some(cost), false) = (cost, used[column]) {
                used[column] = true;
                largest = largest.max(3.0 - cost + largest_worth(others, used));
                used[column] = false;
            }
        }
        largest
    }

    #[test]
    fn the_best_pair_is_given_up_where_all_pairs_together_are_better() {
        // The best pair first would leave the worst one over.
        let costs = vec![vec![Some(0.5), Some(2.9)], vec![Some(0.1), Some(0.4)]];
        assert_eq!(assigned(&costs, 2), [Some(0), Some(1)]);
    }

    #[test]
    fn only_what_may_be_paired_is_and_what_has_one_choice_takes_it_however_bad() {
        assert_eq!(assigned(&vec![vec![None, Some(3.0)], vec![None, None]], 2), [Some(1), None]);
        assert_eq!(assigned(&vec![vec![Some(3.0)], vec![None], vec![Some(2.0)]], 1), [None, None, Some(0)]);
        assert_eq!(assigned(&vec![], 4), []);
        assert_eq!(assigned(&vec![vec![], vec![]], 0), [None, None]);
    }

    proptest! {
        #[test]
        fn no_other_pairs_are_worth_more(
            (columns, costs) in (0..6_usize).prop_flat_map(|columns| {
                let cost = prop::option::weighted(0.7, 0.0..=3.0_f64);
                (Just(columns), prop::collection::vec(prop::collection::vec(cost, columns), 0..6))
            }),
        ) {
            let found = worth(&costs, &assigned(&costs, columns)).expect("pairs that may be, each column once");
            prop_assert!((found - largest_worth(&costs, &mut vec![false; columns])).abs() < 1e-7);
        }
    }
}
