//! Outlines one by one to CSV.
use std::fmt;
use std::io::{self, Write};

use freeform_curve_fit::Outline;

use crate::csv_file::field::NUMBER_LIMIT;
use crate::frame::{DEFAULT_OBJECT, OutlineFrame};
use crate::origin_warning::OriginWarnings;
use crate::table::column::Column;
use crate::table::rounding::Rounding;
use crate::write_error::WriteError;

/// Which optional columns a file has; the header comes first, so they are fixed before the first outline.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WriterOptions {
    /// Write the `object` column: needed for any object other than [`DEFAULT_OBJECT`].
    pub object_column: bool,
    /// Write the `arc` column: needed for open outlines, empty for closed ones.
    pub arc_column: bool,
    /// Write the `contour` column: needed for outlines with several contours.
    pub contour_column: bool,
    /// Write the `deviation` column: the standard deviations of the points, empty or null for outlines without. Without it they are not
    /// written.
    pub deviation_column: bool,
    /// Round coordinates to this share of the RMS radius of the first outline or better, and times to a nanosecond;
    /// `None` for all digits.
    pub resolution: Option<f64>,
    /// Write these into the column `warning`, which is there if there are any.
    #[cfg_attr(feature = "serde", serde(default))]
    pub warnings: OriginWarnings,
    /// Write the `warning` column though nothing is known yet: needed where [`OutlineWriter::warn`] may tell of warnings later.
    #[cfg_attr(feature = "serde", serde(default))]
    pub warning_column: bool,
}

impl WriterOptions {
    /// The columns that these outlines need.
    #[must_use]
    pub fn needed_for<'a>(frames: impl IntoIterator<Item = &'a OutlineFrame>) -> Self {
        frames.into_iter().fold(Self::default(), |options, frame| Self {
            object_column: options.object_column || frame.object != DEFAULT_OBJECT,
            arc_column: options.arc_column || matches!(frame.outline, Outline::Open(_)),
            contour_column: options.contour_column || has_several(&frame.outline),
            deviation_column: options.deviation_column || frame.outline.deviations().is_some(),
            ..options
        })
    }

    /// Whether there is a column `warning`.
    pub(crate) const fn has_warning_column(&self) -> bool {
        self.warning_column || !self.warnings.is_empty()
    }

    /// Adds warnings that rows to come are to have; whether there is a column for them, and any was not among them.
    pub(crate) fn add_warnings(&mut self, warnings: OriginWarnings) -> bool {
        let is_new = self.has_warning_column() && !warnings.without(self.warnings).is_empty();
        if is_new {
            self.warnings = self.warnings.and(warnings);
        }
        is_new
    }

    /// Refuses what the columns cannot hold or would not be read back.
    pub(crate) fn check(&self, frame: &OutlineFrame) -> Result<(), WriteError> {
        let OutlineFrame { object, time, .. } = frame;
        if !self.object_column && object != DEFAULT_OBJECT {
            return Err(WriteError::NoObjectColumn { object: object.clone() });
        }
        if !self.arc_column && matches!(frame.outline, Outline::Open(_)) {
            return Err(WriteError::NoArcColumn { object: object.clone(), frame: frame.frame });
        }
        if !self.contour_column && has_several(&frame.outline) {
            return Err(WriteError::NoContourColumn { object: object.clone(), frame: frame.frame });
        }
        if object.chars().any(char::is_control) || object.trim_ascii() != object {
            return Err(WriteError::ObjectName { object: object.clone() });
        }
        if !time.is_finite() || time.abs() > NUMBER_LIMIT {
            return Err(WriteError::Time { object: object.clone(), frame: frame.frame, time: *time });
        }
        Ok(())
    }
}

/// Writes outlines one by one as CSV that [`OutlineReader`](crate::OutlineReader) reads back to the last bit, unless
/// rounding is asked for and except for the last point of a closed outline where it repeats the first. Needs no buffered sink.
#[derive(Debug)]
pub struct OutlineWriter<W: Write> {
    writer: csv::Writer<W>,
    options: WriterOptions,
    rounding: Rounding,
    /// Those known so far as text.
    warnings: String,
    /// Holds one number as text.
    text: Vec<u8>,
}

impl<W: Write> OutlineWriter<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// The sink fails.
    pub fn new(sink: W, options: WriterOptions) -> Result<Self, WriteError> {
        let mut writer = csv::Writer::from_writer(sink);
        let required = [Column::Frame, Column::Time, Column::X, Column::Y].into_iter();
        let object = options.object_column.then_some(Column::Object);
        let arc = options.arc_column.then_some(Column::Arc);
        let contour = options.contour_column.then_some(Column::Contour);
        let deviation = options.deviation_column.then_some(Column::Deviation);
        let warning = options.has_warning_column().then_some(Column::Warning);
        let optional = object.into_iter().chain(arc).chain(contour).chain(deviation).chain(warning);
        writer.write_record(required.chain(optional).map(|column| column.name())).map_err(io_error)?;
        let rounding = Rounding::to_share(options.resolution);
        Ok(Self { writer, options, rounding, warnings: options.warnings.to_string(), text: Vec::new() })
    }

    /// Writes these warnings too into the rows to come. Without the column `warning`, which the options ask for, they are not written.
    pub fn warn(&mut self, warnings: OriginWarnings) {
        if self.options.add_warnings(warnings) {
            self.warnings = self.options.warnings.to_string();
        }
    }

    /// Writes one outline.
    ///
    /// # Errors
    /// The sink fails; the outline needs a column that the header lacks; the time is not finite or beyond 1e100; the
    /// object's name has control characters or white space at an end. Nothing of the outline has been written then,
    /// unless the sink failed.
    pub fn write(&mut self, frame: &OutlineFrame) -> Result<(), WriteError> {
        self.options.check(frame)?;
        let open = matches!(frame.outline, Outline::Open(_));
        self.rounding.take(&frame.outline);
        let mut deviations = frame.outline.deviations();
        for (arc, piece) in frame.outline.pieces().enumerate() {
            for point in piece.points {
                self.field(format_args!("{}", frame.frame))?;
                self.number(self.rounding.time(frame.time))?;
                self.number(self.rounding.coordinate(point.x))?;
                self.number(self.rounding.coordinate(point.y))?;
                if self.options.object_column {
                    self.writer.write_field(&frame.object).map_err(io_error)?;
                }
                match self.options.arc_column {
                    true if open => self.field(format_args!("{arc}"))?,
                    true => self.writer.write_field("").map_err(io_error)?,
                    false => {}
                }
                match self.options.contour_column {
                    true if !open => self.field(format_args!("{arc}"))?,
                    true => self.writer.write_field("").map_err(io_error)?,
                    false => {}
                }
                if self.options.deviation_column {
                    match deviations.as_mut().and_then(Iterator::next) {
                        Some(deviation) => self.number(deviation)?,
                        None => self.writer.write_field("").map_err(io_error)?,
                    }
                }
                if self.options.has_warning_column() {
                    self.writer.write_field(&self.warnings).map_err(io_error)?;
                }
                self.writer.write_record(None::<&[u8]>).map_err(io_error)?;
            }
        }
        Ok(())
    }

    /// Writes out what is buffered.
    ///
    /// # Errors
    /// The sink fails.
    pub fn flush(&mut self) -> Result<(), WriteError> {
        Ok(self.writer.flush()?)
    }

    /// Writes out what is buffered and hands the sink back.
    ///
    /// # Errors
    /// The sink fails.
    pub fn finish(self) -> Result<W, WriteError> {
        self.writer.into_inner().map_err(|error| WriteError::Io(error.into_error()))
    }

    /// The shortest text that reads back as the same number, without long runs of zeros.
    fn number(&mut self, value: f64) -> Result<(), WriteError> {
        if value == 0.0 || (1e-5..1e16).contains(&value.abs()) {
            self.field(format_args!("{value}"))
        } else {
            self.field(format_args!("{value:e}"))
        }
    }

    fn field(&mut self, text: fmt::Arguments<'_>) -> Result<(), WriteError> {
        self.text.clear();
        self.text.write_fmt(text)?;
        self.writer.write_field(&self.text).map_err(io_error)
    }
}

fn has_several(outline: &Outline) -> bool {
    matches!(outline, Outline::Closed(closed) if !closed.inner().is_empty())
}

/// Keeps the kind, by which a closed pipe is told from a full disc.
fn io_error(error: csv::Error) -> WriteError {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => WriteError::Io(error),
        other => WriteError::Io(io::Error::other(format!("{other:?}"))),
    }
}
