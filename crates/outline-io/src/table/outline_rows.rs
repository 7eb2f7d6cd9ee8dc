//! The rows of one outline, gathered until it is complete.
use std::collections::HashSet;

use freeform_curve_fit::{ClosedOutline, OpenArc, OpenOutline, Outline, OutlineError};
use nalgebra::Point2;

use crate::csv_file::field::quoted_start;
use crate::error::ReadErrorKind;
use crate::frame::OutlineFrame;
use crate::table::column::Column;

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
    /// Standard deviations of their points; empty where none are stated.
    deviations: Vec<Vec<f64>>,
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
            deviations: Vec::new(),
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

    /// Takes the standard deviation of the point that was added last.
    pub(crate) fn state_deviation(&mut self, deviation: f64) {
        self.deviations.resize_with(self.pieces.len(), Vec::new);
        if let Some(of_piece) = self.deviations.last_mut() {
            of_piece.push(deviation);
        }
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
        let outline = |(pieces, deviations)| match open {
            true => open_outline(pieces, deviations),
            false => closed_outline_with(pieces, deviations),
        };
        let (points, found) = (self.point_count, self.deviations.iter().map(Vec::len).sum());
        if found != 0 && found != points {
            return (self.object, Err(OutlineError::DeviationCount { found, points }));
        }
        (self.object, outline((self.pieces, self.deviations)))
    }

    /// The frame with the outline of the points, or why they are none.
    pub(crate) fn into_frame(self) -> Result<OutlineFrame, ReadErrorKind> {
        let (frame, time) = (self.frame, self.time);
        match self.into_outline() {
            (object, Ok(outline)) => Ok(OutlineFrame { frame, time, object, outline }),
            (object, Err(source)) => Err(ReadErrorKind::Degenerate { object, frame, source }),
        }
    }
}

pub(crate) fn closed_outline(pieces: Vec<Vec<Point2<f64>>>) -> Result<Outline, OutlineError> {
    closed_outline_with(pieces, Vec::new())
}

/// With the standard deviations of the points, unless there are none.
fn closed_outline_with(
    mut pieces: Vec<Vec<Point2<f64>>>,
    mut deviations: Vec<Vec<f64>>,
) -> Result<Outline, OutlineError> {
    for (index, points) in pieces.iter_mut().enumerate() {
        if points.len() > 1 && points.first() == points.last() {
            points.pop();
            deviations.get_mut(index).map(Vec::pop);
        }
    }
    let mut contours = pieces.into_iter();
    let boundary = ClosedOutline::new(contours.next().unwrap_or_default())?;
    let outline = boundary.with_inner(contours.collect())?;
    match deviations.is_empty() {
        true => Ok(outline.into()),
        false => outline.with_deviations(deviations.concat()).map(Outline::Closed),
    }
}

/// With the standard deviations of the points, unless there are none.
fn open_outline(pieces: Vec<Vec<Point2<f64>>>, deviations: Vec<Vec<f64>>) -> Result<Outline, OutlineError> {
    let mut arcs = Vec::with_capacity(pieces.len());
    let mut refused = None;
    let mut deviations = deviations.into_iter();
    for points in pieces {
        let arc = OpenArc::new(points);
        let arc = match deviations.next() {
            Some(deviations) => arc.and_then(|arc| arc.with_deviations(deviations)),
            None => arc,
        };
        match arc {
            Ok(arc) => arcs.push(arc),
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    match refused {
        Some(error) if arcs.is_empty() => Err(error),
        _ => OpenOutline::new(arcs).map(Outline::Open),
    }
}
