//! The columns of a table of outlines as numpy arrays, which are looked into where they are.
use freeform_motion::outline_io::{
    ColumnOutlines, ListChunk, ListOutlines, Lists, Marks, OutlineColumns, OutlineFrame, OutlineLists, ReadError,
};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::errors::value_error;

/// Names of the objects, and per row the position of the object among them (None for one object), frame, time, and the points.
#[derive(FromPyObject)]
pub(crate) struct TableArrays<'py>(
    Vec<String>,
    Option<PyReadonlyArray1<'py, u32>>,
    PyReadonlyArray1<'py, u64>,
    PyReadonlyArray1<'py, f64>,
    Points<'py>,
);

#[derive(FromPyObject)]
enum Points<'py> {
    /// One per row.
    OfRows(PointArrays<'py>),
    /// One list per row, in chunks of rows.
    Lists(Vec<ChunkArrays<'py>>),
}

/// x, y, arc and contour (None for closed outlines of one contour), and standard deviation (NaN or None for none).
#[derive(FromPyObject)]
struct PointArrays<'py>(
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    Option<PyReadonlyArray1<'py, i64>>,
    Option<PyReadonlyArray1<'py, i64>>,
    Option<PyReadonlyArray1<'py, f64>>,
);

/// Lists of x and of y, arc and contour, and lists of standard deviations.
#[derive(FromPyObject)]
struct ChunkArrays<'py>(
    ListArrays<'py, f64>,
    ListArrays<'py, f64>,
    Option<MarkArrays<'py>>,
    Option<MarkArrays<'py>>,
    Option<ListArrays<'py, f64>>,
);

/// Offsets, and the values of all lists.
#[derive(FromPyObject)]
struct ListArrays<'py, T: numpy::Element>(PyReadonlyArray1<'py, i64>, PyReadonlyArray1<'py, T>);

#[derive(FromPyObject)]
enum MarkArrays<'py> {
    OfRows(PyReadonlyArray1<'py, i64>),
    OfPoints(ListArrays<'py, i64>),
}

/// The outlines of a table.
pub(crate) enum TableOutlines<'a> {
    OfPoints(ColumnOutlines<'a>),
    OfLists(ListOutlines<'a>),
}

impl TableArrays<'_> {
    /// The outlines, one after the other.
    pub(crate) fn outlines(&self) -> PyResult<TableOutlines<'_>> {
        let Self(names, object, frame, time, points) = self;
        let object = optional(object.as_ref())?;
        let (frame, time) = (frame.as_slice()?, time.as_slice()?);
        match points {
            Points::OfRows(PointArrays(x, y, arc, contour, deviation)) => {
                let (x, y) = (x.as_slice()?, y.as_slice()?);
                let (arc, contour) = (optional(arc.as_ref())?, optional(contour.as_ref())?);
                let deviation = optional(deviation.as_ref())?;
                let columns = OutlineColumns { names, object, frame, time, x, y, arc, contour, deviation };
                columns.outlines().map(TableOutlines::OfPoints).map_err(value_error)
            }
            Points::Lists(chunks) => {
                let chunks = chunks.iter().map(ChunkArrays::view).collect::<PyResult<_>>()?;
                let lists = OutlineLists { names, object, frame, time, chunks };
                lists.outlines().map(TableOutlines::OfLists).map_err(value_error)
            }
        }
    }
}

impl ChunkArrays<'_> {
    fn view(&self) -> PyResult<ListChunk<'_>> {
        let Self(x, y, arc, contour, deviation) = self;
        let (arc, contour) = (marks(arc.as_ref())?, marks(contour.as_ref())?);
        let deviation = deviation.as_ref().map(ListArrays::view).transpose()?;
        Ok(ListChunk { x: x.view()?, y: y.view()?, arc, contour, deviation })
    }
}

impl<T: numpy::Element> ListArrays<'_, T> {
    fn view(&self) -> PyResult<Lists<'_, T>> {
        Ok(Lists { offsets: self.0.as_slice()?, values: self.1.as_slice()? })
    }
}

fn marks<'a>(marks: Option<&'a MarkArrays<'_>>) -> PyResult<Marks<'a>> {
    Ok(match marks {
        None => Marks::None,
        Some(MarkArrays::OfRows(marks)) => Marks::OfRows(marks.as_slice()?),
        Some(MarkArrays::OfPoints(marks)) => Marks::OfPoints(marks.view()?),
    })
}

fn optional<'a, T: numpy::Element>(array: Option<&'a PyReadonlyArray1<'_, T>>) -> PyResult<Option<&'a [T]>> {
    Ok(array.map(PyReadonlyArray1::as_slice).transpose()?)
}

impl Iterator for TableOutlines<'_> {
    type Item = Result<OutlineFrame, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        match self {
            Self::OfPoints(outlines) => outlines.next(),
            Self::OfLists(outlines) => outlines.next(),
        }
    }
}
