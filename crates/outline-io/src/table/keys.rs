//! What a table in memory says of its rows beside their points: object, frame, time. Shared by tables of points and of outlines.
use freeform_curve_fit::{Outline, OutlineError};

use crate::csv_file::field::{NUMBER_LIMIT, positive};
use crate::error::{Place, ReadError, ReadErrorKind, Span};
use crate::frame::{DEFAULT_OBJECT, OutlineFrame};
use crate::table::column::Column;
use crate::table::latest_frames::check_order;
use crate::table::outline_rows::OutlineRows;

/// Name of a table in messages.
const TABLE: &str = "<table>";

/// Why columns do not form a table.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ColumnsError {
    /// A column has another length than the column `frame`.
    #[error("column {column} has {found} rows, column frame has {expected}")]
    Length {
        /// The column.
        column: Column,
        /// Its rows.
        found: usize,
        /// Rows of the column `frame`.
        expected: usize,
    },
    /// An object without a name.
    #[error("row {row} is of object {position}, there are {names} names")]
    NoName {
        /// The row, counted from 0.
        row: usize,
        /// Position of the object.
        position: u32,
        /// Number of names.
        names: usize,
    },
    /// A list that ends before it begins, or beyond the values.
    #[error("column {column}: list {list} of a chunk is from {start} to {end} of {values} values")]
    Offsets {
        /// The column.
        column: Column,
        /// The list, counted from 0 in its chunk.
        list: usize,
        /// Where it begins.
        start: i64,
        /// Where it ends.
        end: i64,
        /// Number of values.
        values: usize,
    },
}

/// The columns of a table that say what a row is of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TableKeys<'a> {
    pub(crate) names: &'a [String],
    pub(crate) object: Option<&'a [u32]>,
    pub(crate) frame: &'a [u64],
    pub(crate) time: &'a [f64],
}

impl TableKeys<'_> {
    pub(crate) fn rows(&self) -> usize {
        self.frame.len()
    }

    /// All columns have one length, and all objects a name.
    pub(crate) fn check(&self) -> Result<(), ColumnsError> {
        check_length(Column::Time, self.time.len(), self.rows())?;
        check_length(Column::Object, self.object.map_or(self.rows(), <[_]>::len), self.rows())?;
        let names = self.names.len();
        let mut objects = self.object.unwrap_or_default().iter().enumerate();
        match objects.find(|(_, position)| **position as usize >= names) {
            Some((row, &position)) => Err(ColumnsError::NoName { row, position, names }),
            None => Ok(()),
        }
    }

    pub(crate) fn object(&self, row: usize) -> usize {
        self.object.map_or(0, |column| column[row] as usize)
    }

    pub(crate) fn name(&self, row: usize) -> &str {
        self.object.and_then(|column| self.names.get(column[row] as usize)).map_or(DEFAULT_OBJECT, String::as_str)
    }

    /// Whether two rows are of one object and frame.
    pub(crate) fn are_alike(&self, a: usize, b: usize) -> bool {
        self.frame[a] == self.frame[b] && self.object(a) == self.object(b)
    }

    /// Refuses a row whose time is not that of the first row of its outline.
    pub(crate) fn check_time(&self, row: usize, first: usize) -> Result<(), ReadError> {
        let (time, previous) = (self.time[row], self.time[first]);
        if time == previous {
            return Ok(());
        }
        check_number(time, Column::Time, row)?;
        let (object, frame) = (self.name(first).to_owned(), self.frame[first]);
        Err(at(Some(Column::Time), row, ReadErrorKind::TimeChanges { object, frame, previous, time }))
    }

    /// The outline of some rows, from what was gathered of them.
    pub(crate) fn finished(
        &self,
        (first, last): (usize, usize),
        outline: Result<Outline, OutlineError>,
    ) -> Result<OutlineFrame, ReadError> {
        let (frame, time, object) = (self.frame[first], self.time[first], self.name(first).to_owned());
        match outline {
            Ok(outline) => Ok(OutlineFrame { frame, time, object, outline }),
            Err(source) => {
                let span = Some(Span::Rows(first as u64, last as u64));
                let place = Place { file: TABLE.to_owned(), span, column: None };
                Err(ReadError { place, kind: ReadErrorKind::Degenerate { object, frame, source } })
            }
        }
    }

    /// Where the points of an outline that begins in a row are gathered.
    pub(crate) fn begin(&self, row: usize, capacity: usize) -> OutlineRows {
        OutlineRows::new(self.frame[row], self.time[row], self.name(row).to_owned(), row as u64, capacity)
    }
}

/// Frame number and time of the latest outline of every object of a table.
#[derive(Debug, Clone)]
pub(crate) struct LatestOutlines(Vec<Option<(u64, f64)>>);

impl LatestOutlines {
    pub(crate) fn of(keys: &TableKeys<'_>) -> Self {
        Self(vec![None; keys.object.map_or(1, |_| keys.names.len())])
    }

    /// Frames and times of an object increase, and are numbers.
    pub(crate) fn check(&self, keys: &TableKeys<'_>, row: usize) -> Result<(), ReadError> {
        let (frame, time) = (keys.frame[row], keys.time[row]);
        check_number(time, Column::Time, row)?;
        let Some(latest) = self.0[keys.object(row)] else { return Ok(()) };
        check_order(keys.name(row), (frame, time), latest).map_err(|(column, kind)| at(Some(column), row, kind))
    }

    pub(crate) fn set(&mut self, keys: &TableKeys<'_>, row: usize) {
        self.0[keys.object(row)] = Some((keys.frame[row], keys.time[row]));
    }
}

pub(crate) fn check_length(column: Column, found: usize, expected: usize) -> Result<(), ColumnsError> {
    if found == expected { Ok(()) } else { Err(ColumnsError::Length { column, found, expected }) }
}

/// Refuses what a file may not hold either.
pub(crate) fn check_number(value: f64, column: Column, row: usize) -> Result<(), ReadError> {
    if !value.is_finite() {
        return Err(at(Some(column), row, ReadErrorKind::NotFinite { text: value.to_string() }));
    }
    if value.abs() > NUMBER_LIMIT {
        return Err(at(Some(column), row, ReadErrorKind::TooLarge { value, limit: NUMBER_LIMIT }));
    }
    Ok(())
}

/// Refuses what is no standard deviation.
pub(crate) fn check_deviation(value: f64, row: usize) -> Result<(), ReadError> {
    check_number(value, Column::Deviation, row)?;
    positive(value).map(drop).map_err(|kind| at(Some(Column::Deviation), row, kind))
}

pub(crate) fn at(column: Option<Column>, row: usize, kind: ReadErrorKind) -> ReadError {
    let span = Some(Span::Rows(row as u64, row as u64));
    ReadError { place: Place { file: TABLE.to_owned(), span, column }, kind }
}

/// The text of an arc or contour by which pieces are told apart; empty for none.
pub(crate) fn mark_text(mark: i64) -> String {
    if mark < 0 { String::new() } else { mark.to_string() }
}
