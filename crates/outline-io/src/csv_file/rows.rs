//! Rows of CSV one by one, with their line numbers.
use std::io::{self, Chain, Cursor, Read};

use csv::{ByteRecord, ReaderBuilder, Terminator};
use nalgebra::Point2;

use crate::csv_file::columns::{HeaderError, Role};
use crate::csv_file::field::{leading_number, number, unquoted_length};
use crate::csv_file::lines::{COMMENT, Lines, ROW_LIMIT};
use crate::csv_file::not_csv::{HEAD_LENGTH, not_csv};
use crate::error::{Place, ReadError, ReadErrorKind, Span};
use crate::table::column::Column;

/// The rows of a CSV file one after the other, with their line numbers; comments and blank lines left out. Two rows
/// are held at a time, whatever the length of the file.
///
/// Most rows repeat the one before in all but the point, see [`Self::next_point`]; all others are read by the csv
/// crate. It is given one line at a time, so that it holds no more of the file than the row that it returns, and both
/// can take turns.
#[derive(Debug)]
pub(crate) struct Rows<R> {
    file: String,
    reader: csv::Reader<Lines<Chain<Cursor<Vec<u8>>, R>>>,
    field_count: usize,
    /// The latest row that the csv crate has read.
    row: ByteRecord,
    /// Whether that row reads the same without quotes.
    needs_no_quotes: bool,
    /// Whether that row is still to be handed out: it came where a header was expected.
    is_put_back: bool,
    /// Lines that the csv crate has not seen.
    lines_repeated: u64,
    previous: ByteRecord,
}

impl<R: Read> Rows<R> {
    /// Reads the header and lets `columns` find its way in it.
    pub(crate) fn open<C>(
        mut source: R,
        file: String,
        columns: impl Fn(&ByteRecord) -> Result<C, HeaderError>,
    ) -> Result<(Self, C), ReadError> {
        // The csv crate takes a byte order mark off too, but only where the first read returns all of it.
        let mut start = Vec::new();
        let head = source.by_ref().take(HEAD_LENGTH).read_to_end(&mut start);
        if let Some(kind) = head.err().map(ReadErrorKind::Io).or_else(|| not_csv(&start, &file)) {
            return Err(ReadError { place: Place { file, span: None, column: None }, kind });
        }
        if start.starts_with(b"\xef\xbb\xbf") {
            start.drain(..3);
        }
        // Ending rows at "\n" alone makes line numbers exact; the "\r" of a "\r\n" falls to trimming.
        let reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(COMMENT))
            .terminator(Terminator::Any(b'\n'))
            .from_reader(Lines::new(Cursor::new(start).chain(source)));
        let (row, previous) = (ByteRecord::new(), ByteRecord::new());
        let mut rows = Self {
            file,
            reader,
            field_count: 0,
            row,
            needs_no_quotes: false,
            is_put_back: false,
            lines_repeated: 0,
            previous,
        };
        if !rows.read_row()? {
            // Comments alone: of what follows them, where no line ends, all is a comment too.
            let has_returns_alone = rows.reader.get_ref().has_returns_alone();
            let kind = if has_returns_alone { ReadErrorKind::LineEnds } else { ReadErrorKind::Empty };
            return Err(rows.error_at(None, None, kind));
        }
        if rows.reader.get_ref().has_returns_alone() && rows.row.as_slice().trim_ascii_end().contains(&b'\r') {
            return Err(rows.error_at(None, None, ReadErrorKind::LineEnds));
        }
        rows.field_count = rows.row.len();
        let found = match columns(&rows.row) {
            Err(error @ (_, ReadErrorKind::MissingColumns { .. })) => {
                let found = rows.columns_of_comment(columns).ok_or(error);
                rows.is_put_back = found.is_ok();
                found
            }
            found => found,
        };
        let found = found.map_err(|(column, kind)| rows.error(column, kind))?;
        if !rows.is_put_back {
            rows.row.clear();
        }
        rows.needs_no_quotes = false;
        Ok((rows, found))
    }

    /// Moves to the next row and returns its point, with its standard deviation where there is one, provided that what is buffered begins with that
    /// row, that it has no quotes and that it agrees with the row before to the byte wherever that is the role of a column. Otherwise
    /// nothing changes, and [`Self::advance`] is to be called. There is a role for every column.
    pub(crate) fn next_point(&mut self, roles: &[Role]) -> Option<(Point2<f64>, Option<f64>)> {
        let mut rest = self.reader.get_ref().buffered();
        if !self.needs_no_quotes || rest.first() == Some(&COMMENT) {
            return None;
        }
        let (mut point, mut deviation) = (Point2::origin(), None);
        let length = rest.len();
        for (index, role) in roles.iter().enumerate() {
            let used = match *role {
                Role::Coordinate(axis) => {
                    let (value, used) = leading_number(rest)?;
                    point[axis] = value;
                    used
                }
                Role::Deviation => {
                    let (value, used) = leading_number(rest).filter(|(value, _)| *value > 0.0)?;
                    deviation = Some(value);
                    used
                }
                Role::Outline => rest.starts_with(&self.row[index]).then_some(self.row[index].len())?,
                Role::Ignored => unquoted_length(rest)?,
            };
            let (end, after) = rest[used..].split_first()?;
            let expected = if index + 1 == roles.len() { b'\n' } else { b',' };
            if *end != expected {
                return None;
            }
            rest = after;
        }
        let length = length - rest.len();
        self.reader.get_mut().skip_line(length);
        self.lines_repeated += 1;
        Some((point, deviation))
    }

    /// Moves to the next row; false at the end of the file. The row has as many fields as the header.
    pub(crate) fn advance(&mut self) -> Result<bool, ReadError> {
        if !self.read_row()? {
            return Ok(false);
        }
        let (found, expected) = (self.row.len(), self.field_count);
        if found == expected {
            return Ok(true);
        }
        let cut = found < expected && self.reader.get_ref().ended_within_line();
        let kind = if cut {
            ReadErrorKind::CutShort { found, expected }
        } else {
            ReadErrorKind::FieldCount { found, expected }
        };
        Err(self.error(None, kind))
    }

    /// Fields of the header and of every row.
    pub(crate) fn field_count(&self) -> usize {
        self.field_count
    }

    /// A field of the present row.
    pub(crate) fn field(&self, index: usize) -> &[u8] {
        &self.row[index]
    }

    /// A field of the present row unless the row is so short that the field is missing or may be cut.
    pub(crate) fn whole_field(&self, index: usize) -> Option<&[u8]> {
        let whole = self.row.len() == self.field_count || index + 1 < self.row.len();
        if whole { self.row.get(index) } else { None }
    }

    /// Whether the field has the same text as in the row before, white space at its ends aside.
    pub(crate) fn same_as_before(&self, index: usize) -> bool {
        let (before, now) = (self.previous.get(index), self.row.get(index));
        // Nearly always the same to the byte, which is sooner seen.
        before == now || before.map(<[u8]>::trim_ascii) == now.map(<[u8]>::trim_ascii)
    }

    /// Line on which the present row begins, counted from 1.
    pub(crate) fn line(&self) -> u64 {
        let within = self.row.iter().flatten().filter(|byte| **byte == b'\n').count() as u64;
        self.end_line().saturating_sub(within).max(1)
    }

    /// Line on which the present row ends: another than [`Self::line`] only where a quoted name holds line breaks.
    pub(crate) fn end_line(&self) -> u64 {
        let terminated = !self.reader.get_ref().ended_within_line();
        self.csv_line() - u64::from(terminated)
    }

    /// An error in the present row.
    pub(crate) fn error(&self, column: Option<Column>, kind: ReadErrorKind) -> ReadError {
        let line = self.line();
        self.error_at(Some((line, line)), column, kind)
    }

    /// An error between the given lines.
    pub(crate) fn error_at(&self, lines: Option<(u64, u64)>, column: Option<Column>, kind: ReadErrorKind) -> ReadError {
        ReadError {
            place: Place { file: self.file.clone(), span: lines.map(|(first, last)| Span::Lines(first, last)), column },
            kind,
        }
    }

    /// The columns that the last comment before the first row names, where that row has numbers, as many as there are names.
    fn columns_of_comment<C>(&self, columns: impl Fn(&ByteRecord) -> Result<C, HeaderError>) -> Option<C> {
        let header: ByteRecord = self.reader.get_ref().last_comment().split(|byte| *byte == b',').collect();
        let has_numbers = self.row.iter().any(|field| number(field).is_ok());
        (has_numbers && header.len() == self.row.len()).then(|| columns(&header).ok())?
    }

    fn read_row(&mut self) -> Result<bool, ReadError> {
        if std::mem::take(&mut self.is_put_back) {
            self.needs_no_quotes = needs_no_quotes(&self.row);
            return Ok(true);
        }
        std::mem::swap(&mut self.row, &mut self.previous);
        loop {
            self.reader.get_mut().begin_row();
            match self.reader.read_byte_record(&mut self.row) {
                Ok(true) if is_blank(&self.row) => {}
                Ok(more) => {
                    self.needs_no_quotes = needs_no_quotes(&self.row);
                    return Ok(more);
                }
                Err(error) => return Err(self.failure(error)),
            }
        }
    }

    /// Line that the csv crate has come to.
    fn csv_line(&self) -> u64 {
        self.lines_repeated + self.reader.position().line()
    }

    fn failure(&mut self, error: csv::Error) -> ReadError {
        let line = self.csv_line();
        self.row.clear();
        let kind = if self.reader.get_ref().has_returns_alone() {
            ReadErrorKind::LineEnds
        } else if self.reader.get_ref().exceeded() {
            ReadErrorKind::RowTooLong { limit: ROW_LIMIT as u64 }
        } else {
            match error.into_kind() {
                csv::ErrorKind::Io(error) => ReadErrorKind::Io(error),
                other => ReadErrorKind::Io(io::Error::other(format!("{other:?}"))),
            }
        };
        self.error_at(Some((line, line)), None, kind)
    }
}

/// Whether a row reads the same without quotes.
fn needs_no_quotes(row: &ByteRecord) -> bool {
    !row.as_slice().iter().any(|byte| b",\n\"".contains(byte))
}

/// A line of nothing but white space comes as one blank field.
fn is_blank(row: &ByteRecord) -> bool {
    row.len() == 1 && row[0].trim_ascii().is_empty()
}
