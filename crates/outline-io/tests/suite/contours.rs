//! Bodies with several contours: traced, written and read.
use freeform_curve_fit::{ClosedOutline, Outline};
use freeform_outline_io::{
    Contours, GrayImage, OutlineFrame, OutlineReader, OutlineWriter, TraceSettings, WriterOptions, trace_mask,
};
use image::Luma;

/// A disc of radius 40 with a hole of radius 10, grey edges.
fn holed() -> GrayImage {
    GrayImage::from_fn(120, 110, |column, row| {
        let (x, y) = (f64::from(column) + 0.5, f64::from(row) + 0.5);
        let share = |cx: f64, cy: f64, radius: f64| (radius - (x - cx).hypot(y - cy) + 0.5).clamp(0.0, 1.0);
        Luma([(30.0 + 180.0 * share(60.0, 55.0, 40.0) * (1.0 - share(75.0, 50.0, 10.0))).round() as u8])
    })
}

fn traced(contours: Contours, y_up: bool) -> ClosedOutline {
    let settings = TraceSettings { contours, y_up, ..TraceSettings::default() };
    let traced = trace_mask(&holed(), &settings).expect("a disc");
    assert_eq!(traced.edges.expect("edges").deviations.len(), traced.outline.point_count());
    match traced.outline {
        Outline::Closed(closed) => closed,
        Outline::Open(_) => panic!("nothing is clipped"),
    }
}

#[test]
fn a_hole_is_traced_where_contours_are_asked_for_and_runs_the_other_way_round() {
    assert!(traced(Contours::Boundary, true).inner().is_empty());
    for y_up in [true, false] {
        let outline = traced(Contours::All, y_up);
        assert_eq!(outline.inner().len(), 1);
        let hole = ClosedOutline::new(outline.inner()[0].clone()).expect("a hole");
        let area = std::f64::consts::PI * 100.0;
        assert!(
            outline.signed_area() > 0.0 && (hole.signed_area() / -area - 1.0).abs() < 0.02,
            "{}",
            hole.signed_area()
        );
        let centre_y = if y_up { 110.0 - 50.0 } else { 50.0 };
        let mean = hole.points().iter().map(|p| p.coords).sum::<nalgebra::Vector2<f64>>() / hole.points().len() as f64;
        assert!((mean - nalgebra::Vector2::new(75.0, centre_y)).norm() < 0.2, "{mean}");
    }
}

#[test]
fn contours_come_back_from_csv_to_the_last_bit_and_need_their_column() {
    let outline = Outline::Closed(traced(Contours::All, true));
    let frame = OutlineFrame { frame: 3, time: 0.1, object: "0".to_owned(), outline };
    let options = WriterOptions::needed_for([&frame]);
    assert!(options.contour_column);
    let mut writer = OutlineWriter::new(Vec::new(), options).expect("memory");
    writer.write(&frame).expect("memory");
    let csv = writer.finish().expect("memory");
    let read: Vec<_> =
        OutlineReader::new(&csv[..], "csv").expect("a header").collect::<Result<_, _>>().expect("outlines");
    assert_eq!(read, std::slice::from_ref(&frame));
    let mut without = OutlineWriter::new(Vec::new(), WriterOptions::default()).expect("memory");
    assert!(without.write(&frame).expect_err("no column").to_string().contains("contour column"));
    let torn = "frame,time,x,y,contour\n0,0,0,0,a\n0,0,9,0,a\n0,0,0,9,a\n0,0,1,1,b\n0,0,2,1,b\n0,0,1,2,b\n0,0,5,1,a\n";
    let error = OutlineReader::new(torn.as_bytes(), "csv").expect("a header").next().expect("a row").expect_err("torn");
    assert!(error.to_string().contains("contour \"a\" comes a second time"), "{error}");
}

#[test]
fn points_of_grey_pictures_state_deviations_that_come_back_from_csv_in_their_order() {
    let outline = traced(Contours::All, true);
    let stated: Vec<f64> = Outline::Closed(outline.clone()).deviations().expect("deviations").collect();
    assert_eq!(stated.len(), outline.points().len() + outline.inner()[0].len());
    // The picture has no noise, and its edges are those of a box: a hundredth of a pixel is what any edge is known to.
    assert!(stated.iter().all(|deviation| (0.005..2.0).contains(deviation)), "{stated:?}");
    let frame = |outline| OutlineFrame { frame: 0, time: 0.0, object: "0".to_owned(), outline };
    let frames = [frame(Outline::Closed(outline.clone())), {
        let without = ClosedOutline::new(outline.points().to_vec()).expect("an outline");
        OutlineFrame { frame: 1, time: 1.0, ..frame(without.into()) }
    }];
    let options = WriterOptions::needed_for(&frames);
    assert!(options.deviation_column);
    let mut writer = OutlineWriter::new(Vec::new(), options).expect("memory");
    frames.iter().for_each(|frame| writer.write(frame).expect("memory"));
    let csv = writer.finish().expect("memory");
    let read: Vec<_> =
        OutlineReader::new(&csv[..], "csv").expect("a header").collect::<Result<_, _>>().expect("outlines");
    assert_eq!(read, frames);
    // Without the column the points are the same.
    let options = WriterOptions { deviation_column: false, ..options };
    let mut writer = OutlineWriter::new(Vec::new(), options).expect("memory");
    writer.write(&frames[0]).expect("memory");
    let csv = writer.finish().expect("memory");
    let read = OutlineReader::new(&csv[..], "csv").expect("a header").next().expect("an outline").expect("an outline");
    assert!(read.outline.deviations().is_none() && read.outline.points().eq(frames[0].outline.points()));
}
