//! Points where no outline is known: beyond a known end of it, and on from there along the contour.
//!
//! Of an arc that was hidden so far the points next to a known end lie beyond it. Further on they may lie anywhere, nearest to what is across or to
//! another end, and look like outliers. What tells them from outliers is that the contour leaves the outline where that ends: in a wrong pose it
//! leaves it anywhere.
use super::Piece;

/// Where a point of a contour lies in a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Lies {
    OnOutline,
    /// Too far from it to count.
    Off,
    /// Nearest to a known end, and beyond it.
    BeyondEnd,
}

impl Lies {
    pub(crate) fn of(is_beyond_end: bool, is_on_outline: bool) -> Self {
        match (is_beyond_end, is_on_outline) {
            (true, _) => Self::BeyondEnd,
            (false, true) => Self::OnOutline,
            (false, false) => Self::Off,
        }
    }
}

/// Calls `hide` with the points off the outline that are parts of hidden arcs: of a piece of so many points, runs of points that do not lie on the
/// outline, and lie beyond an end of it wherever they border on points that do. The piece begins and ends anywhere if it is open. What `lies` tells
/// of a point comes from `of_points`, in which `hide` may change what it is called with.
pub(crate) fn hide_points<S: ?Sized>(
    of_points: &mut S,
    (count, closed): (usize, bool),
    lies: impl Fn(&S, usize) -> Lies,
    mut hide: impl FnMut(&mut S, usize),
) {
    let start = if closed { (0..count).find(|i| lies(of_points, *i) == Lies::OnOutline) } else { Some(0) };
    let Some(start) = start else { return };
    let at = |k: usize| if start + k < count { start + k } else { start + k - count };
    let mut next = 0;
    while next < count {
        let first = next;
        while next < count && lies(of_points, at(next)) != Lies::OnOutline {
            next += 1;
        }
        if next == first {
            next += 1;
            continue;
        }
        // Noise takes the first point of an arc over the end now and then.
        let run = first..next;
        let leaves_at_end = |list: &S, two: [usize; 2]| {
            two.into_iter().any(|k| run.contains(&k) && lies(list, at(k)) == Lies::BeyondEnd)
        };
        let borders = [closed || first > 0, closed || next < count];
        let at_ends = [[first, first + 1], [next - 1, next.saturating_sub(2)]].map(|two| leaves_at_end(of_points, two));
        if borders == [false; 2] || (0..2).any(|side| borders[side] && !at_ends[side]) {
            continue;
        }
        for k in run {
            if lies(of_points, at(k)) == Lies::Off {
                hide(of_points, at(k));
            }
        }
    }
}

/// [`hide_points`] of all pieces of a contour, with the numbers that points have in the whole of it.
pub(super) fn hide_points_of_pieces<S: ?Sized>(
    of_points: &mut S,
    pieces: &[Piece],
    lies: impl Fn(&S, usize) -> Lies,
    mut hide: impl FnMut(&mut S, usize),
) {
    for piece in pieces {
        let range = piece.range();
        let start = range.start;
        hide_points(
            of_points,
            (range.len(), piece.closed),
            |of_points, i| lies(of_points, start + i),
            |of_points, i| hide(of_points, start + i),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is hidden of points that lie on the outline (o), off it (x) and beyond an end (e).
    fn hidden(points: &str, closed: bool) -> Vec<usize> {
        let lies: Vec<_> = points
            .chars()
            .map(|c| match c {
                'o' => Lies::OnOutline,
                'x' => Lies::Off,
                _ => Lies::BeyondEnd,
            })
            .collect();
        let count = lies.len();
        let mut of_points = (lies, Vec::new());
        hide_points(&mut of_points, (count, closed), |(lies, _), i| lies[i], |(_, hidden), i| hidden.push(i));
        let mut hidden = of_points.1;
        hidden.sort_unstable();
        hidden
    }

    #[test]
    fn points_are_hidden_where_the_contour_leaves_the_outline_at_ends_and_outliers_are_not() {
        assert_eq!(hidden("oooexxxeoo", true), [4, 5, 6]);
        assert_eq!(hidden("xxeoooooex", true), [0, 1, 9]);
        assert_eq!(hidden("ooxexxxeoo", true), [2, 4, 5, 6]);
        // It returns elsewhere than at an end, or leaves it elsewhere.
        assert_eq!(hidden("oooexxxxoo", true), []);
        assert_eq!(hidden("ooxxxxeooo", true), []);
        assert_eq!(hidden("ooxooxxooo", true), []);
        // An open piece may end anywhere.
        assert_eq!(hidden("oooexxx", false), [4, 5, 6]);
        assert_eq!(hidden("xxxeooo", false), [0, 1, 2]);
        assert_eq!(hidden("ooooxxx", false), []);
        // What shows nothing of the outline is no part of it.
        assert_eq!(hidden("xxexx", false), []);
        assert_eq!(hidden("xxexx", true), []);
        assert_eq!(hidden("", true), []);
    }
}
