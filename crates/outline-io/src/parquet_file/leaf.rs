//! The values of one column of a row group.
use parquet::basic::{ConvertedType, LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::schema::types::{ColumnDescPtr, ColumnDescriptor};

use crate::parquet_file::pages::{Allowance, CheckedPages};
use crate::parquet_file::source::damaged;

/// What is read of a column that holds numbers or names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LeafKind {
    Signed32,
    Unsigned32,
    Signed64,
    Unsigned64,
    Float,
    Double,
    Text,
}

impl LeafKind {
    /// `None` for types that are neither numbers nor names.
    pub(crate) fn of(column: &ColumnDescriptor) -> Option<Self> {
        let (logical, converted) = (column.logical_type_ref(), column.converted_type());
        let is_text = matches!(logical, None | Some(LogicalType::String | LogicalType::Enum))
            && matches!(converted, ConvertedType::NONE | ConvertedType::UTF8 | ConvertedType::ENUM);
        // A column of nothing but nulls has a type of its own.
        let is_plain = matches!(logical, None | Some(LogicalType::Unknown)) && converted == ConvertedType::NONE;
        let is_unsigned = match (logical, converted) {
            (Some(LogicalType::Integer(integer)), _) => Some(!integer.is_signed),
            (
                None,
                ConvertedType::UINT_8 | ConvertedType::UINT_16 | ConvertedType::UINT_32 | ConvertedType::UINT_64,
            ) => Some(true),
            (None, ConvertedType::INT_8 | ConvertedType::INT_16 | ConvertedType::INT_32 | ConvertedType::INT_64) => {
                Some(false)
            }
            _ => is_plain.then_some(false),
        };
        match (column.physical_type(), is_unsigned) {
            (Type::INT32, Some(false)) => Some(Self::Signed32),
            (Type::INT32, Some(true)) => Some(Self::Unsigned32),
            (Type::INT64, Some(false)) => Some(Self::Signed64),
            (Type::INT64, Some(true)) => Some(Self::Unsigned64),
            (Type::FLOAT, _) if is_plain => Some(Self::Float),
            (Type::DOUBLE, _) if is_plain => Some(Self::Double),
            (Type::BYTE_ARRAY, _) if is_text => Some(Self::Text),
            _ => None,
        }
    }
}

/// Values as the file has them, without its nulls.
#[derive(Debug)]
pub(crate) enum Values {
    Signed(Vec<i64>),
    Unsigned(Vec<u64>),
    Float(Vec<f64>),
    Text(Vec<ByteArray>),
}

/// Some rows of a column.
#[derive(Debug)]
pub(crate) struct Cells {
    pub(crate) values: Values,
    /// Per value or null, how much of it is there; empty where nothing can be missing.
    pub(crate) definition: Vec<i16>,
    /// Per value or null, 0 where it begins a row; empty where every row has one.
    pub(crate) repetition: Vec<i16>,
}

/// A column of a row group, read from the beginning to the end.
pub(crate) struct Leaf {
    kind: LeafKind,
    reader: ColumnReader,
    allowance: Allowance,
}

impl Leaf {
    /// The allowance is that of the pages.
    pub(crate) fn new(kind: LeafKind, column: ColumnDescPtr, pages: CheckedPages, allowance: Allowance) -> Self {
        Self { kind, reader: get_column_reader(column, Box::new(pages)), allowance }
    }

    /// The next rows, exactly so many.
    pub(crate) fn read(&mut self, rows: usize) -> Result<Cells, ParquetError> {
        self.allowance.renew();
        let (mut definition, mut repetition) = (Vec::new(), Vec::new());
        let levels = (&mut definition, &mut repetition);
        let kind = self.kind;
        let values = match &mut self.reader {
            ColumnReader::Int32ColumnReader(reader) => {
                let values = read_all::<Int32Type>(reader, rows, levels)?;
                match kind {
                    LeafKind::Unsigned32 => {
                        Values::Unsigned(values.into_iter().map(|value| u64::from(value as u32)).collect())
                    }
                    _ => Values::Signed(values.into_iter().map(i64::from).collect()),
                }
            }
            ColumnReader::Int64ColumnReader(reader) => {
                let values = read_all::<Int64Type>(reader, rows, levels)?;
                match kind {
                    LeafKind::Unsigned64 => Values::Unsigned(values.into_iter().map(|value| value as u64).collect()),
                    _ => Values::Signed(values),
                }
            }
            ColumnReader::FloatColumnReader(reader) => {
                let values = read_all::<FloatType>(reader, rows, levels)?;
                Values::Float(values.into_iter().map(f64::from).collect())
            }
            ColumnReader::DoubleColumnReader(reader) => Values::Float(read_all::<DoubleType>(reader, rows, levels)?),
            ColumnReader::ByteArrayColumnReader(reader) => {
                Values::Text(read_all::<ByteArrayType>(reader, rows, levels)?)
            }
            _ => return Err(damaged("a column of another type than the schema says")),
        };
        Ok(Cells { values, definition, repetition })
    }
}

fn read_all<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: usize,
    (definition, repetition): (&mut Vec<i16>, &mut Vec<i16>),
) -> Result<Vec<T::T>, ParquetError> {
    let mut values = Vec::new();
    let mut read = 0;
    while read < rows {
        let (records, _, levels) =
            reader.read_records(rows - read, Some(&mut *definition), Some(&mut *repetition), &mut values)?;
        if records == 0 && levels == 0 {
            return Err(damaged(format!("{read} row(s) where there should be {rows}")));
        }
        read += records;
    }
    Ok(values)
}
