use std::io::{self, Chain, Cursor, Read};

use csv::{ByteRecord, ReaderBuilder, Terminator};

use crate::csv_columns::{Column, HeaderError};
use crate::error::{Place, ReadError, ReadErrorKind};
use crate::row_limit::{ROW_LIMIT, RowLimit};

/// The rows of a CSV file one after the other, with their line numbers; comments and blank lines left out. Two rows
/// are held at a time, whatever the length of the file.
#[derive(Debug)]
pub(crate) struct Rows<R> {
    file: String,
    reader: csv::Reader<RowLimit<Chain<Cursor<Vec<u8>>, R>>>,
    field_count: usize,
    row: ByteRecord,
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
        if let Err(error) = source.by_ref().take(3).read_to_end(&mut start) {
            let place = Place { file, lines: None, column: None };
            return Err(ReadError { place, kind: ReadErrorKind::Io(error) });
        }
        if start == b"\xef\xbb\xbf" {
            start.clear();
        }
        // Ending rows at "\n" alone makes line numbers exact; the "\r" of a "\r\n" falls to trimming.
        let reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .terminator(Terminator::Any(b'\n'))
            .buffer_capacity(1 << 16)
            .from_reader(RowLimit::new(Cursor::new(start).chain(source)));
        let mut rows = Self { file, reader, field_count: 0, row: ByteRecord::new(), previous: ByteRecord::new() };
        if !rows.read_row()? {
            return Err(rows.error_at(None, None, ReadErrorKind::Empty));
        }
        rows.field_count = rows.row.len();
        let found = columns(&rows.row).map_err(|(column, kind)| rows.error(column, kind))?;
        rows.row.clear();
        Ok((rows, found))
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
        self.reader.position().line() - u64::from(terminated)
    }

    /// An error in the present row.
    pub(crate) fn error(&self, column: Option<Column>, kind: ReadErrorKind) -> ReadError {
        let line = self.line();
        self.error_at(Some((line, line)), column, kind)
    }

    /// An error between the given lines.
    pub(crate) fn error_at(&self, lines: Option<(u64, u64)>, column: Option<Column>, kind: ReadErrorKind) -> ReadError {
        ReadError { place: Place { file: self.file.clone(), lines, column }, kind }
    }

    fn read_row(&mut self) -> Result<bool, ReadError> {
        std::mem::swap(&mut self.row, &mut self.previous);
        loop {
            self.reader.get_mut().renew();
            match self.reader.read_byte_record(&mut self.row) {
                Ok(true) if is_blank(&self.row) => {}
                Ok(more) => return Ok(more),
                Err(error) => return Err(self.failure(error)),
            }
        }
    }

    fn failure(&mut self, error: csv::Error) -> ReadError {
        let line = self.reader.position().line();
        self.row.clear();
        let kind = if self.reader.get_ref().exceeded() {
            ReadErrorKind::RowTooLong { limit: ROW_LIMIT }
        } else {
            match error.into_kind() {
                csv::ErrorKind::Io(error) => ReadErrorKind::Io(error),
                other => ReadErrorKind::Io(io::Error::other(format!("{other:?}"))),
            }
        };
        self.error_at(Some((line, line)), None, kind)
    }
}

/// A line of nothing but white space comes as one blank field.
fn is_blank(row: &ByteRecord) -> bool {
    row.len() == 1 && row[0].trim_ascii().is_empty()
}
