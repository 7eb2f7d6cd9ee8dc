//! What a report says and what it leaves out.
use freeform_drawing::{PicturesLeftOut, Report, write_report};

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

#[test]
fn of_many_pictures_left_out_ten_are_told_with_their_reasons_and_the_others_by_their_numbers() {
    let first: Vec<(u64, String)> = (0..12).map(|frame| (frame, format!("picture {frame} is dark"))).collect();
    let page = page(&Report { left_out: PicturesLeftOut { count: 12, first: &first }, ..Report::default() });
    assert!(page.contains("Pictures without an outline: 12"));
    assert_eq!(page.matches("is dark").count(), 10);
    assert!(page.contains("<li>2 more: 10-11</li>"), "{page}");
}

#[test]
fn a_page_without_a_player_loads_no_script_and_nothing_from_elsewhere() {
    let page = page(&Report { title: "<b>".to_owned(), ..Report::default() });
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("<title>&lt;b&gt;</title>"));
    assert!(!page.contains("<script") && !page.contains("http"), "{page}");
}
