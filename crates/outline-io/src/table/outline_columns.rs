//! Outlines as columns in memory, one row per point.
use nalgebra::Point2;

use crate::error::{ReadError, ReadErrorKind};
use crate::frame::OutlineFrame;
use crate::table::column::Column;
use crate::table::keys::{
    ColumnsError, LatestOutlines, TableKeys, at, check_deviation, check_length, check_number, mark_text,
};
use crate::table::outline_rows::{OutlineRows, closed_outline};

/// A table of outlines in memory: one entry per point in every column, as the columns of a CSV file. The rows of one outline (same frame
/// and object) follow each other in the order of the contour. [`OutlineLists`](crate::OutlineLists) has one row per outline.
#[derive(Debug, Clone, Copy)]
pub struct OutlineColumns<'a> {
    /// Names of the objects.
    pub names: &'a [String],
    /// Position of the object in `names`; `None` where all rows are of one object, which is named
    /// [`DEFAULT_OBJECT`](crate::DEFAULT_OBJECT).
    pub object: Option<&'a [u32]>,
    /// Frame number.
    pub frame: &'a [u64],
    /// Time in seconds.
    pub time: &'a [f64],
    /// First coordinate.
    pub x: &'a [f64],
    /// Second coordinate.
    pub y: &'a [f64],
    /// Number of the arc, negative for none; `None` where all outlines are closed.
    pub arc: Option<&'a [i64]>,
    /// Number of the contour, negative for none; `None` where all closed outlines have one.
    pub contour: Option<&'a [i64]>,
    /// Standard deviation along the normal of the contour, in the unit of the coordinates, NaN for all points of outlines without; `None`
    /// where no outline has them.
    pub deviation: Option<&'a [f64]>,
}

impl<'a> OutlineColumns<'a> {
    /// The outlines one after the other, by the rules of [`OutlineReader`](crate::OutlineReader). Rows in the places of errors are counted
    /// from 0.
    ///
    /// ```
    /// use freeform_outline_io::OutlineColumns;
    ///
    /// let (names, object) = (["left".to_owned(), "right".to_owned()], [0, 0, 0, 1, 1, 1]);
    /// let (x, y) = ([0.0, 2.0, 0.0, 5.0, 7.0, 5.0], [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    /// let (frame, time) = ([0; 6], [0.0; 6]);
    /// let columns = OutlineColumns {
    ///     names: &names, object: Some(&object), frame: &frame, time: &time, x: &x, y: &y,
    ///     arc: None, contour: None, deviation: None,
    /// };
    /// let outlines = columns.outlines()?.collect::<Result<Vec<_>, _>>()?;
    /// assert_eq!(outlines[1].object, "right");
    /// assert_eq!(outlines[1].outline.centroid().x, 17.0 / 3.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Columns of different lengths; an object without a name.
    pub fn outlines(&self) -> Result<ColumnOutlines<'a>, ColumnsError> {
        let Self { names, object, frame, time, .. } = *self;
        let keys = TableKeys { names, object, frame, time };
        keys.check()?;
        let expected = keys.rows();
        check_length(Column::X, self.x.len(), expected)?;
        check_length(Column::Y, self.y.len(), expected)?;
        check_length(Column::Arc, self.arc.map_or(expected, <[_]>::len), expected)?;
        check_length(Column::Contour, self.contour.map_or(expected, <[_]>::len), expected)?;
        check_length(Column::Deviation, self.deviation.map_or(expected, <[_]>::len), expected)?;
        Ok(ColumnOutlines { columns: *self, keys, row: 0, latest: LatestOutlines::of(&keys), ended: false })
    }
}

/// The outlines of a table. Ends after an error that is not [recoverable](ReadError::is_recoverable).
#[derive(Debug, Clone)]
pub struct ColumnOutlines<'a> {
    columns: OutlineColumns<'a>,
    keys: TableKeys<'a>,
    row: usize,
    latest: LatestOutlines,
    ended: bool,
}

impl ColumnOutlines<'_> {
    /// Rows that have been read.
    #[must_use]
    pub fn rows_read(&self) -> usize {
        self.row
    }

    fn outline(&mut self) -> Result<OutlineFrame, ReadError> {
        let (keys, first) = (self.keys, self.row);
        self.latest.check(&keys, first)?;
        let last = (first..keys.rows()).take_while(|row| keys.are_alike(*row, first)).last().unwrap_or(first);
        let rows = first..last + 1;
        rows.clone().try_for_each(|row| keys.check_time(row, first))?;
        let OutlineColumns { x, y, arc, contour, deviation, .. } = self.columns;
        for row in rows.clone() {
            check_number(x[row], Column::X, row)?;
            check_number(y[row], Column::Y, row)?;
            if let Some(stated) = deviation.map(|deviation| deviation[row]).filter(|stated| !stated.is_nan()) {
                check_deviation(stated, row)?;
            }
        }
        let outline = if arc.is_none() && contour.is_none() && deviation.is_none() {
            let points = x[rows.clone()].iter().zip(&y[rows]).map(|(x, y)| Point2::new(*x, *y));
            closed_outline(vec![points.collect()])
        } else {
            self.pieces(rows)?.into_outline().1
        };
        self.row = last + 1;
        self.latest.set(&keys, first);
        keys.finished((first, last), outline)
    }

    /// The points of arcs and contours, and their standard deviations.
    fn pieces(&self, rows: std::ops::Range<usize>) -> Result<OutlineRows, ReadError> {
        let OutlineColumns { x, y, arc, contour, deviation, .. } = self.columns;
        let mut outline = self.keys.begin(rows.start, rows.len());
        let mut arc_text = String::new();
        for row in rows.clone() {
            let follows = row > rows.start;
            let continues = |marks: &[i64]| follows && marks[row].max(-1) == marks[row - 1].max(-1);
            let arc_continues = arc.is_none_or(continues);
            if let Some(arc) = arc
                && !arc_continues
            {
                arc_text = mark_text(arc[row]);
            }
            if let Some(contour) = contour
                && arc_text.is_empty()
                && !continues(contour)
            {
                let entered = outline.enter_contour(mark_text(contour[row]).as_bytes(), false);
                entered.map_err(|kind| at(Some(Column::Contour), row, kind))?;
            }
            let added =
                outline.add(Point2::new(x[row], y[row]), arc_text.as_bytes(), arc_continues && follows, row as u64);
            added.map_err(|(kind, column): (ReadErrorKind, _)| at(column, row, kind))?;
            if let Some(stated) = deviation.map(|deviation| deviation[row]).filter(|stated| !stated.is_nan()) {
                outline.state_deviation(stated);
            }
        }
        Ok(outline)
    }
}

impl Iterator for ColumnOutlines<'_> {
    type Item = Result<OutlineFrame, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended || self.row == self.keys.rows() {
            return None;
        }
        let outline = self.outline();
        self.ended = outline.as_ref().is_err_and(|error| !error.is_recoverable());
        Some(outline)
    }
}
