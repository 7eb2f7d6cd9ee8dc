//! What a report says and what it leaves out.
use freeform_drawing::{PictureLeftOut, PicturesLeftOut, Report, write_report};

fn page(report: &Report<'_>) -> String {
    let mut page = Vec::new();
    write_report(&mut page, report).expect("memory");
    String::from_utf8(page).expect("UTF-8")
}

#[test]
fn a_report_that_no_command_made_has_none() {
    assert!(!page(&Report::default()).contains("<h2>Command</h2>"));
    let report = Report { command: "freeform identify a&b.csv".to_owned(), ..Report::default() };
    assert!(page(&report).contains("<h2>Command</h2>\n<pre>freeform identify a&amp;b.csv</pre>"));
}

fn left_out(frame: u64, file: String, reason: &str) -> PictureLeftOut {
    PictureLeftOut { frame, file, reason: reason.to_owned() }
}

#[test]
fn of_many_pictures_left_out_ten_are_told_with_their_reasons_and_the_others_by_their_numbers() {
    let first: Vec<_> = (0..12).map(|frame| left_out(frame, format!("a/long/way/{frame}.png"), "it is dark")).collect();
    let page = page(&Report { left_out: PicturesLeftOut { count: 14, first: &first }, ..Report::default() });
    assert!(page.contains("Pictures without an outline: 14"));
    assert_eq!(page.matches("it is dark").count(), 10);
    assert!(page.contains("<li>3.png: frame 3: it is dark</li>") && !page.contains("long/way"), "{page}");
    assert!(page.contains("<li>4 more: 10-11</li>"), "{page}");
}

#[test]
fn of_pictures_left_out_of_one_file_the_file_is_named_once_and_each_reason_too() {
    let film = || "a/long/way/film.gif".to_owned();
    let first: Vec<_> =
        (0..60).map(|frame| left_out(frame, film(), ["dark", "grey"][usize::from(frame == 7)])).collect();
    let page = page(&Report { left_out: PicturesLeftOut { count: 60, first: &first }, ..Report::default() });
    let list = "<ul>\n<li>film.gif: frames 0-6, 8-59: dark</li>\n<li>frame 7: grey</li>\n</ul>";
    assert!(page.contains(list) && !page.contains("long/way"), "{page}");
}

#[test]
fn a_page_without_a_player_loads_no_script_and_nothing_from_elsewhere() {
    let page = page(&Report { title: "<b>".to_owned(), ..Report::default() });
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("<title>&lt;b&gt;</title>"));
    assert!(!page.contains("<script") && !page.contains("http"), "{page}");
}
