//! Tables as Parquet files: read as lines of CSV, written from lines of CSV.
//!
//! Rows of a Parquet file stand in groups, and the file is readable once its end is written.

use super::output::{LineFile, input_error};
use super::{InputError, cell};
use crate::measure::Kind;
use csv::StringRecord;
use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, RowGroupMetaData};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::FileReader;
use parquet::file::serialized_reader::SerializedFileReader;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::record::{Field, Row, reader::RowIter};
use parquet::schema::types::{Type, TypePtr};
use serde_json::Value;
use std::cell::Cell;
use std::fs::File;
use std::io::{self, Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

/// Rows of a group: 10 columns take 1 MB.
const GROUP_ROWS: usize = 10_000;

/// Is a file a Parquet file, by its name?
pub(super) fn is_parquet(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"))
}

thread_local! {
    static IS_READING: Cell<bool> = const { Cell::new(false) };
}

/// Does the thread read a Parquet file? The library panics on some damaged files.
pub(super) fn is_reading() -> bool {
    IS_READING.get()
}

/// A piece of reading; what is wrong with the file otherwise.
fn guarded<T>(read: impl FnOnce() -> Result<T, ParquetError>) -> Result<T, String> {
    IS_READING.set(true);
    let result = catch_unwind(AssertUnwindSafe(read));
    IS_READING.set(false);
    match result {
        Ok(Ok(read)) => Ok(read),
        Ok(Err(ParquetError::General(words))) => Err(words),
        Ok(Err(error)) => Err(error.to_string()),
        Err(_) => Err("the file is damaged".to_owned()),
    }
}

/// A Parquet file as lines of CSV, the first one with the names of the columns.
pub(super) struct Lines {
    /// None after an error.
    rows: Option<RowIter<'static>>,
    line: io::Cursor<String>,
}

impl Lines {
    /// Opens a file.
    pub(super) fn open(path: &Path) -> Result<Self, InputError> {
        let refused = |error: &dyn std::fmt::Display| {
            input_error(path, format!("cannot be read as Parquet: {error}"))
        };
        let file = File::open(path).map_err(|error| refused(&error))?;
        let open = || {
            let reader = SerializedFileReader::new(file)?;
            let groups = reader.metadata().row_groups().iter().flat_map(RowGroupMetaData::columns);
            let is_known =
                |method| matches!(method, Compression::UNCOMPRESSED | Compression::SNAPPY);
            if !groups.map(ColumnChunkMetaData::compression).all(is_known) {
                let words = "it is compressed by another method; allowed: Snappy or none";
                return Err(ParquetError::General(words.to_owned()));
            }
            let columns = reader.metadata().file_metadata().schema().get_fields();
            if let Some(column) = columns.iter().find(|column| !is_read(column)) {
                return Err(ParquetError::General(of_another_kind(column.name())));
            }
            let line = cell::row(columns.iter().map(|column| column.name().to_owned()));
            Ok(Self { rows: Some(reader.into_iter()), line: io::Cursor::new(line) })
        };
        guarded(open).map_err(|error| refused(&error))
    }
}

impl Read for Lines {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let count = self.line.read(to)?;
        if count > 0 || to.is_empty() {
            return Ok(count);
        }
        let Some(mut rows) = self.rows.take() else { return Ok(0) };
        let Some(row) = guarded(|| rows.next().transpose()).map_err(io::Error::other)? else {
            return Ok(0);
        };
        self.line = io::Cursor::new(line_of(row)?);
        self.rows = Some(rows);
        self.line.read(to)
    }
}

fn line_of(row: Row) -> io::Result<String> {
    let cells: io::Result<Vec<String>> = row.into_columns().into_iter().map(cell_of).collect();
    Ok(cell::row(cells?))
}

/// Has a column values that a cell can have?
fn is_read(column: &Type) -> bool {
    let kind = column.get_basic_info().converted_type();
    let is_whole = !matches!(
        kind,
        ConvertedType::DECIMAL
            | ConvertedType::DATE
            | ConvertedType::TIME_MILLIS
            | ConvertedType::TIME_MICROS
            | ConvertedType::TIMESTAMP_MILLIS
            | ConvertedType::TIMESTAMP_MICROS
    );
    column.is_primitive()
        && column.get_basic_info().repetition() != Repetition::REPEATED
        && match column.get_physical_type() {
            Physical::BOOLEAN | Physical::FLOAT | Physical::DOUBLE => true,
            Physical::INT32 | Physical::INT64 => is_whole,
            Physical::BYTE_ARRAY => kind == ConvertedType::UTF8,
            _ => false,
        }
}

fn of_another_kind(name: &str) -> String {
    format!("column {name} has values of another kind; allowed: numbers, texts and truth values")
}

/// The cell of a value; a number has the digits that read as the same number.
fn cell_of((name, field): (String, Field)) -> io::Result<String> {
    Ok(match field {
        Field::Null => String::new(),
        Field::Bool(value) => value.to_string(),
        Field::Byte(value) => value.to_string(),
        Field::Short(value) => value.to_string(),
        Field::Int(value) => value.to_string(),
        Field::Long(value) => value.to_string(),
        Field::UByte(value) => value.to_string(),
        Field::UShort(value) => value.to_string(),
        Field::UInt(value) => value.to_string(),
        Field::ULong(value) => value.to_string(),
        Field::Float(value) => value.to_string(),
        Field::Double(value) => value.to_string(),
        Field::Str(value) => cell::of_value(&Value::from(value)),
        _ => return Err(io::Error::other(of_another_kind(&name))),
    })
}

type Writer = Box<dyn Write + Send>;

/// A table of results that is written in groups of rows.
pub(super) struct ParquetFile {
    writer: SerializedFileWriter<Writer>,
    kinds: Vec<Kind>,
    rows: Vec<StringRecord>,
}

impl ParquetFile {
    /// Begins a file with the columns of a header, a line of CSV.
    pub(super) fn new(file: LineFile, header: &str, kinds: Vec<Kind>) -> Result<Self, InputError> {
        let names = cell::split(header).map_err(InputError)?;
        let column = |(name, kind): (&str, &Kind)| -> Result<TypePtr, ParquetError> {
            let (physical, logical) = match kind {
                Kind::Number => (Physical::DOUBLE, None),
                Kind::Flag => (Physical::BOOLEAN, None),
                Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            };
            let column = Type::primitive_type_builder(name, physical).with_logical_type(logical);
            Ok(Arc::new(column.with_repetition(Repetition::OPTIONAL).build()?))
        };
        let columns: Result<Vec<_>, _> = names.iter().zip(&kinds).map(column).collect();
        let begin = || {
            let schema = Type::group_type_builder("results").with_fields(columns?).build()?;
            let properties = WriterProperties::builder().set_compression(Compression::SNAPPY);
            SerializedFileWriter::new(
                file.into_writer(),
                Arc::new(schema),
                Arc::new(properties.build()),
            )
        };
        let writer = begin().map_err(|error| refused(&error))?;
        Ok(Self { writer, kinds, rows: Vec::new() })
    }

    /// Takes a row, a line of CSV.
    pub(super) fn write(&mut self, line: &str) -> Result<(), InputError> {
        self.rows.push(cell::split(line).map_err(InputError)?);
        if self.rows.len() < GROUP_ROWS { Ok(()) } else { self.write_group() }
    }

    fn write_group(&mut self) -> Result<(), InputError> {
        let mut write = || {
            let mut group = self.writer.next_row_group()?;
            for (k, kind) in self.kinds.iter().enumerate() {
                let cells = self.rows.iter().map(|row| &row[k]);
                match kind {
                    Kind::Number => {
                        write_column::<DoubleType>(&mut group, cells, |cell| cell.parse().ok())
                    }
                    Kind::Flag => {
                        write_column::<BoolType>(&mut group, cells, |cell| cell.parse().ok())
                    }
                    Kind::Text => write_column::<ByteArrayType>(&mut group, cells, |cell| {
                        (!cell.is_empty()).then(|| ByteArray::from(cell))
                    }),
                }?;
            }
            group.close()
        };
        write().map_err(|error| refused(&error))?;
        self.rows.clear();
        Ok(())
    }

    /// Writes the last group and the end of the file.
    pub(super) fn finish(mut self) -> Result<(), InputError> {
        if !self.rows.is_empty() {
            self.write_group()?;
        }
        self.writer.close().map(drop).map_err(|error| refused(&error))
    }
}

/// Writes the next column of a group; a cell without a value is null.
fn write_column<'a, T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, Writer>,
    cells: impl Iterator<Item = &'a str>,
    value: impl Fn(&str) -> Option<T::T>,
) -> Result<(), ParquetError> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    for cell in cells {
        let value = value(cell);
        levels.push(i16::from(value.is_some()));
        values.extend(value);
    }
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    column.typed::<T>().write_batch(&values, Some(&levels), None)?;
    column.close()
}

fn refused(error: &ParquetError) -> InputError {
    InputError(format!("--format parquet: {error}"))
}
