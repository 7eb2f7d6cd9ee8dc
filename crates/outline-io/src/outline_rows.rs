use std::collections::HashSet;

use freeform_curve_fit::{ClosedOutline, OpenArc, OpenOutline, Outline, OutlineError};
use nalgebra::Point2;

use crate::column::Column;
use crate::csv_field::quoted_start;
use crate::error::ReadErrorKind;

/// Largest number of points of one outline; a file that never changes its frame number must not fill the memory.
const POINT_LIMIT: usize = 1 << 22;

/// The rows of one outline as they come in.
#[derive(Debug)]
pub(crate) struct OutlineRows {
    pub(crate) frame: u64,
    pub(crate) time: f64,
    pub(crate) object: String,
    pub(crate) first_line: u64,
    pub(crate) last_line: u64,
    point_count: usize,
    /// Arc values met so far: empty for a closed outline.
    arc_values: HashSet<Vec<u8>>,
    /// Contour values met so far.
    contour_values: HashSet<Vec<u8>>,
    /// The arcs, or the closed contours.
    pieces: Vec<Vec<Point2<f64>>>,
}

impl OutlineRows {
    pub(crate) fn new(frame: u64, time: f64, object: String, first_line: u64, capacity: usize) -> Self {
        let pieces = vec![Vec::with_capacity(capacity)];
        Self {
            frame,
            time,
            object,
            first_line,
            last_line: first_line,
            point_count: 0,
            arc_values: HashSet::new(),
            contour_values: HashSet::new(),
            pieces,
        }
    }

    /// Room to reserve for the next outline, which is likely to have as many points.
    pub(crate) fn capacity_hint(&self) -> usize {
        self.pieces[0].len()
    }

    /// Enters the contour of the next point, if it is another than that of the point before. Arcs may be of any contour.
    pub(crate) fn enter_contour(&mut self, contour: &[u8], continues: bool) -> Result<(), ReadErrorKind> {
        let first = self.point_count == 0;
        if !first && (continues || !self.arc_values.is_empty()) {
            return Ok(());
        }
        if !self.contour_values.insert(contour.to_vec()) {
            let (object, frame) = (self.object.clone(), self.frame);
            return Err(ReadErrorKind::SecondContour { object, frame, contour: quoted_start(contour) });
        }
        if !first {
            self.pieces.push(Vec::new());
        }
        Ok(())
    }

    /// Adds a point. `arc` is the row's arc value, empty for none; `arc_continues` tells that it is that of the row
    /// before.
    pub(crate) fn add(
        &mut self,
        point: Point2<f64>,
        arc: &[u8],
        arc_continues: bool,
        line: u64,
    ) -> Result<(), (ReadErrorKind, Option<Column>)> {
        let first = self.point_count == 0;
        if first || !arc_continues {
            self.enter_arc(arc, first).map_err(|kind| (kind, Some(Column::Arc)))?;
        }
        if self.point_count == POINT_LIMIT {
            let (object, frame) = (self.object.clone(), self.frame);
            return Err((ReadErrorKind::TooManyPoints { object, frame, limit: POINT_LIMIT }, None));
        }
        if let Some(piece) = self.pieces.last_mut() {
            piece.push(point);
        }
        self.point_count += 1;
        self.last_line = line;
        Ok(())
    }

    fn enter_arc(&mut self, arc: &[u8], first: bool) -> Result<(), ReadErrorKind> {
        let (object, frame) = (self.object.clone(), self.frame);
        let open = !self.arc_values.is_empty();
        if !first && arc.is_empty() == open {
            return Err(ReadErrorKind::MixedArcs { object, frame });
        }
        if arc.is_empty() {
            return Ok(());
        }
        if !self.arc_values.insert(arc.to_vec()) {
            return Err(ReadErrorKind::SecondArc { object, frame, arc: quoted_start(arc) });
        }
        if !first {
            self.pieces.push(Vec::new());
        }
        Ok(())
    }

    /// The object's name and the outline of the points.
    pub(crate) fn into_outline(self) -> (String, Result<Outline, OutlineError>) {
        let open = !self.arc_values.is_empty();
        (self.object, if open { open_outline(self.pieces) } else { closed_outline(self.pieces) })
    }
}

pub(crate) fn closed_outline(pieces: Vec<Vec<Point2<f64>>>) -> Result<Outline, OutlineError> {
    let mut contours = pieces.into_iter().map(|mut points| {
        if points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        points
    });
    let boundary = ClosedOutline::new(contours.next().unwrap_or_default())?;
    boundary.with_inner(contours.collect()).map(Outline::Closed)
}

pub(crate) fn open_outline(pieces: Vec<Vec<Point2<f64>>>) -> Result<Outline, OutlineError> {
    let mut arcs = Vec::with_capacity(pieces.len());
    let mut refused = None;
    for points in pieces {
        match OpenArc::new(points) {
            Ok(arc) => arcs.push(arc),
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    match refused {
        Some(error) if arcs.is_empty() => Err(error),
        _ => OpenOutline::new(arcs).map(Outline::Open),
    }
}
