//! Where in a row of CSV each column stands.
use csv::ByteRecord;

use crate::csv_file::field::quoted_start;
use crate::error::ReadErrorKind;
use crate::table::column::Column;

/// Where in a row each column stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns {
    pub(crate) frame: usize,
    pub(crate) time: usize,
    pub(crate) x: usize,
    pub(crate) y: usize,
    pub(crate) object: Option<usize>,
    pub(crate) arc: Option<usize>,
    pub(crate) contour: Option<usize>,
    pub(crate) deviation: Option<usize>,
    pub(crate) warning: Option<usize>,
}

/// What a column is to the rows of one outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// Holds a coordinate of the point: 0 for x, 1 for y.
    Coordinate(usize),
    /// Holds the standard deviation of the point.
    Deviation,
    /// Tells outlines and their arcs apart: the same in every row of one.
    Outline,
    /// Is not looked at.
    Ignored,
}

/// Why a header is not usable; the column is set where one is to blame.
pub(crate) type HeaderError = (Option<Column>, ReadErrorKind);

impl Columns {
    pub(crate) fn find(header: &ByteRecord) -> Result<Self, HeaderError> {
        let [frame, time, x, y] = require(header, [Column::Frame, Column::Time, Column::X, Column::Y])?;
        let object = position(header, Column::Object)?;
        let arc = position(header, Column::Arc)?;
        let contour = position(header, Column::Contour)?;
        let deviation = position(header, Column::Deviation)?;
        // Columns of this name may be those of another program, who may have several.
        let warning = position(header, Column::Warning).unwrap_or_default();
        Ok(Self { frame, time, x, y, object, arc, contour, deviation, warning })
    }

    /// The role of the column at an index.
    pub(crate) fn role(&self, index: usize) -> Role {
        match index {
            _ if index == self.x => Role::Coordinate(0),
            _ if index == self.y => Role::Coordinate(1),
            _ if Some(index) == self.deviation => Role::Deviation,
            _ if [Some(self.frame), Some(self.time), self.object, self.arc, self.contour, self.warning]
                .contains(&Some(index)) =>
            {
                Role::Outline
            }
            _ => Role::Ignored,
        }
    }
}

/// Positions of columns that must be there.
pub(crate) fn require<const N: usize>(header: &ByteRecord, wanted: [Column; N]) -> Result<[usize; N], HeaderError> {
    let mut positions = [0; N];
    let mut missing = Vec::new();
    for (slot, column) in positions.iter_mut().zip(wanted) {
        match position(header, column)? {
            Some(index) => *slot = index,
            None => missing.push(column),
        }
    }
    if missing.is_empty() {
        return Ok(positions);
    }
    let names: Vec<String> = header.iter().map(|name| String::from_utf8_lossy(name).trim().to_owned()).collect();
    Err((None, ReadErrorKind::MissingColumns { missing, header: quoted_start(names.join(",").as_bytes()) }))
}

fn position(header: &ByteRecord, column: Column) -> Result<Option<usize>, HeaderError> {
    let mut found = header.iter().enumerate().filter(|(_, name)| name.trim_ascii() == column.name().as_bytes());
    let first = found.next().map(|(index, _)| index);
    match found.next() {
        Some(_) => Err((Some(column), ReadErrorKind::RepeatedColumn)),
        None => Ok(first),
    }
}
