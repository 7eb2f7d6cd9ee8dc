//! Some rows of a Parquet file as columns in memory.
use std::sync::Arc;

use crate::csv_file::field::{NUMBER_LIMIT, positive, quoted_start};
use crate::error::ReadErrorKind;
use crate::frame::{DEFAULT_OBJECT, NAME_LIMIT};
use crate::origin_warning::OriginWarnings;
use crate::parquet_file::columns::{Arity, Found};
use crate::parquet_file::leaf::{Cells, Values};
use crate::table::column::Column;

/// Largest whole number up to which floats have them all.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// A mark that is not there.
pub(crate) const NO_MARK: i64 = -1;

/// Arcs or contours that points belong to; [`NO_MARK`] for none.
#[derive(Debug, Clone, Default)]
pub(crate) enum Marks {
    #[default]
    None,
    /// Of whole rows.
    OfRows(Vec<i64>),
    /// Of single points.
    OfPoints(Vec<i64>),
}

/// Rows that follow each other.
#[derive(Debug, Default)]
pub(crate) struct Batch {
    /// Number of the first in the file.
    pub(crate) first_row: u64,
    pub(crate) object: Vec<Arc<str>>,
    pub(crate) frame: Vec<u64>,
    pub(crate) time: Vec<f64>,
    /// Where the points of every row end.
    pub(crate) ends: Vec<usize>,
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) arc: Marks,
    pub(crate) contour: Marks,
    /// Standard deviations of the points, NaN where none is stated; empty where the file has no such column.
    pub(crate) deviation: Vec<f64>,
    /// Those of all rows.
    pub(crate) warnings: OriginWarnings,
}

/// What is wrong in which of the rows just read, and in which column.
#[derive(Debug)]
pub(crate) struct BadRow {
    pub(crate) row: usize,
    pub(crate) column: Column,
    pub(crate) kind: ReadErrorKind,
}

impl Batch {
    pub(crate) fn rows(&self) -> usize {
        self.frame.len()
    }

    /// The points of a row.
    pub(crate) fn points(&self, row: usize) -> std::ops::Range<usize> {
        let start = row.checked_sub(1).map_or(0, |before| self.ends[before]);
        start..self.ends[row]
    }

    /// Leaves out what comes from a row on.
    pub(crate) fn truncate(&mut self, rows: usize) {
        let points = rows.checked_sub(1).map_or(0, |last| self.ends.get(last).copied().unwrap_or(usize::MAX));
        self.object.truncate(rows);
        self.frame.truncate(rows);
        self.time.truncate(rows);
        self.ends.truncate(rows);
        self.x.truncate(points);
        self.y.truncate(points);
        self.deviation.truncate(points);
        for marks in [&mut self.arc, &mut self.contour] {
            match marks {
                Marks::None => {}
                Marks::OfRows(marks) => marks.truncate(rows),
                Marks::OfPoints(marks) => marks.truncate(points),
            }
        }
    }

    /// Adds the rows of another batch of the same file.
    pub(crate) fn append(&mut self, mut other: Self) {
        let points = self.x.len();
        self.object.append(&mut other.object);
        self.frame.append(&mut other.frame);
        self.time.append(&mut other.time);
        self.ends.extend(other.ends.iter().map(|end| end + points));
        self.x.append(&mut other.x);
        self.y.append(&mut other.y);
        self.deviation.append(&mut other.deviation);
        self.warnings = self.warnings.and(other.warnings);
        for (marks, new) in [(&mut self.arc, other.arc), (&mut self.contour, other.contour)] {
            match (marks, new) {
                (Marks::OfRows(marks), Marks::OfRows(mut new)) | (Marks::OfPoints(marks), Marks::OfPoints(mut new)) => {
                    marks.append(&mut new);
                }
                (marks, new) => *marks = new,
            }
        }
    }
}

/// Position of the value of every row, `None` for a null.
fn positions<'a>(found: &'a Found, cells: &'a Cells, rows: usize) -> impl Iterator<Item = Option<usize>> + 'a {
    let mut next = 0;
    (0..rows).map(move |row| {
        let is_present = cells.definition.get(row).is_none_or(|level| *level == found.present);
        is_present.then(|| {
            next += 1;
            next - 1
        })
    })
}

/// One value per row, up to the first row where it cannot be had.
fn each_row<T>(
    found: &Found,
    cells: &Cells,
    rows: usize,
    value: impl Fn(&Values, Option<usize>) -> Result<T, ReadErrorKind>,
) -> (Vec<T>, Option<BadRow>) {
    let mut values = Vec::with_capacity(rows);
    for (row, position) in positions(found, cells, rows).enumerate() {
        match value(&cells.values, position) {
            Ok(value) => values.push(value),
            Err(kind) => return (values, Some(BadRow { row, column: found.column, kind })),
        }
    }
    (values, None)
}

/// Frame numbers.
pub(crate) fn frames(found: &Found, cells: &Cells, rows: usize) -> (Vec<u64>, Option<BadRow>) {
    each_row(found, cells, rows, |values, position| {
        let position = position.ok_or(ReadErrorKind::EmptyField)?;
        let wrong = |text: String| Err(ReadErrorKind::NotAFrameNumber { text });
        match values {
            Values::Signed(values) => {
                let value = values[position];
                u64::try_from(value).or_else(|_| wrong(value.to_string()))
            }
            Values::Unsigned(values) => Ok(values[position]),
            // Programs that know no missing whole numbers write them as floats.
            Values::Float(values) => match values[position] {
                value if value >= 0.0 && value.fract() == 0.0 && value < EXACT => Ok(value as u64),
                value => wrong(value.to_string()),
            },
            Values::Text(values) => wrong(quoted_start(values[position].data())),
        }
    })
}

/// Finite numbers.
pub(crate) fn numbers(found: &Found, cells: &Cells, rows: usize) -> (Vec<f64>, Option<BadRow>) {
    each_row(found, cells, rows, |values, position| {
        checked(number(values, position.ok_or(ReadErrorKind::EmptyField)?)?)
    })
}

fn number(values: &Values, position: usize) -> Result<f64, ReadErrorKind> {
    match values {
        Values::Signed(values) => Ok(values[position] as f64),
        Values::Unsigned(values) => Ok(values[position] as f64),
        Values::Float(values) => Ok(values[position]),
        Values::Text(values) => Err(ReadErrorKind::NotANumber { text: quoted_start(values[position].data()) }),
    }
}

/// Names of objects; those that follow each other share theirs.
pub(crate) fn names(found: Option<&Found>, cells: Option<&Cells>, rows: usize) -> (Vec<Arc<str>>, Option<BadRow>) {
    let (Some(found), Some(cells)) = (found, cells) else { return (vec![Arc::from(DEFAULT_OBJECT); rows], None) };
    let mut latest: Arc<str> = Arc::from("");
    let mut all = Vec::with_capacity(rows);
    for (row, position) in positions(found, cells, rows).enumerate() {
        let bad = |kind| Some(BadRow { row, column: found.column, kind });
        let text;
        let name = match (&cells.values, position) {
            (_, None) => return (all, bad(ReadErrorKind::NoName)),
            (Values::Text(values), Some(position)) => {
                let bytes = values[position].data().trim_ascii();
                if bytes.len() > NAME_LIMIT {
                    let kind = ReadErrorKind::NameTooLong { length: bytes.len(), limit: NAME_LIMIT };
                    return (all, bad(kind));
                }
                let Ok(name) = std::str::from_utf8(bytes) else {
                    return (all, bad(ReadErrorKind::NotUtf8 { text: quoted_start(bytes) }));
                };
                name
            }
            (Values::Signed(values), Some(position)) => {
                text = values[position].to_string();
                &text
            }
            (Values::Unsigned(values), Some(position)) => {
                text = values[position].to_string();
                &text
            }
            (Values::Float(values), Some(position)) => {
                text = values[position].to_string();
                &text
            }
        };
        if *name != *latest {
            latest = Arc::from(name);
        }
        all.push(Arc::clone(&latest));
    }
    (all, None)
}

/// What a column of texts says of how outlines were found.
pub(crate) fn warnings(cells: &Cells) -> OriginWarnings {
    let Values::Text(texts) = &cells.values else { return OriginWarnings::default() };
    let mut latest: &[u8] = &[];
    let mut all = OriginWarnings::default();
    for text in texts {
        // Nearly always the same.
        if text.data() != latest {
            latest = text.data();
            all = all.and(OriginWarnings::of_text(&String::from_utf8_lossy(latest)));
        }
    }
    all
}

/// Coordinates, and where those of every row end.
pub(crate) fn coordinates(found: &Found, cells: Cells, rows: usize) -> (Vec<f64>, Vec<usize>, Option<BadRow>) {
    if found.arity == Arity::One {
        let (values, bad) = numbers(found, &cells, rows);
        let ends = (1..=values.len()).collect();
        return (values, ends, bad);
    }
    let (ends, mut bad) = list_ends(found, &cells);
    let values: Vec<f64> = match cells.values {
        Values::Signed(values) => values.into_iter().map(|value| value as f64).collect(),
        Values::Unsigned(values) => values.into_iter().map(|value| value as f64).collect(),
        Values::Float(values) => values,
        Values::Text(_) => Vec::new(),
    };
    // A bad number is told rather than a null behind it.
    if let Some(first) = values.iter().position(|value| value.is_nan() || value.abs() > NUMBER_LIMIT) {
        let row = ends.partition_point(|end| *end <= first);
        if row < ends.len()
            && let Err(kind) = checked(values[first])
        {
            bad = Some(BadRow { row, column: found.column, kind });
        }
    }
    (values, ends, bad)
}

/// Where the values of each list end, up to the first bad row.
fn list_ends(found: &Found, cells: &Cells) -> (Vec<usize>, Option<BadRow>) {
    let mut ends: Vec<usize> = Vec::new();
    let mut values = 0;
    for (index, repetition) in cells.repetition.iter().enumerate() {
        if *repetition == 0 {
            ends.push(values);
        }
        let level = cells.definition.get(index).copied().unwrap_or(found.present);
        // A list that is there and empty has the level just below that of its elements.
        let is_missing = level + 1 < found.element;
        if is_missing || (found.element..found.present).contains(&level) {
            let row = ends.len().saturating_sub(1);
            ends.pop();
            return (ends, Some(BadRow { row, column: found.column, kind: ReadErrorKind::EmptyField }));
        }
        if level == found.present {
            values += 1;
            if let Some(end) = ends.last_mut() {
                *end = values;
            }
        }
    }
    (ends, None)
}

/// Arcs or contours. Lists must be as long as those of the points, or missing.
pub(crate) fn marks(found: &Found, cells: &Cells, points: &[usize]) -> (Marks, Option<BadRow>) {
    if found.arity == Arity::One {
        let (marks, bad) = each_row(found, cells, points.len(), |values, position| {
            position.map_or(Ok(NO_MARK), |position| mark(values, position))
        });
        return (Marks::OfRows(marks), bad);
    }
    // A mark that is missing in a list is none, but takes its place.
    let (marks, bad) = each_point(found, cells, points, NO_MARK, |values, position| {
        position.map_or(Ok(NO_MARK), |position| mark(values, position))
    });
    (Marks::OfPoints(marks), bad)
}

/// Standard deviations, NaN where none is stated. Lists must be as long as those of the points, or missing.
pub(crate) fn deviations(found: &Found, cells: &Cells, points: &[usize]) -> (Vec<f64>, Option<BadRow>) {
    let stated = |values: &Values, position: usize| checked(number(values, position)?).and_then(positive);
    match found.arity {
        Arity::One => each_row(found, cells, points.len(), |values, position| {
            position.map_or(Ok(f64::NAN), |position| stated(values, position))
        }),
        Arity::List => each_point(found, cells, points, f64::NAN, |values, position| {
            stated(values, position.ok_or(ReadErrorKind::EmptyField)?)
        }),
    }
}

/// One value per point from lists, up to the first row where it cannot be had; `none` for the points of rows whose list is missing or empty.
fn each_point<T: Copy>(
    found: &Found,
    cells: &Cells,
    points: &[usize],
    none: T,
    value: impl Fn(&Values, Option<usize>) -> Result<T, ReadErrorKind>,
) -> (Vec<T>, Option<BadRow>) {
    let mut all = Vec::with_capacity(points.last().copied().unwrap_or(0));
    let (mut item, mut next) = (0, 0);
    let mut start = 0;
    for (row, end) in points.iter().enumerate() {
        let bad = |kind| Some(BadRow { row, column: found.column, kind });
        let first = all.len();
        let mut is_first = true;
        while item < cells.repetition.len() && (is_first || cells.repetition[item] != 0) {
            is_first = false;
            let level = cells.definition.get(item).copied().unwrap_or(found.present);
            item += 1;
            if level < found.element {
                continue;
            }
            let position = (level == found.present).then_some(next);
            next += usize::from(position.is_some());
            match value(&cells.values, position) {
                Ok(value) => all.push(value),
                Err(kind) => return (all, bad(kind)),
            }
        }
        let (count, expected) = (all.len() - first, end - start);
        if count == 0 {
            all.resize(first + expected, none);
        } else if count != expected {
            return (all, bad(ReadErrorKind::ListLength { found: count, expected }));
        }
        start = *end;
    }
    (all, None)
}

fn mark(values: &Values, position: usize) -> Result<i64, ReadErrorKind> {
    let wrong = |text: String| Err(ReadErrorKind::NotAWholeNumber { text });
    match values {
        Values::Signed(values) => Ok(values[position].max(NO_MARK)),
        Values::Unsigned(values) => i64::try_from(values[position]).or_else(|_| wrong(values[position].to_string())),
        Values::Float(values) => match values[position] {
            value if value.is_nan() || value < 0.0 => Ok(NO_MARK),
            value if value.fract() == 0.0 && value < EXACT => Ok(value as i64),
            value => wrong(value.to_string()),
        },
        Values::Text(values) => wrong(quoted_start(values[position].data())),
    }
}

fn checked(value: f64) -> Result<f64, ReadErrorKind> {
    match value {
        _ if !value.is_finite() => Err(ReadErrorKind::NotFinite { text: value.to_string() }),
        _ if value.abs() > NUMBER_LIMIT => Err(ReadErrorKind::TooLarge { value, limit: NUMBER_LIMIT }),
        _ => Ok(value),
    }
}
