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
fn of_many_reasons_ten_are_told_and_the_other_pictures_by_their_numbers() {
    let mut left_out = PicturesLeftOut::default();
    (0..14).for_each(|frame| left_out.take(frame, &format!("a/long/way/{frame}.png"), "it is dark"));
    let page = page(&Report { left_out: Some(&left_out), ..Report::default() });
    assert!(page.contains("Pictures without an outline: 14"));
    assert_eq!(page.matches("it is dark").count(), 10);
    assert!(page.contains("<li>3.png: frame 3: it is dark</li>") && !page.contains("long/way"), "{page}");
    assert!(page.contains("<li>4 more: 10-13</li>"), "{page}");
}

#[test]
fn of_pictures_left_out_of_one_file_the_file_is_named_once_and_each_reason_too() {
    let mut left_out = PicturesLeftOut::default();
    (0..60).for_each(|frame| {
        left_out.take(frame, "a/long/way/film.gif", if frame == 7 { "grey" } else { "dark" });
    });
    let page = page(&Report { left_out: Some(&left_out), ..Report::default() });
    let list = "<ul>\n<li>film.gif: frames 0-6, 8-59: dark</li>\n<li>frame 7: grey</li>\n</ul>";
    assert!(page.contains(list) && !page.contains("long/way"), "{page}");
}

#[test]
fn however_many_pictures_share_a_reason_all_of_them_are_told() {
    let mut left_out = PicturesLeftOut::default();
    (0..3000).for_each(|frame| left_out.take(frame, "film.gif", "dark"));
    // Every other one is of another reason: their numbers are no longer a few runs.
    (3000..3600).for_each(|frame| left_out.take(frame, "film.gif", if frame % 2 == 0 { "dark" } else { "grey" }));
    let page = page(&Report { left_out: Some(&left_out), ..Report::default() });
    assert!(page.contains("Pictures without an outline: 3600"));
    let [dark, grey] = ["dark", "grey"].map(|reason| {
        let line = page.lines().find(|line| line.ends_with(&format!(": {reason}</li>"))).expect("a line");
        line.to_owned()
    });
    assert!(dark.starts_with("<li>film.gif: frames 0-3000, 3002, ") && dark.contains(" and 200 more: "), "{dark}");
    assert!(grey.starts_with("<li>frames 3001, 3003, ") && grey.contains(" and 200 more: "), "{grey}");
    assert!(!page.contains(": </li>"), "{page}");
}

#[test]
fn a_page_without_a_player_loads_no_script_and_nothing_from_elsewhere() {
    let page = page(&Report { title: "<b>".to_owned(), ..Report::default() });
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("<title>&lt;b&gt;</title>"));
    assert!(!page.contains("<script") && !page.contains("http"), "{page}");
}
