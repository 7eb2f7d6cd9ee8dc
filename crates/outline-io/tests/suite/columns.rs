//! Outlines as columns of a table: the same as from a file, and the same mistakes found.
use freeform_curve_fit::{ClosedOutline, OpenArc, OpenOutline, Outline};
use freeform_outline_io::{
    Column, ColumnsError, OutlineColumns, OutlineFrame, OutlineReader, OutlineWriter, ReadError, ReadErrorKind, Span,
    WriterOptions,
};
use nalgebra::Point2;
use proptest::prelude::*;

/// Columns that own their rows.
#[derive(Debug, Clone, Default)]
struct Table {
    names: Vec<String>,
    object: Vec<u32>,
    frame: Vec<u64>,
    time: Vec<f64>,
    x: Vec<f64>,
    y: Vec<f64>,
    arc: Vec<i64>,
    contour: Vec<i64>,
    deviation: Vec<f64>,
}

impl Table {
    fn of(frames: &[OutlineFrame]) -> Self {
        let mut table = Self::default();
        for frame in frames {
            let object = table.names.iter().position(|name| *name == frame.object).unwrap_or_else(|| {
                table.names.push(frame.object.clone());
                table.names.len() - 1
            });
            match frame.outline.deviations() {
                Some(stated) => table.deviation.extend(stated),
                None => table.deviation.resize(table.deviation.len() + frame.outline.point_count(), f64::NAN),
            }
            for (number, piece) in (0..).zip(frame.outline.pieces()) {
                for p in piece.points {
                    table.object.push(object as u32);
                    table.frame.push(frame.frame);
                    table.time.push(frame.time);
                    table.x.push(p.x);
                    table.y.push(p.y);
                    table.arc.push(if piece.closed { -1 } else { number });
                    table.contour.push(if piece.closed { number } else { -1 });
                }
            }
        }
        table
    }

    fn columns(&self) -> OutlineColumns<'_> {
        let Self { names, object, frame, time, x, y, arc, contour, deviation } = self;
        let (arc, contour, deviation) = (Some(&arc[..]), Some(&contour[..]), Some(&deviation[..]));
        OutlineColumns { names, object: Some(object), frame, time, x, y, arc, contour, deviation }
    }

    fn read(&self) -> Vec<Result<OutlineFrame, ReadError>> {
        self.columns().outlines().expect("columns").collect()
    }
}

fn triangle(shift: f64) -> Outline {
    let points = [(0.0, 0.0), (2.0, 0.0), (0.0, 1.0)];
    Outline::closed(points.map(|(x, y)| Point2::new(x + shift, y)).to_vec()).expect("a triangle")
}

fn two_arcs(shift: f64) -> Outline {
    let arc = |points: [(f64, f64); 3]| {
        OpenArc::new(points.map(|(x, y)| Point2::new(x + shift, y)).to_vec()).expect("an arc")
    };
    let arcs = vec![arc([(0.0, 0.0), (1.0, 0.0), (2.0, 0.5)]), arc([(2.0, 2.0), (1.0, 3.0), (0.0, 2.0)])];
    OpenOutline::new(arcs).expect("two arcs").into()
}

fn with_hole(shift: f64) -> Outline {
    let square = |half: f64| {
        [(-half, -half), (half, -half), (half, half), (-half, half)].map(|(x, y)| Point2::new(x + shift, y)).to_vec()
    };
    let boundary = ClosedOutline::new(square(2.0)).expect("a square");
    boundary.with_inner(vec![square(1.0)]).expect("a hole inside").into()
}

/// With standard deviations of its points.
fn stating(outline: Outline) -> Outline {
    let stated = (1..=outline.point_count()).map(|point| 0.1 * point as f64).collect();
    outline.with_deviations(stated).expect("positive numbers")
}

fn frame(frame: u64, object: &str, outline: Outline) -> OutlineFrame {
    OutlineFrame { frame, time: frame as f64 / 30.0, object: object.to_owned(), outline }
}

fn recording() -> Vec<OutlineFrame> {
    let frames = (0..4_u64).flat_map(|k| {
        let shift = 0.1 * k as f64;
        [frame(k, "left", triangle(shift)), frame(k, "right", two_arcs(shift)), frame(2 * k, "third", triangle(-shift))]
    });
    frames.collect()
}

#[test]
fn columns_give_the_outlines_that_the_same_rows_of_a_file_give() {
    let mut frames = recording();
    frames.extend((0..3).map(|k| frame(k, "hollow", with_hole(0.1 * k as f64))));
    let stated = [triangle(0.0), two_arcs(0.0), with_hole(0.0)].map(stating);
    frames.extend((0..).zip(stated).map(|(k, outline)| frame(k, "stating", outline)));
    let options = WriterOptions::needed_for(&frames);
    assert!(options.arc_column && options.contour_column && options.deviation_column);
    let mut writer = OutlineWriter::new(Vec::new(), options).expect("memory");
    frames.iter().for_each(|frame| writer.write(frame).expect("memory"));
    let file = writer.finish().expect("memory");
    let from_file: Vec<_> =
        OutlineReader::new(&file[..], "test").expect("a header").collect::<Result<_, _>>().expect("good");
    let from_columns: Vec<_> = Table::of(&frames).read().into_iter().collect::<Result<_, _>>().expect("good");
    assert_eq!(from_columns, from_file);
    assert_eq!(from_columns, frames);
}

#[test]
fn without_objects_and_arcs_there_is_one_object_with_closed_outlines() {
    let table = Table::of(&[frame(3, "0", triangle(0.0)), frame(5, "0", triangle(1.0))]);
    let columns =
        OutlineColumns { object: None, arc: None, contour: None, deviation: None, names: &[], ..table.columns() };
    let read: Vec<_> = columns.outlines().expect("columns").collect::<Result<_, _>>().expect("good");
    assert_eq!(read, [frame(3, "0", triangle(0.0)), frame(5, "0", triangle(1.0))]);
}

#[test]
fn a_last_point_that_repeats_the_first_is_dropped_with_its_deviation() {
    let mut table = Table::of(&[frame(0, "0", stating(triangle(0.0)))]);
    let again = table.clone();
    for (column, first) in [(&mut table.x, again.x[0]), (&mut table.y, again.y[0])] {
        column.push(first);
    }
    table.object.push(0);
    table.frame.push(0);
    table.time.push(0.0);
    table.arc.push(-1);
    table.contour.push(0);
    table.deviation.push(7.0);
    assert_eq!(table.read().remove(0).expect("a triangle").outline, stating(triangle(0.0)));
}

#[test]
fn columns_of_different_lengths_and_objects_without_names_are_refused() {
    let table = Table::of(&recording());
    let rows = table.frame.len();
    let short = OutlineColumns { y: &table.y[1..], ..table.columns() };
    assert!(
        matches!(short.outlines(), Err(ColumnsError::Length { found, expected, .. }) if (found, expected) == (rows - 1, rows))
    );
    let short = OutlineColumns { deviation: Some(&table.deviation[1..]), ..table.columns() };
    let expected = ColumnsError::Length { column: Column::Deviation, found: rows - 1, expected: rows };
    assert_eq!(short.outlines().err(), Some(expected));
    let nameless = OutlineColumns { names: &table.names[..2], ..table.columns() };
    assert_eq!(nameless.outlines().err(), Some(ColumnsError::NoName { row: 9, position: 2, names: 2 }));
}

/// The first error that is not recoverable, with its row; nothing may come after it.
fn failure(table: &Table) -> (u64, ReadErrorKind) {
    let mut read = table.read();
    let last = read.pop().expect("something").expect_err("an error at the end");
    assert!(read.iter().all(|item| item.as_ref().is_ok_and(|_| true)), "{read:?}");
    let Some(Span::Rows(row, _)) = last.place.span else { panic!("no row: {last}") };
    (row, last.kind)
}

#[test]
fn mistakes_are_told_with_their_row() {
    let good = Table::of(&recording());
    let spoiled = |spoil: &dyn Fn(&mut Table)| {
        let mut table = good.clone();
        spoil(&mut table);
        failure(&table)
    };
    assert!(matches!(spoiled(&|t| t.x[4] = f64::NAN), (4, ReadErrorKind::NotFinite { .. })));
    assert!(matches!(spoiled(&|t| t.y[4] = -1e101), (4, ReadErrorKind::TooLarge { .. })));
    assert!(matches!(spoiled(&|t| t.time[4] = 7.0), (4, ReadErrorKind::TimeChanges { .. })));
    assert!(matches!(spoiled(&|t| t.time[5] = f64::INFINITY), (5, ReadErrorKind::NotFinite { .. })));
    assert!(matches!(spoiled(&|t| t.arc[4] = -1), (4, ReadErrorKind::MixedArcs { .. })));
    assert!(matches!(spoiled(&|t| t.arc[8] = 0), (8, ReadErrorKind::SecondArc { .. })));
    assert!(matches!(spoiled(&|t| t.contour[1] = 1), (2, ReadErrorKind::SecondContour { .. })));
    let later = |t: &mut Table, frame: u64, time: f64| {
        t.frame[12..15].fill(frame);
        t.time[12..15].fill(time);
    };
    assert!(matches!(spoiled(&|t| later(t, 0, 1.0)), (12, ReadErrorKind::SecondOutline { .. })));
    assert!(matches!(spoiled(&|t| later(t, 7, 0.0)), (12, ReadErrorKind::TimeNotIncreasing { .. })));
    assert!(matches!(
        spoiled(&|t| {
            t.frame[..3].fill(9);
            t.time[..3].fill(-1.0);
        }),
        (12, ReadErrorKind::FrameNotIncreasing { previous: 9, .. })
    ));
}

#[test]
fn deviations_that_are_none_are_refused_with_their_row() {
    let good = Table::of(
        &recording().into_iter().map(|of| OutlineFrame { outline: stating(of.outline), ..of }).collect::<Vec<_>>(),
    );
    assert!(good.read().iter().all(|read| read.as_ref().is_ok_and(|frame| frame.outline.deviations().is_some())));
    for (value, message) in [
        (0.0, "row 4: column deviation: 0 is not a standard deviation (a number above 0, or nothing)"),
        (-0.5, "row 4: column deviation: -0.5 is not a standard deviation (a number above 0, or nothing)"),
        (f64::INFINITY, "row 4: column deviation: \"inf\" is not a finite number: leave out the point"),
        (1e101, "row 4: column deviation: 1e101 is beyond 1e100"),
    ] {
        let mut table = good.clone();
        table.deviation[4] = value;
        let read = table.read();
        let error = read[1].as_ref().expect_err("no deviation");
        assert!(error.to_string().ends_with(message) && !error.is_recoverable() && read.len() == 2, "{error}");
    }
}

#[test]
fn an_outline_with_deviations_of_some_points_is_left_out_and_the_reading_goes_on() {
    for outline in [triangle(0.0), two_arcs(0.0), with_hole(0.0)] {
        let points = outline.point_count();
        let mut table = Table::of(&[frame(0, "0", stating(outline.clone())), frame(1, "0", outline)]);
        // NaN is none, for all points of an outline.
        assert!(table.read().iter().all(Result::is_ok));
        table.deviation[2] = f64::NAN;
        let read = table.read();
        let error = read[0].as_ref().expect_err("one is missing");
        let message = format!("{} standard deviation(s) for {points} points", points - 1);
        assert!(error.is_recoverable() && error.to_string().ends_with(&message), "{error}");
        assert!(read.len() == 2 && read[1].is_ok());
    }
}

#[test]
fn reading_goes_on_after_points_that_are_no_outline() {
    let mut table = Table::of(&recording());
    table.y[..3].fill(0.0);
    let read = table.read();
    let error = read[0].as_ref().expect_err("points on one line");
    assert!(error.is_recoverable() && error.place.span == Some(Span::Rows(0, 2)));
    assert!(read[1..].iter().all(Result::is_ok));
    assert_eq!(read.len(), 12);
}

proptest! {
    #[test]
    fn no_columns_make_it_panic_or_run_on(
        rows in prop::collection::vec((0..3_u32, 0..4_u64, -1.0..2.0_f64, prop::num::f64::ANY, prop::num::f64::ANY, -2..3_i64, prop::num::f64::ANY), 0..40),
    ) {
        let mut table = Table { names: ["a", "b", "c"].map(str::to_owned).to_vec(), ..Table::default() };
        for (object, frame, time, x, y, arc, deviation) in rows {
            table.object.push(object);
            table.frame.push(frame);
            table.time.push(time);
            table.x.push(x);
            table.y.push(y);
            table.arc.push(arc);
            table.contour.push(arc - 1);
            table.deviation.push(deviation);
        }
        let count = table.frame.len();
        prop_assert!(table.columns().outlines().expect("columns").count() <= count);
    }
}
