//! Pictures that are traced side by side.
use std::sync::Arc;

use freeform_outline_io::{
    Background, GrayImage, PictureError, PictureErrorKind, PictureFrame, PictureOutlines, PictureSettings, Selection,
};
use image::Luma;

/// Light discs on dark ground.
fn discs(centres: &[f64], radius: f64) -> Arc<GrayImage> {
    Arc::new(GrayImage::from_fn(160, 60, |column, row| {
        let distance = |centre: &f64| (f64::from(column) + 0.5 - centre).hypot(f64::from(row) + 0.5 - 30.0);
        let nearest = centres.iter().map(distance).fold(f64::INFINITY, f64::min);
        Luma([(20.0 + 180.0 * (radius - nearest + 0.5).clamp(0.0, 1.0)) as u8])
    }))
}

fn frame(frame: u64, picture: Arc<GrayImage>) -> Result<PictureFrame, PictureError> {
    Ok(PictureFrame { frame, time: frame as f64, file: format!("{frame}.png"), picture })
}

#[test]
fn they_give_what_they_give_one_after_the_other() {
    let shared = discs(&[30.0], 10.0);
    let read = |number: u64| match number {
        4 | 7 => Err(PictureError { file: format!("{number}.png"), frame: None, kind: PictureErrorKind::NotAFile }),
        // The same as before, and once more.
        6..=9 => frame(number, Arc::clone(&shared)),
        // Nothing to be seen.
        11 => frame(number, Arc::new(GrayImage::new(160, 60))),
        _ => frame(number, discs(&[20.0 + 2.0 * number as f64], 9.0)),
    };
    for background in [None, Some(Background::RunningMedian(5)), Some(Background::Surface)] {
        let settings = PictureSettings { background, ..PictureSettings::default() };
        let traced = |at_once: usize| {
            let outlines = PictureOutlines::new((0..15).map(read), settings.clone()).expect("settings");
            outlines.tracing_at_once(at_once).map(|item| item.map_err(|error| error.to_string())).collect::<Vec<_>>()
        };
        let one = traced(1);
        assert_eq!(one.len(), 15);
        assert!(one.iter().flatten().filter(|traced| traced.objects.is_ok()).count() > 5);
        for at_once in [0, 2, 3, 7, 100] {
            assert_eq!(traced(at_once), one, "{at_once} at once");
        }
    }
}

#[test]
fn an_object_that_is_kept_while_it_is_not_traced_has_its_name_again() {
    // For longer than a name is kept by itself; the other one stays.
    let centres = |number: u64| if (5..25).contains(&number) { vec![120.0] } else { vec![30.0, 120.0] };
    let names = |at_once: usize, keeps: bool| {
        let settings = PictureSettings { selection: Selection::All, ..PictureSettings::default() };
        let pictures = (0..30).map(|number| frame(number, discs(&centres(number), 10.0)));
        let mut outlines = PictureOutlines::new(pictures, settings).expect("settings").tracing_at_once(at_once);
        let mut names = Vec::new();
        while let Some(traced) = outlines.next() {
            let traced = traced.expect("a picture");
            if keeps {
                (0..2).for_each(|name| outlines.keep(name, traced.frame.frame));
            }
            names = traced.objects.expect("objects").into_iter().map(|(name, _)| name).collect();
        }
        names
    };
    for at_once in [1, 4] {
        assert_eq!(names(at_once, true), [0, 1], "{at_once} at once");
        assert!(names(at_once, false).contains(&2), "{at_once} at once");
    }
}

#[test]
fn a_source_that_has_ended_is_not_asked_again() {
    let mut left = 5;
    let mut is_over = false;
    let source = std::iter::from_fn(|| {
        assert!(!is_over, "asked again");
        is_over = left == 0;
        left -= i32::from(left > 0);
        (!is_over).then(|| frame(5 - left as u64, discs(&[30.0], 10.0)))
    });
    let mut outlines = PictureOutlines::new(source, PictureSettings::default()).expect("settings").tracing_at_once(4);
    assert_eq!(outlines.by_ref().count(), 5);
    assert!(outlines.next().is_none());
}
