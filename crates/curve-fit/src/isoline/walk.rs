//! Lines through the cells of a grid whose nodes are inside or outside.

/// Column and row of a node.
pub(super) type Node = [i64; 2];

/// Where a line passes between two neighbouring nodes of which one is inside: those on its left and on its right, seen with
/// columns to the right and rows upwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Step {
    pub(super) left: Node,
    pub(super) right: Node,
}

impl Step {
    /// The two nodes, the one of the lower column or row first.
    pub(super) fn ascending(self) -> [Node; 2] {
        let Self { left, right } = self;
        if left <= right { [left, right] } else { [right, left] }
    }
}

/// A line from step to step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Line {
    pub(super) steps: Vec<Step>,
    /// Whether the last step leads to the first, which is not repeated.
    pub(super) closed: bool,
}

/// Which steps of a grid have been gone.
#[derive(Debug)]
pub(super) struct Passed(Vec<u64>);

impl Passed {
    fn has(&self, index: usize) -> bool {
        self.0[index / 64] >> (index % 64) & 1 == 1
    }

    pub(super) fn mark(&mut self, index: usize) {
        self.0[index / 64] |= 1 << (index % 64);
    }
}

/// A grid of nodes. Lines end where they leave it.
pub(super) struct Grid<I, J> {
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// Whether a node is inside.
    pub(super) is_inside: I,
    /// Whether a cell with two opposite corners inside joins them; otherwise it joins those outside. Cells are told by their
    /// node of the lowest column and row.
    pub(super) joins_inside: J,
}

impl<I: Fn(Node) -> bool, J: Fn(Node) -> bool> Grid<I, J> {
    /// The lines through those of these steps that a line passes, in their order, each line once. Closed lines come whole;
    /// open ones from the step on, so that their starts are to be those at the edge of the grid.
    pub(super) fn lines(&self, starts: impl Iterator<Item = Step>) -> Vec<Line> {
        let mut passed = self.nothing_passed();
        let mut lines = Vec::new();
        for start in starts {
            if self.begins_a_line(&passed, start) {
                let line = self.follow(start);
                line.steps.iter().for_each(|step| passed.mark(self.index(*step)));
                lines.push(line);
            }
        }
        lines
    }

    /// No step of this grid.
    pub(super) fn nothing_passed(&self) -> Passed {
        // Two to a node: the way to its right and the way upwards.
        Passed(vec![0; (2 * self.columns * self.rows).div_ceil(64)])
    }

    /// Whether a line that has not been followed passes here.
    pub(super) fn begins_a_line(&self, passed: &Passed, start: Step) -> bool {
        !passed.has(self.index(start)) && (self.is_inside)(start.left) != (self.is_inside)(start.right)
    }

    /// The steps of the line from one on, not twice the same: to where it leaves the grid, or to the one before the first.
    pub(super) fn steps_from(&self, start: Step) -> impl Iterator<Item = Step> {
        std::iter::successors(Some(start), move |present| self.next(*present).filter(|next| *next != start))
    }

    pub(super) fn index(&self, step: Step) -> usize {
        let [[column, row], [_, far_row]] = step.ascending();
        2 * (row as usize * self.columns + column as usize) + usize::from(far_row > row)
    }

    fn follow(&self, start: Step) -> Line {
        let mut steps = vec![start];
        let mut present = start;
        while let Some(next) = self.next(present) {
            if next == start {
                return Line { steps, closed: true };
            }
            steps.push(next);
            present = next;
        }
        Line { steps, closed: false }
    }

    /// Crosses the cell ahead; `None` where the grid ends.
    fn next(&self, Step { left, right }: Step) -> Option<Step> {
        let across = [right[0] - left[0], right[1] - left[1]];
        let ahead = |[column, row]: Node| [column - across[1], row + across[0]];
        let (far_left, far_right) = (ahead(left), ahead(right));
        // Both are in the grid, or neither.
        let is_in_grid =
            (0..self.columns as i64).contains(&far_left[0]) && (0..self.rows as i64).contains(&far_left[1]);
        if !is_in_grid {
            return None;
        }
        let inside = (self.is_inside)(left);
        let is_as_left = |node: Node| (self.is_inside)(node) == inside;
        let (turned_left, turned_right) = (Step { left, right: far_left }, Step { left: far_right, right });
        Some(match (is_as_left(far_left), is_as_left(far_right)) {
            (true, false) => Step { left: far_left, right: far_right },
            (false, false) => turned_left,
            (true, true) => turned_right,
            (false, true) => {
                let column = left[0].min(right[0]).min(far_left[0]);
                let row = left[1].min(right[1]).min(far_left[1]);
                let joins_left = (self.joins_inside)([column, row]) == inside;
                if joins_left { turned_right } else { turned_left }
            }
        })
    }
}
