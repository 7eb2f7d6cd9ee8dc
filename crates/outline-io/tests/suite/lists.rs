//! Outlines as lists of a table with one row per outline: the same as from a file, and the same mistakes found.
use freeform_curve_fit::{ClosedOutline, OpenArc, OpenOutline, Outline};
use freeform_outline_io::{
    Column, ColumnsError, ListChunk, Lists, Marks, OutlineFrame, OutlineLists, ReadError, ReadErrorKind, Span,
};
use nalgebra::Point2;
use proptest::prelude::*;

/// Lists that own their values.
#[derive(Debug, Clone)]
struct Owned<T> {
    offsets: Vec<i64>,
    values: Vec<T>,
}

impl<T: Clone> Owned<T> {
    fn of(lists: &[Vec<T>]) -> Self {
        // Values of a slice of an Arrow array begin anywhere.
        let mut owned = Self { offsets: vec![0], values: Vec::new() };
        for list in lists {
            owned.values.extend(list.iter().cloned());
            owned.offsets.push(owned.values.len() as i64);
        }
        owned
    }

    fn view(&self) -> Lists<'_, T> {
        Lists { offsets: &self.offsets, values: &self.values }
    }
}

/// A row as in Parquet.
#[derive(Debug, Clone)]
struct Row {
    object: u32,
    frame: u64,
    time: f64,
    x: Vec<f64>,
    y: Vec<f64>,
    arc: Vec<i64>,
    contour: Vec<i64>,
    deviation: Vec<f64>,
}

impl Row {
    fn of(frame: &OutlineFrame, names: &[String]) -> Self {
        let object = names.iter().position(|name| *name == frame.object).expect("a name") as u32;
        let deviation = frame.outline.deviations().into_iter().flatten().collect();
        let (x, y, arc, contour) = (vec![], vec![], vec![], vec![]);
        let mut row = Self { object, frame: frame.frame, time: frame.time, x, y, arc, contour, deviation };
        for (number, piece) in (0..).zip(frame.outline.pieces()) {
            for p in piece.points {
                row.x.push(p.x);
                row.y.push(p.y);
                if piece.closed { row.contour.push(number) } else { row.arc.push(number) }
            }
        }
        row
    }
}

fn names() -> Vec<String> {
    ["left", "right", "hollow"].map(str::to_owned).to_vec()
}

/// Reads rows in chunks of so many.
fn read_in(rows: &[Row], chunk: usize, with_marks: bool) -> Result<Vec<Result<OutlineFrame, ReadError>>, ColumnsError> {
    let names = names();
    let columns: Vec<_> = rows
        .chunks(chunk)
        .map(|rows| {
            let lists =
                |pick: fn(&Row) -> &Vec<f64>| Owned::of(&rows.iter().map(|r| pick(r).clone()).collect::<Vec<_>>());
            let marks =
                |pick: fn(&Row) -> &Vec<i64>| Owned::of(&rows.iter().map(|r| pick(r).clone()).collect::<Vec<_>>());
            (lists(|r| &r.x), lists(|r| &r.y), marks(|r| &r.arc), marks(|r| &r.contour), lists(|r| &r.deviation))
        })
        .collect();
    let marks = |lists| if with_marks { Marks::OfPoints(lists) } else { Marks::None };
    let chunks = columns
        .iter()
        .map(|(x, y, arc, contour, deviation)| ListChunk {
            x: x.view(),
            y: y.view(),
            arc: marks(arc.view()),
            contour: marks(contour.view()),
            // A chunk may have the column where others lack it.
            deviation: Some(deviation.view()).filter(|lists| !lists.values.is_empty()),
        })
        .collect();
    let object: Vec<u32> = rows.iter().map(|row| row.object).collect();
    let frame: Vec<u64> = rows.iter().map(|row| row.frame).collect();
    let time: Vec<f64> = rows.iter().map(|row| row.time).collect();
    let table = OutlineLists { names: &names, object: Some(&object), frame: &frame, time: &time, chunks };
    Ok(table.outlines()?.collect())
}

fn read(rows: &[Row]) -> Vec<Result<OutlineFrame, ReadError>> {
    read_in(rows, 4, true).expect("columns")
}

fn square(half: f64, shift: f64) -> Vec<Point2<f64>> {
    [(-half, -half), (half, -half), (half, half), (-half, half)].map(|(x, y)| Point2::new(x + shift, y)).to_vec()
}

/// With standard deviations of its points.
fn stating(outline: Outline) -> Outline {
    let stated = (1..=outline.point_count()).map(|point| 0.1 * point as f64).collect();
    outline.with_deviations(stated).expect("positive numbers")
}

fn recording() -> Vec<OutlineFrame> {
    let arc = |shift: f64| OpenArc::new(square(1.0, shift)[..3].to_vec()).expect("an arc");
    let frames = (0..5_u64).flat_map(|k| {
        let shift = 0.1 * k as f64;
        let outlines: [(&str, Outline); 3] = [
            ("left", Outline::closed(square(1.0, shift)).expect("a square")),
            ("right", OpenOutline::new(vec![arc(shift), arc(shift + 4.0)]).expect("two arcs").into()),
            (
                "hollow",
                ClosedOutline::new(square(2.0, shift))
                    .and_then(|boundary| boundary.with_inner(vec![square(1.0, shift)]))
                    .expect("a hole inside")
                    .into(),
            ),
        ];
        // Some frames state standard deviations, as some programs do not.
        let outlines = outlines.map(|(object, outline)| match k {
            1 | 3 => (object, stating(outline)),
            _ => (object, outline),
        });
        outlines.map(|(object, outline)| OutlineFrame { frame: k, time: shift, object: object.to_owned(), outline })
    });
    frames.collect()
}

fn rows() -> Vec<Row> {
    recording().iter().map(|frame| Row::of(frame, &names())).collect()
}

#[test]
fn lists_give_the_outlines_that_they_are_of_in_however_many_chunks() {
    for chunk in [1, 2, 4, 100] {
        let read = read_in(&rows(), chunk, true).expect("columns");
        let read: Vec<_> = read.into_iter().collect::<Result<_, _>>().expect("good");
        assert_eq!(read, recording());
    }
}

#[test]
fn without_marks_every_row_is_one_closed_contour() {
    let closed: Vec<Row> = rows().into_iter().filter(|row| row.object == 0).collect();
    let read: Vec<_> =
        read_in(&closed, 2, false).expect("columns").into_iter().collect::<Result<_, _>>().expect("good");
    let expected: Vec<_> = recording().into_iter().filter(|frame| frame.object == "left").collect();
    assert_eq!(read, expected);
}

#[test]
fn rows_that_are_arcs_or_contours_make_one_outline_also_over_the_end_of_a_chunk() {
    let points = |half: f64| square(half, 0.0);
    let lists = |axis: usize| Owned::of(&[2.0, 1.0].map(|half| points(half).iter().map(|p| p[axis]).collect()));
    let (x, y) = (lists(0), lists(1));
    let (first, second) = (&[0, 4][..], &[4, 8][..]);
    let chunk = |offsets, contour| ListChunk {
        x: Lists { offsets, values: &x.values },
        y: Lists { offsets, values: &y.values },
        arc: Marks::None,
        contour: Marks::OfRows(contour),
        deviation: None,
    };
    let table = |chunks| OutlineLists { names: &[], object: None, frame: &[7, 7], time: &[0.5, 0.5], chunks };
    let read: Vec<_> = table(vec![chunk(first, &[0]), chunk(second, &[1])]).outlines().expect("columns").collect();
    let outline = &read[0].as_ref().expect("an outline").outline;
    assert_eq!((read.len(), outline.pieces().count(), outline.point_count()), (1, 2, 8));
    // The same contour twice, and a row that is none.
    let again: Vec<_> = table(vec![chunk(first, &[0]), chunk(second, &[0])]).outlines().expect("columns").collect();
    assert!(matches!(again[0].as_ref().expect_err("twice").kind, ReadErrorKind::SecondContour { .. }));
    let none: Vec<_> = table(vec![chunk(first, &[-1]), chunk(second, &[-1])]).outlines().expect("columns").collect();
    assert!(none[0].is_ok());
    assert!(matches!(none[1].as_ref().expect_err("no piece").kind, ReadErrorKind::SecondOutline { .. }));
}

/// The error that ends the reading, with its row and column.
fn failure(spoil: impl Fn(&mut Vec<Row>)) -> (u64, Option<Column>, ReadErrorKind) {
    let mut rows = rows();
    spoil(&mut rows);
    let mut read = read(&rows);
    let last = read.pop().expect("something").expect_err("an error at the end");
    assert!(read.iter().all(Result::is_ok), "{read:?}");
    let Some(Span::Rows(row, _)) = last.place.span else { panic!("no row: {last}") };
    (row, last.place.column, last.kind)
}

#[test]
fn mistakes_are_told_with_their_row_and_column() {
    use ReadErrorKind as Kind;
    let found = failure(|rows| rows[5].x[2] = f64::NAN);
    assert!(matches!(found, (5, Some(Column::X), Kind::NotFinite { .. })), "{found:?}");
    let found = failure(|rows| rows[6].y[0] = 1e101);
    assert!(matches!(found, (6, Some(Column::Y), Kind::TooLarge { .. })), "{found:?}");
    let found = failure(|rows| rows[7].y.truncate(5));
    assert!(matches!(found, (7, Some(Column::Y), Kind::ListLength { found: 5, expected: 6 })), "{found:?}");
    let found = failure(|rows| rows[4].arc.truncate(5));
    assert!(matches!(found, (4, Some(Column::Arc), Kind::ListLength { found: 5, expected: 6 })), "{found:?}");
    let found = failure(|rows| rows[4].arc[5] = 0);
    assert!(matches!(found, (4, Some(Column::Arc), Kind::SecondArc { .. })), "{found:?}");
    let found = failure(|rows| rows[4].arc[5] = -7);
    assert!(matches!(found, (4, Some(Column::Arc), Kind::MixedArcs { .. })), "{found:?}");
    let found = failure(|rows| rows[3].time = f64::INFINITY);
    assert!(matches!(found, (3, Some(Column::Time), Kind::NotFinite { .. })), "{found:?}");
    let found = failure(|rows| rows[3].time = 0.0);
    assert!(matches!(found, (3, Some(Column::Time), Kind::TimeNotIncreasing { .. })), "{found:?}");
    let found = failure(|rows| rows[3].frame = 0);
    assert!(matches!(found, (3, Some(Column::Frame), Kind::SecondOutline { .. })), "{found:?}");
    let found = failure(|rows| rows.swap(3, 6));
    assert!(matches!(found, (6, Some(Column::Frame), Kind::FrameNotIncreasing { previous: 2, .. })), "{found:?}");
}

#[test]
fn deviations_that_are_none_are_refused_with_row_and_column() {
    use ReadErrorKind as Kind;
    for row in [3, 4, 5] {
        let column = Some(Column::Deviation);
        let found = failure(|rows| rows[row].deviation[2] = 0.0);
        assert!(
            matches!(found, (at, of, Kind::NotPositive { value: 0.0 }) if at == row as u64 && of == column),
            "{found:?}"
        );
        let found = failure(|rows| rows[row].deviation[2] = -1.0);
        assert!(
            matches!(found, (at, of, Kind::NotPositive { value: -1.0 }) if at == row as u64 && of == column),
            "{found:?}"
        );
        let found = failure(|rows| rows[row].deviation[2] = f64::NAN);
        assert!(matches!(found, (at, of, Kind::NotFinite { .. }) if at == row as u64 && of == column), "{found:?}");
        let found = failure(|rows| rows[row].deviation[2] = f64::INFINITY);
        assert!(matches!(found, (at, of, Kind::NotFinite { .. }) if at == row as u64 && of == column), "{found:?}");
        let found = failure(|rows| rows[row].deviation[2] = 1e101);
        assert!(matches!(found, (at, of, Kind::TooLarge { .. }) if at == row as u64 && of == column), "{found:?}");
        let found = failure(|rows| rows[row].deviation.truncate(2));
        assert!(matches!(found, (at, of, Kind::ListLength { .. }) if at == row as u64 && of == column), "{found:?}");
        let found = failure(|rows| rows[row].deviation.push(1.0));
        assert!(matches!(found, (at, of, Kind::ListLength { .. }) if at == row as u64 && of == column), "{found:?}");
    }
}

#[test]
fn an_outline_of_rows_of_which_some_state_deviations_is_left_out() {
    let (x, y) = ([0.0, 1.0, 5.0, 5.0], [0.0, 0.0, 1.0, 2.0]);
    let read = |offsets: &[i64], values: &[f64]| {
        let chunk = ListChunk {
            x: Lists { offsets: &[0, 2, 4], values: &x },
            y: Lists { offsets: &[0, 2, 4], values: &y },
            arc: Marks::OfRows(&[0, 1]),
            contour: Marks::None,
            deviation: Some(Lists { offsets, values }),
        };
        let table = OutlineLists { names: &[], object: None, frame: &[0, 0], time: &[0.0, 0.0], chunks: vec![chunk] };
        table.outlines().expect("columns").next().expect("an outline")
    };
    let outline = read(&[0, 2, 4], &[0.1, 0.2, 0.3, 0.4]).expect("two arcs").outline;
    assert!(outline.deviations().expect("deviations").eq([0.1, 0.2, 0.3, 0.4]));
    assert!(read(&[0, 0, 0], &[]).expect("two arcs").outline.deviations().is_none());
    for (offsets, values) in [([0, 2, 2], [0.1, 0.2]), ([0, 0, 2], [0.3, 0.4])] {
        let error = read(&offsets, &values).expect_err("one arc states none");
        assert!(error.is_recoverable(), "{error}");
        assert!(error.to_string().ends_with("2 standard deviation(s) for 4 points"), "{error}");
    }
}

#[test]
fn lists_of_deviations_that_do_not_fit_the_rows_or_their_values_are_refused() {
    let (x, y) = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let error = |offsets: &[i64]| {
        let lists = |values| Lists { offsets: &[0, 3], values };
        let deviation = Some(Lists { offsets, values: &[0.5; 3] });
        let chunk = ListChunk { x: lists(&x), y: lists(&y), arc: Marks::None, contour: Marks::None, deviation };
        let chunks = vec![chunk];
        OutlineLists { names: &[], object: None, frame: &[0], time: &[0.0], chunks }.outlines().err()
    };
    assert_eq!(error(&[0, 3]), None);
    let column = Column::Deviation;
    assert_eq!(error(&[0, 0, 3]), Some(ColumnsError::Length { column, found: 2, expected: 1 }));
    let (list, start, end, values) = (0, 0, 4, 3);
    assert_eq!(error(&[0, 4]), Some(ColumnsError::Offsets { column, list, start, end, values }));
}

#[test]
fn reading_goes_on_after_a_row_whose_points_are_no_outline() {
    let mut rows = rows();
    rows[3].y.fill(0.0);
    (rows[6].x, rows[6].y, rows[6].contour) = (vec![], vec![], vec![]);
    let read = read(&rows);
    let bad: Vec<_> = (0..).zip(&read).filter_map(|(row, read)| Some((row, read.as_ref().err()?))).collect();
    assert!(bad.iter().all(|(row, error)| error.is_recoverable() && error.place.span == Some(Span::Rows(*row, *row))));
    assert_eq!((bad.len(), read.len()), (2, 15));
}

#[test]
fn columns_that_do_not_fit_together_are_refused() {
    let values = [0.0, 1.0, 0.0];
    let error = |x: &[i64], y: &[i64], rows: usize| {
        let lists = |offsets| Lists { offsets, values: &values };
        let (arc, contour) = (Marks::None, Marks::None);
        let chunks = vec![ListChunk { x: lists(x), y: lists(y), arc, contour, deviation: None }];
        let (frame, time) = (vec![0; rows], vec![0.0; rows]);
        OutlineLists { names: &[], object: None, frame: &frame, time: &time, chunks }.outlines().err()
    };
    assert_eq!(error(&[0, 3], &[0, 3], 1), None);
    let length = |column, found, expected| Some(ColumnsError::Length { column, found, expected });
    assert_eq!(error(&[0, 3], &[0, 3], 2), length(Column::X, 1, 2));
    assert_eq!(error(&[0, 3], &[0, 1, 3], 1), length(Column::Y, 2, 1));
    for (start, end) in [(0, 4), (-1, 2), (2, 1), (i64::MAX, i64::MIN)] {
        let expected = Some(ColumnsError::Offsets { column: Column::X, list: 0, start, end, values: 3 });
        assert_eq!(error(&[start, end], &[0, 3], 1), expected);
    }
}

proptest! {
    #[test]
    fn no_lists_make_it_panic_or_run_on(
        rows in prop::collection::vec(
            (0..3_u32, 0..4_u64, -1.0..2.0_f64, prop::collection::vec((-3.0..3.0_f64, -3.0..3.0_f64, -2..3_i64), 0..6), 0..3_usize, prop::collection::vec(-0.1..3.0_f64, 0..6)), 0..20),
        chunk in 1..5_usize,
    ) {
        let rows: Vec<Row> = rows
            .into_iter()
            .map(|(object, frame, time, points, cut, deviation)| Row {
                object,
                frame,
                time,
                x: points.iter().map(|p| p.0).collect(),
                y: points.iter().skip(cut / 2).map(|p| p.1).collect(),
                arc: points.iter().map(|p| p.2).collect(),
                contour: points.iter().skip(cut).map(|p| p.2 - 1).collect(),
                deviation,
            })
            .collect();
        prop_assert!(read_in(&rows, chunk, true).expect("columns").len() <= rows.len());
    }
}
