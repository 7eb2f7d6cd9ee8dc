//! Which columns of a Parquet file hold what.
use parquet::basic::LogicalType;
use parquet::schema::types::SchemaDescriptor;

use crate::csv_file::columns::HeaderError;
use crate::csv_file::field::quoted_start;
use crate::error::ReadErrorKind;
use crate::parquet_file::leaf::LeafKind;
use crate::table::column::Column;

/// How much of an outline a row holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Layout {
    /// All of it, or one of its arcs or contours: coordinates are lists.
    Pieces,
    /// One point, as a row of CSV.
    Points,
}

/// What a row has in a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Arity {
    One,
    List,
}

/// A column that is read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) column: Column,
    /// Position among the columns of the file.
    pub(crate) position: usize,
    pub(crate) kind: LeafKind,
    pub(crate) arity: Arity,
    /// Definition level of a value that is there.
    pub(crate) present: i16,
    /// Lowest definition level of an element of a list, which may be null.
    pub(crate) element: i16,
}

/// The columns of a table of outlines.
#[derive(Debug, Clone)]
pub(crate) struct TableColumns {
    /// `None` only where all rows are one shape.
    pub(crate) frame: Option<Found>,
    pub(crate) time: Option<Found>,
    pub(crate) x: Found,
    pub(crate) y: Found,
    pub(crate) object: Option<Found>,
    pub(crate) arc: Option<Found>,
    pub(crate) contour: Option<Found>,
    pub(crate) deviation: Option<Found>,
    pub(crate) warning: Option<Found>,
}

/// Whether frames are needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Needed {
    Sequence,
    /// Without frame and time all rows are one shape.
    Shape,
}

impl TableColumns {
    pub(crate) fn find(schema: &SchemaDescriptor, needed: Needed) -> Result<Self, HeaderError> {
        let find = |column| find(schema, column);
        let [frame, time, x, y] = [find(Column::Frame)?, find(Column::Time)?, find(Column::X)?, find(Column::Y)?];
        let is_shape = needed == Needed::Shape && frame.is_none() && time.is_none();
        let mut missing = Vec::new();
        for (found, column) in [(&frame, Column::Frame), (&time, Column::Time)] {
            if found.is_none() && !is_shape {
                missing.push(column);
            }
        }
        missing.extend(x.is_none().then_some(Column::X));
        missing.extend(y.is_none().then_some(Column::Y));
        let (Some(x), Some(y), []) = (x, y, &missing[..]) else {
            let names: Vec<&str> = schema.root_schema().get_fields().iter().map(|field| field.name()).collect();
            return Err((
                None,
                ReadErrorKind::MissingColumns { missing, header: quoted_start(names.join(",").as_bytes()) },
            ));
        };
        let columns = Self {
            frame,
            time,
            x,
            y,
            object: find(Column::Object)?,
            arc: find(Column::Arc)?,
            contour: find(Column::Contour)?,
            deviation: find(Column::Deviation)?,
            // Columns of this name may be those of another program, of any type.
            warning: find(Column::Warning).unwrap_or_default().filter(|found| found.arity == Arity::One),
        };
        columns.check(schema)?;
        Ok(columns)
    }

    pub(crate) fn layout(&self) -> Layout {
        match self.x.arity {
            Arity::One => Layout::Points,
            Arity::List => Layout::Pieces,
        }
    }

    /// Every column that is read.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Found> {
        let optional =
            [&self.frame, &self.time, &self.object, &self.arc, &self.contour, &self.deviation, &self.warning];
        optional.into_iter().flatten().chain([&self.x, &self.y])
    }

    /// Refuses lists where one value is needed, and one of two coordinates that is a list.
    fn check(&self, schema: &SchemaDescriptor) -> Result<(), HeaderError> {
        let wrong = |found: &Found, expected| Err((Some(found.column), column_type(schema, found.position, expected)));
        for found in [&self.frame, &self.time, &self.object].into_iter().flatten() {
            if found.arity == Arity::List {
                return wrong(found, "one value in a row");
            }
        }
        match (self.x.arity, self.y.arity) {
            (Arity::List, Arity::One) => return wrong(&self.y, "lists, as column x has"),
            (Arity::One, Arity::List) => return wrong(&self.y, "one value in a row, as column x has"),
            _ => {}
        }
        for found in [&self.arc, &self.contour, &self.deviation].into_iter().flatten() {
            if self.x.arity == Arity::One && found.arity == Arity::List {
                return wrong(found, "one value in a row, as column x has");
            }
        }
        match &self.deviation {
            Some(found) if self.x.arity == Arity::List && found.arity == Arity::One => {
                wrong(found, "lists, as column x has")
            }
            _ => Ok(()),
        }
    }
}

fn find(schema: &SchemaDescriptor, column: Column) -> Result<Option<Found>, HeaderError> {
    let fields = schema.root_schema().get_fields();
    if fields.iter().filter(|field| field.name().trim() == column.name()).count() > 1 {
        return Err((Some(column), ReadErrorKind::RepeatedColumn));
    }
    let of_name = |position: &usize| {
        let parts = schema.column(*position);
        parts.path().parts().first().is_some_and(|name| name.trim() == column.name())
    };
    let mut positions = (0..schema.num_columns()).filter(of_name);
    let Some(position) = positions.next() else { return Ok(None) };
    let descriptor = schema.column(position);
    // A column of nothing but nulls has no lists, whatever x and y have, and states nothing.
    let is_null =
        matches!(descriptor.logical_type_ref(), Some(LogicalType::Unknown)) && descriptor.max_rep_level() == 0;
    if column == Column::Deviation && is_null {
        return Ok(None);
    }
    let expected = match column {
        Column::Object => "text or whole numbers",
        Column::Warning => "text",
        Column::Frame | Column::Time => "numbers",
        Column::X | Column::Y | Column::Deviation => "lists of numbers, or numbers",
        Column::Arc | Column::Contour => "lists of whole numbers, or whole numbers",
    };
    let arity = match descriptor.max_rep_level() {
        0 => Arity::One,
        _ => Arity::List,
    };
    let is_simple = positions.next().is_none() && descriptor.max_rep_level() <= 1;
    let kind = LeafKind::of(&descriptor).filter(|kind| match column {
        Column::Object => !matches!(kind, LeafKind::Float | LeafKind::Double),
        Column::Warning => *kind == LeafKind::Text,
        _ => *kind != LeafKind::Text,
    });
    let Some(kind) = kind.filter(|_| is_simple) else {
        return Err((Some(column), column_type(schema, position, expected)));
    };
    let (present, element) = (descriptor.max_def_level(), descriptor.repeated_ancestor_def_level());
    Ok(Some(Found { column, position, kind, arity, present, element }))
}

/// What is wrong with the type of a column.
fn column_type(schema: &SchemaDescriptor, position: usize, expected: &'static str) -> ReadErrorKind {
    let descriptor = schema.column(position);
    if schema.get_column_root(position).is_group() && descriptor.max_rep_level() == 0 {
        return ReadErrorKind::ColumnType { found: "struct".to_owned(), expected };
    }
    let annotation = match (descriptor.logical_type_ref(), descriptor.converted_type()) {
        (Some(logical), _) => format!(" ({logical:?})"),
        (None, parquet::basic::ConvertedType::NONE) => String::new(),
        (None, converted) => format!(" ({converted})"),
    };
    let list = match descriptor.max_rep_level() {
        0 => "",
        1 => "lists of ",
        _ => "lists of lists of ",
    };
    let found = format!("{list}{}{annotation}", descriptor.physical_type());
    ReadErrorKind::ColumnType { found: quoted_start(found.as_bytes()), expected }
}
