//! Outlines as lists in memory, one row per outline.
use std::ops::Range;

use nalgebra::Point2;

use crate::error::{ReadError, ReadErrorKind};
use crate::frame::OutlineFrame;
use crate::table::column::Column;
use crate::table::keys::{
    ColumnsError, LatestOutlines, TableKeys, at, check_deviation, check_length, check_number, mark_text,
};
use crate::table::outline_rows::{OutlineRows, closed_outline};

/// Lists of values one after the other, as Arrow has them: list `i` is `values[offsets[i]..offsets[i + 1]]`.
#[derive(Debug, Clone, Copy)]
pub struct Lists<'a, T> {
    /// Where the lists begin, and where the last one ends: one more than there are lists.
    pub offsets: &'a [i64],
    /// The values of all lists.
    pub values: &'a [T],
}

impl<'a, T> Lists<'a, T> {
    fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// A list; empty if its offsets are none, which [`Self::check`] finds out.
    fn list(&self, index: usize) -> &'a [T] {
        self.range(index).and_then(|range| self.values.get(range)).unwrap_or_default()
    }

    fn range(&self, index: usize) -> Option<Range<usize>> {
        let (start, end) = (self.offsets.get(index)?, self.offsets.get(index + 1)?);
        Some(usize::try_from(*start).ok()?..usize::try_from(*end).ok()?)
    }

    fn check(&self, column: Column) -> Result<(), ColumnsError> {
        let is_there = |index: usize| self.range(index).is_some_and(|range| self.values.get(range).is_some());
        match (0..self.len()).find(|index| !is_there(*index)) {
            Some(list) => {
                let (start, end) = (self.offsets[list], self.offsets[list + 1]);
                Err(ColumnsError::Offsets { column, list, start, end, values: self.values.len() })
            }
            None => Ok(()),
        }
    }
}

/// Arcs or contours that points belong to, by number; negative for none.
#[derive(Debug, Clone, Copy, Default)]
pub enum Marks<'a> {
    /// All outlines are closed, or have one contour.
    #[default]
    None,
    /// A row is one arc or contour, and the rows of one object and frame, which follow each other, are one outline.
    OfRows(&'a [i64]),
    /// One for each point; an empty list for none.
    OfPoints(Lists<'a, i64>),
}

impl Marks<'_> {
    fn len(&self) -> Option<usize> {
        match self {
            Self::None => None,
            Self::OfRows(marks) => Some(marks.len()),
            Self::OfPoints(marks) => Some(marks.len()),
        }
    }

    fn check(&self, column: Column) -> Result<(), ColumnsError> {
        if let Self::OfPoints(marks) = self { marks.check(column) } else { Ok(()) }
    }

    /// Whether a row is a piece of an outline.
    fn is_piece(&self, row: usize) -> bool {
        matches!(self, Self::OfRows(marks) if marks[row] >= 0)
    }

    /// Of a point of a row.
    fn of(&self, row: usize, point: usize) -> i64 {
        match self {
            Self::None => -1,
            Self::OfRows(marks) => marks[row].max(-1),
            Self::OfPoints(marks) => marks.list(row).get(point).map_or(-1, |mark| (*mark).max(-1)),
        }
    }
}

/// Points of rows that follow each other, one list per row.
#[derive(Debug, Clone, Copy)]
pub struct ListChunk<'a> {
    /// First coordinates.
    pub x: Lists<'a, f64>,
    /// Second coordinates.
    pub y: Lists<'a, f64>,
    /// Arcs of open outlines.
    pub arc: Marks<'a>,
    /// Contours of closed outlines.
    pub contour: Marks<'a>,
    /// Standard deviations of the points along the normal of the contour, in the unit of the coordinates, an empty list for outlines
    /// without; `None` where no outline has them.
    pub deviation: Option<Lists<'a, f64>>,
}

impl<'a> ListChunk<'a> {
    /// The standard deviations of the points of a row; none where it states none.
    fn deviations(&self, row: usize) -> &'a [f64] {
        self.deviation.map_or(&[], |lists| lists.list(row))
    }
}

/// A table of outlines in memory with one row per outline, whose points are lists: as in Parquet, and as Arrow has it. The points may be
/// in several chunks, as in a table of record batches, and are not copied before their turn comes. Frames of an object increase from row
/// to row. [`OutlineColumns`](crate::OutlineColumns) has one row per point.
#[derive(Debug, Clone)]
pub struct OutlineLists<'a> {
    /// Names of the objects.
    pub names: &'a [String],
    /// Position of the object in `names`; `None` where all rows are of one object, which is named
    /// [`DEFAULT_OBJECT`](crate::DEFAULT_OBJECT).
    pub object: Option<&'a [u32]>,
    /// Frame number.
    pub frame: &'a [u64],
    /// Time in seconds.
    pub time: &'a [f64],
    /// The points of the rows.
    pub chunks: Vec<ListChunk<'a>>,
}

impl<'a> OutlineLists<'a> {
    /// The outlines one after the other, by the rules of Parquet files, but that rows are not ordered. Rows in the places of errors are
    /// counted from 0.
    ///
    /// ```
    /// use freeform_outline_io::{ListChunk, Lists, Marks, OutlineLists};
    ///
    /// let offsets = [0, 3, 6];
    /// let x = Lists { offsets: &offsets, values: &[0.0, 2.0, 0.0, 5.0, 7.0, 5.0] };
    /// let y = Lists { offsets: &offsets, values: &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0] };
    /// let chunks = vec![ListChunk { x, y, arc: Marks::None, contour: Marks::None, deviation: None }];
    /// let table = OutlineLists { names: &[], object: None, frame: &[0, 1], time: &[0.0, 0.1], chunks };
    /// let outlines = table.outlines()?.collect::<Result<Vec<_>, _>>()?;
    /// assert_eq!(outlines[1].outline.centroid().x, 17.0 / 3.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Columns of different lengths, an object without a name, offsets that leave their values.
    pub fn outlines(self) -> Result<ListOutlines<'a>, ColumnsError> {
        let Self { names, object, frame, time, chunks } = self;
        let keys = TableKeys { names, object, frame, time };
        keys.check()?;
        let mut rows = 0;
        for chunk in &chunks {
            check_length(Column::Y, chunk.y.len(), chunk.x.len())?;
            chunk.x.check(Column::X)?;
            chunk.y.check(Column::Y)?;
            for (column, marks) in [(Column::Arc, chunk.arc), (Column::Contour, chunk.contour)] {
                check_length(column, marks.len().unwrap_or(chunk.x.len()), chunk.x.len())?;
                marks.check(column)?;
            }
            if let Some(deviation) = chunk.deviation {
                check_length(Column::Deviation, deviation.len(), chunk.x.len())?;
                deviation.check(Column::Deviation)?;
            }
            rows += chunk.x.len();
        }
        check_length(Column::X, rows, keys.rows())?;
        let place = Place { row: 0, chunk: 0, in_chunk: 0 };
        Ok(ListOutlines { keys, chunks, place, latest: LatestOutlines::of(&keys), ended: false })
    }
}

/// A row, by its number and by its chunk.
#[derive(Debug, Clone, Copy)]
struct Place {
    row: usize,
    chunk: usize,
    in_chunk: usize,
}

/// The outlines of a table. Ends after an error that is not [recoverable](ReadError::is_recoverable).
#[derive(Debug, Clone)]
pub struct ListOutlines<'a> {
    keys: TableKeys<'a>,
    chunks: Vec<ListChunk<'a>>,
    place: Place,
    latest: LatestOutlines,
    ended: bool,
}

impl<'a> ListOutlines<'a> {
    /// The chunk of a row; chunks without rows are skipped.
    fn chunk(&self, place: &mut Place) -> Option<ListChunk<'a>> {
        loop {
            let chunk = self.chunks.get(place.chunk)?;
            if place.in_chunk < chunk.x.len() {
                return Some(*chunk);
            }
            (place.chunk, place.in_chunk) = (place.chunk + 1, 0);
        }
    }

    fn outline(&mut self) -> Option<Result<OutlineFrame, ReadError>> {
        let mut place = self.place;
        let chunk = self.chunk(&mut place)?;
        Some(self.outline_at(place, &chunk))
    }

    fn outline_at(&mut self, mut place: Place, chunk: &ListChunk<'a>) -> Result<OutlineFrame, ReadError> {
        let (keys, first) = (self.keys, place.row);
        self.latest.check(&keys, first)?;
        let (x, y) = points(chunk, place)?;
        let has_marks = !matches!((chunk.arc, chunk.contour), (Marks::None, Marks::None));
        let outline = if !has_marks && chunk.deviations(place.in_chunk).is_empty() {
            place.row += 1;
            place.in_chunk += 1;
            closed_outline(vec![x.iter().zip(y).map(|(x, y)| Point2::new(*x, *y)).collect()])
        } else {
            self.pieces(&mut place, x.len())?.into_outline().1
        };
        self.place = place;
        self.latest.set(&keys, first);
        keys.finished((first, place.row - 1), outline)
    }

    /// The points of arcs and contours, from one row or several; goes to the row behind them.
    fn pieces(&self, place: &mut Place, capacity: usize) -> Result<OutlineRows, ReadError> {
        let (keys, first) = (self.keys, place.row);
        let mut outline = keys.begin(first, capacity);
        while let Some(chunk) = self.chunk(place) {
            let (row, in_chunk) = (place.row, place.in_chunk);
            if row > first {
                let is_piece = chunk.arc.is_piece(in_chunk) || chunk.contour.is_piece(in_chunk);
                if !(keys.are_alike(row, first) && is_piece) {
                    break;
                }
                keys.check_time(row, first)?;
            }
            add_row(&mut outline, &chunk, *place)?;
            place.row += 1;
            place.in_chunk += 1;
        }
        Ok(outline)
    }
}

/// The coordinates of a row: as many of each, and finite.
fn points<'a>(chunk: &ListChunk<'a>, place: Place) -> Result<(&'a [f64], &'a [f64]), ReadError> {
    let (x, y) = (chunk.x.list(place.in_chunk), chunk.y.list(place.in_chunk));
    check_list(Column::Y, y.len(), x.len(), place.row)?;
    x.iter().try_for_each(|value| check_number(*value, Column::X, place.row))?;
    y.iter().try_for_each(|value| check_number(*value, Column::Y, place.row))?;
    Ok((x, y))
}

fn check_list(column: Column, found: usize, expected: usize, row: usize) -> Result<(), ReadError> {
    if found == expected { Ok(()) } else { Err(at(Some(column), row, ReadErrorKind::ListLength { found, expected })) }
}

/// Adds the points of a row to its outline.
fn add_row(outline: &mut OutlineRows, chunk: &ListChunk<'_>, place: Place) -> Result<(), ReadError> {
    let (row, in_chunk) = (place.row, place.in_chunk);
    let (x, y) = points(chunk, place)?;
    for (column, marks) in [(Column::Arc, chunk.arc), (Column::Contour, chunk.contour)] {
        if let Marks::OfPoints(marks) = marks
            && !marks.list(in_chunk).is_empty()
        {
            check_list(column, marks.list(in_chunk).len(), x.len(), row)?;
        }
    }
    let deviations = chunk.deviations(in_chunk);
    if !deviations.is_empty() {
        check_list(Column::Deviation, deviations.len(), x.len(), row)?;
        deviations.iter().try_for_each(|deviation| check_deviation(*deviation, row))?;
    }
    let mut latest = None;
    let mut arc_text = String::new();
    for (point, (x, y)) in x.iter().zip(y).enumerate() {
        let (arc, contour) = (chunk.arc.of(in_chunk, point), chunk.contour.of(in_chunk, point));
        // A row that is a piece begins a new one.
        let (arc_continues, contour_continues) =
            latest.map_or((false, false), |before: (i64, i64)| (before.0 == arc, before.1 == contour));
        if !arc_continues {
            arc_text = mark_text(arc);
        }
        if arc < 0 && !matches!(chunk.contour, Marks::None) && !contour_continues {
            let entered = outline.enter_contour(mark_text(contour).as_bytes(), false);
            entered.map_err(|kind| at(Some(Column::Contour), row, kind))?;
        }
        latest = Some((arc, contour));
        let added = outline.add(Point2::new(*x, *y), arc_text.as_bytes(), arc_continues, row as u64);
        added.map_err(|(kind, column)| at(column, row, kind))?;
        if let Some(deviation) = deviations.get(point) {
            outline.state_deviation(*deviation);
        }
    }
    Ok(())
}

impl Iterator for ListOutlines<'_> {
    type Item = Result<OutlineFrame, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let outline = self.outline()?;
        self.ended = outline.as_ref().is_err_and(|error| !error.is_recoverable());
        Some(outline)
    }
}
